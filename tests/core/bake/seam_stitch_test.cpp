#include "core/bake/seam_stitch.h"

#include <gtest/gtest.h>

#include "core/atlas/atlas_shapes.h"
#include "core/atlas/chart_fill.h"

namespace phat {
namespace {

struct Sheet {
    Scene scene;
    Atlas atlas;
    TexelPoints points;
    std::vector<uint8_t> receives;
    std::vector<SeamPoint> seams;
};

/// A square of one metre that bends at x = 1/2 by `bendDegrees`, with vertices of its own on both sides;
/// `islands`: both halves have charts of their own.
Sheet bentSheet(float bendDegrees, bool islands, bool smoothNormals, Sides sides = Sides::front) {
    Sheet sheet;
    const float bend = glm::radians(bendDegrees);
    for (const bool right : {false, true}) {
        const glm::vec3 along = right ? glm::vec3(std::cos(bend), 0, std::sin(bend)) : glm::vec3(1, 0, 0);
        const glm::vec3 start = right ? glm::vec3(0.5f, 0, 0) : glm::vec3(0);
        const uint32_t first = uint32_t(sheet.scene.positions.size());
        for (int i = 0; i < 4; ++i) {
            const glm::vec2 uv(i == 1 || i == 2, i >= 2);
            const glm::vec3 flat = glm::cross(along, glm::vec3(0, 1, 0));
            sheet.scene.positions.push_back(start + 0.5f * uv.x * along + glm::vec3(0, uv.y, 0));
            sheet.scene.normals.push_back(smoothNormals ? glm::vec3(0, 0, 1) : flat);
            sheet.scene.uv0.push_back({0.4f * uv.x + (right ? islands ? 0.5f : 0.4f : 0.0f), 0.8f * uv.y});
        }
        sheet.scene.triangles.push_back(first + glm::uvec3(0, 1, 2));
        sheet.scene.triangles.push_back(first + glm::uvec3(0, 2, 3));
    }
    sheet.scene.materials.emplace_back();
    Surface surface;
    surface.triangleCount = 4;
    surface.vertexCount = 8;
    sheet.scene.surfaces.push_back(surface);
    sheet.scene.triangleSurface.assign(4, 0);

    AtlasSettings settings;
    settings.useUvSet = 0;
    settings.texelBudget = 4096;
    SilentProgress progress;
    sheet.atlas = buildAtlas(sheet.scene, {sides}, settings, progress);
    sheet.points = buildTexelPoints(sheet.scene, sheet.atlas);
    sheet.receives = irradianceTexels(sheet.atlas, sheet.points);
    sheet.seams = findSeams(sheet.scene, sheet.atlas);
    return sheet;
}

/// `value` of the position at the texels on the surface, the gutters filled from them.
template <typename ValueAt>
IrradianceMap mapOf(const Sheet& sheet, const ValueAt& value) {
    IrradianceMap map(sheet.atlas.texelCount(), glm::vec3(0));
    std::vector<uint8_t> known = sheet.receives;
    for (size_t i = 0; i < map.size(); ++i)
        if (known[i]) map[i] = value(sheet.points.position[i]);
    fillWithinCharts(map, known, sheet.atlas, sheet.points);
    return map;
}

void stitch(IrradianceMap& map, const Sheet& sheet, float spreadTexels = 0) {
    SilentProgress progress;
    stitchSeams(map, sheet.seams, {sheet.atlas, sheet.points, sheet.receives}, spreadTexels, progress);
}

float largestJump(const IrradianceMap& map, const Sheet& sheet) {
    float largest = 0;
    for (const SeamPoint& seam : sheet.seams) {
        const glm::vec3 a = irradianceAt(map, sheet.atlas, seam.chart[0], seam.position[0]);
        const glm::vec3 b = irradianceAt(map, sheet.atlas, seam.chart[1], seam.position[1]);
        largest = std::max(largest, maxComponent(glm::abs(a - b)));
    }
    return largest;
}

// Over one metre a ramp, and a step of a tenth between the charts.
glm::vec3 rampWithStep(glm::vec3 p) {
    const float value = 1.0f + p.x + (p.x > 0.5f ? 0.1f : 0.0f);
    return {value, 2 * value, 0.5f * value};
}

TEST(SeamStitch, FindsTheCutOnce) {
    const Sheet sheet = bentSheet(0, true, false);
    ASSERT_EQ(sheet.atlas.charts.size(), 2u);
    const float texels = 1.0f / sheet.atlas.texelSizeMeters;
    EXPECT_NEAR(float(sheet.seams.size()), 2 * texels, 2);
    float length = 0;
    for (const SeamPoint& seam : sheet.seams) {
        EXPECT_NE(seam.chart[0], seam.chart[1]);
        length += seam.weight;
    }
    EXPECT_NEAR(length, texels, 0.01f * texels);
}

// Gutters lie in the surface's plane here: both charts must read one position from their positions.
TEST(SeamStitch, BothSidesAreOnePoint) {
    const Sheet sheet = bentSheet(0, true, false);
    ASSERT_FALSE(sheet.seams.empty());
    for (const SeamPoint& seam : sheet.seams) {
        const glm::vec3 a = irradianceAt(sheet.points.position, sheet.atlas, seam.chart[0], seam.position[0]);
        const glm::vec3 b = irradianceAt(sheet.points.position, sheet.atlas, seam.chart[1], seam.position[1]);
        EXPECT_NEAR(a.x, 0.5f, 0.01f * sheet.atlas.texelSizeMeters);
        EXPECT_LT(glm::distance(a, b), 0.01f * sheet.atlas.texelSizeMeters);
    }
}

TEST(SeamStitch, JumpsGoAndTheMeanStays) {
    const Sheet sheet = bentSheet(0, true, false);
    const IrradianceMap before = mapOf(sheet, rampWithStep);
    for (const float spread : {0.0f, 4.0f}) {
        IrradianceMap after = before;
        stitch(after, sheet, spread);
        ASSERT_GT(largestJump(before, sheet), 0.2f) << "twice the step, in green";
        EXPECT_LT(largestJump(after, sheet), 0.1f * largestJump(before, sheet)) << spread;
        glm::dvec3 sumBefore(0), sumAfter(0);
        for (size_t i = 0; i < before.size(); ++i) {
            if (!sheet.receives[i]) continue;
            sumBefore += before[i];
            sumAfter += after[i];
            const float away = std::abs(sheet.points.position[i].x - 0.5f) / sheet.atlas.texelSizeMeters;
            if (spread == 0 && away > 1.5f) {
                EXPECT_EQ(before[i], after[i]);
            }
        }
        EXPECT_NEAR(sumAfter.y / sumBefore.y, 1, 0.002) << spread;
    }
}

// A ramp goes on over the cut: afterwards both charts read the truth there, though each knows its side only.
TEST(SeamStitch, SlopesGoOn) {
    const Sheet sheet = bentSheet(0, true, false);
    IrradianceMap map = mapOf(sheet, [](glm::vec3 p) { return glm::vec3(1.0f + p.x); });
    const float slope = sheet.atlas.texelSizeMeters;  // a texel
    stitch(map, sheet);
    for (const SeamPoint& seam : sheet.seams)
        for (const int side : {0, 1})
            EXPECT_NEAR(irradianceAt(map, sheet.atlas, seam.chart[side], seam.position[side]).x, 1.5f,
                        0.25f * slope);
}

TEST(SeamStitch, OneChartHasNoSeam) {
    const Sheet sheet = bentSheet(0, false, false);
    ASSERT_EQ(sheet.atlas.charts.size(), 1u);
    EXPECT_TRUE(sheet.seams.empty());
    const IrradianceMap before = mapOf(sheet, rampWithStep);
    IrradianceMap after = before;
    stitch(after, sheet);
    EXPECT_EQ(before, after);
}

TEST(SeamStitch, CreasesStay) {
    EXPECT_TRUE(bentSheet(90, true, false).seams.empty());
    EXPECT_FALSE(bentSheet(5, true, false).seams.empty());
    EXPECT_FALSE(bentSheet(40, true, true).seams.empty()) << "what counts is the shading normal";
}

TEST(SeamStitch, SidesAreNotMixed) {
    const Sheet one = bentSheet(0, true, false), both = bentSheet(0, true, false, Sides::both);
    ASSERT_EQ(both.atlas.charts.size(), 4u);
    size_t backs = 0;
    for (const SeamPoint& seam : both.seams) {
        EXPECT_EQ(both.atlas.charts[seam.chart[0]].back, both.atlas.charts[seam.chart[1]].back);
        backs += both.atlas.charts[seam.chart[0]].back;
    }
    EXPECT_GT(backs, 0u);
    EXPECT_EQ(2 * backs, both.seams.size());
    EXPECT_GT(one.seams.size(), 0u);
}

// Half of the sheet is under something: what its texels were given there must not reach the other half.
TEST(SeamStitch, OccludedTexelsHaveNoSay) {
    Sheet sheet = bentSheet(0, true, false);
    for (size_t i = 0; i < sheet.points.state.size(); ++i)
        if (sheet.points.valid(i) && sheet.points.position[i].x > 0.5f && sheet.points.position[i].y > 0.5f)
            sheet.points.state[i] = TexelState::occluded;
    sheet.receives = irradianceTexels(sheet.atlas, sheet.points);
    const IrradianceMap before = mapOf(sheet, rampWithStep);
    IrradianceMap after = before;
    stitch(after, sheet);
    bool changed = false;
    for (size_t i = 0; i < before.size(); ++i) {
        if (!sheet.receives[i]) continue;
        if (sheet.points.position[i].y > 0.5f + 3 * sheet.atlas.texelSizeMeters) {
            EXPECT_EQ(before[i], after[i]);
        } else {
            changed |= before[i] != after[i];
        }
    }
    EXPECT_TRUE(changed);
}

TEST(SeamStitch, LightStaysPositive) {
    const Sheet sheet = bentSheet(0, true, false);
    IrradianceMap map = mapOf(sheet, [](glm::vec3 p) { return glm::vec3(p.x > 0.5f ? 1.0f : 0.0f); });
    stitch(map, sheet);
    for (const glm::vec3 value : map) ASSERT_TRUE(glm::all(glm::greaterThanEqual(value, glm::vec3(0))));
}

// A change on one of the small pieces that share a chart does not reach the others.
TEST(SeamStitch, OtherPiecesKeepTheirLight) {
    Sheet sheet;
    for (int i = 0; i < 60; ++i) {
        Scene tube = shapes::cylinder(0.03f, 0.05f);
        for (glm::vec3& p : tube.positions) p += 0.1f * glm::vec3(float(i % 10), float(i / 10), 0);
        shapes::add(sheet.scene, tube.positions, tube.triangles);
    }
    AtlasSettings settings;
    settings.texelBudget = 20'000;
    SilentProgress progress;
    sheet.atlas = buildAtlas(sheet.scene, {}, settings, progress);
    sheet.points = buildTexelPoints(sheet.scene, sheet.atlas);
    sheet.receives = irradianceTexels(sheet.atlas, sheet.points);
    sheet.seams = findSeams(sheet.scene, sheet.atlas);
    const auto isFirst = [&](size_t texel) {
        return sheet.scene.triangleSurface[sheet.points.triangle[texel]] == 0;
    };
    IrradianceMap map(sheet.atlas.texelCount(), glm::vec3(1));
    for (size_t i = 0; i < map.size(); ++i)
        if (sheet.points.valid(i) && isFirst(i) && sheet.points.normal[i].x > 0) map[i] = glm::vec3(3);
    const IrradianceMap before = map;
    stitch(map, sheet, 3);
    size_t changed = 0;
    for (size_t i = 0; i < map.size(); ++i) {
        if (!sheet.points.valid(i)) continue;
        if (isFirst(i))
            changed += map[i] != before[i];
        else
            ASSERT_NEAR(map[i].x, 1, 1e-4f) << i;
    }
    EXPECT_GT(changed, 10u);
}

}  // namespace
}  // namespace phat
