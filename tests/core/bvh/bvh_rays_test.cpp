#include "core/bvh/bvh_rays.h"

#include <gtest/gtest.h>

#include "core/scene/posed_scene.h"
#include "core/scene/scene_motion.h"
#include "support/hit_comparison.h"
#include "support/ray_scenes.h"

namespace phat::test {
namespace {

struct World {
    explicit World(Scene scene) : posed(std::move(scene)), bvh(buildSceneBvh(posed.rest())) { pose({}); }

    void pose(std::vector<glm::mat4> worldFromRest) {
        top = poseBvh(bvh, worldFromRest);
        posed.setState({std::move(worldFromRest), posed.rest().lights, {}, 0});
    }
    const Scene& scene() const { return posed.scene(); }
    const RayScene& embree() const { return posed.snapshot()->rays(); }
    BvhRays rays() const { return {posed.scene(), bvh, top}; }

    PosedScene posed;
    SceneBvh bvh;
    PosedBvh top;
};

Comparison compare(const World& world, const std::vector<Ray>& rays, double tolerance) {
    Comparison result(world.scene(), tolerance);
    for (const Ray& ray : rays)
        result.add(ray, world.rays().closestHit(ray), world.embree().closestHit(ray.origin, ray.direction));
    return result;
}

void expectLikeEmbree(const World& world, int count, int mostTiesOfRandomRays) {
    const double tolerance = roundingOf(world.scene());
    const Comparison random = compare(world, randomRays(world.scene(), count, 1.2f, 51), tolerance);
    EXPECT_EQ(random.wrong(), 0) << random.firstWrong();
    EXPECT_LE(random.ties(), mostTiesOfRandomRays);
    EXPECT_GT(random.hits(), count / 20);
    const Comparison adversarial = compare(world, adversarialRays(world.scene(), count, 1.2f, 52), tolerance);
    EXPECT_EQ(adversarial.wrong(), 0) << adversarial.firstWrong();
    EXPECT_GT(adversarial.hits(), count / 20);
}

TEST(BvhRays, HitWhatEmbreeHits) {
    expectLikeEmbree(World(triangleSoup(1, 0.5f)), 20000, 20);
    expectLikeEmbree(World(triangleSoup(5000, 0.2f)), 20000, 40);
    expectLikeEmbree(World(sphere(glm::vec3(0), 1, 24)), 20000, 20);
    Scene room;
    addRoom(room, lambert(0.5f), {1, 2, 3});
    expectLikeEmbree(World(room), 20000, 20);
}

TEST(BvhRays, CoincidentSidesAreMetFromTheFront) {
    for (const TwoLayers& layers : twoLayers()) {
        const World world(layers.scene);
        layers.expectFronts([&](const Ray& ray) { return world.rays().closestHit(ray); });
    }
}

TEST(BvhRays, HitWhatEmbreeHitsAtAnyScaleAndPlace) {
    for (const float scale : {0x1p-30f, 0x1p-10f, 0x1p12f, 0x1p30f}) {
        Scene scene = triangleSoup(2000, 0.2f);
        transform(scene, glm::vec3(scale), glm::vec3(0));
        expectLikeEmbree(World(scene), 10000, 20);
    }
    Scene away = sphere({100, -5000, 3}, 2, 24);
    expectLikeEmbree(World(away), 10000, 2000);
    // A room on a wide ground.
    Scene ground;
    addRoom(ground, lambert(0.5f), {4, 3, 5});
    addFloor(ground, lambert(0.5f), 2000, -0.1f);
    expectLikeEmbree(World(ground), 20000, 200);
}

TEST(BvhRays, DegenerateTrianglesHideNothing) {
    Scene scene = triangleSoup(500, 0.3f);
    Rng rng(53);
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 a = randomPoint(rng), b = a + 0.3f * randomPoint(rng);
        const glm::vec3 c = i % 3 == 0   ? a
                            : i % 3 == 1 ? glm::mix(a, b, rng.uniform())
                                         : a + 1e-7f * randomPoint(rng);
        addTriangle(scene, std::array{a, b, i % 9 == 0 ? b : c}, kNoUvs);
    }
    for (int i = 0; i < 200; ++i) {  // the same triangle many times
        const glm::uvec3 t = scene.triangles[0];
        addTriangle(scene, std::array{scene.positions[t.x], scene.positions[t.y], scene.positions[t.z]},
                    kNoUvs);
    }
    expectLikeEmbree(World(scene), 20000, 2000);
}

int escapes(Scene scene, glm::vec3 center, float extent) {
    const World world(std::move(scene));
    int escaped = 0;
    for (const Ray& ray : raysAtEdges(world.scene(), center, extent, 200'000))
        escaped += !world.rays().closestHit(ray) || !world.rays().anyHit(ray, kFarDistance);
    return escaped;
}

TEST(BvhRays, NoneEscapesAClosedMesh) {
    EXPECT_EQ(escapes(sphere(glm::vec3(0), 1, 64), glm::vec3(0), 0.5f), 0);
    EXPECT_EQ(escapes(sphere({100, -50, 3}, 1, 64), {100, -50, 3}, 0.5f), 0);
    Scene box;
    addRoom(box, lambert(0.5f), {1, 2, 3});
    EXPECT_EQ(escapes(box, {0.5f, 1, 1.5f}, 0.49f), 0);
}

// Boxes of walls have no thickness, and two of them meet in a line: rounding must not let a ray pass both.
TEST(BvhRays, NoneEscapesWhereFlatBoxesMeet) {
    EXPECT_EQ(escapes(tiledRoom(), {1.9f, 1.6f, 2.0f}, 1.2f), 0);
}

TEST(BvhRays, StopAtTheirMaximumDistance) {
    const World world(triangleSoup(300, 0.4f));
    const BvhRays rays = world.rays();
    int hits = 0;
    for (const Ray& ray : randomRays(world.scene(), 5000, 1.5f, 55)) {
        const Hit hit = rays.closestHit(ray);
        EXPECT_EQ(rays.anyHit(ray, kFarDistance), bool(hit));
        if (!hit) continue;
        ++hits;
        EXPECT_EQ(rays.closestHit(ray, std::nextafter(hit.distance, 1e30f)).triangle, hit.triangle);
        EXPECT_TRUE(rays.anyHit(ray, std::nextafter(hit.distance, 1e30f)));
        EXPECT_FALSE(rays.closestHit(ray, hit.distance));  // open
        EXPECT_FALSE(rays.anyHit(ray, hit.distance));
    }
    EXPECT_GT(hits, 500);
}

TEST(BvhRays, BarycentricsAreWhereTheRayMeetsTheTriangle) {
    const World world(triangleSoup(500, 0.5f));
    int compared = 0;
    for (const Ray& ray : randomRays(world.scene(), 5000, 1.2f, 56)) {
        const Hit hit = world.rays().closestHit(ray);
        const Hit want = world.embree().closestHit(ray.origin, ray.direction);
        if (!hit || hit.triangle != want.triangle) continue;
        ++compared;
        EXPECT_NEAR(hit.barycentric.x, want.barycentric.x, 1e-3);
        EXPECT_NEAR(hit.barycentric.y, want.barycentric.y, 1e-3);
    }
    EXPECT_GT(compared, 1000);
}

// The same ray passes the same blended triangles in both: they decide by the same hash.
TEST(BvhRays, PassWhatIsTransparentAsEmbreesDo) {
    const World world(roomOfSpheres(12));
    ASSERT_LT(world.bvh.firstTransparent, world.scene().triangles.size());
    const Comparison result =
        compare(world, randomRays(world.scene(), 30000, 0.95f, 57), roundingOf(world.scene()));
    EXPECT_EQ(result.wrong(), 0);
    EXPECT_LE(result.ties(), 30);
    int passed = 0;
    Scene solid = world.scene();
    for (Material& material : solid.materials) material.alphaMode = AlphaMode::opaque;
    const World all(solid);
    for (const Ray& ray : randomRays(world.scene(), 2000, 0.95f, 58))
        passed += world.rays().closestHit(ray).triangle != all.rays().closestHit(ray).triangle;
    EXPECT_GT(passed, 100);
}

TEST(BvhRays, FollowWhatHasMoved) {
    World world(roomOfSpheres(12));
    const auto motion = [](uint32_t node, glm::vec3 meters, glm::vec3 degrees, glm::vec3 scale) {
        glm::mat4 m = matrixOf(NodeMotion{node, {2, 1.5f, 2.5f}, meters, degrees});
        glm::mat4 scaling(1);
        for (int axis = 0; axis < 3; ++axis) scaling[axis][axis] = scale[axis];
        return m * scaling;
    };
    std::vector<glm::mat4> moved(13, glm::mat4(1));
    moved[1] = motion(1, {0.5f, 0.2f, -0.3f}, {0, 0, 0}, glm::vec3(1));
    moved[2] = motion(2, {0, 0, 0}, {30, 70, -20}, glm::vec3(1));
    moved[3] = motion(3, {0.3f, 0, 0}, {0, 10, 0}, {0.5f, 1.2f, 0.8f});
    moved[4] = motion(4, {3, 0, 0}, {0, 0, 0}, {-1, 1, 1});  // mirrored
    moved[6] = motion(6, {10, 20, 30}, {5, 5, 5}, glm::vec3(3));
    moved[9] = motion(9, {4, 0.5f, 0}, {0, 0, 50}, {-0.9f, 1, 1});
    world.pose(moved);
    const auto count = std::count_if(world.top.nodes.begin(), world.top.nodes.end(), isInstance);
    EXPECT_GE(count, 6);
    const Comparison random =
        compare(world, randomRays(world.scene(), 30000, 0.95f, 59), 2 * roundingOf(world.scene()));
    EXPECT_EQ(random.wrong(), 0);
    const Comparison adversarial =
        compare(world, adversarialRays(world.scene(), 30000, 0.95f, 60), 2 * roundingOf(world.scene()));
    EXPECT_EQ(adversarial.wrong(), 0);
    EXPECT_LT(random.ties(), 60);

    // And back again.
    world.pose({});
    EXPECT_EQ(std::count_if(world.top.nodes.begin(), world.top.nodes.end(), isInstance), 0);
    EXPECT_EQ(compare(world, randomRays(world.scene(), 5000, 0.95f, 61), roundingOf(world.scene())).wrong(),
              0);
}

// A node without extent in some direction has no way back to rest.
TEST(BvhRays, LeaveOutWhatIsFlattened) {
    World world(roomOfSpheres(3));
    std::vector<glm::mat4> moved(4, glm::mat4(1));
    moved[3] = glm::mat4(0);
    moved[3][3] = glm::vec4(2, 1, 2, 1);
    world.pose(moved);
    for (const Ray& ray : randomRays(world.scene(), 2000, 0.95f, 62)) {
        const Hit hit = world.rays().closestHit(ray);
        ASSERT_TRUE(hit);
        EXPECT_NE(world.scene().surfaces[world.scene().triangleSurface[hit.triangle]].node, 3u);
    }
}

TEST(BvhRays, NothingMeetsAnEmptyScene) {
    const World world{Scene{}};
    BvhReads reads;
    EXPECT_FALSE(world.rays().closestHit({{0, 0, 0}, {0, 0, 1}}, kFarDistance, &reads));
    EXPECT_FALSE(world.rays().anyHit({{0, 0, 0}, {0, 0, 1}}, kFarDistance));
    EXPECT_EQ(reads.nodes, 1u);
    EXPECT_EQ(reads.texels(), 3u);
}

TEST(BvhRays, ReadFewNodesOfManyTriangles) {
    const World world(triangleSoup(20000, 0.1f));
    BvhReads closest, any;
    const auto rays = randomRays(world.scene(), 2000, 0.5f, 63);
    for (const Ray& ray : rays) {
        world.rays().closestHit(ray, kFarDistance, &closest);
        world.rays().anyHit(ray, kFarDistance, &any);
    }
    EXPECT_EQ(closest.texels(), 3 * closest.nodes + 2 * closest.triangles);
    const double nodes = double(closest.nodes) / double(rays.size());
    const double triangles = double(closest.triangles) / double(rays.size());
    // At least the way from the root to a leaf, log4 of 20,000 over 4; at most 1.5 times
    // the 26.6 and 20.8 that were counted.
    EXPECT_GE(nodes, 6);
    EXPECT_LE(nodes, 40);
    EXPECT_LE(triangles, 31);
    EXPECT_LT(any.texels(), closest.texels());
}

TEST(BvhRays, FindTheirWayAmongAMillionTriangles) {
    Scene scene;
    addSurface(scene, lambert(0.5f));
    constexpr int kSide = 708;
    Rng rng(64);
    std::vector<float> heights((kSide + 1) * (kSide + 1));
    for (float& height : heights) height = 0.02f * rng.uniform();
    const auto at = [&](int x, int y) {
        return glm::vec3(float(x) / 50, heights[size_t(y * (kSide + 1) + x)], float(y) / 50);
    };
    Surface& surface = scene.surfaces.back();
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x) scene.positions.push_back(at(x, y));
    scene.normals.assign(scene.positions.size(), {0, 1, 0});
    scene.tangents.assign(scene.positions.size(), glm::vec4(0));
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const uint32_t a = y * (kSide + 1) + x, b = a + kSide + 1;
            scene.triangles.push_back({a, b, a + 1});
            scene.triangles.push_back({a + 1, b, b + 1});
        }
    }
    scene.triangleSurface.assign(scene.triangles.size(), 0);
    surface.triangleCount = uint32_t(scene.triangles.size());
    surface.vertexCount = uint32_t(scene.positions.size());
    ASSERT_GE(scene.triangles.size(), 1'000'000u);
    const World world(std::move(scene));
    EXPECT_LE(world.bvh.groups[0].stackWords, 20);
    expectLikeEmbree(world, 5000, 200);
}

}  // namespace
}  // namespace phat::test
