#include "io/gltf/gltf_rewrite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_keep.h"

namespace phat {
namespace {

using nlohmann::json;

using gltf::kByte, gltf::kFloat, gltf::kShort, gltf::kUnsignedByte, gltf::kUnsignedInt, gltf::kUnsignedShort;

std::string texCoordName(uint64_t index) {
    return fmt::format("TEXCOORD_{}", index);
}

bool isSkinAttribute(std::string_view name) {
    return name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
}

void dropEarlierBake(json& file) {
    const auto pointer = json::json_pointer(std::string("/extensions/") + kPhatExtension);
    if (!file.contains(pointer)) return;
    const std::string atlasUv = texCoordName(wholeNumber(file[pointer], "texCoord"));
    for (json& mesh : file["meshes"])
        for (json& primitive : mesh["primitives"]) primitive["attributes"].erase(atlasUv);
    gltf::eraseExtension(file, kPhatExtension);
    gltf::forgetExtension(file, kPhatExtension);
}

// The first index that no surface uses; never 0, which materials take for the first of their own.
uint32_t freeTexCoord(const json& gltf, const Scene& scene) {
    uint32_t index = 1;
    for (const Surface& surface : scene.surfaces) {
        const json& attributes =
            gltfItem(gltf, "meshes", surface.mesh).at("primitives").at(surface.primitive).at("attributes");
        while (attributes.contains(texCoordName(index))) ++index;
    }
    return index;
}

// The surface's vertices, split so that each has one position in the atlas.
struct SplitVertices {
    std::vector<uint32_t> sourceVertex;  // per new vertex
    std::vector<glm::vec2> uv;           // of the atlas
    std::vector<uint32_t> indices;
};

SplitVertices splitVertices(const Surface& surface, const SurfaceCorners& corners, const SurfacePart& part) {
    constexpr uint32_t kNone = ~0u;
    SplitVertices split;
    std::vector<uint32_t> first(corners.vertexCount, kNone);  // copies of a vertex form a list
    std::vector<uint32_t> next;
    for (size_t t = 0; t < part.triangles.size(); ++t) {
        for (int slot = 0; slot < 3; ++slot) {
            const int corner = swappedCorner(slot, corners.swapped != part.back);
            const uint32_t vertex = corners.vertices[part.triangles[t] - surface.firstTriangle][corner];
            const glm::vec2 uv = part.uvs[t][corner];
            if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1))
                throw std::runtime_error("the atlas places a triangle outside itself");
            uint32_t copy = first[vertex];
            while (copy != kNone && split.uv[copy] != uv) copy = next[copy];
            if (copy == kNone) {
                copy = uint32_t(split.uv.size());
                split.sourceVertex.push_back(vertex);
                split.uv.push_back(uv);
                next.push_back(std::exchange(first[vertex], copy));
            }
            split.indices.push_back(copy);
        }
    }
    return split;
}

/// What a part's attributes are made of.
struct PartVertices {
    const SurfaceCorners& corners;
    SplitVertices split;
    bool back = false;
};

template <class T>
void addBounds(json& accessor, std::span<const uint8_t> bytes, uint32_t components, size_t elementSize) {
    std::vector<T> low(components), high(components);
    for (size_t at = 0; at < bytes.size(); at += elementSize) {
        for (uint32_t c = 0; c < components; ++c) {
            T value;
            std::memcpy(&value, &bytes[at + c * sizeof(T)], sizeof(T));
            low[c] = at == 0 ? value : std::min(low[c], value);
            high[c] = at == 0 ? value : std::max(high[c], value);
        }
    }
    accessor["min"] = low;
    accessor["max"] = high;
}

// Required of POSITION by the specification (section 3.7.2.1), in the accessor's own component type.
void addBounds(json& accessor, std::span<const uint8_t> bytes, const AccessorElements& from) {
    switch (from.componentType) {
        case kByte:
            return addBounds<int8_t>(accessor, bytes, from.components, from.elementSize);
        case kUnsignedByte:
            return addBounds<uint8_t>(accessor, bytes, from.components, from.elementSize);
        case kShort:
            return addBounds<int16_t>(accessor, bytes, from.components, from.elementSize);
        case kUnsignedShort:
            return addBounds<uint16_t>(accessor, bytes, from.components, from.elementSize);
        default:
            return addBounds<float>(accessor, bytes, from.components, from.elementSize);
    }
}

template <class T>
void negate(std::vector<uint8_t>& bytes) {
    for (size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
        T value;
        std::memcpy(&value, &bytes[at], sizeof(T));
        // The least whole number, which stands for -1 as the one above it does, has no counterpart.
        value = T(-std::max(value, T(-std::numeric_limits<T>::max())));
        std::memcpy(&bytes[at], &value, sizeof(T));
    }
}

