#include "io/phat/web_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <set>

#include "io/base/content_name.h"
#include "io/base/file_error.h"
#include "io/gltf/glb_builder.h"
#include "io/gltf/gltf_rewrite.h"
#include "io/gltf/gltf_source.h"

namespace phat {
namespace {

using nlohmann::json;

struct Later {
    std::string name;
    std::set<uint64_t> views;
};

// The bufferViews of payloads that diffuse light does without, by the part that they belong to.
std::vector<Later> laterViews(const json& extension) {
    std::vector<Later> parts;
    const auto add = [](Later& part, const json& object, std::initializer_list<const char*> keys) {
        for (const char* key : keys)
            if (object.contains(key)) part.views.insert(wholeNumber(object[key], "bufferView"));
    };
    const auto addSource = [&](const json& source, const std::string& name) {
        for (size_t i = 0; i < source.at("layers").size(); ++i) {
            parts.push_back({i == 0 ? name : fmt::format("{}-{}", name, i + 1), {}});
            add(parts.back(), source["layers"][i], {"radiance", "direction", "scrambles", "pdf"});
            if (i == 0) add(parts.back(), source, {"guides"});
        }
    };
    addSource(extension.at("area"), "lamps");
    addSource(extension.at("indirect"), "reflections");
    if (!parts.empty()) add(parts.front(), extension.at("tiles"), {"distances"});
    if (!parts.empty() && extension.contains("bvh")) add(parts.front(), extension["bvh"], {"nodes", "order"});
    if (!parts.empty() && extension.contains("probes"))
        add(parts.front(), extension["probes"], {"cells", "places", "indirect", "area", "distances"});
    return parts;
}

// Views are copied one by one, and many may look at the same bytes.
void checkOverlaps(const GltfSource& source) {
    constexpr uint64_t kMaxUses = 4;  // of a byte, in the mean
    uint64_t held = 0, viewed = 0;
    for (const auto& buffer : source.buffers) held += buffer.size();
    for (const json& view : source.json.at("bufferViews")) {
        viewed += std::min(wholeNumber(view, "byteLength"), held);
        if (viewed > kMaxUses * held) throw std::runtime_error("too many of its bufferViews overlap");
    }
}

WebParts split(const GltfSource& source, const std::string& stem) {
    checkOverlaps(source);
    const std::vector<Later> later = laterViews(source.json.at("extensions").at(kPhatExtension));
    GlbBuilder room{source.json, {}};
    std::vector<GlbBuilder> parts(later.size());
    json& views = room.json.at("bufferViews");
    for (uint64_t i = 0; i < views.size(); ++i) {
        const auto owner = std::find_if(later.begin(), later.end(),
                                        [&](const Later& part) { return part.views.contains(i); });
        const size_t part = size_t(owner - later.begin());
        GlbBuilder& to = owner == later.end() ? room : parts[part];
        while (to.bin.size() % 4 != 0) to.bin.push_back(0);
        const auto bytes = bufferViewBytes(source, i);
        views[i]["buffer"] = owner == later.end() ? 0 : part + 1;
        views[i]["byteOffset"] = to.bin.size();
        to.bin.insert(to.bin.end(), bytes.begin(), bytes.end());
    }
    WebParts result;
    room.json["buffers"] = json::array({json::object()});
    for (size_t i = 0; i < parts.size(); ++i) {
        WebPart& part = result.later.emplace_back();
        part.uri = contentName(stem + "." + later[i].name, parts[i].bin, "bin");
        part.bytes = std::move(parts[i].bin);
        room.json["buffers"].push_back({{"uri", part.uri}, {"byteLength", part.bytes.size()}});
    }
    std::vector<uint8_t> bytes = glbBytes(room);
    const std::string name = contentName(stem, bytes, "glb");
    result.room = {name, std::move(bytes)};
    return result;
}

}  // namespace

WebParts splitForWeb(GltfSource source, const std::string& stem) {
    assert(source.buffers.empty());
    try {
        readGltfBuffers(source);
        return split(source, stem);
    } catch (const json::exception& error) {
        throw FileError(source.path, error.what());
    } catch (const std::runtime_error& error) {
        throw FileError(source.path, error.what());
    }
}

}  // namespace phat
