#pragma once
// Hits of two ray tracers that compute in floats, each in its own way: the same, ties, or wrong.

#include <glm/gtx/string_cast.hpp>
#include <string>

#include "core/scene/rays.h"

namespace phat::test {

/// Some units in the last place of the scene's coordinates: what rounding may shift a surface by.
inline double roundingOf(const Scene& scene) {
    const Bounds bounds = boundsOf(scene);
    return 32 * 0x1p-24 *
           maxComponent(glm::max(glm::abs(bounds.low), glm::abs(bounds.high)) + bounds.diagonal());
}

/// How far inside of a triangle a ray crosses its plane, in metres: negative outside. In double.
inline double insideBy(const Scene& scene, uint32_t triangle, const Ray& ray) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::dvec3 corners[3] = {scene.positions[t.x], scene.positions[t.y], scene.positions[t.z]};
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const glm::dvec3 o(ray.origin), d(ray.direction);
    double inside = 1e30;
    for (int i = 0; i < 3; ++i) {
        // The distance between the lines of the ray and of the edge, on the side that the winding says.
        const glm::dvec3 a = corners[i], b = corners[(i + 1) % 3], across = glm::cross(d, b - a);
        const double length = glm::length(across);
        if (!(length > 0)) return 0;
        const double side = glm::dot(across, a - o) / length;
        inside = std::min(inside, glm::dot(normal, d) < 0 ? side : -side);
    }
    return inside;
}

/// `tolerance` in metres: what may shift a surface. What lies nearer to an edge than that may be hit or
/// missed, and what lies nearer to another hit may be before or behind it.
class Comparison {
  public:
    Comparison(const Scene& scene, double tolerance) : scene_(scene), tolerance_(tolerance) {}

    void add(const Ray& ray, const Hit& is, const Hit& want) {
        hits_ += bool(want);
        const bool same = is.triangle == want.triangle && is.backFace == want.backFace;
        if (same && !want) return;
        bool near = false;
        if (is && want)
            near = std::abs(double(is.distance) - want.distance) *
                       std::min(cosine(is, ray), cosine(want, ray)) <=
                   tolerance_;
        if (same && near) return;
        const bool otherSide = is && is.triangle == want.triangle && is.backFace != want.backFace;
        if ((near && !otherSide) || isDoubtful(is, ray) || isDoubtful(want, ray)) {
            ++ties_;
            return;
        }
        if (wrong_++ == 0) firstWrong_ = glm::to_string(ray.origin) + ' ' + glm::to_string(ray.direction);
    }

    int hits() const { return hits_; }
    int ties() const { return ties_; }
    int wrong() const { return wrong_; }
    const std::string& firstWrong() const { return firstWrong_; }

  private:
    double cosine(const Hit& hit, const Ray& ray) const {
        const glm::uvec3 t = scene_.triangles[hit.triangle];
        const glm::dvec3 a(scene_.positions[t.x]), b(scene_.positions[t.y]), c(scene_.positions[t.z]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        return std::abs(glm::dot(normal, glm::dvec3(ray.direction))) / std::max(glm::length(normal), 1e-300);
    }
    bool isDoubtful(const Hit& hit, const Ray& ray) const {
        return hit && (std::abs(insideBy(scene_, hit.triangle, ray)) <= tolerance_ ||
                       hit.distance * cosine(hit, ray) <= tolerance_ || cosine(hit, ray) <= 1e-6);
    }

    const Scene& scene_;
    double tolerance_;
    int hits_ = 0, ties_ = 0, wrong_ = 0;
    std::string firstWrong_;
};

}  // namespace phat::test
