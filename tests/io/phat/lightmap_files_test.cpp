#include "io/phat/lightmap_files.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "core/base/rgbm.h"
#include "io/gltf/gltf_picture.h"
#include "io/gltf/gltf_source.h"
#include "io/image/image_file.h"
#include "io/phat/baked_scene.h"

namespace phat {
namespace {

using nlohmann::json;

/// The hard scene, baked and exported.
struct Exported {
    explicit Exported(uint32_t pageSize, LightmapLight light = LightmapLight::area,
                      bool directional = false) {
        test::GltfBuilder gltf = test::hardScene();
        // Of the atlas's own number.
        gltf.json["materials"][0]["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
        gltf.json["images"] = {{{"uri", "missing.png"}}};
        gltf.json["textures"] = {{{"source", 0}}};
        writeBytes(folder.file("hard.glb"), gltf.glb());
        GltfSource input = openGltf(folder.file("hard.glb"));
        const LoadedScene loaded = loadGltf(input);
        Bake bake = test::randomBake(loaded.scene, 1, false, 5);
        for (uint32_t& word : bake.phatexture.indirectIrradiance) word = packRgb9e5(glm::vec3(word % 1000));
        for (uint32_t& word : bake.phatexture.areaIrradiance) word = packRgb9e5(glm::vec3(0, word % 100, 0));
        writeBakedFile(folder.file("hard.phat.glb"), input, loaded.scene, bake, test::someRecord());
        source = openGltf(folder.file("hard.phat.glb"));
        baked = readBakedFile(source);
        pages = pagesOf(baked.atlas, pageSize);
        SilentProgress progress;
        std::vector<std::string> notes;
        for (LightmapFile& file :
             lightmapFiles({source, baked, pages, "hard", light, directional}, progress, notes)) {
            writeBytes(folder.file(file.name), {file.bytes.begin(), file.bytes.end()});
            files[file.name] = std::move(file.bytes);
        }
        plain = openGltf(folder.file("hard.glb"));
        scene = loadGltf(plain).scene;
        for (const Surface& surface : scene.surfaces) {
            const SurfaceCorners corners = surfaceCorners(plain, scene, surface);
            const json& attributes = primitiveOf(surface)["attributes"];
            const auto values = readAccessor(plain, attributes.at("TEXCOORD_1").get<uint64_t>());
            for (const auto& vertices : corners.vertices)
                for (int c = 0; c < 3; ++c)
                    std::memcpy(&uvs.emplace_back(), &values.bytes[sizeof(glm::vec2) * vertices[size_t(c)]],
                                sizeof(glm::vec2));
        }
    }

    json description() const {
        return json::parse(files.at("lightmap.json").begin(), files.at("lightmap.json").end());
    }
    const json& primitiveOf(const Surface& surface) const {
        return plain.json["meshes"][surface.mesh]["primitives"][surface.primitive];
    }
    const json& materialOf(const Surface& surface) const {
        return plain.json["materials"][primitiveOf(surface).at("material").get<size_t>()];
    }

    TemporaryFolder folder;
    GltfSource source;
    BakedScene baked;
    AtlasPages pages;
    std::map<std::string, std::vector<uint8_t>> files;
    GltfSource plain;  // as exported
    Scene scene;
    std::vector<glm::vec2> uvs;  // of the corners of its triangles
};

// Corners of a triangle, sorted: what two scenes that split vertices otherwise have in common.
using Place = std::array<std::array<float, 3>, 3>;
struct SortedTriangle {
    SortedTriangle(const Scene& scene, uint32_t triangle) {
        const auto at = [&](int c) {
            const glm::vec3 p = scene.positions[scene.triangles[triangle][c]];
            return std::array{p.x, p.y, p.z};
        };
        std::sort(order.begin(), order.end(), [&](int a, int b) { return at(a) < at(b); });
        for (size_t c = 0; c < 3; ++c) place[c] = at(order[c]);
    }
    // A point within it, of `corner` as they are in the scene.
    glm::vec2 pointOf(const glm::vec2* corner) const {
        return 0.47f * corner[order[0]] + 0.31f * corner[order[1]] + 0.22f * corner[order[2]];
    }

