// What changes a key, and what does not.

#include "core/bake/stage_keys.h"

#include <gtest/gtest.h>

#include <functional>

#include "support/moving_room.h"

namespace phat::test {
namespace {

struct Keys {
    uint64_t all, geometry, areaIrradiance;
};

Keys keysOf(const Scene& scene) {
    static const Atlas atlas;
    const SceneKeys keys(scene);
    const uint64_t geometry = keys.ofGeometry(atlas);
    return {keys.ofAll(smallBake()), geometry, keys.ofAreaIrradiance(geometry, smallBake())};
}

struct Change {
    const char* name;
    std::function<void(Scene&)> apply;
    bool all, geometry, areaIrradiance;  // which keys it changes
};

TEST(StageKeys, ChangeWithWhatTheirStagesRead) {
    Scene scene = roomWithBox();
    scene.images.push_back(TextureImage{"", 1, 1, {glm::u8vec4(10)}});
    const Keys before = keysOf(scene);
    const size_t lamp = scene.materials.size() - 1;
    const Change changes[] = {
        {"name", [](Scene& s) { s.materials[0].name = "other", s.surfaces[0].name = "x"; }, false, false,
         false},
        {"node's number",
         [](Scene& s) {
             for (Surface& x : s.surfaces) x.node += 3;
         },
         false, false, false},
        {"camera", [](Scene& s) { s.cameras.emplace_back(); }, false, false, false},
        {"colour", [](Scene& s) { s.materials[0].baseColor.x = 0.1f; }, true, false, false},
        {"roughness", [](Scene& s) { s.materials[0].roughness = 0.1f; }, true, false, false},
        {"texture", [](Scene& s) { s.materials[0].baseColorTexture.image = 0; }, true, false, false},
        {"point light", [](Scene& s) { s.lights[0].intensity.y *= 2; }, true, false, false},
        {"photometry",
         [](Scene& s) {
             s.lights[0].photometry = Photometry(PhotometricWeb{"", 100, 1, 1, {1, 1}});
         },
         true, false, false},
        {"emission", [&](Scene& s) { s.materials[lamp].emission.x = 1; }, true, false, true},
        {"emitter's albedo", [&](Scene& s) { s.materials[lamp].baseColor.x = 0; }, true, false, true},
        {"sky", [](Scene& s) { s.environment = Environment{Image(2, 1, glm::vec3(1))}; }, true, false, true},
        {"glass", [](Scene& s) { s.materials[0].transmission = 1; }, true, true, true},
        {"mask", [](Scene& s) { s.materials[0].alphaMode = AlphaMode::mask; }, true, true, true},
        {"both sides", [](Scene& s) { s.materials[0].doubleSided = true; }, true, true, true},
        {"corner", [](Scene& s) { s.positions[0].x += 0.01f; }, true, true, true},
        {"normal",
         [](Scene& s) { s.normals[0] = glm::normalize(s.normals[0] + glm::vec3(0.1f, 0.2f, 0.3f)); }, true,
         true, true},
        {"nodes joined", [](Scene& s) { s.surfaces[0].node = kBoxNode; }, true, true, true},
    };
    for (const Change& change : changes) {
        Scene changed = scene;
        change.apply(changed);
        const Keys after = keysOf(changed);
        EXPECT_EQ(after.all != before.all, change.all) << change.name;
        EXPECT_EQ(after.geometry != before.geometry, change.geometry) << change.name;
        EXPECT_EQ(after.areaIrradiance != before.areaIrradiance, change.areaIrradiance) << change.name;
    }
}

// A picture counts, and not its number; of a material that lets light through, all counts.
TEST(StageKeys, SeeThroughMaterials) {
    Scene scene = roomWithBox();
    scene.images = {TextureImage{"", 1, 1, {glm::u8vec4(10)}}, TextureImage{"", 1, 1, {glm::u8vec4(20)}}};
    scene.materials[0].alphaMode = AlphaMode::blend;
    scene.materials[0].baseColorTexture.image = 0;
    const Keys before = keysOf(scene);
    Scene renumbered = scene;
    std::swap(renumbered.images[0], renumbered.images[1]);
    EXPECT_NE(keysOf(renumbered).geometry, before.geometry);
    renumbered.materials[0].baseColorTexture.image = 1;
    EXPECT_EQ(keysOf(renumbered).all, before.all);
    scene.materials[0].baseColor.w = 0.5f;
    EXPECT_NE(keysOf(scene).geometry, before.geometry);
}

TEST(StageKeys, OfPhotonsStraightFromAreaLightsAlone) {
    PhotonMap photons;
    photons.photons.resize(3);
    photons.photons[0].firstHit = photons.photons[1].firstHit = true;
    photons.photons[1].punctual = true;
    const uint64_t before = keyOfAreaLight(1, photons, smallBake());
    photons.photons[1].fluxWatts = photons.photons[2].fluxWatts = glm::vec3(1);
    EXPECT_EQ(keyOfAreaLight(1, photons, smallBake()), before);
    photons.photons[0].fluxWatts = glm::vec3(1);
    EXPECT_NE(keyOfAreaLight(1, photons, smallBake()), before);
}

}  // namespace
}  // namespace phat::test
