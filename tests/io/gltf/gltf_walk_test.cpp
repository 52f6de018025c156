// Real and broken files: the large collections beside the repository when they are there, else the copies in
// tests/data.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_sound.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

fs::path collection(const std::string& name) {
    const fs::path beside = fs::path(PHAT_SOURCE_DIR) / ".." / "shared" / name;
    return fs::exists(beside) ? beside : fs::path(PHAT_SOURCE_DIR) / "tests" / "data" / name;
}

LoadedScene loadSound(const fs::path& path) {
    LoadedScene loaded = loadGltf(path.string());
    EXPECT_EQ(test::countUnsound(loaded.scene), 0) << path;
    return loaded;
}

LoadedScene loadSample(const std::string& name) {
    return loadSound(collection("loader") / name);
}

bool hasNote(const LoadedScene& loaded, const std::string& part) {
    for (const std::string& note : loaded.notes)
        if (note.find(part) != std::string::npos) return true;
    return false;
}

bool hasLight(const Scene& scene) {
    if (!scene.lights.empty()) return true;
    for (const Surface& surface : scene.surfaces)
        if (scene.materials[surface.material].emission != glm::vec3(0)) return true;
    return false;
}

TEST(GltfWalk, BrokenFilesKeepToTheManifest) {
    const fs::path folder = collection("broken");
    std::ifstream manifest(folder / "MANIFEST.tsv");
    std::string line;
    std::getline(manifest, line);  // titles
    int files = 0;
    while (std::getline(manifest, line)) {
        std::istringstream columns(line);
        std::string name, what, expected;
        std::getline(columns, name, '\t');
        std::getline(columns, what, '\t');
        std::getline(columns, expected, '\t');
        ++files;
        bool loads = true;
        try {
            loadSound(folder / name);
        } catch (const FileError& error) {
            loads = false;
            EXPECT_FALSE(error.reason.empty());
        }
        EXPECT_TRUE(expected == "reject" || expected == "tolerate" || expected == "either") << line;
        // A room whose camera shows nothing opens without it.
        const bool mended = name == "85-camera-zero-fov.glb";
        EXPECT_FALSE(expected == "reject" && loads && !mended) << name << ": " << what;
        EXPECT_FALSE(mended && !loads) << name << ": " << what;
        EXPECT_FALSE(expected == "tolerate" && !loads) << name << ": " << what;
    }
    EXPECT_GT(files, 40);
}

TEST(GltfWalk, BrokenPartsAreDroppedWithANote) {
    const fs::path folder = collection("broken");
    for (const char* name : {"33-node-huge.glb", "55-pos-nan.glb", "57-pos-1e38.glb"}) {
        const LoadedScene loaded = loadSound(folder / name);
        EXPECT_TRUE(loaded.scene.triangles.empty()) << name;
        EXPECT_TRUE(hasNote(loaded, "2 triangles were dropped")) << name;
    }
    EXPECT_TRUE(hasNote(loadSound(folder / "61-normals-nan.glb"), "4 vertex normals"));
    EXPECT_TRUE(hasNote(loadSound(folder / "75-img-bomb.glb"), "image 0"));
    EXPECT_TRUE(hasNote(loadSound(folder / "77-img-traversal.glb"), "outside the scene's folder"));
    EXPECT_TRUE(loadSound(folder / "00-good.glb").notes.empty());
}

TEST(GltfWalk, CompressedFilesLoad) {
    // As other loaders have them: the sphere is of radius .93.
    const LoadedScene sphere = loadSample("DenseSphere.glb");
    EXPECT_TRUE(sphere.notes.empty());
    EXPECT_EQ(sphere.scene.triangles.size(), 30720u);
    for (const glm::vec3& position : sphere.scene.positions) ASSERT_NEAR(glm::length(position), 0.93f, 0.02f);
    const LoadedScene box = loadSample("BoxMeshopt.glb");
    EXPECT_TRUE(box.notes.empty());
    EXPECT_EQ(box.scene.triangles.size(), 12u);
    EXPECT_NEAR(glm::distance(boundsOf(box.scene).high, glm::vec3(0.5f)), 0, 1e-4f);
    const LoadedScene pirate = loadSample("pirate.glb");
    EXPECT_TRUE(pirate.notes.empty());
    EXPECT_EQ(pirate.scene.triangles.size(), 5010u);
    EXPECT_NEAR(boundsOf(pirate.scene).high.y, 1.904f, 1e-3f);
}

