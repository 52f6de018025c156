#pragma once
// A small scene with what makes rewriting hard, and a bake of it with random contents.

#include <random>

#include "core/bake/bake.h"
#include "io/gltf/gltf_builder.h"
#include "io/phat/baked_file.h"
#include "support/temporary_folder.h"

namespace phat::test {

/// A cube with normals and two UV sets, quantised and interleaved, shown three times (one of them mirrored);
/// a flat strip without normals and UVs; a mesh of two primitives shown twice; a line; a light and a camera.
inline GltfBuilder hardScene() {
    GltfBuilder gltf;
    gltf.json["extensionsUsed"] = {"KHR_mesh_quantization", "KHR_lights_punctual"};
    gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    gltf.json["extras"] = {{"kept", "as it is"}};
    gltf.push("materials", {{"name", "paint"},
                            {"doubleSided", true},
                            {"pbrMetallicRoughness", {{"roughnessFactor", .3}}}});  // finer texels

    // Six faces; a vertex is position (3 shorts, padded to 8 bytes) and normal (3 bytes, padded to 4).
    std::vector<int8_t> vertices;
    std::vector<float> uv0, uv1;
    std::vector<uint16_t> indices;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = -1; side <= 1; side += 2) {
            const auto first = uint16_t(vertices.size() / 12);
            for (int corner = 0; corner < 4; ++corner) {
                int16_t position[4] = {};
                position[axis] = int16_t(side * 1000);
                position[(axis + 1) % 3] = int16_t(corner % 2 ? 1000 : -1000);
                position[(axis + 2) % 3] = int16_t(corner / 2 ? 1000 : -1000);
                for (const int16_t p : position) {
                    vertices.push_back(int8_t(p & 255));
                    vertices.push_back(int8_t(p >> 8));
                }
                for (int a = 0; a < 4; ++a) vertices.push_back(int8_t(a == axis ? side * 127 : 0));
                uv0.insert(uv0.end(), {float(corner % 2), float(corner / 2)});
                uv1.insert(uv1.end(), {0.1f * float(first), 0.3f * float(corner)});
            }
            for (const int i : side > 0 ? std::array{0, 1, 3, 0, 3, 2} : std::array{0, 3, 1, 0, 2, 3})
                indices.push_back(uint16_t(first + i));
        }
    const int view = gltf.view(vertices, 12);
    const int positions = gltf.accessor(view, kShort, "VEC3", 24);
    gltf.json["accessors"][positions]["min"] = {-1000, -1000, -1000};
    gltf.json["accessors"][positions]["max"] = {1000, 1000, 1000};
    const int normals = gltf.accessor(view, kByte, "VEC3", 24, true, 8);
    const nlohmann::json cube = {{"attributes",
                                  {{"POSITION", positions},
                                   {"NORMAL", normals},
                                   {"TEXCOORD_0", gltf.floats("VEC2", uv0)},
                                   {"TEXCOORD_1", gltf.floats("VEC2", uv1)}}},
                                 {"indices", gltf.indices(indices)},
                                 {"material", 0}};
    const int cubeMesh = gltf.mesh(cube);
    const auto bounded = [&](const std::vector<float>& values, const std::vector<float>& low,
                             const std::vector<float>& high) {
        const int accessor = gltf.floats("VEC3", values);
        gltf.json["accessors"][accessor]["min"] = low;
        gltf.json["accessors"][accessor]["max"] = high;
        return accessor;
    };
    const int strip = bounded({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, .5f, 0, 2, 0}, {0, 0, 0}, {1, 2, .5f});
    const int quad = bounded({0, 0, 0, 2, 0, 0, 2, 0, 2, 0, 0, 2}, {0, 0, 0}, {2, 0, 2});
    const int up = gltf.floats("VEC3", {0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0});
    const nlohmann::json line = {{"attributes", {{"POSITION", quad}}}, {"mode", 1}};
    const nlohmann::json fan = {{"attributes", {{"POSITION", quad}, {"NORMAL", up}}}, {"mode", 6}};
    const nlohmann::json flat = {{"attributes", {{"POSITION", strip}}}, {"mode", 5}};
    const int pair =
        gltf.push("meshes", {{"primitives", nlohmann::json::array({fan, line, flat})}, {"name", "pair"}});

