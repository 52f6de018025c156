#include "core/scene/brdf.h"

#include "core/base/random.h"

namespace phat {
namespace {

// Albedo of a unit specular lobe in terms of f0 and f90, by quasi-Monte Carlo over visible normals: each
// sample weighs F * G2 / G1 (Heitz 2018, equation 19).
glm::vec2 integrateSplitSum(float nDotV, float alpha) {
    constexpr uint32_t kSamples = 1024;
    const glm::vec3 v(std::sqrt(std::max(0.0f, 1.0f - nDotV * nDotV)), 0.0f, nDotV);
    glm::dvec2 sum(0);
    for (uint32_t i = 0; i < kSamples; ++i) {
        const glm::vec2 square((float(i) + 0.5f) / kSamples, float(reverseBits(i, 10)) / kSamples);
        const glm::vec3 h = squareToVisibleNormal(square, v, alpha);
        const float vDotH = std::max(glm::dot(v, h), 0.0f);
        const glm::vec3 l = 2.0f * vDotH * h - v;
        if (l.z <= 0.0f) continue;
        const float shadowing = 4.0f * l.z * v.z * smithV(l.z, v.z, alpha) / smithG1(v.z, alpha);
        const float grazing = std::pow(1.0f - vDotH, 5.0f);
        sum += glm::dvec2(1.0f - grazing, grazing) * double(shadowing);
    }
    return glm::vec2(sum / double(kSamples));
}

std::vector<glm::vec2> integrateSplitSumTable() {
    constexpr float kMinCosine = 1e-3f;  // at 0 the visible normals are undefined
    std::vector<glm::vec2> table(kSplitSumSize * kSplitSumSize);
    for (int y = 0; y < kSplitSumSize; ++y) {
        for (int x = 0; x < kSplitSumSize; ++x) {
            const float nDotV = float(x) / (kSplitSumSize - 1);
            const float roughness = float(y) / (kSplitSumSize - 1);
            table[size_t(y) * kSplitSumSize + x] =
                integrateSplitSum(std::max(nDotV, kMinCosine), std::max(roughness * roughness, kMinAlpha));
        }
    }
    return table;
}

struct LobeAlbedos {
    glm::vec3 diffuse;
    glm::vec3 specular;
    float coat;
};

// As diffuseWeight, where the specular albedo is known.
float weightOfDiffuse(const Brdf& brdf, glm::vec3 specular) {
    float brightest = maxComponent(brdf.diffuseColor);
    if (brdf.transmission > 0.0f && brdf.transmission < 1.0f) brightest /= 1.0f - brdf.transmission;
    return brightest <= 0.0f ? 1.0f : std::clamp((1.0f - maxComponent(specular)) / brightest, 0.0f, 1.0f);
}

LobeAlbedos lobeAlbedos(const Brdf& brdf, glm::vec3 towardEye) {
    const float transmission = clearcoatTransmission(brdf, towardEye);
    const glm::vec3 specular = specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, towardEye.z);
    return {transmission * weightOfDiffuse(brdf, specular) * brdf.diffuseColor, transmission * specular,
            1.0f - transmission};
}

// Chances of drawing from each lobe; they sum to 1 unless nothing is reflected.
glm::vec3 lobeChances(const LobeAlbedos& albedos) {
    const glm::vec3 weight(luminance(albedos.diffuse), luminance(albedos.specular), albedos.coat);
    const float sum = weight.x + weight.y + weight.z;
    return sum > 0.0f ? weight / sum : glm::vec3(0);
}

float reflectedPdf(glm::vec3 towardEye, glm::vec3 towardLight, float alpha) {
    const glm::vec3 sum = towardEye + towardLight;
    const float length = glm::length(sum);
    if (length <= 0.0f) return 0.0f;
    const glm::vec3 h = sum / length;
    const float vDotH = glm::dot(towardEye, h);
    return vDotH > 0.0f ? squareToVisibleNormalPdf(h, towardEye, alpha) / (4.0f * vDotH) : 0.0f;
}

glm::vec3 reflectAbout(glm::vec3 v, glm::vec3 h) {
    return 2.0f * glm::dot(v, h) * h - v;
}

// The coat has a normal of its own; its formulas run in that normal's frame.
Frame coatFrame(const Brdf& brdf) {
    return brdf.clearcoatNormal.z >= 1.0f ? Frame{} : frameFromNormal(brdf.clearcoatNormal);
}

}  // namespace