TEST(GltfWalk, TriangleCountsBoundsAndNotes) {
    struct Expected {
        const char* name;
        size_t triangles, surfaces, notes;
        glm::vec3 low, high;
    };
    for (const Expected& expected : {
             Expected{"AnimatedMorphCube.glb", 12, 1, 2, glm::vec3(-1), glm::vec3(1)},
             Expected{"BoxVertexColors.glb", 12, 1, 0, glm::vec3(-0.5f), glm::vec3(0.5f)},
             Expected{"Mesh_PrimitiveMode_04.glb", 2, 1, 0, {-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}},
             Expected{"Mesh_PrimitiveMode_05.glb", 2, 1, 0, {-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}},
             Expected{"Mesh_PrimitiveMode_06.glb", 2, 1, 0, {-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}},
             Expected{"Mesh_PrimitiveMode_12.glb", 2, 1, 0, {-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}},
             Expected{"SimpleSparseAccessor.glb", 12, 1, 0, {0, 0, 0}, {6, 4, 0}},
             Expected{"TwoCubes.glb", 24, 2, 0, {-3, -1, -1}, {3, 1, 1}},
             Expected{"singleBlendshapeCube_sparse.glb", 12, 1, 2, glm::vec3(-0.005f), glm::vec3(0.005f)},
         }) {
        const LoadedScene loaded = loadSample(expected.name);
        EXPECT_EQ(loaded.scene.triangles.size(), expected.triangles) << expected.name;
        EXPECT_EQ(loaded.scene.surfaces.size(), expected.surfaces) << expected.name;
        EXPECT_EQ(loaded.notes.size(), expected.notes) << expected.name;
        const Bounds bounds = boundsOf(loaded.scene);
        EXPECT_NEAR(glm::distance(bounds.low, expected.low), 0, 1e-4f) << expected.name;
        EXPECT_NEAR(glm::distance(bounds.high, expected.high), 0, 1e-4f) << expected.name;
    }
}

TEST(GltfWalk, PrimitiveModes) {
    for (const char* name : {"Mesh_PrimitiveMode_00.glb", "Mesh_PrimitiveMode_02.glb"}) {
        const LoadedScene loaded = loadSample(name);
        EXPECT_TRUE(loaded.scene.triangles.empty()) << name;
        EXPECT_TRUE(hasNote(loaded, "1 primitive of points or lines")) << name;
    }
    // List, strip and fan of the same square: all face +z and cover it once.
    for (const char* name : {"Mesh_PrimitiveMode_04.glb", "Mesh_PrimitiveMode_05.glb",
                             "Mesh_PrimitiveMode_06.glb", "Mesh_PrimitiveMode_12.glb"}) {
        const Scene scene = loadSample(name).scene;
        float area = 0;
        for (const glm::uvec3& t : scene.triangles) {
            const glm::vec3 p = scene.positions[t[0]];
            area += 0.5f * glm::cross(scene.positions[t[1]] - p, scene.positions[t[2]] - p).z;
        }
        EXPECT_FLOAT_EQ(area, 1) << name;
        for (const glm::vec3& normal : scene.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1)) << name;
    }
}

TEST(GltfWalk, VertexColours) {
    const Scene scene = loadSample("BoxVertexColors.glb").scene;
    ASSERT_EQ(scene.colors.size(), 24u);
    // As the file's floats say, alpha included.
    const auto near = [](glm::vec4 a, glm::vec4 b) { return glm::distance(a, b) < 1e-3f; };
    EXPECT_TRUE(near(scene.colors[0], {0, 0.0101f, 1, 0}));
    EXPECT_TRUE(near(scene.colors[2], {0.8039f, 0.8039f, 0.8039f, 1}));
    EXPECT_TRUE(near(scene.colors[23], {0.0175f, 0.9957f, 0.3621f, 0.0217f}));
    EXPECT_FLOAT_EQ(scene.materials[0].roughness, 0.99f);
}

