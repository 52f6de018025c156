#include "core/scene/shading.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

double decodeSrgb(int code) {
    const double s = code / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

TextureImage randomImage(int width, int height, uint64_t seed) {
    Rng rng(seed);
    TextureImage image;
    image.width = width;
    image.height = height;
    for (int i = 0; i < width * height; ++i) {
        const uint32_t bits = rng.bits();
        image.texels.push_back({bits & 255, bits >> 8 & 255, bits >> 16 & 255, bits >> 24});
    }
    return image;
}

TextureImage onePixel(glm::u8vec4 code) {
    TextureImage image;
    image.width = image.height = 1;
    image.texels = {code};
    return image;
}

// Walks to the texel instead of computing it: each step past an edge repeats, turns round or stays.
int wrapByWalking(int i, int size, Wrap wrap) {
    int at = 0, step = i < 0 ? -1 : 1;
    for (int n = std::abs(i); n > 0; --n) {
        int next = at + step;
        if (next >= 0 && next < size) {
            at = next;
        } else if (wrap == Wrap::repeat) {
            at = next < 0 ? size - 1 : 0;
        } else if (wrap == Wrap::mirroredRepeat) {
            step = -step;  // the edge texel is seen twice
        }
    }
    return at;
}

glm::dvec4 texelAt(const TextureImage& image, const TextureSlot& slot, int x, int y, bool srgb) {
    const glm::u8vec4 code = image.texels[size_t(wrapByWalking(y, image.height, slot.wrapV)) * image.width +
                                          wrapByWalking(x, image.width, slot.wrapU)];
    if (!srgb) return glm::dvec4(code) / 255.0;
    return {decodeSrgb(code.r), decodeSrgb(code.g), decodeSrgb(code.b), code.a / 255.0};
}

// Every texel weighs the tent around its centre.
glm::dvec4 lookUp(const TextureImage& image, const TextureSlot& slot, glm::dvec2 uv, bool srgb) {
    const glm::dvec2 at = uv * glm::dvec2(image.width, image.height);
    const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
    if (slot.nearest) return texelAt(image, slot, x, y, srgb);
    glm::dvec4 sum(0);
    for (int i = x - 1; i <= x + 1; ++i)
        for (int j = y - 1; j <= y + 1; ++j)
            sum += std::max(0.0, 1 - std::abs(at.x - (i + 0.5))) *
                   std::max(0.0, 1 - std::abs(at.y - (j + 0.5))) * texelAt(image, slot, i, j, srgb);
    return sum;
}

bool nearTexelEdge(double x) {
    return std::abs(x - std::round(x)) < 1e-3;
}

TEST(Textures, WrapAndFilterAsGltfSays) {
    Scene scene;
    scene.images = {randomImage(5, 3, 1), randomImage(1, 1, 2), randomImage(2, 8, 3)};
    Rng rng(4);
    for (const Wrap wrapU : {Wrap::repeat, Wrap::mirroredRepeat, Wrap::clampToEdge}) {
        for (const Wrap wrapV : {Wrap::repeat, Wrap::mirroredRepeat, Wrap::clampToEdge}) {
            for (int i = 0; i < 3000; ++i) {
                TextureSlot slot;
                slot.image = i % 3;
                slot.wrapU = wrapU;
                slot.wrapV = wrapV;
                slot.nearest = i & 1;
                const bool srgb = i & 2;
                const glm::vec2 uv = 7.0f * rng.uniform2() - 3.0f;
                const TextureImage& image = scene.images[slot.image];
                if (slot.nearest && (nearTexelEdge(uv.x * image.width) || nearTexelEdge(uv.y * image.height)))
                    continue;
                const glm::dvec4 want = lookUp(image, slot, uv, srgb);
                const glm::vec4 got = sampleTexture(scene, slot, uv, srgb);
                for (int c = 0; c < 4; ++c)
                    ASSERT_NEAR(got[c], want[c], 2e-5) << uv.x << ' ' << uv.y << ' ' << slot.nearest << srgb;
            }
        }
    }
}

// source: KHR_texture_transform: uv' = translation * rotation * scale * uv, rotation counter-clockwise in a
// system whose v points down.
TEST(Textures, AreTransformed) {
    Scene scene;
    scene.images = {randomImage(4, 4, 5)};
    TextureSlot slot;
    slot.image = 0;
    const glm::dvec2 offset(0.3, -0.2), scale(2, 0.5);
    const double angle = 0.7;
    const glm::dmat3 translation(1, 0, 0, 0, 1, 0, offset.x, offset.y, 1);
    const glm::dmat3 rotation(std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0,
                              1);
    const glm::dmat3 scaling(scale.x, 0, 0, 0, scale.y, 0, 0, 0, 1);
    const glm::dmat3 all = translation * rotation * scaling;
    slot.uvTransform = glm::mat3x2(glm::vec2(all[0]), glm::vec2(all[1]), glm::vec2(all[2]));
    Rng rng(6);
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec2 uv(rng.uniform2());
        const glm::dvec2 moved(
            std::cos(angle) * scale.x * uv.x + std::sin(angle) * scale.y * uv.y + offset.x,
            -std::sin(angle) * scale.x * uv.x + std::cos(angle) * scale.y * uv.y + offset.y);
        const glm::dvec4 want = lookUp(scene.images[0], slot, moved, false);
        const glm::vec4 got = sampleTexture(scene, slot, uv, false);
        for (int c = 0; c < 4; ++c) ASSERT_NEAR(got[c], want[c], 2e-5);
    }
}

