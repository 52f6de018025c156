#include "core/scene/glass.h"

#include <bit>

#include "core/scene/brdf.h"

namespace phat {
namespace {

// Between parallel faces each crossing after the first two is an internal reflection, a factor of at most the
// reflectance; light that is trapped for longer than this is lost.
constexpr int kMaxCrossings = 64;

// Beer's law: attenuationColor is what is left after attenuationDistance (KHR_materials_volume).
glm::vec3 attenuation(const Material& material, float meters) {
    if (material.attenuationColor == glm::vec3(1) || !(meters > 0.0f)) return glm::vec3(1);
    return glm::pow(material.attenuationColor, glm::vec3(meters / material.attenuationDistance));
}

// Cosine on the inner side of an interface (Snell's law). pre: cosine >= 0, ior >= 1.
float refractedCosine(float cosine, float ior) {
    return std::sqrt(std::max(1.0f - (1.0f - cosine * cosine) / square(std::max(ior, 1.0f)), 0.0f));
}

bool isSmooth(const Brdf& brdf) {
    return brdf.alpha <= kMinAlpha;
}

glm::vec3 microNormal(const Brdf& brdf, glm::vec3 eye, Rng& rng) {
    return isSmooth(brdf) ? glm::vec3(0, 0, 1) : squareToVisibleNormal(rng.uniform2(), eye, brdf.alpha);
}

glm::vec3 mirroredAbout(glm::vec3 v, glm::vec3 h) {
    return 2.0f * glm::dot(v, h) * h - v;
}

// Thin glass scatters like its specular lobe, mirrored to the other side (KHR_materials_transmission).
glm::vec3 throughThin(const Brdf& brdf, glm::vec3 eye, Rng& rng) {
    if (isSmooth(brdf)) return -eye;
    const glm::vec3 reflected = mirroredAbout(eye, microNormal(brdf, eye, rng));
    return reflected.z > 0.0f ? glm::vec3(reflected.x, reflected.y, -reflected.z) : -eye;
}

// Refracts about a microfacet [Walter et al. 2007], or about the surface where that does not cross it; `eta`:
// of the side of `eye` over that of the result. Zero at total internal reflection.
glm::vec3 refracted(glm::vec3 eye, glm::vec3 h, float eta) {
    const glm::vec3 direction = glm::refract(-eye, h, eta);
    return direction.z < 0.0f ? direction : glm::refract(-eye, glm::vec3(0, 0, 1), eta);
}

uint64_t bitsOf(glm::vec3 v) {
    return hashOf(std::bit_cast<uint32_t>(v.x), std::bit_cast<uint32_t>(v.y), std::bit_cast<uint32_t>(v.z));
}

glm::vec3 thinAttenuation(const Scene& scene, const Hit& hit, const Material& material, float cosine) {
    return attenuation(material, thicknessAt(scene, hit) / refractedCosine(cosine, material.ior));
}

glm::vec3 pastSurface(const RayScene& rays, const SurfacePoint& point, glm::vec3 direction) {
    // Grazing rays would get too far along the surface.
    constexpr float kMinCosine = 0.1f;
    const float cosine = glm::dot(direction, point.normalGeometric);
    const glm::vec3 outward = cosine >= 0.0f ? point.normalGeometric : -point.normalGeometric;
    const glm::vec3 beyond = rays.offsetOrigin(point.position, outward);
    if (std::abs(cosine) < kMinCosine) return beyond;
    // On the ray itself, so that thin glass in a large scene does not shift it.
    return point.position + glm::dot(beyond - point.position, outward) / std::abs(cosine) * direction;
}

}  // namespace

GlassWalk::GlassWalk(const RayScene& rays, const Ray& ray, uint64_t seed)
    : rays_(rays),
      ray_(ray),
      from_(ray.origin),
      rng_(rays.hasGlass() ? hashOf(bitsOf(ray.origin), bitsOf(ray.direction), seed) : 0) {}

void GlassWalk::absorb(const Hit& hit) {
    const Material* through = inside_;
    if (hit && hit.backFace && rays_.glassOf(hit.triangle) == Glass::volume)
        through = &rays_.scene().materialOf(hit.triangle);
    if (!through || !hit) return;
    const glm::vec3 position = ray_.origin + hit.distance * ray_.direction;
    throughput_ *= attenuation(*through, glm::distance(from_, position));
}

void GlassWalk::goOn(const SurfacePoint& from, glm::vec3 direction) {
    from_ = from.position;
    ray_ = {pastSurface(rays_, from, direction), direction};
}

bool GlassWalk::leaves(const SurfacePoint& at, const Material& material) {
    const glm::vec3 eye = at.shading.toLocal(-ray_.direction);
    const glm::vec3 h = microNormal(at.brdf, eye, rng_);
    const float cosine = std::min(std::abs(glm::dot(eye, h)), 1.0f), ior = std::max(material.ior, 1.0f);
    const float sine2 = square(ior) * (1.0f - square(cosine));
    // Schlick's formula with the angle outside, so that both directions reflect alike.
    const float reflectance =
        sine2 >= 1.0f ? 1.0f : maxComponent(schlick(at.brdf.f0, at.brdf.f90, std::sqrt(1.0f - sine2)));
    glm::vec3 local(0);
    if (rng_.uniform() >= reflectance) local = refracted(eye, h, ior);
    const bool isTransmitted = local != glm::vec3(0);
    if (isTransmitted) {
        throughput_ *= at.brdf.transmissionColor;
    } else {
        local = mirroredAbout(eye, h);
        if (local.z <= 0.0f) local = {-eye.x, -eye.y, eye.z};
    }
    const glm::vec3 direction = glm::normalize(at.shading.toWorld(local));
    // A shading normal that sends light to the wrong side: the flat surface decides.
    const bool crosses = glm::dot(direction, at.normalGeometric) < 0.0f;
    if (crosses == isTransmitted)
        goOn(at, direction);
    else if (isTransmitted)
        goOn(at, ray_.direction);
    else
        goOn(at, glm::reflect(ray_.direction, at.normalGeometric));
    return isTransmitted;
}

glm::vec3 GlassWalk::transmitted(const SurfacePoint& at, const Material& material, Glass glass) {
    const glm::vec3 eye = at.shading.toLocal(-ray_.direction);
    const glm::vec3 local = glass == Glass::thin ? throughThin(at.brdf, eye, rng_)
                                                 : refracted(eye, microNormal(at.brdf, eye, rng_),
                                                             1.0f / std::max(material.ior, 1.0f));
    const glm::vec3 direction = glm::normalize(at.shading.toWorld(local));
    return glm::dot(direction, at.normalGeometric) < 0.0f ? direction : ray_.direction;
}

bool GlassWalk::passes(const Hit& hit) {
    const Scene& scene = rays_.scene();
    const Material& material = scene.materialOf(hit.triangle);
    const Glass glass = rays_.glassOf(hit.triangle);
    absorb(hit);
    if (++crossings_ > kMaxCrossings) {
        throughput_ = glm::vec3(0);
        return false;
    }
    const SurfacePoint at = glassAt(scene, hit, ray_.direction);
    if (glass == Glass::volume && hit.backFace) {
        way_ += hit.distance;
        inside_ = leaves(at, material) ? nullptr : &material;
        return true;
    }
    const float cosine = glm::dot(at.shading.normal, -ray_.direction);
    glm::vec3 transmittance = interfaceTransmittance(at.brdf, at.shading.toLocal(-ray_.direction));
    if (glass == Glass::thin) transmittance *= thinAttenuation(scene, hit, material, cosine);
    const float chance = std::min(maxComponent(transmittance), 1.0f);
    if (!(rng_.uniform() < chance)) {
        throughput_ /= 1.0f - chance;
        return false;
    }
    throughput_ *= transmittance / chance;
    way_ += hit.distance;
    goOn(at, transmitted(at, material, glass));
    if (glass == Glass::volume) inside_ = &material;
    return true;
}

SeenThrough seeThrough(const RayScene& rays, const Ray& ray, uint64_t seed, uint64_t& rayCount,
                       SeenSides sides) {
    SeenThrough seen{rays.closestHit(ray.origin, ray.direction), ray};
    if (!rays.hasGlass()) return seen;
    const Scene& scene = rays.scene();
    GlassWalk walk(rays, ray, seed);
    float skipped = 0;
    // Skipping backs ends where floats are too coarse to get past one.
    while (seen.hit) {
        const Hit& hit = seen.hit;
        const bool hidden = sides == SeenSides::visible && hit.backFace && !walk.inside() &&
                            !scene.materialOf(hit.triangle).doubleSided;
        if (hidden) {
            const SurfacePoint at = surfaceAt(scene, hit, seen.ray.direction);
            const glm::vec3 beyond = rays.offsetOrigin(at.position, -at.normalGeometric);
            if (!(glm::dot(beyond - seen.ray.origin, seen.ray.direction) > 0)) return {{}, seen.ray};
            skipped += hit.distance;
            seen.ray.origin = beyond;
        } else if (rays.glassOf(hit.triangle) == Glass::none) {
            walk.ends(hit);
            break;
        } else if (walk.passes(hit)) {
            seen.ray = walk.ray();
        } else {
            break;
        }
        ++rayCount;
        seen.hit = rays.closestHit(seen.ray.origin, seen.ray.direction);
    }
    seen.throughput = walk.throughput();
    if (seen.hit) seen.hit.distance += walk.wayMeters() + skipped;
    return seen;
}

StraightView seeStraight(const RayScene& rays, const Ray& ray, float maxDistance, uint64_t& rayCount) {
    StraightView view{rays.closestHit(ray.origin, ray.direction, maxDistance)};
    const Scene& scene = rays.scene();
    glm::vec3 origin = ray.origin, from = ray.origin;  // `from`: on the surface
    float way = 0;
    const Material* inside = nullptr;  // of the volume that was entered, through an interface that reflects:
    float entryReflectance = 0;
    for (int i = 0; view.hit; ++i) {
        const Hit hit = view.hit;
        const Material& material = scene.materialOf(hit.triangle);
        const Glass glass = rays.glassOf(hit.triangle);
        if (glass == Glass::none || i == kMaxCrossings) {
            if (inside) view.transmittance *= attenuation(*inside, hit.distance);
            view.hit.distance += way;
            break;
        }
        const SurfacePoint at = glassAt(scene, hit, ray.direction);
        const glm::vec3 eye = at.shading.toLocal(-ray.direction);
        view.transmittance *= interfaceTransmittance(at.brdf, eye);
        const float reflectance = maxComponent(specularAlbedo(at.brdf.f0, at.brdf.f90, at.brdf.alpha, eye.z));
        if (glass == Glass::thin) {
            view.transmittance *= thinAttenuation(scene, hit, material, eye.z);
        } else if (hit.backFace) {
            // Between parallel planes the refracted ray is shorter. What is reflected back and forth leaves
            // in the end, a geometric series [Stokes 1862].
            const glm::vec3 left =
                attenuation(material, glm::distance(at.position, from) * eye.z /
                                          std::max(refractedCosine(eye.z, material.ior), 1e-3f));
            view.transmittance *= left / (1.0f - entryReflectance * reflectance * left * left);
        }
        const bool enters = glass == Glass::volume && !hit.backFace;
        if (glass == Glass::volume) {
            inside = enters ? &material : nullptr;
            entryReflectance = enters ? reflectance : 0.0f;
        }
        if (maxComponent(view.transmittance) <= 0.0f) return view;
        from = at.position;
        origin = pastSurface(rays, at, ray.direction);
        way += hit.distance;
        ++rayCount;
        view.hit = rays.closestHit(origin, ray.direction, maxDistance - way);
    }
    const bool endsInside = !view.hit && inside && maxDistance < kFarDistance;
    if (endsInside) view.transmittance *= attenuation(*inside, maxDistance - way);
    return view;
}

}  // namespace phat
