#include "core/render/hit_gloss.h"

namespace phat {
namespace {

// The sharper of the two lobes, which bounds what is alike.
float sharpestAlpha(const Brdf& brdf) {
    return brdf.clearcoat > 0 ? std::min(brdf.alpha, brdf.clearcoatAlpha) : brdf.alpha;
}

}  // namespace

uint32_t sideOf(const Scene& scene, const Hit& hit) {
    return 2 * scene.triangleSurface[hit.triangle] + uint32_t(hit.backFace);
}

bool HitGlossSum::add(const GlossyHit& hit, glm::vec3 weight) {
    const float mean = maxComponent(weight);
    if (hit.reflected.walks == 0 || mean <= 0.0f) return false;
    if (weight_ > 0 && hit.side != sum_.side) return false;
    sum_.side = hit.side;
    sum_.position += mean * hit.point.position;
    sum_.towardEye -= mean * hit.arriving;
    sum_.mirror += mean * glm::reflect(hit.arriving, hit.point.shading.normal);
    sum_.alpha += mean * sharpestAlpha(hit.point.brdf);
    sum_.distance += mean * hit.reflected.nearness;
    light_ += weight * hit.reflected.glossy;
    albedo_ += weight * hit.reflected.glossyAlbedo;
    weight_ += mean;
    walks_ += hit.reflected.walks;
    return true;
}

HitGloss HitGlossSum::mean(float weights) const {
    if (weight_ <= 0.0f) return {};
    HitGloss gloss;
    gloss.lobe = sum_;
    gloss.lobe.position /= weight_;
    gloss.lobe.towardEye = glm::normalize(sum_.towardEye);
    gloss.lobe.mirror = glm::normalize(sum_.mirror);
    gloss.lobe.alpha /= weight_;
    gloss.lobe.distance = weight_ / sum_.distance;
    gloss.light.indirect = light_ / glm::max(albedo_, glm::vec3(1e-20f));
    gloss.light.weight = float(walks_);
    gloss.carried = albedo_ / weights;
    return gloss;
}

}  // namespace phat