// Normals, and tangents with their handedness, of what is turned around.
void turnAround(const std::string& name, uint32_t componentType, std::vector<uint8_t>& bytes) {
    if (name != "NORMAL" && name != "TANGENT") return;
    if (componentType == kFloat) negate<float>(bytes);
    if (componentType == kByte) negate<int8_t>(bytes);
    if (componentType == kShort) negate<int16_t>(bytes);
}

size_t appendAttribute(const GltfSource& source, const std::string& name, uint64_t index,
                       const PartVertices& part, GlbBuilder& glb) {
    const SplitVertices& split = part.split;
    const AccessorElements elements = readAccessor(source, index, part.corners.vertexCount);
    std::vector<uint8_t> bytes(split.sourceVertex.size() * elements.elementSize);
    for (size_t i = 0; i < split.sourceVertex.size(); ++i)
        std::memcpy(&bytes[i * elements.elementSize],
                    &elements.bytes[size_t(split.sourceVertex[i]) * elements.elementSize],
                    elements.elementSize);
    json accessor = gltfItem(source.json, "accessors", index);
    for (const char* key : {"bufferView", "byteOffset", "sparse", "min", "max"}) accessor.erase(key);
    accessor["count"] = split.sourceVertex.size();
    if (name == "POSITION") addBounds(accessor, bytes, elements);
    if (part.back) turnAround(name, elements.componentType, bytes);
    return appendAccessor(glb, std::move(accessor), bytes, ViewTarget::vertices);
}

template <class T>
size_t appendArray(GlbBuilder& glb, uint32_t componentType, const char* type, std::span<const T> values,
                   ViewTarget target) {
    return appendAccessor(glb, {{"componentType", componentType}, {"type", type}, {"count", values.size()}},
                          {reinterpret_cast<const uint8_t*>(values.data()), values.size_bytes()}, target);
}

size_t appendIndices(GlbBuilder& glb, const SplitVertices& split) {
    // 65535 itself would restart the primitive.
    if (split.uv.size() > 65535)
        return appendArray<uint32_t>(glb, kUnsignedInt, "SCALAR", split.indices, ViewTarget::indices);
    const std::vector<uint16_t> narrow(split.indices.begin(), split.indices.end());
    return appendArray<uint16_t>(glb, kUnsignedShort, "SCALAR", narrow, ViewTarget::indices);
}

/// Common to the rewritten primitives of a file.
struct PrimitiveRewriter {
    const GltfSource& source;
    GlbBuilder& glb;
    uint32_t texCoord;                      // of the atlas
    std::map<size_t, size_t> zeroUvs = {};  // accessors by vertex count

    void rewrite(json& primitive, const PartVertices& part);
};

void PrimitiveRewriter::rewrite(json& primitive, const PartVertices& part) {
    const SplitVertices& split = part.split;
    json attributes = json::object();
    for (const auto& [name, index] : primitive.at("attributes").items())
        if (!isSkinAttribute(name))
            attributes[name] = appendAttribute(source, name, index.get<uint64_t>(), part, glb);
    // UV sets must be numbered without gaps; a set that a material misses is read as zeros in any case.
    for (uint32_t set = 0; set < texCoord; ++set) {
        if (attributes.contains(texCoordName(set))) continue;
        const auto [found, isNew] = zeroUvs.try_emplace(split.uv.size(), 0);
        if (isNew) {
            const std::vector<glm::vec2> zeros(split.uv.size(), glm::vec2(0));
            found->second = appendArray<glm::vec2>(glb, kFloat, "VEC2", zeros, ViewTarget::vertices);
        }
        attributes[texCoordName(set)] = found->second;
    }
    attributes[texCoordName(texCoord)] =
        appendArray<glm::vec2>(glb, kFloat, "VEC2", split.uv, ViewTarget::vertices);
    primitive["attributes"] = std::move(attributes);
    primitive["indices"] = appendIndices(glb, split);
    primitive.erase("mode");
    primitive.erase("targets");
}

