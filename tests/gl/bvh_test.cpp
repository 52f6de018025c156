// Rays of shaders/lib/bvh.glsl against their twin on the CPU, in both flavours.

#include <gtest/gtest.h>

#include "core/bvh/bvh_rays.h"
#include "core/scene/posed_scene.h"
#include "core/scene/scene_motion.h"
#include "gl/bvh_upload.h"
#include "gl/fullscreen.h"
#include "gl/gl_context.h"
#include "gl/gl_evaluate.h"
#include "gl/textures.h"
#include "support/hit_comparison.h"
#include "support/ray_scenes.h"

namespace phat::test {
namespace {

constexpr uint32_t kWidth = 128;

struct World {
    explicit World(Scene scene)
        : posed(std::move(scene)), bvh(buildSceneBvh(posed.rest())), top(poseBvh(bvh, {})) {}

    void pose(std::vector<glm::mat4> worldFromRest) {
        top = poseBvh(bvh, worldFromRest);
        posed.setState({std::move(worldFromRest), posed.rest().lights, {}, 0});
    }
    const Scene& scene() const { return posed.scene(); }
    BvhRays rays() const { return {posed.scene(), bvh, top}; }

    PosedScene posed;
    SceneBvh bvh;
    PosedBvh top;
};

GlTexture rayTexture(const std::vector<glm::vec4>& values) {
    GlTexture texture = createTexture2D(GL_RGBA32F, {kWidth, uint32_t(values.size()) / kWidth});
    glTextureSubImage2D(texture.name(), 0, 0, 0, kWidth, GLsizei(values.size() / kWidth), GL_RGBA, GL_FLOAT,
                        values.data());
    return texture;
}

class BvhShader : public ::testing::TestWithParam<GlslFlavor> {
  protected:
    // As hitOut of trace_rays.frag. pre: as many rays as whole rows.
    std::vector<glm::vec4> trace(const World& world, const GpuBvh& gpu, const std::vector<Ray>& rays,
                                 std::vector<std::string> defines = {}, float maxDistance = kFarDistance) {
        for (const std::string& define : bvhDefines(world.bvh)) defines.push_back(define);
        FullscreenProgram program;
        program.program =
            ShaderProgram(kShaderFolder, "fullscreen.vert", "trace_rays.frag", defines, GetParam());
        program.noVertices = GlVertexArray([] {
            GLuint name = 0;
            glCreateVertexArrays(1, &name);
            return name;
        }());
        std::vector<glm::vec4> origins, directions;
        for (const Ray& ray : rays) {
            origins.emplace_back(ray.origin, maxDistance);
            directions.emplace_back(ray.direction, 0);
        }
        const GlTexture origin = rayTexture(origins), direction = rayTexture(directions);
        const glm::uvec2 size(kWidth, rays.size() / kWidth);
        const GlTexture target = createTexture2D(GL_RGBA32F, size);
        bindBvh(gpu, program.program, 0);
        program.program.bind("rayOrigins", kBvhUnits, origin.name());
        program.program.bind("rayDirections", kBvhUnits + 1, direction.name());
        program.draw(createFramebuffer({{target.name()}}), size);
        std::vector<glm::vec4> hits(rays.size());
        glGetTextureImage(target.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(hits.size() * sizeof(hits[0])),
                          hits.data());
        checkGl("tracing rays");
        return hits;
    }

    std::vector<Hit> closest(const World& world, const GpuBvh& gpu, const std::vector<Ray>& rays) {
        std::vector<Hit> hits;
        for (const glm::vec4& out : trace(world, gpu, rays)) {
            Hit& hit = hits.emplace_back();
            if (out.y == 0) continue;
            hit = {out.x, world.bvh.order[size_t(std::abs(out.y)) - 1], {out.z, out.w}, out.y < 0};
        }
        return hits;
    }

