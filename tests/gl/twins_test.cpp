// GLSL functions against their C++ twins over random inputs, on the GPU, in both flavours.

#include <gtest/gtest.h>

#include <bit>

#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "core/phatexel/directions.h"
#include "core/phatexel/phatexture.h"
#include "core/scene/brdf.h"
#include "core/scene/occluders.h"
#include "gl/gl_context.h"
#include "gl/gl_evaluate.h"
#include "gl/renderer.h"
#include "gl/textures.h"

namespace phat::test {
namespace {

using Row = std::array<glm::vec4, 4>;
constexpr int kRows = 4000;

class Twins : public ::testing::TestWithParam<GlslFlavor> {
  protected:
    std::vector<glm::vec4> run(const std::string& include, const std::string& body,
                               const std::vector<Row>& rows, GLuint splitSum = 0, GLuint guidePdf = 0) {
        return evaluateGlsl(include, body, rows, GetParam(), splitSum, guidePdf);
    }
    HeadlessContext context_;
};

INSTANTIATE_TEST_SUITE_P(Flavors, Twins, ::testing::Values(GlslFlavor::desktop, GlslFlavor::web),
                         [](const auto& flavor) {
                             return flavor.param == GlslFlavor::desktop ? "desktop" : "web";
                         });

void expectNear(glm::vec3 gpu, glm::vec3 cpu, float relative, float absolute, int row) {
    for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(gpu[c], cpu[c], relative * std::abs(cpu[c]) + absolute)
            << "row " << row << " channel " << c;
}

std::vector<Row> randomRows(uint64_t seed) {
    Rng random(seed);
    std::vector<Row> rows(kRows);
    for (Row& row : rows)
        for (glm::vec4& v : row)
            for (int c = 0; c < 4; ++c) v[c] = random.uniform();
    return rows;
}

GlTexture splitSumTexture() {
    GlTexture texture = createTexture2D(GL_RG32F, glm::uvec2(kSplitSumSize));
    glTextureSubImage2D(texture.name(), 0, 0, 0, kSplitSumSize, kSplitSumSize, GL_RG, GL_FLOAT,
                        splitSumTable().data());
    return texture;
}

TEST_P(Twins, HemisphereMap) {
    const auto rows = randomRows(1);
    const auto there = run("lib/hemisphere_map.glsl", "result = vec4(squareToHemisphere(a.xy), 0.0);", rows);
    const auto back = run("lib/hemisphere_map.glsl",
                          "result = vec4(hemisphereToSquare(squareToHemisphere(a.xy)), 0.0, 0.0);", rows);
    for (int i = 0; i < kRows; ++i) {
        const glm::vec2 square(rows[i][0]);
        expectNear(glm::vec3(there[i]), squareToHemisphere(square), 0, 2e-6f, i);
        expectNear(glm::vec3(back[i]), glm::vec3(square, 0), 0, 3e-4f, i);
    }
}

TEST_P(Twins, SphereOcclusion) {
    const auto rows = randomRows(40);
    const auto result = run("lib/contact_shadow.glsl",
                            "result = vec4(sphereOcclusion(4.0 * a.xyz - 2.0, 0.1 + a.w, normalize(b.xyz - "
                            "0.5)), 0.0, 0.0, 0.0);",
                            rows);
    for (int i = 0; i < kRows; ++i) {
        const glm::vec4 &a = rows[i][0], &b = rows[i][1];
        const float want =
            sphereOcclusion(4.0f * glm::vec3(a) - 2.0f, 0.1f + a.w, glm::normalize(glm::vec3(b) - 0.5f));
        ASSERT_NEAR(result[i].x, want, 1e-4f) << i;
    }
}

TEST_P(Twins, PhatexelUnpacking) {
    Rng random(2);
    std::vector<Row> rows(kRows);
    std::vector<PackedPhatexel> packed(kRows);
    for (int i = 0; i < kRows; ++i) {
        Phatexel phatexel;
        phatexel.valid = i % 7 != 0;
        const float scale = std::exp2(30 * random.uniform() - 15);
        phatexel.radiance = scale * glm::vec3(random.uniform2(), random.uniform());
        phatexel.directionBlock = squareToHemisphere(random.uniform2()) * glm::vec3(1, 1, i % 2 ? 1 : -1);
        phatexel.distance = i % 5 == 0 ? kFarDistance : 1e-3f * std::exp2(20 * random.uniform());
        packed[i] = packPhatexel(phatexel, kEvaluatedUnitMeters);
        // 16 bits a float: bit patterns would not survive as NaNs.
        rows[i][0] = {float(packed[i].radiance & 0xffffu), float(packed[i].radiance >> 16),
                      float(packed[i].directionDistance & 0xffffu), float(packed[i].directionDistance >> 16)};
    }
    const std::string unpack =
        "uvec4 u = uvec4(a); Phatexel p = unpackPhatexel(uvec2(u.x | (u.y << 16), u.z | (u.w << 16)));";
    const auto radiance =
        run("lib/phatexel.glsl", unpack + "result = vec4(p.radiance, p.valid ? 1.0 : 0.0);", rows);
    const auto direction =
        run("lib/phatexel.glsl", unpack + "result = vec4(p.directionBlock, p.distance);", rows);
    for (int i = 0; i < kRows; ++i) {
        const Phatexel want = unpackPhatexel(packed[i], kEvaluatedUnitMeters);
        ASSERT_EQ(radiance[i].w > 0.5f, want.valid);
        if (!want.valid) continue;
        expectNear(glm::vec3(radiance[i]), want.radiance, 1e-6f, 0, i);
        expectNear(glm::vec3(direction[i]), want.directionBlock, 0, 1e-6f, i);
        ASSERT_NEAR(direction[i].w, want.distance, 1e-4f * want.distance);
    }
}

// What is stored between the lookup's passes; the halves of a rounding may fall either way.
TEST_P(Twins, PackedRadianceAndMirrorDirections) {
    const auto rows = randomRows(14);
    const std::string pack =
        "vec3 rgb = a.xyz * exp2(a.w * 20.0 - 10.0);"
        "vec3 mirror = normalize(b.xyz - 0.5);"
        "LobeSums drawn = noLobeSums();"
        "drawn.indirect = vec4(rgb, 1.0);"
        "drawn.cosine = 100.0 * b.x;"
        "drawn.mirror = mirror;"
        "drawn.surface = 5u;"
        "drawn.alpha = b.w;"
        "LobeSums back = unpackLobeSums(packLobeSums(drawn));";
    const auto lobe =
        run("lib/packed_sums.glsl", pack + "result = vec4(back.alpha, back.cosine, 0.0, 0.0);", rows);
    const auto there =
        run("lib/packed_sums.glsl",
            pack + "result = vec4(back.indirect.rgb, dot(back.mirror, mirror) * float(back.surface) / 5.0);",
            rows);
    for (int row = 0; row < kRows; ++row) {
        const glm::vec4 a = rows[row][0];
        const glm::vec3 rgb = glm::vec3(a) * std::exp2(a.w * 20 - 10);
        const glm::vec3 here = unpackRgb9e5(packRgb9e5(rgb));
        expectNear(there[row], here, 0, 1.01f * maxComponent(rgb) / 256, row);
        expectNear(there[row], rgb, 0, 1.01f * maxComponent(rgb) / 512, row);
        ASSERT_GT(there[row].w, 0.999999f) << "row " << row;
        ASSERT_NEAR(lobe[row].y, 100 * rows[row][1].x, 0.1f * rows[row][1].x + 1e-6f) << "row " << row;
        // Its root in steps of 1/255.
        ASSERT_NEAR(std::sqrt(lobe[row].x), std::sqrt(rows[row][1].w), 0.51f / 255) << "row " << row;
    }
}

TEST_P(Twins, GuideDensity) {
    constexpr int kGuides = 3;
    std::vector<Guide> guides(kGuides);
    Rng random(3);
    std::vector<float> pdf(size_t(kGuides) * kGuideSize * kGuideSize);
    for (int g = 0; g < kGuides; ++g) {
        for (uint16_t& weight : guides[g].weight) weight = uint16_t(1 + random.bits() % 65535);
        for (int cell = 0; cell < kGuideSize * kGuideSize; ++cell) {
            const glm::vec2 center(cell % kGuideSize + 0.5f, cell / kGuideSize + 0.5f);
            pdf[size_t(cell / kGuideSize) * kGuides * kGuideSize + size_t(g) * kGuideSize +
                cell % kGuideSize] =
                squareToGuidePdf(guides[g], squareToHemisphere(center / float(kGuideSize)));
        }
    }
    const GlTexture texture = createTexture2D(GL_R32F, {kGuides * kGuideSize, kGuideSize});
    glTextureSubImage2D(texture.name(), 0, 0, 0, kGuides * kGuideSize, kGuideSize, GL_RED, GL_FLOAT,
                        pdf.data());

    auto rows = randomRows(4);
    for (int i = 0; i < kRows; ++i)
        rows[i][1] = glm::vec4(squareToHemisphere(rows[i][0]), float(i % kGuides));
    const auto results =
        run("lib/phatexel.glsl", "result = vec4(squareToGuidePdf(guidePdf, int(b.w), b.xyz));", rows, 0,
            texture.name());
    int differ = 0;
    for (int i = 0; i < kRows; ++i) {
        const float want = squareToGuidePdf(guides[i % kGuides], glm::vec3(rows[i][1]));
        if (std::abs(results[i].x - want) > 1e-5f * want) ++differ;
    }
    // A direction within rounding of a cell's border may fall to either side: 1e-6 of 1/16 of the square.
    EXPECT_LE(differ, 2);
}

// Rows: a = (diffuse, alpha), b = (f0, f90), c = eye and light on the square, d = coat.
struct BrdfCase {
    Brdf brdf;
    glm::vec3 towardEye, towardLight;
};

BrdfCase caseOf(const Row& row) {
    BrdfCase made;
    made.brdf.diffuseColor = 0.9f * glm::vec3(row[0]);
    made.brdf.alpha = std::max(row[0].w * row[0].w, kMinAlpha);
    made.brdf.f0 = glm::vec3(row[1]);
    made.brdf.f90 = row[1].w;
    made.brdf.clearcoat = row[3].x > 0.5f ? row[3].y : 0.0f;
    made.brdf.clearcoatAlpha = 0.01f + 0.5f * row[3].z;
    made.brdf.clearcoatNormal = glm::normalize(glm::vec3(0.3f * row[3].w, 0.1f, 1));
    made.brdf.transmission = row[3].y > 0.5f ? 0.7f * row[3].z : 0.0f;
    made.brdf.transmissionColor = {row[0].z, row[0].y, row[0].x};
    made.towardEye = squareToHemisphere({row[2].x, row[2].y});
    made.towardLight = squareToHemisphere({row[2].z, row[2].w});
    return made;
}

const std::string kBrdfCase = R"(
    Brdf brdf = Brdf(0.9 * a.xyz, b.xyz, b.w, max(a.w * a.w, kMinAlpha), d.x > 0.5 ? d.y : 0.0,
                     0.01 + 0.5 * d.z, normalize(vec3(0.3 * d.w, 0.1, 1.0)), d.y > 0.5 ? 0.7 * d.z : 0.0,
                     a.zyx);
    vec3 eye = squareToHemisphere(c.xy), light = squareToHemisphere(c.zw);)";

TEST_P(Twins, SplitSum) {
    const auto rows = randomRows(8);
    const auto entries = run("lib/split_sum.glsl", R"(
        ivec2 at = ivec2(a.xy * 63.999);
        float roughness = float(at.y) / 63.0;
        result.xy = integrateSplitSum(max(float(at.x) / 63.0, 1e-3), max(roughness * roughness, kMinAlpha));)",
                             rows);
    for (int i = 0; i < kRows; ++i) {
        const glm::ivec2 at(glm::vec2(rows[i][0]) * 63.999f);
        const glm::vec2 want = splitSumTable()[size_t(at.y) * kSplitSumSize + size_t(at.x)];
        // Sums of 1,024 floats.
        expectNear(glm::vec3(glm::vec2(entries[i]), 0), glm::vec3(want, 0), 1e-4f, 1e-5f, i);
    }
}

