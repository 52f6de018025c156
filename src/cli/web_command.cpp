// phat web: a folder that any web server can host, with a baked room to walk through.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "cli/commands.h"
#include "cli/data_folders.h"
#include "cli/exposure.h"
#include "cli/interrupt.h"
#include "cli/progress_bar.h"
#include "cli/render_methods.h"
#include "cli/render_options.h"
#include "core/scene/default_camera.h"
#include "core/scene/enclosure.h"
#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/baked_file.h"
#include "io/phat/web_parts.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRoom = "room.glb";
constexpr const char* kPartsStem = "room";
constexpr const char* kPoster = "poster.jpg";
constexpr int kPosterWidth = 960;

struct WebOptions {
    std::string input, site, title;
    std::optional<float> exposureStops;  // none: the poster's own
    bool quiet = false;
};

std::string readText(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) throw FileError(path.string(), "the viewer is not built; `make web` does it");
    return text.str();
}

void writeText(const fs::path& path, const std::string& text) {
    replaceFile(path.string(), std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

void fill(std::string& page, const std::string& placeholder, const std::string& value) {
    const size_t at = page.find(placeholder);
    if (at == std::string::npos) throw FileError(siteFolder(), "the viewer was built by another version");
    page.replace(at, placeholder.size(), value);
}

// The viewer's JavaScript by the files' names: what a page begins with, and what it loads when needed.
std::map<std::string, std::string> readScripts(const fs::path& built) {
    std::map<std::string, std::string> scripts;
    for (const auto& entry : fs::directory_iterator(built))
        if (entry.path().extension() == ".js")
            scripts[entry.path().filename().string()] = readText(entry.path());
    return scripts;
}

// Returns its exposure.
double writePoster(const WebOptions& options, const fs::path& site, Progress& progress) {
    RenderOptions poster;
    poster.input = options.input;
    poster.output = (site / kPoster).string();
    poster.width = kPosterWidth;
    poster.reflections = Reflections::lookup;  // as the page draws
    poster.exposureStops = options.exposureStops;
    return renderDrawn(poster, progress).front().at("exposure").at("stops").get<double>();
}

// Eye, target and field of view in degrees of a file without a camera that pages show by; else nothing.
std::string defaultCameraOf(const RayScene& rays) {
    const Scene& scene = rays.scene();
    const bool has = std::any_of(scene.cameras.begin(), scene.cameras.end(),
                                 [](const Camera& camera) { return camera.perspective; });
    if (has) return "";
    const DefaultView view = defaultView(rays, LightSampler(scene));
    const glm::vec3 eye(view.camera.worldFromCamera[3]);
    return fmt::format("{} {} {} {} {} {} {}", eye.x, eye.y, eye.z, view.target.x, view.target.y,
                       view.target.z, glm::degrees(view.camera.yfovRadians));
}

// Corners of boxes, low and high, in which an eye is inside.
std::string roomsOf(const RayScene& rays) {
    std::string text;
    for (const Bounds& box : roomBoxes(rays))
        text += fmt::format("{}{:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.5g}", text.empty() ? "" : " ", box.low.x,
                            box.low.y, box.low.z, box.high.x, box.high.y, box.high.z);
    return text;
}

void writeSite(const WebOptions& options) {
    GltfSource source = openGltf(options.input);
    if (!isBakedFile(source)) throw FileError(options.input, "is not a baked file: `phat bake` makes one");
    if (phatexelStorage(source) != PhatexelStorage::packed)
        throw FileError(
            options.input,
            "has PHATexels in the paper's storage, which pages do not read: bake without --storage paper");
    const fs::path site = options.site, built = siteFolder();
    std::string page = readText(built / "index.html");
    const std::map<std::string, std::string> scripts = readScripts(built);
    const std::string style = readText(built / "viewer.css");
    const std::string name = fs::path(options.input).filename().string();
    fill(page, "@TITLE@", escaped(options.title.empty() ? name.substr(0, name.find('.')) : options.title));
    {
        const Scene scene = readBakedFile(options.input).loaded.scene;
        const RayScene rays(scene);
        fill(page, "@CAMERA@", defaultCameraOf(rays));
        fill(page, "@ROOMS@", roomsOf(rays));
    }
    const WebParts parts = splitForWeb(source, kPartsStem);

    std::error_code error;
    fs::create_directories(site, error);
    if (error) throw FileError(options.site, "cannot be created: " + error.message());
    catchInterrupts();
    ProgressBar progress(progressStyle(options.quiet), {});
    const double exposure = writePoster(options, site, progress);
    fill(page, "@EXPOSURE@", fmt::format("{}", exposure));
    for (const WebPart& part : parts.later) replaceFile((site / part.uri).string(), part.bytes);
    replaceFile((site / kRoom).string(), parts.room);
    for (const auto& [script, text] : scripts) writeText(site / script, text);
    writeText(site / "viewer.css", style);
    writeText(site / "index.html", page);
    if (options.quiet) return;
    uint64_t bytes = 0, first = parts.room.size();
    for (const auto& entry : fs::directory_iterator(site)) bytes += entry.file_size();
    for (const auto& [script, text] : scripts)
        if (page.find('"' + script + '"') != std::string::npos) first += text.size();
    fmt::print("{}: {:.1f} MB; a first picture after {:.1f} MB\n", options.site, double(bytes) * 1e-6,
               double(first) * 1e-6);
}

}  // namespace

void addWebCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("web", "Write a page that shows a baked file, for any web server");
    CLI::Option* input = command->add_option("IN", "A .phat.glb file")->required();
    CLI::Option* site = command->add_option("-o,--output", "Folder of the page; made if missing")
                            ->type_name("SITE")
                            ->required();
    CLI::Option* title =
        command->add_option("--title", "Of the page; default: the file's name")->type_name("TEXT");
    const auto exposure = std::make_shared<std::optional<float>>();
    declareExposure(*command, *exposure);
    CLI::Option* quiet = command->add_flag("--quiet")->description("Say nothing");
    command->footer(
        "The folder is complete: no other site is asked for anything. Browsers load it from a web server\n"
        "only, e.g.: python3 -m http.server --directory room-site\n"
        "Example: phat web room.phat.glb -o room-site");
    command->callback([=] {
        WebOptions options;
        options.input = input->as<std::string>();
        options.site = site->as<std::string>();
        if (*title) options.title = title->as<std::string>();
        options.exposureStops = *exposure;
        options.quiet = quiet->count() > 0;
        writeSite(options);
    });
}

}  // namespace phat