// A bake is of one pose: what would deform its surfaces goes, in the node, the mesh and the animations.
void dropDeformation(const GltfSource& source, const Scene& scene, const std::vector<size_t>& meshOfSurface,
                     RewrittenGltf& out) {
    json& gltf = out.glb.json;
    std::vector<std::string>& notes = out.notes;
    std::set<uint32_t> nodes;
    size_t skins = 0, morphs = 0;
    for (size_t i = 0; i < scene.surfaces.size(); ++i) {
        if (!nodes.insert(scene.surfaces[i].node).second) continue;
        json& node = gltf["nodes"].at(scene.surfaces[i].node);
        json& mesh = gltf["meshes"].at(meshOfSurface[i]);
        bool morphed = false;
        for (json& primitive : mesh["primitives"]) {
            morphed = primitive.erase("targets") > 0 || morphed;
            json& attributes = primitive["attributes"];
            for (auto it = attributes.begin(); it != attributes.end();)
                it = isSkinAttribute(it.key()) ? attributes.erase(it) : std::next(it);
        }
        mesh.erase("weights");
        node.erase("weights");
        skins += node.erase("skin");
        morphs += morphed;
    }

    size_t channels = 0, broken = 0;
    json animations = json::array();
    for (json& animation : gltf.value("animations", json::array())) {
        broken += gltf::dropBrokenChannels(source, animation);
        json kept = json::array();
        for (const json& channel : animation.at("channels")) {
            const json& target = channel.at("target");
            const bool drops = target.value("path", "") == "weights" && target.contains("node") &&
                               nodes.contains(uint32_t(wholeNumber(target, "node")));
            if (!drops) kept.push_back(channel);
            channels += drops;
        }
        animation["channels"] = std::move(kept);
        if (!animation["channels"].empty()) animations.push_back(std::move(animation));
    }
    gltf.erase("animations");
    if (!animations.empty()) gltf["animations"] = std::move(animations);

    const json& allNodes = gltf["nodes"];
    if (std::none_of(allNodes.begin(), allNodes.end(), [](const json& n) { return n.contains("skin"); }))
        gltf.erase("skins");

    if (skins) notes.push_back(fmt::format("{} skinned meshes are kept in the pose that was baked", skins));
    if (morphs) notes.push_back(fmt::format("morph targets of {} meshes are dropped", morphs));
    if (broken) notes.push_back(fmt::format("{} broken animation channels are dropped", broken));
    if (channels)
        notes.push_back(fmt::format("{} animation channels of morph targets are dropped", channels));
}

// All triangles of a surface.
SurfacePart wholeSurface(const Surface& surface, const Atlas& atlas) {
    SurfacePart whole;
    for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t) {
        whole.triangles.push_back(t);
        std::array<glm::vec2, 3>& uvs = whole.uvs.emplace_back();
        for (int corner = 0; corner < 3; ++corner)
            uvs[size_t(corner)] =
                uvFromTexel(atlas.triangleTexels[t][size_t(corner)] + 0.0f, atlas.sizeTexels);
    }
    return whole;
}

}  // namespace

RewrittenGltf rewriteGltf(const GltfSource& source, const Scene& scene, const Atlas& atlas) {
    std::vector<std::vector<SurfacePart>> parts;
    for (const Surface& surface : scene.surfaces) parts.push_back({wholeSurface(surface, atlas)});
    return rewriteGltf(source, scene, parts);
}

RewrittenGltf rewriteGltf(const GltfSource& source, const Scene& scene,
                          const std::vector<std::vector<SurfacePart>>& parts) {
    RewrittenGltf out;
    json& gltf = out.glb.json = source.json;
    gltf.erase("buffers");
    gltf["bufferViews"] = json::array();
    gltf["accessors"] = json::array();
    dropEarlierBake(gltf);

    Kept kept;
    keepAllIfReferencesAreUnknown(source, out.glb, kept);
    out.texCoord = freeTexCoord(gltf, scene);
    // World-space texels belong to one position.
    const std::vector<size_t> meshOfSurface = gltf::giveNodesTheirOwnMeshes(gltf, scene.surfaces);
    dropDeformation(source, scene, meshOfSurface, out);

    PrimitiveRewriter rewriter{source, out.glb, out.texCoord};
    std::set<std::pair<size_t, size_t>> rewritten;
    for (size_t i = 0; i < scene.surfaces.size(); ++i) {
        const Surface& surface = scene.surfaces[i];
        const size_t mesh = meshOfSurface[i];
        const json original = gltf["meshes"].at(mesh).at("primitives").at(surface.primitive);
        const SurfaceCorners corners = surfaceCorners(source, scene, surface);
        for (const SurfacePart& part : parts[i]) {
            json primitive = original;
            rewriter.rewrite(primitive, {corners, splitVertices(surface, corners, part), part.back});
            json& primitives = gltf["meshes"][mesh]["primitives"];
            const bool first = &part == &parts[i].front();
            const size_t at = first ? surface.primitive : primitives.size();
            if (!first) primitives.push_back(nullptr);
            primitives[at] = std::move(primitive);
            rewritten.insert({mesh, at});
            out.parts.push_back({mesh, at, part.page, part.oneSided});
        }
    }
    keepReferences(source, rewritten, out.glb, kept, out.notes);
    return out;
}

}  // namespace phat
