// A bake does not depend on the unit that its scene is in.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/bake/bake.h"
#include "support/scaled_scene.h"

namespace phat {
namespace {

using namespace test;

BakeSettings coarse(Directions directions, RadianceSource radiance) {
    BakeSettings settings;
    settings.atlas.texelBudget = 40'000;
    settings.photons.count = 30'000;
    settings.directions = directions;
    settings.radiance = radiance;
    settings.pathsPerPhatexel = 2;
    return settings;
}

Bake bakeAt(float factor, const BakeSettings& settings) {
    SilentProgress progress;
    return bake(scaledScene(litTerrace(), factor), settings, progress);
}

/// A quantity of every texel of two bakes: what it is on average in the second, and how the first differs.
struct Comparison {
    double sum = 0, difference = 0, square = 0, count = 0;

    void add(double a, double b) {
        sum += b;
        difference += a - b;
        square += (a - b) * (a - b);
        ++count;
    }
    // Guided directions differ where rounding decides otherwise, and then by their noise: three standard
    // errors.
    void expectSame(const char* what, double scale) const {
        ASSERT_GT(count, 1000) << what;
        const double mean = difference / count,
                     noise = 3 * std::sqrt(square / count - mean * mean) / std::sqrt(count);
        EXPECT_LT(std::abs(mean), kSameMean * scale + noise) << what;
        EXPECT_LT(noise, 3 * kSameMean * scale) << what << ": the test tells nothing";
    }
    void expectSame(const char* what) const { expectSame(what, sum / count); }
};

void compareLayers(const Bake& a, const Bake& b, const PhatexelLayer& layerA, const PhatexelLayer& layerB) {
    Comparison radiance, octaves;
    for (size_t i = 0; i < layerA.texels.size(); ++i) {
        const Phatexel x = unpackPhatexel(layerA.texels[i], a.atlas.unitMeters),
                       y = unpackPhatexel(layerB.texels[i], b.atlas.unitMeters);
        if (!x.valid || !y.valid) continue;
        radiance.add(double(luminance(x.radiance)), double(luminance(y.radiance)));
        if (x.distance == kFarDistance || y.distance == kFarDistance) continue;
        octaves.add(std::log2(double(x.distance) / double(a.atlas.unitMeters)),
                    std::log2(double(y.distance) / double(b.atlas.unitMeters)));
    }
    radiance.expectSame("radiance");
    octaves.expectSame("distance in units of length", 1);
}

void compareIrradiance(const Bake& a, const std::vector<uint32_t>& irradianceA,
                       const std::vector<uint32_t>& irradianceB) {
    Comparison irradiance;
    for (size_t i = 0; i < irradianceA.size(); ++i)
        if (a.points.state[i] == TexelState::surface)
            irradiance.add(double(luminance(unpackRgb9e5(irradianceA[i]))),
                           double(luminance(unpackRgb9e5(irradianceB[i]))));
    irradiance.expectSame("irradiance");
}

void expectSame(const Bake& a, const Bake& b) {
    ASSERT_EQ(a.atlas.sizeTexels, b.atlas.sizeTexels) << "texel by texel";
    compareLayers(a, b, a.phatexture.indirect[0], b.phatexture.indirect[0]);
    compareLayers(a, b, a.phatexture.area[0], b.phatexture.area[0]);
    compareIrradiance(a, a.phatexture.indirectIrradiance, b.phatexture.indirectIrradiance);
    compareIrradiance(a, a.phatexture.areaIrradiance, b.phatexture.areaIrradiance);
}

template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expectSameBytes(const Bake& a, const Bake& b, float factor) {
    EXPECT_EQ(a.atlas.unitMeters, factor * b.atlas.unitMeters);
    EXPECT_TRUE(sameBytes(a.phatexture.indirect[0].texels, b.phatexture.indirect[0].texels));
    EXPECT_TRUE(sameBytes(a.phatexture.area[0].texels, b.phatexture.area[0].texels));
    EXPECT_EQ(a.phatexture.indirectIrradiance, b.phatexture.indirectIrradiance);
    EXPECT_EQ(a.phatexture.areaIrradiance, b.phatexture.areaIrradiance);
    EXPECT_TRUE(sameBytes(a.phatexture.indirectGuides, b.phatexture.indirectGuides));
    EXPECT_TRUE(sameBytes(a.phatexture.probes, b.phatexture.probes));
}

// All random numbers are the same.
TEST(Scale, LightIsTheSameInEveryUnit) {
    const BakeSettings settings = coarse(Directions::guided, RadianceSource::texels);
    const Bake inMeters = bakeAt(1, settings);
    for (const float factor : kScales) {
        SCOPED_TRACE(factor);
        const Bake baked = bakeAt(factor, settings);
        expectSame(baked, inMeters);
        if (factor == 1024) expectSameBytes(baked, inMeters, factor);
    }
}

// Densities of photons have a largest radius.
TEST(Scale, PhotonsAreTheSameInEveryUnit) {
    const BakeSettings settings = coarse(Directions::photons, RadianceSource::photons);
    const Bake inMeters = bakeAt(1, settings);
    for (const float factor : kScales) {
        SCOPED_TRACE(factor);
        expectSame(bakeAt(factor, settings), inMeters);
    }
}

}  // namespace
}  // namespace phat