TEST(Textures, OddCoordinatesAreHarmless) {
    Scene scene;
    scene.images = {randomImage(3, 3, 7), TextureImage()};
    TextureSlot slot;
    EXPECT_EQ(sampleTexture(scene, slot, {0.3f, 0.4f}, true), glm::vec4(1)) << "no image";
    slot.image = 1;
    EXPECT_EQ(sampleTexture(scene, slot, {0.3f, 0.4f}, true), glm::vec4(1)) << "an image without texels";
    slot.image = 0;
    for (const float odd : {1e30f, -1e30f, std::numeric_limits<float>::infinity(), std::nanf("")}) {
        for (const Wrap wrap : {Wrap::repeat, Wrap::mirroredRepeat, Wrap::clampToEdge}) {
            slot.wrapU = slot.wrapV = wrap;
            const glm::vec4 value = sampleTexture(scene, slot, {odd, -odd}, false);
            for (int c = 0; c < 4; ++c) EXPECT_TRUE(value[c] >= 0 && value[c] <= 1);
        }
    }
}

// A unit quad in z = 0 that faces +z, u along x and v along y.
Scene quad(const Material& material) {
    Scene scene;
    addQuad(scene, material, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return scene;
}

constexpr glm::vec2 kBarycentric(0.25f, 0.5f);

void expectNear(glm::vec3 got, glm::vec3 want, float tolerance = 1e-5f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], tolerance) << c;
}