TEST_P(Twins, InterfaceTransmittance) {
    const GlTexture table = splitSumTexture();
    const auto rows = randomRows(15);
    const auto results =
        run("lib/brdf.glsl", kBrdfCase + "result = vec4(interfaceTransmittance(brdf, eye), 0);", rows,
            table.name());
    for (int i = 0; i < kRows; ++i) {
        const BrdfCase made = caseOf(rows[i]);
        expectNear(glm::vec3(results[i]), interfaceTransmittance(made.brdf, made.towardEye), 1e-4f, 1e-5f, i);
    }
}

TEST_P(Twins, BrdfLobes) {
    const GlTexture table = splitSumTexture();
    const auto rows = randomRows(5);
    const auto diffuse = run(
        "lib/brdf.glsl", kBrdfCase + "result = vec4(evaluateLobes(viewedBrdf(brdf, eye), light).diffuse, 0);",
        rows, table.name());
    const auto specular =
        run("lib/brdf.glsl",
            kBrdfCase + "result = vec4(evaluateLobes(viewedBrdf(brdf, eye), light).specular, 0);", rows,
            table.name());
    const auto sum =
        run("lib/brdf.glsl", kBrdfCase + "result = vec4(evaluateBrdf(viewedBrdf(brdf, eye), light), 0);",
            rows, table.name());
    for (int i = 0; i < kRows; ++i) {
        const BrdfCase made = caseOf(rows[i]);
        const LobeValues want = evaluateLobes(made.brdf, made.towardEye, made.towardLight);
        expectNear(glm::vec3(diffuse[i]), want.diffuse, 1e-4f, 1e-6f, i);
        // D's denominator cancels near the peak: an error of 1e-7 in n.h over alpha^2.
        const float relative = 1e-4f + 1e-6f / square(std::min(made.brdf.alpha, made.brdf.clearcoatAlpha));
        if (relative > 0.1f) continue;
        expectNear(glm::vec3(specular[i]), want.specular, relative, 1e-5f, i);
        expectNear(glm::vec3(sum[i]), want.diffuse + want.specular, relative, 1e-5f, i);
    }
}

