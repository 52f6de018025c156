#include "core/scene/default_camera.h"

#include <tbb/parallel_for.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "core/scene/camera_ray.h"
#include "core/scene/enclosure.h"
#include "core/scene/seen_light.h"
#include "core/scene/shading.h"

namespace phat {
namespace {

constexpr float kAspect = 1.5f;
constexpr float kMargin = 1.05f;  // around a scene that is seen from outside

constexpr int kHeadings = 16;
constexpr int kRaysAcross = 18, kRaysDown = 12;
// The views that show most are asked for their light, too.
constexpr size_t kMaxLitViews = 32;

glm::vec3 headingOf(int index) {
    const float angle = 2 * kPi * (float(index) + 0.5f) / kHeadings;
    return {std::sin(angle), 0, -std::cos(angle)};
}

glm::vec3 rayThrough(glm::vec3 forward, int x, int y) {
    const float slope = std::tan(0.5f * kDefaultFovRadians);
    const glm::vec3 right(-forward.z, 0, forward.x);
    const glm::vec2 at((2 * float(x) + 1) / kRaysAcross - 1, 1 - (2 * float(y) + 1) / kRaysDown);
    return glm::normalize(forward + at.x * slope * kAspect * right + glm::vec3(0, at.y * slope, 0));
}

Camera lookingAt(glm::vec3 eye, glm::vec3 target, float znear) {
    Camera camera;
    camera.name = "default";
    camera.yfovRadians = kDefaultFovRadians;
    camera.znear = znear;
    camera.worldFromCamera = glm::inverse(glm::lookAt(eye, target, glm::vec3(0, 1, 0)));
    return camera;
}

struct RoomView {
    StandPoint from;
    int heading = 0;
    float score = 0;
};

// What a view shows on a grid of rays.
struct Seen {
    glm::vec3 position{0}, normal{0};
    float distance = 0;
    uint32_t material = 0;
    bool surface = false;
};

using SeenGrid = std::array<Seen, size_t(kRaysAcross) * kRaysDown>;

SeenGrid seenIn(const RayScene& rays, const RoomView& view) {
    const Scene& scene = rays.scene();
    SeenGrid grid;
    for (int y = 0; y < kRaysDown; ++y) {
        for (int x = 0; x < kRaysAcross; ++x) {
            const Ray ray{view.from.eye, rayThrough(headingOf(view.heading), x, y)};
            const Hit hit = visibleBehindGlass(rays, ray);
            if (!hit) continue;
            grid[size_t(y * kRaysAcross + x)] = {
                ray.origin + hit.distance * ray.direction,
                surfaceAt(scene, hit, ray.direction).normalGeometric, hit.distance,
                scene.surfaces[scene.triangleSurface[hit.triangle]].material, true};
        }
    }
    return grid;
}

// Whether two neighbouring rays meet different things: another material, or planes that are not one.
bool differs(const Seen& a, const Seen& b, float roomHeight) {
    constexpr float kStep = 0.02f;       // of the room's height
    constexpr float kSameNormal = 0.9f;  // a cosine
    if (!a.surface || !b.surface) return a.surface != b.surface;
    return a.material != b.material || glm::dot(a.normal, b.normal) < kSameNormal ||
           std::abs(glm::dot(a.normal, b.position - a.position)) > kStep * roomHeight;
}

// The fraction of neighbouring rays that meet different things: small on bare walls, large on furniture.
float detailOf(const SeenGrid& grid, float roomHeight) {
    int pairs = 0, different = 0;
    for (int y = 0; y < kRaysDown; ++y) {
        for (int x = 0; x < kRaysAcross; ++x) {
            const Seen& seen = grid[size_t(y * kRaysAcross + x)];
            const auto compare = [&](int dx, int dy) {
                if (x + dx >= kRaysAcross || y + dy >= kRaysDown) return;
                ++pairs;
                different += differs(seen, grid[size_t((y + dy) * kRaysAcross + x + dx)], roomHeight);
            };
            compare(1, 0);
            compare(0, 1);
        }
    }
    return float(different) / float(pairs);
}

// How much there is to see: depth counts by its logarithm, so that a corridor does not beat the room, what
// stands right before the eye counts against the view, and things count more than bare walls.
float contentScore(const RayScene& rays, const RoomView& view) {
    constexpr float kNear = 0.35f;       // of the room's height
    constexpr float kBare = 0.1f;        // what a wall without anything on it is worth
    constexpr float kMaxDetail = 0.25f;  // beyond it a view is not better, but cluttered
    const SeenGrid grid = seenIn(rays, view);
    float depth = 0, near = 0;
    for (const Seen& seen : grid) {
        if (!seen.surface) continue;  // a window shows none of the room
        depth += std::log1p(seen.distance / view.from.roomHeight);
        near += seen.distance < kNear * view.from.roomHeight;
    }
    constexpr float kCount = kRaysAcross * kRaysDown;
    const float detail = std::min(detailOf(grid, view.from.roomHeight), kMaxDetail);
    return depth / kCount * std::max(0.05f, 1 - 2 * near / kCount) * (kBare + detail);
}

Camera cameraOf(const RoomView& view) {
    return lookingAt(view.from.eye, view.from.eye + headingOf(view.heading), 0.004f * view.from.roomHeight);
}

template <class Score>
void rank(std::vector<RoomView>& views, const Score& score) {
    tbb::parallel_for(size_t(0), views.size(), [&](size_t i) { views[i].score = score(views[i]); });
    std::stable_sort(views.begin(), views.end(),
                     [](const RoomView& a, const RoomView& b) { return a.score > b.score; });
}

DefaultView insideView(const RayScene& rays, const LightSampler& lights,
                       const std::vector<StandPoint>& points) {
    std::vector<RoomView> views;
    for (const StandPoint& point : points)
        for (int heading = 0; heading < kHeadings; ++heading) views.push_back({point, heading});
    rank(views, [&](const RoomView& view) { return contentScore(rays, view); });
    views.resize(std::min(views.size(), kMaxLitViews));
    rank(views, [&](const RoomView& view) {
        return view.score * (0.3f + litFraction(rays, lights, cameraOf(view)));
    });

    const StandPoint& from = views.front().from;
    const glm::vec3 forward = headingOf(views.front().heading);
    const Hit hit = visibleBehindGlass(rays, {from.eye, forward});
    DefaultView view;
    view.inside = true;
    view.target = from.eye + (hit ? hit.distance : from.roomHeight) * forward;
    view.camera = cameraOf(views.front());
    return view;
}

// The nearest eye along `back` for which all points are within a pyramid of the given slopes: each side plane
// touches a point.
glm::vec3 tightEye(const Scene& scene, const std::vector<bool>& counts, const glm::mat3& worldFromView) {
    const glm::vec2 slope = std::tan(0.5f * kDefaultFovRadians) * glm::vec2(kAspect, 1) / kMargin;
    glm::vec2 right(-1e30f), left(-1e30f);  // also: top, bottom
    const glm::mat3 viewFromWorld = glm::transpose(worldFromView);
    for (size_t t = 0; t < scene.triangles.size(); ++t) {
        for (int c = 0; c < 3 && counts[t]; ++c) {
            const glm::vec3 p = viewFromWorld * scene.positions[scene.triangles[t][c]];
            right = glm::max(right, glm::vec2(p) + slope * p.z);
            left = glm::max(left, -glm::vec2(p) + slope * p.z);
        }
    }
    const glm::vec2 distance = (right + left) / (2.0f * slope);
    return worldFromView * glm::vec3(0.5f * (right - left), std::max(distance.x, distance.y));
}

DefaultView outsideView(const Scene& scene) {
    DefaultView view;
    const Bounds bounds = boundsWithoutGround(scene);
    const float size = bounds.diagonal() > 0 ? bounds.diagonal() : 1.0f;
    view.target = bounds.empty() ? glm::vec3(0) : bounds.center();
    const glm::vec3 back = glm::normalize(glm::vec3(0.6f, 0.45f, 1.0f));
    glm::vec3 eye = view.target + 2 * size * back;
    const Camera aimed = lookingAt(eye, view.target, 0);
    if (!bounds.empty())
        eye = tightEye(scene, trianglesWithoutGround(scene), glm::mat3(aimed.worldFromCamera));
    // Very flat or small things would touch the near plane.
    const float distance = std::max(glm::dot(eye - view.target, back), 0.6f * size);
    eye += back * (distance - glm::dot(eye - view.target, back));
    view.target = eye - distance * back;
    view.camera = lookingAt(eye, view.target, 1e-3f * distance);
    return view;
}

}  // namespace

DefaultView defaultView(const RayScene& rays, const LightSampler& lights) {
    const std::vector<StandPoint> points = standPoints(rays);
    return points.empty() ? outsideView(rays.scene()) : insideView(rays, lights, points);
}

Camera defaultCamera(const Scene& scene) {
    return defaultView(RayScene(scene), LightSampler(scene)).camera;
}

}  // namespace phat
