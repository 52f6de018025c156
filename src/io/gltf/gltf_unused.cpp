#include "io/gltf/gltf_unused.h"

#include <map>
#include <set>
#include <string>

#include "io/gltf/gltf_json.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

// Indices that are reached, by the array that they point into.
using Reached = std::map<std::string, std::set<uint64_t>>;

// Attributes that the loader reads, by how their names begin.
bool isRead(const std::string& attribute) {
    for (const char* name : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"})
        if (attribute == name) return true;
    return attribute.starts_with("JOINTS_") || attribute.starts_with("WEIGHTS_");
}

// Follows the references of JSON that may be anything: what is no index is not followed.
class Walk {
  public:
    Walk(const GltfSource& source, Reached& reached) : gltf_(source.json), reached_(reached) {}

    void run() {
        for (const uint64_t node : sceneNodes(gltf_, true)) visitNode(node);
        visitJoints();
        if (gltf_.contains("extensions")) visitViews(gltf_["extensions"], 0);
        for (size_t i = 0; i < countOf(gltf_, "animations"); ++i) visitAnimation(gltf_["animations"][i]);
    }

  private:
    // The element that object[key] points at, the first time that it is reached.
    const json* follow(const json& object, const char* key, const char* array) {
        const auto index = object.find(key);
        if (index == object.end() || !index->is_number_unsigned()) return nullptr;
        const uint64_t at = index->get<uint64_t>();
        if (at >= countOf(gltf_, array) || !reached_[array].insert(at).second) return nullptr;
        const json& element = gltf_[array][at];
        return element.is_object() ? &element : nullptr;
    }

    void visitNode(uint64_t index) {
        reached_["nodes"].insert(index);
        const json& node = gltf_["nodes"][index];
        if (const json* mesh = follow(node, "mesh", "meshes"))
            for (size_t p = 0; p < countOf(*mesh, "primitives"); ++p)
                visitPrimitive((*mesh)["primitives"][p]);
        if (const json* skin = follow(node, "skin", "skins")) visitAccessor(*skin, "inverseBindMatrices");
        follow(node, "camera", "cameras");
        if (const json* instancing = findExtension(node, "EXT_mesh_gpu_instancing"))
            if (instancing->contains("attributes"))
                for (const auto& item : instancing->at("attributes").items())
                    visitAccessor(instancing->at("attributes"), item.key().c_str());
    }

    // Joints may stand outside the scene; their transforms count all the same.
    void visitJoints() {
        if (reached_["skins"].empty()) return;
        const std::vector<int64_t> parents = parentNodes(gltf_);
        for (const uint64_t skin : reached_["skins"])
            for (const json& joint : gltf_["skins"][skin].at("joints"))
                for (int64_t node = joint.get<int64_t>(); node >= 0 && size_t(node) < parents.size();
                     node = parents[size_t(node)])
                    if (!reached_["nodes"].insert(uint64_t(node)).second) break;
    }

    void visitPrimitive(const json& primitive) {
        if (!primitive.is_object()) return;
        visitAttributes(primitive, "attributes");
        visitAccessor(primitive, "indices");
        if (primitive.contains("targets") && primitive["targets"].is_array())
            for (const json& target : primitive["targets"])
                if (target.is_object())
                    for (const auto& item : target.items()) visitAccessor(target, item.key().c_str());
        if (const json* draco = findExtension(primitive, "KHR_draco_mesh_compression"))
            follow(*draco, "bufferView", "bufferViews");
        visitMaterial(primitive);
        if (const json* variants = findExtension(primitive, "KHR_materials_variants"))
            for (size_t i = 0; i < countOf(*variants, "mappings"); ++i)
                if ((*variants)["mappings"][i].is_object()) visitMaterial((*variants)["mappings"][i]);
    }

    void visitAttributes(const json& primitive, const char* key) {
        const auto attributes = primitive.find(key);
        if (attributes == primitive.end() || !attributes->is_object()) return;
        for (const auto& item : attributes->items())
            if (isRead(item.key())) visitAccessor(*attributes, item.key().c_str());
    }

    void visitAccessor(const json& object, const char* key) {
        if (!object.is_object()) return;
        const json* accessor = follow(object, key, "accessors");
        if (!accessor) return;
        follow(*accessor, "bufferView", "bufferViews");
        if (!accessor->contains("sparse") || !(*accessor)["sparse"].is_object()) return;
        for (const char* part : {"indices", "values"})
            if ((*accessor)["sparse"].contains(part) && (*accessor)["sparse"][part].is_object())
                follow((*accessor)["sparse"][part], "bufferView", "bufferViews");
    }

    void visitMaterial(const json& object) {
        if (const json* material = follow(object, "material", "materials")) visitTextures(*material, 0);
    }

    // Anything in a material with an "index" is a texture.
    void visitTextures(const json& value, int depth) {
        constexpr int kMaxDepth = 16;
        if (depth > kMaxDepth) return;
        if (value.is_object()) {
            if (const json* texture = follow(value, "index", "textures")) {
                follow(*texture, "source", "images");
                follow(*texture, "sampler", "samplers");
                visitImages(*texture);
            }
        }
        if (value.is_object() || value.is_array())
            for (const json& child : value) visitTextures(child, depth + 1);
    }

    void visitImages(const json& texture) {
        for (const char* name : {"EXT_texture_webp", "EXT_texture_avif"})
            if (const json* extension = findExtension(texture, name)) follow(*extension, "source", "images");
        for (const uint64_t image : reached_["images"])
            if (gltf_["images"][image].is_object())
                follow(gltf_["images"][image], "bufferView", "bufferViews");
    }

    void visitViews(const json& value, int depth) {
        constexpr int kMaxDepth = 32;
        if (depth > kMaxDepth || (!value.is_object() && !value.is_array())) return;
        if (value.is_object()) follow(value, "bufferView", "bufferViews");
        for (const json& child : value) visitViews(child, depth + 1);
    }

    void visitAnimation(const json& animation) {
        for (const json& sampler : animation.at("samplers"))
            for (const char* key : {"input", "output"}) visitAccessor(sampler, key);
    }

    const json& gltf_;
    Reached& reached_;
};

// 1x1 white.
constexpr const char* kWhiteUri =
    "data:image/"
    "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAG7buVgAAAABJRU5ErkJggg"
    "==";

json named(const json& element) {
    if (element.is_object() && element.contains("name") && element["name"].is_string())
        return {{"name", element["name"]}};
    return json::object();
}

// The least that an element of the array may be.
json harmless(const GltfSource& source, const std::string& array, const json& element) {
    if (array == "meshes") return {{"primitives", json::array({{{"attributes", json::object()}}})}};
    if (array == "accessors") return {{"componentType", 5126u}, {"type", "SCALAR"}, {"count", 1u}};
    if (array == "bufferViews") return {{"buffer", source.buffers.size()}, {"byteLength", 4u}};
    if (array == "images") return {{"uri", kWhiteUri}};
    if (array == "cameras")
        return {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.01}}}};
    return array == "materials" || array == "nodes" ? named(element) : json::object();
}