float ggxD(float nDotH, float alpha) {
    const float a2 = alpha * alpha;
    const float d = (nDotH * a2 - nDotH) * nDotH + 1.0f;
    return a2 / (kPi * d * d);
}

float smithV(float nDotL, float nDotV, float alpha) {
    const float a2 = alpha * alpha;
    const float eye = nDotL * std::sqrt(nDotV * nDotV * (1.0f - a2) + a2);
    const float light = nDotV * std::sqrt(nDotL * nDotL * (1.0f - a2) + a2);
    return 0.5f / std::max(eye + light, 1e-7f);
}

float smithG1(float nDotV, float alpha) {
    const float a2 = alpha * alpha;
    return 2.0f * nDotV / (nDotV + std::sqrt(nDotV * nDotV * (1.0f - a2) + a2));
}

glm::vec3 schlick(glm::vec3 f0, float f90, float vDotH) {
    const float m = std::clamp(1.0f - vDotH, 0.0f, 1.0f);
    return f0 + (glm::vec3(f90) - f0) * (m * m * m * m * m);
}

const std::vector<glm::vec2>& splitSumTable() {
    static const std::vector<glm::vec2> table = integrateSplitSumTable();
    return table;
}

glm::vec2 splitSum(float nDotV, float alpha) {
    const std::vector<glm::vec2>& table = splitSumTable();
    constexpr float kLast = kSplitSumSize - 1;
    const float x = std::clamp(nDotV, 0.0f, 1.0f) * kLast;
    const float y = std::clamp(std::sqrt(alpha), 0.0f, 1.0f) * kLast;
    const int x0 = std::min(int(x), kSplitSumSize - 2);
    const int y0 = std::min(int(y), kSplitSumSize - 2);
    const glm::vec2* corner = &table[size_t(y0) * kSplitSumSize + x0];
    const glm::vec2 low = glm::mix(corner[0], corner[1], x - float(x0));
    const glm::vec2 high = glm::mix(corner[kSplitSumSize], corner[kSplitSumSize + 1], x - float(x0));
    return glm::mix(low, high, y - float(y0));
}

glm::vec3 specularAlbedo(glm::vec3 f0, float f90, float alpha, float nDotV) {
    const glm::vec2 ab = splitSum(nDotV, alpha);
    return f0 * ab.x + glm::vec3(f90 * ab.y);
}

float diffuseWeight(const Brdf& brdf, float nDotV) {
    return weightOfDiffuse(brdf, specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, nDotV));
}

float clearcoatTransmission(const Brdf& brdf, glm::vec3 towardEye) {
    if (brdf.clearcoat <= 0.0f) return 1.0f;
    const float cosine = std::max(glm::dot(towardEye, brdf.clearcoatNormal), 0.0f);
    const glm::vec2 ab = splitSum(cosine, brdf.clearcoatAlpha);
    return 1.0f - brdf.clearcoat * (kClearcoatF0 * ab.x + ab.y);
}

glm::vec3 interfaceTransmittance(const Brdf& brdf, glm::vec3 towardEye) {
    const float reflected = maxComponent(specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, towardEye.z));
    return clearcoatTransmission(brdf, towardEye) * std::max(1.0f - reflected, 0.0f) * brdf.transmissionColor;
}