TEST(GltfWalk, ClearCoat) {
    const Scene scene = loadSample("ClearCoatTest.glb").scene;
    EXPECT_EQ(scene.triangles.size(), 37116u);
    EXPECT_EQ(scene.surfaces.size(), 27u);
    EXPECT_EQ(scene.images.size(), 6u);
    int coated = 0, coatNormals = 0;
    for (const Material& material : scene.materials) {
        coated += material.clearcoat == 1;
        coatNormals += material.clearcoatNormalTexture.image >= 0;
    }
    EXPECT_EQ(coated, 6);
    EXPECT_EQ(coatNormals, 2);
    // Normal maps and no TANGENT: generated exactly where they are needed.
    for (const Surface& surface : scene.surfaces) {
        const Material& material = scene.materials[surface.material];
        const bool needed = material.normalTexture.image >= 0 || material.clearcoatNormalTexture.image >= 0;
        for (uint32_t v = 0; v < surface.vertexCount; ++v) {
            const glm::vec4 tangent = scene.tangents[surface.firstVertex + v];
            ASSERT_EQ(tangent != glm::vec4(0), needed) << surface.name;
            if (!needed) continue;
            ASSERT_NEAR(glm::dot(glm::vec3(tangent), scene.normals[surface.firstVertex + v]), 0, 2e-3f);
        }
    }
}

// Where the arrow tips of the test picture, at uv (.5, .5) or so, end up is what the file is made to show:
// each quad maps the tip to its green mark (the file's own readme).
TEST(GltfWalk, TextureTransforms) {
    const Scene scene = loadSample("TextureTransformTest.glb").scene;
    std::map<std::string, const Material*> materials;
    for (const Material& material : scene.materials) materials[material.name] = &material;
    const auto at = [&](const char* name, glm::vec2 uv) {
        return materials.at(name)->baseColorTexture.uvTransform * glm::vec3(uv, 1);
    };
    const auto near = [](glm::vec2 a, glm::vec2 b) { return glm::distance(a, b) < 1e-5f; };
    EXPECT_TRUE(near(at("Offset U", {0.25f, 0.25f}), {0.75f, 0.25f}));
    EXPECT_TRUE(near(at("Offset V", {0.25f, 0.25f}), {0.25f, 0.75f}));
    EXPECT_TRUE(near(at("Offset UV", {0.25f, 0.25f}), {0.75f, 0.75f}));
    EXPECT_TRUE(near(at("Scale", {0.5f, 0.25f}), {0.75f, 0.375f}));
    // 22.5 degrees: the green mark lies 22.5 degrees below the diagonal, where the arrow points
    // untransformed.
    const float angle = 3 * kPi / 8;
    const glm::vec2 greenMark = 0.5f * glm::vec2(std::cos(angle), std::sin(angle));
    EXPECT_TRUE(near(at("Rotation", greenMark), 0.5f * glm::vec2(std::cos(kPi / 4), std::sin(kPi / 4))));
    EXPECT_EQ(materials.at("Scale")->baseColorTexture.wrapU, Wrap::clampToEdge);
}

TEST(GltfWalk, InstancedShapesWithoutMaterial) {
    const Scene scene = loadSample("ShapeCollection.glb").scene;
    EXPECT_EQ(scene.surfaces.size(), 7u);  // 6 meshes, one used twice
    EXPECT_EQ(scene.triangles.size(), 3542u);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].name, "default");
    // Closed shapes: the divergence theorem gives a positive volume only with fronts outside.
    for (const Surface& surface : scene.surfaces) {
        double volume = 0;
        for (uint32_t i = 0; i < surface.triangleCount; ++i) {
            const glm::uvec3 t = scene.triangles[surface.firstTriangle + i];
            volume +=
                glm::dot(scene.positions[t[0]], glm::cross(scene.positions[t[1]], scene.positions[t[2]])) / 6;
        }
        EXPECT_GT(volume, 0.1) << surface.name;
    }
}