    // Arithmetic is the same, but products and sums may be rounded together, and divisions otherwise.
    void expectLikeTwin(const World& world, const GpuBvh& gpu, uint64_t seed, int mostTies) {
        for (const bool adversarial : {false, true}) {
            const int count = 64 * int(kWidth);
            const auto rays = adversarial ? adversarialRays(world.scene(), count, 1.1f, seed)
                                          : randomRays(world.scene(), count, 1.1f, seed);
            const std::vector<Hit> hits = closest(world, gpu, rays);
            Comparison result(world.scene(), 2 * roundingOf(world.scene()));
            for (size_t i = 0; i < rays.size(); ++i)
                result.add(rays[i], hits[i], world.rays().closestHit(rays[i]));
            EXPECT_EQ(result.wrong(), 0) << result.firstWrong();
            EXPECT_GT(result.hits(), count / 20);
            if (!adversarial) {
                EXPECT_LE(result.ties(), mostTies);
            }
        }
    }

    void expectLikeTwin(Scene scene, uint64_t seed, int mostTies) {
        const World world(std::move(scene));
        GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
        moveBvh(gpu, world.top);
        expectLikeTwin(world, gpu, seed, mostTies);
    }

    HeadlessContext context_;
};

INSTANTIATE_TEST_SUITE_P(Flavors, BvhShader, ::testing::Values(GlslFlavor::desktop, GlslFlavor::web),
                         [](const auto& flavor) {
                             return flavor.param == GlslFlavor::desktop ? "desktop" : "web";
                         });

TEST_P(BvhShader, HitsWhatItsTwinHits) {
    expectLikeTwin(triangleSoup(1, 0.5f), 71, 5);
    expectLikeTwin(triangleSoup(4000, 0.2f), 72, 10);
    expectLikeTwin(sphere({100, -50, 3}, 2, 24), 73, 100);
    Scene room;
    addRoom(room, lambert(0.5f), {1, 2, 3});
    expectLikeTwin(room, 74, 5);
    for (const float scale : {0x1p-30f, 0x1p30f}) {
        Scene scaled = triangleSoup(1000, 0.2f);
        transform(scaled, glm::vec3(scale), glm::vec3(0));
        expectLikeTwin(scaled, 75, 10);
    }
}

// More nodes and triangles than a row of their tables, and more than one.
TEST_P(BvhShader, HitsWhatItsTwinHitsAmongManyTriangles) {
    expectLikeTwin(sphere(glm::vec3(0), 1, 160), 76, 20);
}

TEST_P(BvhShader, NoneEscapesAClosedMesh) {
    const auto escapes = [&](Scene scene, glm::vec3 center, float extent) {
        const World world(std::move(scene));
        GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
        moveBvh(gpu, world.top);
        const auto hits = closest(world, gpu, raysAtEdges(world.scene(), center, extent, 1000 * int(kWidth)));
        return std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return !hit; });
    };
    EXPECT_EQ(escapes(sphere({100, -50, 3}, 1, 64), {100, -50, 3}, 0.5f), 0);
    EXPECT_EQ(escapes(tiledRoom(), {1.9f, 1.6f, 2.0f}, 1.2f), 0);
}

// Of a small scene with something far away the lower bits of the corners say where they are.
TEST_P(BvhShader, ReadsAllBitsOfCorners) {
    Scene scene = triangleSoup(1000, 0.2f);
    transform(scene, glm::vec3(0x1p-12f), glm::vec3(0));
    const double tolerance = 2 * roundingOf(scene);
    const auto rays = randomRays(scene, 32 * int(kWidth), 1.1f, 81);
    addTriangle(scene, std::array{glm::vec3(1), glm::vec3(1, 1, 0.9f), glm::vec3(1, 0.9f, 1)}, kNoUvs);
    const World world(std::move(scene));
    GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
    moveBvh(gpu, world.top);
    const std::vector<Hit> hits = closest(world, gpu, rays);
    Comparison result(world.scene(), tolerance);
    for (size_t i = 0; i < rays.size(); ++i) result.add(rays[i], hits[i], world.rays().closestHit(rays[i]));
    EXPECT_EQ(result.wrong(), 0) << result.firstWrong();
    EXPECT_LE(result.ties(), 10);
}

