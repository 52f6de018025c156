#include "core/probes/probe_sh.h"

#include "core/phatexel/phatexture.h"

namespace phat {
namespace {

// Of light from direction w of unit flux density the coefficient of term i is kOfLight[i] * shTerms(w)[i]:
// the clamped cosine is 1/4 + c/2 + 5/16 P2(c) up to order 2, and by the addition theorem
// P2(w.n) = P2(wz) P2(nz) + 3/4 (wx^2 - wy^2)(nx^2 - ny^2) + 3 (wx wy nx ny + wy wz ny nz + wz wx nz nx).
constexpr std::array<float, kShTerms> kOfLight = {0.25f,     0.5f,    0.5f,    0.5f,   0.3125f,
                                                  0.234375f, 0.9375f, 0.9375f, 0.9375f};
// The largest value of a term on the sphere.
constexpr std::array<float, kShTerms> kLargest = {1, 1, 1, 1, 1, 1, 0.5f, 0.5f, 0.5f};
constexpr float kSteps = 127;

int byteOf(const PackedIrradianceSh& packed, int index) {
    return int8_t(packed[size_t(1 + index / 4)] >> 8 * (index % 4) & 0xffu);
}

}  // namespace

std::array<float, kShTerms> shTerms(glm::vec3 d) {
    return {1,         d.x,       d.y,      d.z, 1.5f * d.z * d.z - 0.5f, d.x * d.x - d.y * d.y,
            d.x * d.y, d.y * d.z, d.z * d.x};
}

void IrradianceSh::addLight(glm::vec3 direction, glm::vec3 radianceSolidAngle) {
    const std::array<float, kShTerms> terms = shTerms(direction);
    for (int i = 0; i < kShTerms; ++i) coefficient[i] += kOfLight[i] * terms[i] * radianceSolidAngle;
}

glm::vec3 IrradianceSh::at(glm::vec3 normal) const {
    const std::array<float, kShTerms> terms = shTerms(normal);
    glm::vec3 sum(0);
    for (int i = 0; i < kShTerms; ++i) sum += terms[i] * coefficient[i];
    return glm::max(sum + beyondOrder2(normal), glm::vec3(0));
}

glm::vec3 IrradianceSh::beyondOrder2(glm::vec3 normal) const {
    const glm::vec3 mean = coefficient[0];
    glm::vec3 main(luminance(coefficient[1]), luminance(coefficient[2]), luminance(coefficient[3]));
    const float length = glm::length(main);
    if (length <= 1e-6f * luminance(mean)) return glm::vec3(0);
    main /= length;
    const std::array<float, kShTerms> terms = shTerms(main);
    glm::vec3 order2(0);
    for (int i = 4; i < kShTerms; ++i) order2 += terms[i] * coefficient[i];
    const glm::vec3 p2 = glm::clamp(order2 / glm::max(1.25f * mean, glm::vec3(1e-30f)), 0.0f, 1.0f);
    const float c = glm::dot(normal, main);
    const float missing = std::max(c, 0.0f) - 0.25f - 0.5f * c - 0.3125f * (1.5f * c * c - 0.5f);
    return 4.0f * mean * p2 * p2 * p2 * missing;
}

float shRatioBound(int term) {
    return kOfLight[term] / kOfLight[0] * kLargest[term];
}

PackedIrradianceSh packIrradianceSh(const IrradianceSh& irradiance) {
    PackedIrradianceSh packed{};
    packed[0] = packRgb9e5(irradiance.coefficient[0]);
    const glm::vec3 mean = unpackRgb9e5(packed[0]);
    for (int i = 0; i < 3 * (kShTerms - 1); ++i) {
        const int term = 1 + i / 3, channel = i % 3;
        if (mean[channel] <= 0.0f) continue;
        const float ratio = irradiance.coefficient[term][channel] / mean[channel] / shRatioBound(term);
        const int code = int(std::round(kSteps * std::clamp(ratio, -1.0f, 1.0f)));
        packed[size_t(1 + i / 4)] |= uint32_t(uint8_t(int8_t(code))) << 8 * (i % 4);
    }
    return packed;
}

IrradianceSh unpackIrradianceSh(const PackedIrradianceSh& packed) {
    IrradianceSh result;
    const glm::vec3 mean = unpackRgb9e5(packed[0]);
    result.coefficient[0] = mean;
    for (int i = 0; i < 3 * (kShTerms - 1); ++i) {
        const int term = 1 + i / 3, channel = i % 3;
        result.coefficient[term][channel] =
            float(byteOf(packed, i)) / kSteps * shRatioBound(term) * mean[channel];
    }
    return result;
}

}  // namespace phat