void dropUnreadAttributes(json& gltf) {
    for (size_t m = 0; m < countOf(gltf, "meshes"); ++m) {
        json& mesh = gltf["meshes"][m];
        for (size_t p = 0; p < countOf(mesh, "primitives"); ++p) {
            json& primitive = mesh["primitives"][p];
            if (!primitive.is_object() || !primitive.contains("attributes")) continue;
            json& attributes = primitive["attributes"];
            for (auto it = attributes.begin(); attributes.is_object() && it != attributes.end();)
                it = isRead(it.key()) ? std::next(it) : attributes.erase(it);
        }
    }
}

void dropBrokenAnimations(GltfSource& source) {
    json playable = json::array();
    for (size_t i = 0; i < countOf(source.json, "animations"); ++i) {
        json animation = source.json["animations"][i];
        if (countOf(animation, "samplers") == 0 || countOf(animation, "channels") == 0) continue;
        dropBrokenChannels(source, animation);
        if (!animation["channels"].empty()) playable.push_back(std::move(animation));
    }
    source.json.erase("animations");
    if (!playable.empty()) source.json["animations"] = std::move(playable);
}

}  // namespace

bool leaveOutUnused(GltfSource& source) {
    const json before = source.json;
    json& gltf = source.json;
    dropBrokenAnimations(source);
    Reached reached;
    Walk(source, reached).run();
    for (const char* array : {"nodes", "meshes", "accessors", "bufferViews", "materials", "textures",
                              "images", "samplers", "cameras"})
        for (size_t i = 0; i < countOf(gltf, array); ++i)
            if (!reached[array].contains(i)) gltf[array][i] = harmless(source, array, gltf[array][i]);
    for (size_t i = 0; i < countOf(gltf, "scenes"); ++i)
        if (i != gltf.value("scene", size_t(0))) gltf["scenes"][i] = json::object();
    dropUnreadAttributes(gltf);
    source.buffers.push_back(std::vector<uint8_t>(4));
    return gltf != before;
}

}  // namespace phat::gltf