TEST(GltfWalk, CharacterWithHierarchyAndAnimations) {
    const LoadedScene loaded = loadSample("kenney-character.glb");
    EXPECT_EQ(loaded.scene.triangles.size(), 550u);
    EXPECT_EQ(loaded.scene.surfaces.size(), 6u);
    ASSERT_EQ(loaded.scene.images.size(), 1u);
    EXPECT_EQ(loaded.scene.animations.size(), 4u);
    EXPECT_TRUE(loaded.scene.materials[0].doubleSided);
    const Bounds bounds = boundsOf(loaded.scene);
    EXPECT_NEAR(bounds.low.y, 0, 1e-4f);  // it stands on the floor
    EXPECT_NEAR(bounds.high.y, 1.1f, 0.01f);
}

TEST(GltfWalk, SkinAndUnknownExtensionsAreNoted) {
    const LoadedScene loaded = loadSample("quad_skin.glb");
    EXPECT_EQ(loaded.scene.triangles.size(), 2u);
    EXPECT_TRUE(hasNote(loaded, "FB_ngon_encoding"));
    EXPECT_TRUE(hasNote(loaded, "1 skinned mesh"));
    EXPECT_EQ(loaded.notes.size(), 2u);
}

TEST(GltfWalk, TabletopOfTheRepository) {
    const LoadedScene loaded = loadSound(fs::path(PHAT_SOURCE_DIR) / "scenes" / "tabletop.glb");
    EXPECT_TRUE(loaded.notes.empty());
    EXPECT_EQ(loaded.scene.triangles.size(), 4158u);
    EXPECT_EQ(loaded.scene.surfaces.size(), 16u);
    EXPECT_EQ(loaded.scene.materials.size(), 12u);
    EXPECT_EQ(loaded.scene.images.size(), 2u);
    ASSERT_EQ(loaded.scene.cameras.size(), 1u);
    EXPECT_FLOAT_EQ(loaded.scene.cameras[0].yfovRadians, 0.65186074f);
    EXPECT_FLOAT_EQ(loaded.scene.cameras[0].aspect, 16.0f / 9);
    int lamps = 0;
    for (const Material& material : loaded.scene.materials) {
        if (material.emission == glm::vec3(0)) continue;
        ++lamps;
        EXPECT_NEAR(material.emission.x, 14, 1e-4f);
    }
    EXPECT_EQ(lamps, 1);
}

TEST(GltfWalk, ReferenceScenes) {
    struct Expected {
        const char* name;
        size_t triangles, surfaces, materials, images, lights;
    };
    const fs::path folder = fs::path(PHAT_SOURCE_DIR) / "scenes";
    for (const Expected& expected : {
             Expected{"cornell-glossy.glb", 46, 9, 7, 0, 0},
             Expected{"furnace.glb", 984, 3, 1, 0, 0},
             Expected{"furnace-glossy.glb", 31756, 9, 9, 0, 0},
             Expected{"gallery.glb", 43484, 39, 24, 8, 1},
             Expected{"tabletop.glb", 4158, 16, 12, 2, 0},
         }) {
        const LoadedScene loaded = loadSound(folder / expected.name);
        EXPECT_TRUE(loaded.notes.empty()) << expected.name;
        EXPECT_EQ(loaded.scene.triangles.size(), expected.triangles) << expected.name;
        EXPECT_EQ(loaded.scene.surfaces.size(), expected.surfaces) << expected.name;
        EXPECT_EQ(loaded.scene.materials.size(), expected.materials) << expected.name;
        EXPECT_EQ(loaded.scene.images.size(), expected.images) << expected.name;
        EXPECT_EQ(loaded.scene.lights.size(), expected.lights) << expected.name;
        EXPECT_EQ(loaded.scene.cameras.size(), 1u) << expected.name;
        EXPECT_TRUE(hasLight(loaded.scene)) << expected.name;
    }
    const Scene gallery = loadSound(folder / "gallery.glb").scene;
    EXPECT_EQ(gallery.lights[0].type, PunctualLight::Type::point);
    EXPECT_NEAR(gallery.lights[0].intensity.x, 45, 1e-3f);
    EXPECT_NEAR(gallery.lights[0].intensity.z, 45 * 0.42f, 1e-3f);
    const Scene cornell = loadSound(folder / "cornell-glossy.glb").scene;
    EXPECT_FLOAT_EQ(cornell.materials[1].ior, 1.45f);
    EXPECT_EQ(cornell.materials[1].specularColor, glm::vec3(0));
}

}  // namespace
}  // namespace phat
