#include <gtest/gtest.h>

#include <map>

#include "core/atlas/atlas_checks.h"
#include "core/atlas/atlas_shapes.h"

namespace phat {
namespace {

struct Built {
    Scene scene;
    Atlas atlas;
    TexelPoints points;

    size_t texelCount() const { return points.state.size(); }
    glm::uvec2 texel(size_t i) const { return {i % atlas.sizeTexels.x, i / atlas.sizeTexels.x}; }
    glm::vec2 center(size_t i) const { return glm::vec2(texel(i)) + 0.5f; }
};

Built build(Scene scene, const std::vector<Sides>& sides = {}, float texelSizeMeters = 0) {
    AtlasSettings settings;
    settings.texelBudget = 1 << 16;
    settings.texelSizeMeters = texelSizeMeters;
    SilentProgress progress;
    Built built;
    built.scene = std::move(scene);
    built.atlas = buildAtlas(built.scene, sides, settings, progress);
    built.points = buildTexelPoints(built.scene, built.atlas);
    return built;
}

// Texels are area: what they cover must be what there is. Counting centres errs by about the square root of
// the outline's length in texels; charts here have thousands of texels and hundreds along their outline.
TEST(AtlasTexels, SurfaceTexelsAddUpToTheArea) {
    for (Scene scene :
         {shapes::cube(1), shapes::sphere(1), shapes::torus(1, 0.35f), shapes::moebius(1, 0.5f)}) {
        const double area = surfaceArea(scene);
        const Built built = build(std::move(scene));
        double total = 0;
        for (size_t i = 0; i < built.points.state.size(); ++i) {
            if (built.points.state[i] != TexelState::surface) continue;
            const uint32_t width = built.atlas.sizeTexels.x;
            const uint32_t chart = built.atlas.chartAt({uint32_t(i) % width, uint32_t(i) / width});
            total += square(double(built.atlas.charts[chart].texelSizeMeters));
        }
        EXPECT_NEAR(total, area, 0.02 * area);
    }
}

TEST(AtlasTexels, PlaneContinuesInItsGutters) {
    const Built built = build(shapes::plane(3, 2, 4));
    const auto& corner = built.atlas.triangleTexels[0];
    const glm::vec3 origin = built.scene.positions[built.scene.triangles[0][0]];
    const float size = built.atlas.texelSizeMeters;
    // The whole chart is one rigid motion; its axes follow from the first triangle's edges.
    const glm::vec2 e1 = corner[1] - corner[0];
    const glm::vec3 alongE1 = glm::normalize(built.scene.positions[built.scene.triangles[0][1]] - origin);
    const glm::vec3 acrossE1 = glm::cross(glm::vec3(0, 0, 1), alongE1);
    const glm::vec2 unit = glm::normalize(e1);
    size_t gutters = 0;
    for (size_t i = 0; i < built.texelCount(); ++i) {
        if (!built.points.valid(i)) continue;
        gutters += built.points.state[i] == TexelState::gutter;
        const glm::vec2 d = built.center(i) - corner[0];
        const glm::vec3 expected =
            origin + size * (glm::dot(d, unit) * alongE1 + (unit.x * d.y - unit.y * d.x) * acrossE1);
        ASSERT_LT(glm::distance(built.points.position[i], expected), 1e-4f);
        ASSERT_EQ(built.points.normal[i], glm::vec3(0, 0, 1));
        const bool inside = expected.x > 0 && expected.x < 3 && expected.y > 0 && expected.y < 2;
        ASSERT_EQ(built.points.state[i] == TexelState::surface, inside);
    }
    EXPECT_GT(gutters, 1000u);
}

TEST(AtlasTexels, BarycentricsAndFramesBelongTogether) {
    const Built built = build(shapes::torus(1, 0.35f));
    for (size_t i = 0; i < built.texelCount(); ++i) {
        if (!built.points.valid(i)) continue;
        const glm::uvec3& v = built.scene.triangles[built.points.triangle[i]];
        const auto& corner = built.atlas.triangleTexels[built.points.triangle[i]];
        const glm::vec2 b = built.points.barycentric[i];
        const glm::vec3 weights(1 - b.x - b.y, b);
        glm::vec3 position(0);
        glm::vec2 texel(0);
        for (int k = 0; k < 3; ++k) {
            position += weights[k] * built.scene.positions[v[k]];
            texel += weights[k] * corner[k];
        }
        ASSERT_LT(glm::distance(position, built.points.position[i]), 1e-4f);
        ASSERT_LT(glm::distance(texel, built.center(i)), 0.05f);
        if (built.points.state[i] == TexelState::surface) {
            ASSERT_GE(std::min({weights.x, weights.y, weights.z}), -1e-3f);
        }
        ASSERT_NEAR(glm::length(built.points.normal[i]), 1.0f, 1e-5f);
        ASSERT_NEAR(glm::length(built.points.tangent[i]), 1.0f, 1e-5f);
        ASSERT_NEAR(glm::dot(built.points.normal[i], built.points.tangent[i]), 0.0f, 1e-5f);
    }
}

TEST(AtlasTexels, TangentsRunAlongX) {
    const Built built = build(shapes::sphere(1));
    size_t pairs = 0;
    for (size_t i = 0; i + 1 < built.texelCount(); ++i) {
        if (built.points.state[i] != TexelState::surface || built.points.state[i + 1] != TexelState::surface)
            continue;
        if (built.atlas.chartAt(built.texel(i)) != built.atlas.chartAt(built.texel(i + 1))) continue;
        const glm::vec3 step = glm::normalize(built.points.position[i + 1] - built.points.position[i]);
        ASSERT_GT(glm::dot(step, built.points.tangent[i]), 0.95f);
        ++pairs;
    }
    EXPECT_GT(pairs, 10000u);
}

// Every texel's triangle is the nearest of its chart, by brute force over all of them.
TEST(AtlasTexels, GuttersBelongToTheNearestTriangle) {
    const Built built = build(shapes::torus(1, 0.35f, 24, 12));
    const auto distanceTo = [&](uint32_t triangle, glm::vec2 p) {
        float best = 1e30f;
        const auto& corner = built.atlas.triangleTexels[triangle];
        for (int k = 0; k < 3; ++k) {
            const glm::vec2 a = corner[k], edge = corner[(k + 1) % 3] - a;
            const float s = glm::clamp(glm::dot(p - a, edge) / glm::dot(edge, edge), 0.0f, 1.0f);
            best = std::min(best, glm::distance(p, a + s * edge));
        }
        return best;
    };
    size_t gutters = 0, unused = 0;
    for (size_t i = 0; i < built.texelCount(); ++i) {
        const uint32_t chart = built.atlas.chartAt(built.texel(i));
        if (built.points.state[i] == TexelState::surface || chart == kNoChart) continue;
        float nearest = 1e30f;
        for (uint32_t t = 0; t < built.scene.triangles.size(); ++t)
            if (built.atlas.triangleChart[t] == chart)
                nearest = std::min(nearest, distanceTo(t, built.center(i)));
        if (built.points.state[i] == TexelState::gutter) {
            ++gutters;
            ASSERT_NEAR(distanceTo(built.points.triangle[i], built.center(i)), nearest, 1e-3f);
        } else {
            ++unused;
            ASSERT_GT(nearest, float(kTileSize) - 1e-3f);
        }
    }
    EXPECT_GT(gutters, 1000u);
    EXPECT_GT(unused, 0u);
}

TEST(AtlasTexels, BackSidesMirrorOnlyTheNormal) {
    const Built built = build(shapes::cylinder(0.5f, 1), {Sides::both});
    size_t compared = 0;
    for (size_t i = 0; i < built.texelCount(); ++i) {
        const uint32_t c = built.atlas.chartAt(built.texel(i));
        if (c == kNoChart || built.atlas.charts[c].back) continue;
        const Chart& other = built.atlas.charts[built.atlas.charts[c].otherSide];
        const glm::uvec2 there = built.texel(i) - built.atlas.charts[c].originTexel() + other.originTexel();
        const size_t j = size_t(there.y) * built.atlas.sizeTexels.x + there.x;
        ASSERT_EQ(built.points.state[i], built.points.state[j]);
        if (!built.points.valid(i)) continue;
        ++compared;
        ASSERT_EQ(built.points.position[i], built.points.position[j]);
        ASSERT_EQ(built.points.normal[i], -built.points.normal[j]);
        ASSERT_EQ(built.points.tangent[i], built.points.tangent[j]);
        // Outward on the front.
        ASSERT_GT(glm::dot(glm::vec2(built.points.normal[i]), glm::vec2(built.points.position[i])), 0.0f);
    }
    EXPECT_GT(compared, 10000u);
}

TEST(AtlasTexels, TinyChartsStillHaveTexels) {
    Scene scene = shapes::plane(1, 1);
    shapes::add(scene, {{2, 0, 0}, {2.002f, 0, 0}, {2, 0.002f, 0}}, {{0, 1, 2}});
    const Built built = build(std::move(scene), {}, 0.01f);
    std::map<uint32_t, size_t> texels;
    for (size_t i = 0; i < built.texelCount(); ++i)
        if (built.points.valid(i)) ++texels[built.points.triangle[i]];
    EXPECT_GT(texels[2], 16u);
}

TEST(AtlasTexels, BlockFramesAreMeanFrames) {
    const Built built = build(shapes::plane(3, 2));
    for (const Frame& frame : blockFrames(built.atlas, built.points)) {
        EXPECT_NEAR(frame.normal.z, 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(frame.tangent, built.points.tangent[built.texelCount() / 2]), 1.0f, 1e-4f);
    }
    const Built ball = build(shapes::sphere(1));
    const std::vector<Frame> frames = blockFrames(ball.atlas, ball.points);
    ASSERT_EQ(frames.size(), ball.atlas.blockCount);
    for (size_t i = 0; i < ball.texelCount(); ++i) {
        if (ball.points.state[i] != TexelState::surface) continue;
        // A cap of 40 degrees and its mean: nothing in a block is farther off than the cone's whole angle.
        ASSERT_GT(glm::dot(ball.points.normal[i], frames[ball.atlas.blockAt(ball.texel(i))].normal), 0.17f);
    }
}

void mark(Built& built) {
    const RayScene rays(built.scene);
    SilentProgress progress;
    markOccludedTexels(built.points, built.atlas, rays, progress);
}

TEST(AtlasTexels, NothingCoversAnOpenPlaneOrTheOutsideOfABall) {
    for (Scene scene : {shapes::plane(3, 2, 4), shapes::sphere(1)}) {
        Built built = build(std::move(scene));
        mark(built);
        EXPECT_EQ(std::count(built.points.state.begin(), built.points.state.end(), TexelState::occluded), 0);
    }
}

// A unit cube stands at (1..2, .5..1.5) on a 3 x 2 floor, both facing outward.
void expectBoxPrint(float gapMeters) {
    Scene scene = shapes::plane(3, 2);
    Scene box = shapes::cube(1);
    for (glm::vec3& p : box.positions) p += glm::vec3(1, 0.5f, 0.25f + gapMeters);
    shapes::add(scene, box.positions, box.triangles);
    Built built = build(std::move(scene));
    mark(built);
    const float size = built.atlas.texelSizeMeters;
    size_t under = 0;
    for (size_t i = 0; i < built.texelCount(); ++i) {
        if (built.points.state[i] == TexelState::unused || built.points.triangle[i] > 1) continue;
        const glm::vec3 p = built.points.position[i];
        // Distance to the box's outline, negative inside.
        const glm::vec2 d = glm::abs(glm::vec2(p) - glm::vec2(1.5f, 1.0f)) - 0.5f;
        const float outside = std::max(d.x, d.y);
        const bool occluded = built.points.state[i] == TexelState::occluded;
        if (outside < -size) {
            ASSERT_TRUE(occluded) << p.x << ' ' << p.y;
            ++under;
        }
        if (outside > size) {
            ASSERT_FALSE(occluded) << p.x << ' ' << p.y;
        }
    }
    EXPECT_GT(double(under) * size * size, 0.9);
}

TEST(AtlasTexels, FloorUnderABoxIsOccluded) {
    expectBoxPrint(0);
    // Texels are about 14 mm: a millimetre of air is still pressed against the floor.
    expectBoxPrint(0.001f);
}

TEST(AtlasTexels, GuttersDoNotReachThroughWalls) {
    // The inside of a cube: every face's gutter lies behind a neighbouring face.
    Scene room = shapes::cube(1);
    for (glm::uvec3& t : room.triangles) std::swap(t.y, t.z);
    for (glm::vec3& n : room.normals) n = -n;
    Built built = build(std::move(room));
    mark(built);
    size_t gutters = 0;
    for (size_t i = 0; i < built.texelCount(); ++i) gutters += built.points.state[i] == TexelState::gutter;
    EXPECT_EQ(gutters, 0u);
    const auto surface =
        std::count(built.points.state.begin(), built.points.state.end(), TexelState::surface);
    EXPECT_NEAR(double(surface) * square(built.atlas.texelSizeMeters), 6.0, 0.06);
}

TEST(AtlasTexels, LitBackSidesDoNotCover) {
    // A small plane inside a cube that faces outward is in the dark; it is not once the cube's inside has
    // texels.
    for (const Sides sides : {Sides::front, Sides::both}) {
        Scene scene = shapes::cube(1);
        shapes::add(scene, {{0.3f, 0.3f, 0.5f}, {0.7f, 0.3f, 0.5f}, {0.3f, 0.7f, 0.5f}}, {{0, 1, 2}});
        Built built = build(std::move(scene), {sides, Sides::front});
        mark(built);
        size_t occluded = 0, valid = 0;
        for (size_t i = 0; i < built.texelCount(); ++i) {
            if (built.points.triangle[i] != 12) continue;
            occluded += built.points.state[i] == TexelState::occluded;
            valid += built.points.valid(i);
        }
        EXPECT_EQ(sides == Sides::front ? valid : occluded, 0u);
        EXPECT_GT(sides == Sides::front ? occluded : valid, 100u);
    }
}

}  // namespace
}  // namespace phat