ViewedBrdf viewedBrdf(const Brdf& brdf, glm::vec3 towardEye) {
    ViewedBrdf viewed;
    viewed.brdf = brdf;
    viewed.towardEye = towardEye;
    if (towardEye.z <= 0.0f) return viewed;
    const LobeAlbedos albedos = lobeAlbedos(brdf, towardEye);
    viewed.transmission = 1.0f - albedos.coat;
    viewed.diffuse = albedos.diffuse / kPi;
    viewed.chances = lobeChances(albedos);
    if (brdf.clearcoat > 0.0f) {
        viewed.coatFrame = coatFrame(brdf);
        viewed.towardEyeCoat = viewed.coatFrame.toLocal(towardEye);
    }
    return viewed;
}

ViewedBrdf only(Lobes lobes, const ViewedBrdf& viewed) {
    ViewedBrdf part = viewed;
    if (lobes == Lobes::diffuse) {
        part.brdf.f0 = glm::vec3(0);
        part.brdf.f90 = part.brdf.clearcoat = 0;
        part.chances = glm::vec3(viewed.chances.x > 0.0f ? 1.0f : 0.0f, 0, 0);
    } else if (lobes == Lobes::glossy) {
        part.diffuse = glm::vec3(0);
        const float glossy = viewed.chances.y + viewed.chances.z;
        part.chances =
            glossy > 0.0f ? glm::vec3(0, viewed.chances.y, viewed.chances.z) / glossy : glm::vec3(0);
    }
    return part;
}

LobeValues evaluateLobes(const ViewedBrdf& viewed, glm::vec3 towardLight) {
    LobeValues value;
    const Brdf& brdf = viewed.brdf;
    const glm::vec3 towardEye = viewed.towardEye;
    if (towardEye.z <= 0.0f || towardLight.z <= 0.0f) return value;

    value.diffuse = viewed.diffuse * towardLight.z;
    if (viewed.chances.y <= 0.0f && brdf.clearcoat <= 0.0f) return value;
    const glm::vec3 h = glm::normalize(towardEye + towardLight);
    const float vDotH = glm::dot(towardEye, h);
    value.specular = viewed.transmission * ggxD(h.z, brdf.alpha) *
                     smithV(towardLight.z, towardEye.z, brdf.alpha) * towardLight.z *
                     schlick(brdf.f0, brdf.f90, vDotH);

    if (brdf.clearcoat > 0.0f) {
        const float nDotV = viewed.towardEyeCoat.z;
        const float nDotL = glm::dot(towardLight, brdf.clearcoatNormal);
        if (nDotV > 0.0f && nDotL > 0.0f) {
            const float nDotH = glm::dot(h, brdf.clearcoatNormal);
            value.specular += brdf.clearcoat * ggxD(nDotH, brdf.clearcoatAlpha) *
                              smithV(nDotL, nDotV, brdf.clearcoatAlpha) * nDotL *
                              schlick(glm::vec3(kClearcoatF0), 1.0f, vDotH);
        }
    }
    return value;
}

LobeValues evaluateLobes(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight) {
    return evaluateLobes(viewedBrdf(brdf, towardEye), towardLight);
}

glm::vec3 evaluateBrdf(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight) {
    const LobeValues value = evaluateLobes(brdf, towardEye, towardLight);
    return value.diffuse + value.specular;
}

glm::vec3 reflectance(const Brdf& brdf, glm::vec3 towardEye) {
    const LobeAlbedos albedos = lobeAlbedos(brdf, towardEye);
    return glm::min(albedos.diffuse + albedos.specular + albedos.coat, glm::vec3(1));
}