TEST_P(Twins, BrdfTerms) {
    const GlTexture table = splitSumTexture();
    const auto rows = randomRows(6);
    const auto terms = run("lib/brdf.glsl", kBrdfCase + R"(
        result = vec4(smithV(a.x, a.y, brdf.alpha), smithG1(a.y, brdf.alpha), diffuseWeight(brdf, a.y),
                      clearcoatTransmission(brdf, eye));)",
                           rows, table.name());
    const auto albedo = run("lib/brdf.glsl", kBrdfCase + R"(
        result = vec4(specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, a.y), meanFresnel(b.x, b.w));)",
                            rows, table.name());
    const auto fresnel =
        run("lib/brdf.glsl", "result = vec4(schlick(b.xyz, b.w, a.x), ggxD(a.y, 0.05 + a.w));", rows,
            table.name());
    for (int i = 0; i < kRows; ++i) {
        const BrdfCase made = caseOf(rows[i]);
        const glm::vec4 a = rows[i][0], b = rows[i][1];
        const float v = smithV(a.x, a.y, made.brdf.alpha);
        ASSERT_NEAR(terms[i].x, v, 1e-4f * v) << i;
        ASSERT_NEAR(terms[i].y, smithG1(a.y, made.brdf.alpha), 1e-5f) << i;
        ASSERT_NEAR(terms[i].z, diffuseWeight(made.brdf, a.y), 1e-4f) << i;
        ASSERT_NEAR(terms[i].w, clearcoatTransmission(made.brdf, made.towardEye), 1e-5f) << i;
        expectNear(glm::vec3(albedo[i]), specularAlbedo(made.brdf.f0, made.brdf.f90, made.brdf.alpha, a.y),
                   1e-5f, 1e-5f, i);
        ASSERT_NEAR(albedo[i].w, meanFresnel(b.x, b.w), 1e-6f) << i;
        expectNear(glm::vec3(fresnel[i]), schlick(glm::vec3(b), b.w, a.x), 1e-5f, 1e-6f, i);
        const float dOfH = ggxD(a.y, 0.05f + a.w);
        ASSERT_NEAR(fresnel[i].w, dOfH, 1e-3f * dOfH) << i;
    }
}