TEST_P(BvhShader, PassesWhatIsTransparentAsItsTwin) {
    const World world(roomOfSpheres(12));
    ASSERT_EQ(bvhDefines(world.bvh).size(), 1u);
    GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
    moveBvh(gpu, world.top);
    const auto rays = randomRays(world.scene(), 64 * int(kWidth), 0.95f, 77);
    const std::vector<Hit> hits = closest(world, gpu, rays);
    int different = 0, transparent = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Hit want = world.rays().closestHit(rays[i]);
        different += hits[i].triangle != want.triangle || hits[i].backFace != want.backFace;
        transparent += want && world.scene().materialOf(want.triangle).alphaMode != AlphaMode::opaque;
    }
    // An opacity is a mean of four of 256 values, with weights that are rounded: some part in a million of
    // rays falls between two roundings of it, and masks have borders that rays may meet.
    EXPECT_LE(different, 4);
    EXPECT_GT(transparent, 500);

    // A material that changes is read anew.
    SceneState state{{}, world.scene().lights, world.scene().materials, 0};
    for (Material& material : state.materials) material.baseColor.a *= 0.5f;
    World faint(world.posed.rest());
    faint.posed.setState(state);
    updateOpacity(gpu, faint.scene(), faint.bvh);
    const std::vector<Hit> after = closest(faint, gpu, rays);
    int changed = 0;
    different = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        different += after[i].triangle != faint.rays().closestHit(rays[i]).triangle;
        changed += after[i].triangle != hits[i].triangle;
    }
    EXPECT_LE(different, 4);
    EXPECT_GT(changed, 100);
}

TEST_P(BvhShader, FollowsWhatHasMoved) {
    World world(roomOfSpheres(12));
    GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
    std::vector<glm::mat4> moved(13, glm::mat4(1));
    moved[2] = matrixOf(NodeMotion{2, {2, 1.5f, 2.5f}, {0.3f, -0.1f, 0.2f}, {30, 70, -20}});
    moved[3] = matrixOf(NodeMotion{3, {2, 1.5f, 2.5f}, {-0.5f, 0, 0}, {0, 10, 0}});
    moved[3][0] *= -0.8f;  // mirrored
    moved[7][3] = glm::vec4(0.4f, 0.4f, 0.4f, 1);
    world.pose(moved);
    moveBvh(gpu, world.top);
    expectLikeTwin(world, gpu, 78, 20);
    world.pose({});
    moveBvh(gpu, world.top);
    expectLikeTwin(world, gpu, 79, 20);
}

TEST_P(BvhShader, FindsAnyHitWithinItsDistance) {
    const World world(roomOfSpheres(9));
    GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
    moveBvh(gpu, world.top);
    const auto rays = randomRays(world.scene(), 32 * int(kWidth), 0.9f, 80);
    constexpr float kDistance = 1.5f;
    const auto hits = trace(world, gpu, rays, {"ANY_HIT"}, kDistance);
    int hit = 0, different = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        hit += hits[i].x > 0;
        different += (hits[i].x > 0) != world.rays().anyHit(rays[i], kDistance);
    }
    EXPECT_LE(different, 2);
    EXPECT_GT(hit, int(rays.size()) / 5);
    EXPECT_LT(hit, int(rays.size()) * 4 / 5);
}

TEST_P(BvhShader, NothingMeetsAnEmptyScene) {
    const World world{Scene{}};
    GpuBvh gpu = uploadBvh(world.scene(), world.bvh);
    moveBvh(gpu, world.top);
    const std::vector<Ray> rays(kWidth, Ray{{0, 0, 0}, {0, 0, 1}});
    for (const Hit& hit : closest(world, gpu, rays)) EXPECT_FALSE(hit);
}

}  // namespace
}  // namespace phat::test