    std::array<int, 3> order{0, 1, 2};
    Place place;
};

// The texel of the atlas at a point of a triangle, on its front or back.
size_t texelOf(const Atlas& atlas, uint32_t triangle, glm::vec2 point, bool back) {
    const Chart& own = atlas.charts[atlas.triangleChart[triangle]];
    const Chart& chart = back ? atlas.charts[own.otherSide] : own;
    const glm::uvec2 at = glm::uvec2(point) - own.originTexel() + chart.originTexel();
    return size_t(at.y) * atlas.sizeTexels.x + at.x;
}

glm::vec3 faceNormal(const Scene& scene, uint32_t triangle) {
    const glm::uvec3 t = scene.triangles[triangle];
    return glm::normalize(
        glm::cross(scene.positions[t.y] - scene.positions[t.x], scene.positions[t.z] - scene.positions[t.x]));
}

// How far the normals of vertices agree with their triangle's: they turn with it.
float bending(const Scene& scene, uint32_t triangle) {
    return glm::dot(faceNormal(scene, triangle), scene.normals[scene.triangles[triangle].x]);
}

// By the second UV set each triangle of the plain file reads the irradiance of the baked file's, on its side.
void expectTheBakesLight(const Exported& exported) {
    const Scene& baked = exported.baked.loaded.scene;
    const Atlas& atlas = exported.baked.atlas;
    std::vector<Image> textures;
    const json description = exported.description();
    for (const json& page : description["pages"])
        textures.push_back(readExr(exported.folder.file(page["exr"].get<std::string>())));
    std::map<Place, uint32_t> triangles;
    for (uint32_t t = 0; t < baked.triangles.size(); ++t) triangles[SortedTriangle(baked, t).place] = t;
    size_t compared = 0, backs = 0;
    for (uint32_t t = 0; t < exported.scene.triangles.size(); ++t) {
        const SortedTriangle sorted(exported.scene, t);
        const auto found = triangles.find(sorted.place);
        ASSERT_NE(found, triangles.end());
        const glm::vec3 normal = faceNormal(exported.scene, t);
        const bool back = glm::dot(normal, faceNormal(baked, found->second)) < 0;
        ASSERT_GT(bending(exported.scene, t) * bending(baked, found->second), 0.5f);
        const size_t texel = texelOf(
            atlas, found->second,
            SortedTriangle(baked, found->second).pointOf(atlas.triangleTexels[found->second].data()), back);
        if (exported.baked.points.state[texel] != TexelState::surface) continue;
        const Surface& surface = exported.scene.surfaces[exported.scene.triangleSurface[t]];
        const Image& texture =
            textures[exported.materialOf(surface).at("extras").at("lightmap").get<size_t>()];
        const glm::vec2 at = glm::vec2(texture.width, texture.height) * sorted.pointOf(&exported.uvs[3 * t]);
        const glm::vec3 expected = unpackRgb9e5(exported.baked.phatexture.indirectIrradiance[texel]) +
                                   unpackRgb9e5(exported.baked.phatexture.areaIrradiance[texel]);
        // Halves.
        ASSERT_NEAR(glm::distance(texture.at(int(at.x), int(at.y)), expected), 0, 1e-3 * expected.y);
        ++compared;
        backs += back;
    }
    EXPECT_GT(compared, 30u);
    EXPECT_GT(backs, 10u);
}

TEST(LightmapFiles, ThePlainSceneReadsTheBakesLight) {
    const Exported exported(4096);
    EXPECT_EQ(exported.pages.count, 1u);
    expectTheBakesLight(exported);
}

TEST(LightmapFiles, SoItDoesFromSeveralPages) {
    const Exported exported(40);
    EXPECT_GT(exported.pages.count, 1u);
    EXPECT_EQ(exported.description()["pages"].size(), exported.pages.count);
    expectTheBakesLight(exported);
}

TEST(LightmapFiles, TheSceneIsPlainAndOwnSetsMoveUp) {
    const Exported exported(4096);
    EXPECT_EQ(exported.plain.json.dump().find("PHAT_"), std::string::npos);
    EXPECT_EQ(exported.plain.json["extras"], json({{"kept", "as it is"}}));
    size_t moved = 0;
    for (const Surface& surface : exported.scene.surfaces) {
        const json& primitive = exported.primitiveOf(surface);
        const json& material = exported.materialOf(surface);
        ASSERT_TRUE(primitive["attributes"].contains("TEXCOORD_1"));
        if (!material.contains("occlusionTexture")) continue;
        EXPECT_EQ(material["occlusionTexture"]["texCoord"], 2);
        EXPECT_FALSE(material.contains("doubleSided"));
        moved += primitive["attributes"].contains("TEXCOORD_2");
    }
    EXPECT_EQ(moved, 6u);  // three cubes, of two sides
    EXPECT_TRUE(exported.plain.json["extensions"].contains("KHR_lights_punctual"));
    const Exported lit(4096, LightmapLight::all);
    EXPECT_EQ(lit.plain.json.dump().find("KHR_lights_punctual"), std::string::npos);
    EXPECT_EQ(lit.description()["light"], "all");
}

TEST(LightmapFiles, RgbmIsThePictureOfTheHalves) {
    const Exported exported(4096);
    const json page = exported.description()["pages"][0];
    const float range = exported.description()["rgbmRange"].get<float>();
    const Image halves = readExr(exported.folder.file(page["exr"].get<std::string>()));
    gltf::MemoryBudget budget(1 << 28);
    const TextureImage codes =
        gltf::decodePicture(exported.files.at(page["rgbm"].get<std::string>()), budget);
    ASSERT_EQ(codes.width, halves.width);
    ASSERT_EQ(codes.height, halves.height);
    for (size_t i = 0; i < halves.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(std::sqrt(decodeRgbm(codes.texels[i], range)[c]), std::sqrt(halves.pixels[i][c]),
                        0.51f * range * float(codes.texels[i].a) / 255 / 255 + 1e-3f * range);
}

// In both forms the light of a texel's own normal is that of the plain lightmap.
TEST(LightmapFiles, DirectionsKeepTheIrradiance) {
    const Exported exported(4096, LightmapLight::area, true);
    const json page = exported.description()["pages"][0];
    const auto pathOf = [&](const char* kind) { return exported.folder.file(page[kind].get<std::string>()); };
    const Image plain = readExr(pathOf("exr")), terms = readExr(pathOf("sh"));
    gltf::MemoryBudget budget(1 << 28);
    const TextureImage codes =
        gltf::decodePicture(exported.files.at(page["direction"].get<std::string>()), budget);
    ASSERT_EQ(terms.width, plain.width);
    ASSERT_EQ(terms.height, 4 * plain.height);
    ASSERT_EQ(codes.texels.size(), plain.pixels.size());
    const size_t layer = plain.pixels.size();
    size_t directed = 0;
    for (size_t i = 0; i < layer; ++i) {
        if (exported.baked.points.state[i] != TexelState::surface) continue;
        const glm::vec3 n = exported.baked.points.normal[i], *term = &terms.pixels[i];
        const glm::vec3 light = term[0] + n.y * term[layer] + n.z * term[2 * layer] + n.x * term[3 * layer];
        // Halves are off by 2^-11, of each term by itself.
        const float largest = maxComponent(glm::abs(term[0]) + glm::abs(term[layer]) +
                                           glm::abs(term[2 * layer]) + glm::abs(term[3 * layer]));
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(light[c], plain.pixels[i][c], 0x1p-10f * largest + 0x1p-11f * plain.pixels[i][c]);
        const glm::vec4 code = glm::vec4(codes.texels[i]) / 255.0f;
        const float factor = glm::dot(n, glm::vec3(code) - 0.5f) + 0.5f;
        ASSERT_NEAR(factor, code.a, 0.5f / 255 * (1 + std::sqrt(3.0f)) + 1e-5f);
        directed += glm::length(glm::vec3(code) - 0.5f) > 0.1f;
    }
    EXPECT_GT(directed, 1000u);
}

}  // namespace
}  // namespace phat