TEST_P(Twins, ToneMap) {
    auto rows = randomRows(7);
    for (Row& row : rows)
        for (int c = 0; c < 3; ++c) row[0][c] = std::exp2(16 * row[0][c] - 10);
    constexpr float kStops = 0.75f;
    for (ToneMap operation : {ToneMap::linear, ToneMap::agx, ToneMap::aces}) {
        const auto results =
            run("lib/tone_map.glsl",
                "result = vec4(toneMap(a.xyz, " + std::to_string(int(operation)) + ", 0.75), 0.0);", rows);
        Image image(kRows, 1);
        for (int i = 0; i < kRows; ++i) image.at(i, 0) = glm::vec3(rows[i][0]);
        const Image want = toneMap(image, operation, kStops);
        for (int i = 0; i < kRows; ++i) expectNear(glm::vec3(results[i]), want.at(i, 0), 1e-4f, 2e-5f, i);
    }
}

// Every cell of every group size is held by the texel whose sample stratifiedSquare puts there.
TEST_P(Twins, BlockLayout) {
    const auto rows = randomRows(11);
    const auto there = run("lib/block_layout.glsl",
                           "int bits = 2 + int(a.z * 3.999); int group = 1 << bits;"
                           "ivec2 corner = ivec2(b.xy * float(kBlockSize / group)) * group;"
                           "ivec2 texel = texelHolding(a.xy, corner, bits, uint(a.w * 1024.0));"
                           "result = vec4(vec2(texel), vec2(corner));",
                           rows);
    for (int row = 0; row < kRows; ++row) {
        const auto& [a, b, c, d] = rows[row];
        const int bits = 2 + int(a.z * 3.999f), group = 1 << bits;
        const glm::uvec2 texel(there[row].x, there[row].y), corner(there[row].z, there[row].w);
        ASSERT_EQ(texel / uint32_t(group) * uint32_t(group), corner) << "row " << row;
        const glm::vec2 held = stratifiedSquare(texel, uint32_t(a.w * 1024.0f), glm::vec2(0.5f));
        EXPECT_EQ(glm::ivec2(held * float(group)), glm::ivec2(glm::vec2(a) * float(group))) << "row " << row;
    }
}