BrdfSample sampleBrdf(const ViewedBrdf& viewed, float lobe, glm::vec2 square) {
    BrdfSample sample;
    const glm::vec3 chances = viewed.chances;
    if (!reflects(viewed)) return sample;

    if (lobe < chances.x) {
        sample.direction = squareToCosineHemisphere(square);
    } else if (lobe < chances.x + chances.y) {
        sample.direction = reflectAbout(viewed.towardEye,
                                        squareToVisibleNormal(square, viewed.towardEye, viewed.brdf.alpha));
    } else if (chances.z > 0.0f) {
        const glm::vec3 v = viewed.towardEyeCoat;
        if (v.z <= 0.0f) return sample;
        sample.direction = viewed.coatFrame.toWorld(
            reflectAbout(v, squareToVisibleNormal(square, v, viewed.brdf.clearcoatAlpha)));
    }
    if (sample.direction.z <= 0.0f) return sample;

    sample.pdf = sampleBrdfPdf(viewed, sample.direction);
    if (sample.pdf > 0.0f) sample.weight = evaluateBrdf(viewed, sample.direction) / sample.pdf;
    return sample;
}

BrdfSample sampleBrdf(const Brdf& brdf, glm::vec3 towardEye, float lobe, glm::vec2 square) {
    return sampleBrdf(viewedBrdf(brdf, towardEye), lobe, square);
}

float sampleBrdfPdf(const ViewedBrdf& viewed, glm::vec3 towardLight) {
    if (!reflects(viewed) || towardLight.z <= 0.0f) return 0.0f;
    const glm::vec3 chances = viewed.chances;
    float pdf = chances.x * squareToCosineHemispherePdf(towardLight);
    if (chances.y > 0.0f) pdf += chances.y * reflectedPdf(viewed.towardEye, towardLight, viewed.brdf.alpha);
    if (chances.z > 0.0f && viewed.towardEyeCoat.z > 0.0f)
        pdf += chances.z * reflectedPdf(viewed.towardEyeCoat, viewed.coatFrame.toLocal(towardLight),
                                        viewed.brdf.clearcoatAlpha);
    return pdf;
}

float sampleBrdfPdf(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight) {
    return sampleBrdfPdf(viewedBrdf(brdf, towardEye), towardLight);
}

glm::vec3 squareToCosineHemisphere(glm::vec2 s) {
    const float radius = std::sqrt(s.x);
    const float angle = 2.0f * kPi * s.y;
    return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1.0f - s.x))};
}

float squareToCosineHemispherePdf(glm::vec3 direction) {
    return std::max(direction.z, 0.0f) / kPi;
}

// source: Heitz 2018, "Sampling the GGX Distribution of Visible Normals", section 3.
glm::vec3 squareToVisibleNormal(glm::vec2 s, glm::vec3 towardEye, float alpha) {
    const glm::vec3 v = glm::normalize(glm::vec3(alpha * towardEye.x, alpha * towardEye.y, towardEye.z));
    const float length2 = v.x * v.x + v.y * v.y;
    const glm::vec3 across =
        length2 > 0.0f ? glm::vec3(-v.y, v.x, 0.0f) / std::sqrt(length2) : glm::vec3(1, 0, 0);
    const glm::vec3 along = glm::cross(v, across);

    const float radius = std::sqrt(s.x);
    const float angle = 2.0f * kPi * s.y;
    const float p1 = radius * std::cos(angle);
    const float blend = 0.5f * (1.0f + v.z);
    const float p2 =
        (1.0f - blend) * std::sqrt(std::max(0.0f, 1.0f - p1 * p1)) + blend * radius * std::sin(angle);
    const glm::vec3 n = p1 * across + p2 * along + std::sqrt(std::max(0.0f, 1.0f - p1 * p1 - p2 * p2)) * v;
    return glm::normalize(glm::vec3(alpha * n.x, alpha * n.y, std::max(n.z, 1e-6f)));
}

float squareToVisibleNormalPdf(glm::vec3 half, glm::vec3 towardEye, float alpha) {
    if (half.z <= 0.0f || towardEye.z <= 0.0f) return 0.0f;
    return smithG1(towardEye.z, alpha) * std::max(glm::dot(towardEye, half), 0.0f) * ggxD(half.z, alpha) /
           towardEye.z;
}

}  // namespace phat