    gltf.root({{"mesh", cubeMesh}, {"scale", {.001, .001, .001}}, {"name", "plain"}});
    gltf.root({{"mesh", pair}, {"translation", {4, 0, 0}}});
    gltf.root({{"mesh", cubeMesh},
               {"scale", {-.001, .002, .001}},
               {"translation", {0, 0, 5}},
               {"name", "mirrored"}});
    gltf.root({{"mesh", pair}, {"rotation", {0, .6, 0, .8}}, {"translation", {0, 4, 0}}});
    gltf.root({{"mesh", cubeMesh}, {"scale", {.0005, .001, .001}}, {"translation", {0, 0, -5}}});
    gltf.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", .7}, {"znear", .1}}}});
    gltf.root({{"camera", 0}, {"translation", {0, 1, 9}}, {"name", "eye"}});
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 5}}};
    gltf.root({{"translation", {0, 6, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return gltf;
}

inline std::vector<uint32_t> randomWords(size_t count, std::mt19937& random) {
    std::vector<uint32_t> words(count);
    for (uint32_t& word : words) word = uint32_t(random());
    return words;
}

inline std::vector<PhatexelLayer> randomLayers(int count, const Atlas& atlas, bool withPdf,
                                               std::mt19937& random) {
    const size_t texels = atlas.texelCount(), blocks = atlas.blockCount;
    std::vector<PhatexelLayer> layers(static_cast<size_t>(count));
    for (PhatexelLayer& layer : layers) {
        for (uint32_t y = 0; y < atlas.sizeTexels.y; ++y)
            for (uint32_t x = 0; x < atlas.sizeTexels.x; ++x) {
                const PackedPhatexel any{uint32_t(random()), uint32_t(random())};
                layer.texels.push_back(atlas.chartAt({x, y}) == kNoChart ? PackedPhatexel{} : any);
            }
        for (size_t i = 0; !withPdf && i < blocks; ++i) layer.scrambles.push_back(random() % 1024);
        if (!withPdf) continue;
        for (size_t i = 0; i < texels; ++i) layer.pdf.push_back(float(random()) * 1e-8f);
    }
    return layers;
}

/// The atlas is the scene's own, every component with both sides; light is noise.
inline Bake randomBake(const Scene& scene, int layers, bool withPdf, uint32_t seed) {
    std::mt19937 random(seed);
    SilentProgress progress;
    AtlasSettings settings;
    settings.texelBudget = 6000;
    const std::vector<uint32_t> components = connectedComponents(scene);
    const uint32_t count = *std::max_element(components.begin(), components.end()) + 1;
    Bake bake;
    bake.atlas = buildAtlas(scene, std::vector<Sides>(count, Sides::both), settings, progress);
    bake.points = buildTexelPoints(scene, bake.atlas);
    for (TexelState& state : bake.points.state)
        if (state != TexelState::unused && random() % 5 == 0) state = TexelState::occluded;
    const size_t texels = bake.atlas.texelCount();
    bake.phatexture.indirect = randomLayers(layers, bake.atlas, withPdf, random);
    bake.phatexture.indirectGuides.resize(withPdf ? 0 : bake.atlas.blockCount);
    bake.phatexture.area = randomLayers(1, bake.atlas, false, random);
    bake.phatexture.areaGuides.resize(1);
    for (auto* guides : {&bake.phatexture.indirectGuides, &bake.phatexture.areaGuides})
        for (Guide& guide : *guides)
            for (uint16_t& weight : guide.weight) weight = uint16_t(1 + random() % 65535);
    bake.phatexture.areaIrradiance = randomWords(texels, random);
    bake.phatexture.indirectIrradiance = randomWords(texels, random);
    for (size_t i = 0; i < bake.atlas.tileChart.size(); ++i) {
        PackedTile& tile = bake.phatexture.tilePatches.emplace_back();
        for (glm::uvec4& words : tile)
            for (int c = 0; c < 4; ++c) words[c] = uint32_t(random());
        // The range of the levels is kept in the tile.
        DepthProbe& probe =
            bake.phatexture.probes.emplace_back(DepthProbe{tile[0].w >> 19 & 63, tile[0].w >> 25 & 63, {}});
        for (uint8_t& level : probe.level) level = random() % 16;
    }
    return bake;
}

inline BakeRecord someRecord() {
    return {"phatextures test", "hard.glb", R"({"samples":2})", ~0ull};
}

}  // namespace phat::test