// Red is along the tangent, green along handedness * (normal x tangent), blue along the normal.
TEST(NormalMap, FollowsTangentAndHandedness) {
    Material material = lambert(0.5f);
    material.doubleSided = true;
    material.normalTexture.image = 0;
    Scene scene = quad(material);
    scene.images = {onePixel({204, 178, 230, 255})};
    const glm::vec3 code = glm::vec3(204, 178, 230) / 255.0f * 2.0f - 1.0f;
    const glm::vec3 tangents[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    const glm::vec3 bitangents[] = {{0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};  // z x tangent
    for (int i = 0; i < 3; ++i) {
        for (const float handedness : {1.0f, -1.0f}) {
            for (const float scale : {1.0f, 0.4f}) {
                scene.materials[0].normalScale = scale;
                for (glm::vec4& tangent : scene.tangents) tangent = glm::vec4(tangents[i], handedness);
                const glm::vec3 want =
                    glm::normalize(scale * code.x * tangents[i] +
                                   scale * code.y * handedness * bitangents[i] + code.z * glm::vec3(0, 0, 1));
                const SurfacePoint front = surfaceAt(scene, 0, kBarycentric, false);
                expectNear(front.shading.normal, want);
                expectNear(front.normalGeometric, {0, 0, 1});
                const SurfacePoint back = surfaceAt(scene, 0, kBarycentric, true);
                expectNear(back.shading.normal, -want);
                expectNear(back.normalGeometric, {0, 0, -1});
            }
        }
    }
    for (glm::vec4& tangent : scene.tangents) tangent = glm::vec4(0);
    expectNear(surfaceAt(scene, 0, kBarycentric, false).shading.normal, {0, 0, 1});
}

TEST(NormalMap, CoatHasItsOwn) {
    Material material = lambert(0.5f);
    material.clearcoat = 1;
    material.normalTexture.image = 0;
    Scene scene = quad(material);
    scene.images = {onePixel({204, 128, 230, 255}), onePixel({128, 60, 230, 255})};
    for (glm::vec4& tangent : scene.tangents) tangent = {1, 0, 0, 1};
    const auto coatWorld = [&] {
        const SurfacePoint point = surfaceAt(scene, 0, kBarycentric, false);
        return point.shading.toWorld(point.brdf.clearcoatNormal);
    };
    expectNear(coatWorld(), {0, 0, 1});
    scene.materials[0].clearcoatNormalTexture.image = 1;
    scene.materials[0].clearcoatNormalScale = 0.5f;
    const glm::vec3 code = glm::vec3(128, 60, 230) / 255.0f * 2.0f - 1.0f;
    expectNear(coatWorld(), glm::normalize(glm::vec3(0.5f * code.x, 0.5f * code.y, code.z)));
}

TEST(Shading, NormalsAreInterpolatedAndSeenFromTheirSide) {
    Scene scene = quad(lambert(0.5f));
    scene.normals[0] = glm::normalize(glm::vec3(-1, 0, 1));
    scene.normals[1] = glm::normalize(glm::vec3(1, 0, 2));
    scene.normals[2] = glm::normalize(glm::vec3(0, 1, 3));
    const glm::vec2 b(0.2f, 0.3f);
    const glm::vec3 want =
        glm::normalize(0.5f * scene.normals[0] + 0.2f * scene.normals[1] + 0.3f * scene.normals[2]);
    expectNear(surfaceAt(scene, 0, b, false).shading.normal, want);
    expectNear(surfaceAt(scene, 0, b, true).shading.normal, -want);
    expectNear(surfaceAt(scene, 0, b, false).position, {0.5f, 0.3f, 0});
    // Outside: the position goes on, the normal is the nearest corner's.
    const SurfacePoint outside = surfaceAt(scene, 0, {-0.5f, -0.5f}, false);
    expectNear(outside.position, {-1, -0.5f, 0});
    expectNear(outside.shading.normal, scene.normals[0]);
}

TEST(Shading, SilhouettesFaceTheViewer) {
    Scene scene = quad(lambert(0.5f));
    for (glm::vec3& normal : scene.normals) normal = glm::normalize(glm::vec3(1, 0, 0.5f));
    const glm::vec3 direction = glm::normalize(glm::vec3(1, 0, -0.2f));  // from the left: dot > 0
    const Hit hit{1, 0, kBarycentric, false};
    const SurfacePoint point = surfaceAt(scene, hit, direction);
    const float cosine = -glm::dot(point.shading.normal, direction);
    EXPECT_GT(cosine, 0);
    EXPECT_LT(cosine, 2e-3f) << "bent no farther than it must";
    EXPECT_NEAR(glm::length(point.shading.normal), 1, 1e-5f);
    EXPECT_NEAR(point.shading.normal.y, 0, 1e-6f) << "bent in the plane of normal and ray";
}

TEST(Shading, BackOfASingleSidedSurfaceIsBlack) {
    Material material = emitter({3, 2, 1}, 0.7f);
    material.specular = 1;
    material.clearcoat = 1;
    Scene scene = quad(material);
    const SurfacePoint back = surfaceAt(scene, 0, kBarycentric, true);
    EXPECT_EQ(back.emission, glm::vec3(0));
    EXPECT_EQ(evaluateBrdf(back.brdf, {0, 0.6f, 0.8f}, {0, 0, 1}), glm::vec3(0));
    EXPECT_EQ(reflectance(back.brdf, {0, 0.6f, 0.8f}), glm::vec3(0));
    EXPECT_TRUE(back.backFace);

    scene.materials[0].doubleSided = true;
    const SurfacePoint shining = surfaceAt(scene, 0, kBarycentric, true);
    EXPECT_EQ(shining.emission, glm::vec3(3, 2, 1));
    EXPECT_EQ(evaluateBrdf(shining.brdf, {0, 0.6f, 0.8f}, {0, 0, 1}),
              evaluateBrdf(surfaceAt(scene, 0, kBarycentric, false).brdf, {0, 0.6f, 0.8f}, {0, 0, 1}));
}

TEST(Shading, UnlitReflectsNothing) {
    Material material = emitter({0.5f, 0.25f, 1}, 0.7f);
    material.unlit = true;
    Scene scene = quad(material);
    for (glm::vec4& color : scene.colors) color = {0.5f, 1, 0.25f, 1};
    const SurfacePoint point = surfaceAt(scene, 0, kBarycentric, false);
    expectNear(point.emission, {0.25f, 0.25f, 0.25f});
    EXPECT_EQ(reflectance(point.brdf, {0, 0, 1}), glm::vec3(0));
}

// source: glTF 2.0 appendix B, KHR_materials_ior, KHR_materials_specular.
TEST(Shading, MixesDielectricAndMetal) {
    Rng rng(8);
    for (int i = 0; i < 200; ++i) {
        Material m;
        m.baseColor = {rng.uniform(), rng.uniform(), rng.uniform(), 1};
        m.metallic = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 1.0f : rng.uniform();
        m.roughness = rng.uniform();
        m.ior = 1.3f + rng.uniform();
        m.specular = 1;
        const glm::vec3 tint(rng.uniform(), rng.uniform(), 3);  // may exceed 1; F0 may not
        m.specularColor = tint;
        const Brdf brdf = surfaceAt(quad(m), 0, kBarycentric, false).brdf;
        const double r = (m.ior - 1.0) / (m.ior + 1.0);
        for (int c = 0; c < 3; ++c) {
            const double dielectric = std::min(r * r * tint[c], 1.0);
            EXPECT_NEAR(brdf.f0[c], dielectric * (1 - m.metallic) + m.baseColor[c] * m.metallic, 1e-5);
            const double f0Max = std::min(r * r * 3, 1.0);
            const double loss = f0Max + (1 - f0Max) * kMeanSchlick;
            EXPECT_NEAR(brdf.diffuseColor[c], m.baseColor[c] * (1 - m.metallic) * (1 - loss), 1e-5);
        }
        EXPECT_NEAR(brdf.f90, 1, 1e-6);
        EXPECT_NEAR(brdf.alpha, std::max(double(m.roughness) * m.roughness, 1e-3), 1e-6);
    }
    // `specular` scales both ends; what reflects nothing head-on reflects nothing at all.
    Material m;
    m.metallic = 0;
    m.specular = 0.75f;
    const Brdf part = surfaceAt(quad(m), 0, kBarycentric, false).brdf;
    EXPECT_NEAR(part.f0.x, 0.03f, 1e-6f);
    EXPECT_NEAR(part.f90, 0.75f, 1e-6f);
    for (const auto& [specular, ior] : {std::pair{0.0f, 1.5f}, std::pair{1.0f, 1.0f}}) {
        m.specular = specular;
        m.ior = ior;
        const Brdf none = surfaceAt(quad(m), 0, kBarycentric, false).brdf;
        EXPECT_EQ(none.f0, glm::vec3(0));
        EXPECT_EQ(none.f90, 0);
        EXPECT_EQ(none.diffuseColor, glm::vec3(1));
    }
}

TEST(Shading, TexturesScaleTheirFactors) {
    Material m;
    m.baseColor = {1, 0.5f, 0.25f, 1};
    m.metallic = 0.5f;
    m.roughness = 0.8f;
    m.specular = 0.9f;
    m.clearcoat = 0.7f;
    m.clearcoatRoughness = 0.6f;
    m.emission = {2, 4, 8};
    const glm::u8vec4 code(51, 102, 153, 204);
    const double linear[4] = {0.2, 0.4, 0.6, 0.8};
    for (TextureSlot* slot : {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.emissionTexture,
                              &m.specularTexture, &m.clearcoatTexture, &m.clearcoatRoughnessTexture})
        slot->image = 0;
    Scene scene = quad(m);
    scene.images = {onePixel(code)};
    for (glm::vec4& color : scene.colors) color = {0.5f, 1, 1, 1};
    const SurfacePoint point = surfaceAt(scene, 0, kBarycentric, false);
    const double metallic = 0.5 * linear[2], roughness = 0.8 * linear[1], specular = 0.9 * linear[3];
    const double vertex[3] = {0.5, 1, 1};
    for (int c = 0; c < 3; ++c) {
        const double base = m.baseColor[c] * vertex[c] * decodeSrgb(code[c]);
        EXPECT_NEAR(point.brdf.f0[c], 0.04 * specular * (1 - metallic) + base * metallic, 1e-5);
        EXPECT_NEAR(point.emission[c], m.emission[c] * decodeSrgb(code[c]), 1e-5);
    }
    EXPECT_NEAR(point.brdf.alpha, roughness * roughness, 1e-5);
    EXPECT_NEAR(point.brdf.f90, specular * (1 - metallic) + metallic, 1e-5);
    EXPECT_NEAR(point.brdf.clearcoat, 0.7 * linear[0], 1e-5);
    EXPECT_NEAR(point.brdf.clearcoatAlpha, 0.36 * linear[1] * linear[1], 1e-5);
}

TEST(Shading, SecondUvSetIsRead) {
    Material m = lambert(1);
    m.baseColorTexture.image = 0;
    m.baseColorTexture.nearest = true;
    m.baseColorTexture.uvSet = 1;
    Scene scene = quad(m);
    const uint8_t codes[] = {255, 0};
    addGreyImage(scene, 2, 1, codes);
    for (glm::vec2& uv : scene.uv0) uv = {0.25f, 0.5f};
    for (glm::vec2& uv : scene.uv1) uv = {0.75f, 0.5f};
    EXPECT_EQ(surfaceAt(scene, 0, kBarycentric, false).brdf.diffuseColor, glm::vec3(0));
    scene.materials[0].baseColorTexture.uvSet = 0;
    EXPECT_EQ(surfaceAt(scene, 0, kBarycentric, false).brdf.diffuseColor, glm::vec3(1));
}

TEST(Shading, VertexColorsAreInterpolated) {
    Scene scene = quad(lambert(1));
    scene.colors[0] = {1, 0, 0, 1};
    scene.colors[1] = {0, 1, 0, 1};
    scene.colors[2] = {0, 0, 1, 1};
    expectNear(surfaceAt(scene, 0, {0.2f, 0.3f}, false).brdf.diffuseColor, {0.5f, 0.2f, 0.3f});
}

TEST(Shading, OpacityByMode) {
    Material m = lambert(1);
    m.baseColor.a = 0.8f;
    m.baseColorTexture.image = 0;
    Scene scene = quad(m);
    scene.images = {onePixel({255, 255, 255, 204})};
    for (glm::vec4& color : scene.colors) color.a = 0.75f;
    const auto opacity = [&](AlphaMode mode, float cutoff) {
        scene.materials[0].alphaMode = mode;
        scene.materials[0].alphaCutoff = cutoff;
        return opacityAt(scene, 0, kBarycentric);
    };
    EXPECT_EQ(opacity(AlphaMode::opaque, 0.5f), 1);
    EXPECT_NEAR(opacity(AlphaMode::blend, 0.5f), 0.8f * 0.8f * 0.75f, 1e-6f);
    EXPECT_EQ(opacity(AlphaMode::mask, 0.47f), 1);
    EXPECT_EQ(opacity(AlphaMode::mask, 0.49f), 0);
}

}  // namespace
}  // namespace phat
