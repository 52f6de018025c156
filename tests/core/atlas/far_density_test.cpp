// Far and hidden pieces take few texels.

#include <gtest/gtest.h>

#include "core/atlas/atlas_checks.h"
#include "core/scene/rays.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

double texelsOfTriangle(const Atlas& atlas, uint32_t triangle) {
    return texelAreaOf(atlas, triangle);
}

TEST(FarDensity, RoomOnAKilometreOfGroundHasHalfTheTexels) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {4, 3, 4});
    const double roomArea = surfaceArea(scene);
    const uint32_t ofRoom = uint32_t(scene.triangles.size());
    addFloor(scene, lambert(0.3f), 1000, -0.01f);
    AtlasSettings settings;
    settings.texelBudget = 40'000;
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress);
    double room = 0, ground = 0;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        (t < ofRoom ? room : ground) += texelsOfTriangle(atlas, t);
    EXPECT_GT(room, 10'000);
    // Each of the two may be finer or coarser to fill its tiles, and in area.
    EXPECT_LT(ground, 1.01 * std::pow(kFillFreedom, 4) * room);
    EXPECT_GT(ground, 1'000);
    EXPECT_LT(atlas.finestTexelSizeMeters(), 1.5 * std::sqrt(2 * roomArea / 40'000));
}

TEST(FarDensity, AStreetOfHousesHasOneDensity) {
    Scene scene;
    for (int house = 0; house < 20; ++house) {
        Scene room;
        addRoom(room, lambert(0.6f), {8, 6, 8});
        for (size_t face = 0; face < room.triangles.size(); face += 2) {
            const auto at = [&](uint32_t v) {
                return room.positions[v] + glm::vec3(10.0f * float(house), 0, 0);
            };
            const glm::uvec3& t = room.triangles[face];
            addQuad(scene, lambert(0.6f), at(t.x), at(t.y) - at(t.x), at(t.z) - at(t.y));
        }
    }
    AtlasSettings settings;
    settings.texelBudget = 100'000;
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress);
    EXPECT_GT(double(atlas.finestTexelSizeMeters()) * 1.0001 * kFillFreedom * kFillFreedom,
              double(atlas.texelSizeMeters));
}

TEST(HiddenPieces, FacesBetweenBoardsHaveFewTexels) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {4, 3, 4});
    // Two boxes with a gap of a millimetre; the faces toward it are the first two.
    const glm::vec3 low(1, 0.5f, 1), y(0, 1, 0), z(0, 0, 1);
    const uint32_t first = uint32_t(scene.triangles.size());
    addQuad(scene, lambert(0.6f), low + glm::vec3(1, 0, 0), y, z);       // faces +x
    addQuad(scene, lambert(0.6f), low + glm::vec3(1.001f, 0, 0), z, y);  // faces -x
    addQuad(scene, lambert(0.6f), low, z, y);                            // outer ends
    addQuad(scene, lambert(0.6f), low + glm::vec3(2.001f, 0, 0), y, z);
    const RayScene rays(scene);
    AtlasSettings settings;
    settings.texelBudget = 60'000;
    SilentProgress progress;
    const Atlas open = buildAtlas(scene, {}, settings, progress),
                seen = buildAtlas(rays, {}, settings, progress);
    EXPECT_NEAR(texelsOfTriangle(open, first), texelsOfTriangle(open, first + 4),
                0.2 * texelsOfTriangle(open, first));
    for (const uint32_t face : {first, first + 2})
        EXPECT_LT(10 * texelsOfTriangle(seen, face), texelsOfTriangle(seen, first + 4));
    EXPECT_GE(texelsOfTriangle(seen, first + 4), texelsOfTriangle(open, first + 4));
}

}  // namespace
}  // namespace phat