TEST_P(Twins, VisibleNormals) {
    const auto rows = randomRows(12);
    const auto there = run("lib/visible_normal.glsl",
                           "vec3 v = squareToHemisphere(a.zw);"
                           "result = vec4(squareToVisibleNormal(a.xy, v, 0.01 + b.x), 0.0);",
                           rows);
    for (int row = 0; row < kRows; ++row) {
        const auto& [a, b, c, d] = rows[row];
        const glm::vec3 v = squareToHemisphere({a.z, a.w});
        expectNear(there[row], squareToVisibleNormal(glm::vec2(a), v, 0.01f + b.x), 0, 1e-3f, row);
    }
}

// Without growth the smoothed density is that of visible normals, reflected.
TEST_P(Twins, SmoothedDensityOfNoSpread) {
    const auto rows = randomRows(13);
    const auto there = run("lib/visible_normal.glsl",
                           "vec3 v = squareToHemisphere(a.zw);"
                           "vec3 h = squareToVisibleNormal(a.xy, v, 0.1 + b.x);"
                           "result = vec4(smoothedLobePdf(v, reflect(-v, h), 0.1 + b.x, 0.0));",
                           rows);
    int compared = 0;
    for (int row = 0; row < kRows; ++row) {
        const auto& [a, b, c, d] = rows[row];
        const glm::vec3 v = squareToHemisphere({a.z, a.w});
        const glm::vec3 h = squareToVisibleNormal(glm::vec2(a), v, 0.1f + b.x);
        const float vDotH = glm::dot(v, h);
        if (vDotH < 0.2f || v.z < 0.05f)
            continue;  // GLSL clamps foreshortening; float rounding at the horizon
        const float pdf = squareToVisibleNormalPdf(h, v, 0.1f + b.x) / (4 * vDotH);
        EXPECT_NEAR(there[row].x, pdf, 2e-3f * pdf + 1e-5f) << "row " << row;
        ++compared;
    }
    EXPECT_GT(compared, kRows / 2);
}

}  // namespace
}  // namespace phat::test
