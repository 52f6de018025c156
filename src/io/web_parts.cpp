#include "io/web_parts.h"

#include <set>

#include "io/file_error.h"
#include "io/glb_builder.h"
#include "io/gltf_rewrite.h"
#include "io/gltf_source.h"

namespace phat {
namespace {

using nlohmann::json;

// The bufferViews of payloads that diffuse light does without.
std::set<uint64_t> reflectionViews(const json& extension) {
    std::set<uint64_t> views;
    const auto add = [&](const json& object, const char* key) {
        if (object.contains(key)) views.insert(wholeNumber(object[key], "bufferView"));
    };
    for (const char* source : {"indirect", "area"}) {
        add(extension.at(source), "guides");
        for (const json& layer : extension.at(source).at("layers"))
            for (const char* key : {"radiance", "direction", "scrambles", "pdf"}) add(layer, key);
    }
    add(extension.at("tiles"), "distances");
    return views;
}

WebParts split(const GltfSource& source, const std::string& reflectionsUri) {
    const json& extension = source.json.at("extensions").at(kPhatExtension);
    const std::set<uint64_t> later = reflectionViews(extension);
    GlbBuilder room{source.json, {}}, reflections;
    json& views = room.json.at("bufferViews");
    for (uint64_t i = 0; i < views.size(); ++i) {
        const bool isLater = later.count(i) > 0;
        GlbBuilder& part = isLater ? reflections : room;
        while (part.bin.size() % 4 != 0) part.bin.push_back(0);
        const auto bytes = bufferViewBytes(source, i);
        views[i]["buffer"] = isLater ? 1 : 0;
        views[i]["byteOffset"] = part.bin.size();
        part.bin.insert(part.bin.end(), bytes.begin(), bytes.end());
    }
    if (!later.empty())
        room.json["buffers"] = {json::object(),
                                {{"uri", reflectionsUri}, {"byteLength", reflections.bin.size()}}};
    return {glbBytes(room), std::move(reflections.bin)};
}

}  // namespace

WebParts splitForWeb(const std::string& path, const std::string& reflectionsUri) {
    try {
        return split(readGltfSource(path), reflectionsUri);
    } catch (const json::exception& error) {
        throw FileError(path, error.what());
    } catch (const std::runtime_error& error) {
        throw FileError(path, error.what());
    }
}

}  // namespace phat
