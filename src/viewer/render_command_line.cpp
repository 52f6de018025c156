#include "viewer/render_command_line.h"

#include <fmt/format.h>

#include "gl/flag_names.h"
#include "io/gltf/material_edit.h"

namespace phat {
namespace {

std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                            "0123456789_-+=.,/:") == std::string::npos;
    if (plain) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string point(glm::vec3 p) {
    return fmt::format("{},{},{}", p.x, p.y, p.z);
}

const char* methodOf(Source source) {
    switch (source) {
        case Source::phat:
        case Source::direct:
            return "phat";
        case Source::phatPyramid:
            return "phat-pyramid";
        case Source::phatPaper:
            return "phat-paper";
        case Source::pathTracer:
            return "path";
        case Source::phatexels:  // pre: not asked for
            break;
    }
    return "phat";
}

}  // namespace

std::string renderCommandLine(const ViewerState& state, glm::ivec2 size) {
    const Document& document = *state.document;
    const ViewSettings& view = state.view;
    std::string line = fmt::format("phat render {} -o picture.png --method {} --size {}x{}",
                                   quoted(document.path), methodOf(view.left), size.x, size.y);
    if (!document.variant.empty()) line += " --variant " + quoted(document.variant);
    if (view.left != Source::pathTracer) line += fmt::format(" --spp {}", kKeptSamples);
    if (state.camera > 0) {
        line += fmt::format(" --camera {}", state.camera);
    } else if (state.camera < 0) {
        const Navigation& navigation = state.navigation;
        line += fmt::format(" --eye {} --target {}", point(eyeOf(navigation)), point(focusOf(navigation)));
        if (navigation.camera.perspective)
            line += fmt::format(" --fov {}", glm::degrees(navigation.camera.yfovRadians));
    }
    const Component component = view.left == Source::direct ? Component::direct : view.component;
    if (component != Component::all)
        line += fmt::format(" --component {}", nameOf(kComponentNames, component));
    line += fmt::format(" --exposure {}", view.exposureStops);
    if (view.toneMap != ToneMap::agx)
        line += fmt::format(" --tonemap {}", nameOf(kToneMapNames, view.toneMap));
    const auto edits = materialEdits(document.edits.original().materials, document.edits.now().materials);
    if (!edits.empty()) line += " --set";
    for (const std::string& edit : edits) line += " " + quoted(edit);
    return line;
}

}  // namespace phat
