#include "core/scene/enclosure.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/scene/camera_ray.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// A ground lies within this part of the scene's height above its lowest point, ...
constexpr float kGroundThickness = 0.02f;
// ... and reaches so many times farther than the rest.
constexpr float kGroundOverhang = 1.5f;

constexpr int kColumns = 16;      // of the grid, along each side
constexpr int kMaxLineHits = 64;  // surfaces that one vertical line crosses
constexpr int kDirections = 128;  // that tell whether a point is enclosed
// Windows, doors and a missing piece of wall leave a room a room; a missing wall or ceiling does not.
constexpr float kMinEnclosed = 0.85f;
// Nearer to a wall than a shoulder, of the room's height, there is only the wall to see.
constexpr float kShoulder = 0.1f;
// In a room fronts look inward. What mostly backs surround is the inside of a thing, ...
constexpr float kMinFronts = 0.5f;
// ... unless all of the scene is so, it is as high as rooms are and a few fronts are within: many rooms are
// modelled with their fronts outward.
constexpr float kMinFrontsInMeters = 0.05f;
// Lower spaces than this part of the highest room or, where that is in no known unit, of the scene are
// hollows of furniture, attics, the space under a bed.
constexpr float kMinRoomHeight = 0.5f;
// Less of the scene's ground plan than this, of kColumns^2 points, is a cavity and no room.
constexpr size_t kMinPoints = 8;
// Rooms within these heights are taken to be in metres, or in another unit that files are exported in.
constexpr float kMinRoomMeters = 2, kMaxRoomMeters = 12;
// How many of a metre, a centimetre, a millimetre and a kilometre are a metre.
constexpr float kUnitsInMeter[] = {1, 100, 1000, 0.001f};

// Heights at which the vertical line through (x, z) crosses surfaces, downward.
std::vector<float> crossings(const RayScene& rays, const Bounds& bounds, float x, float z) {
    const float height = bounds.high.y - bounds.low.y, step = 1e-5f * bounds.diagonal();
    std::vector<float> found;
    float y = bounds.high.y + std::max(0.01f * height, step);
    while (found.size() < kMaxLineHits) {
        const Hit hit = rays.closestHit({x, y, z}, {0, -1, 0});
        if (!hit) break;
        const float at = y - hit.distance;
        // Two faces of a sheet, and triangles side by side, are one crossing.
        if (found.empty() || found.back() - at > 10 * step) found.push_back(at);
        y = at - step;
    }
    return found;
}

// What a metre is in the unit in which a room is as high as rooms are; 0: there is none.
float meterIn(float roomHeight) {
    for (const float meter : kUnitsInMeter)
        if (roomHeight >= kMinRoomMeters * meter && roomHeight <= kMaxRoomMeters * meter) return meter;
    return 0;
}

float eyeHeight(float roomHeight) {
    const float meter = meterIn(roomHeight);
    return meter > 0 ? kEyeMeters * meter : kEyeFraction * roomHeight;
}

// Whether `point` is enclosed; fills in what is around it.
bool lookAround(const RayScene& rays, StandPoint& point) {
    int seen = 0, met = 0, fronts = 0;
    point.nearest = kFarDistance;
    for (int i = 0; i < kDirections; ++i) {
        const glm::vec3 direction = spherePoint(i, kDirections);
        const Hit first = rays.closestHit(point.eye, direction);
        if (!first) continue;
        ++met;
        fronts += !first.backFace;
        const Hit hit =
            isCulled(rays.scene(), first) ? visibleBehindGlass(rays, {point.eye, direction}) : first;
        if (!hit) continue;
        ++seen;
        point.nearest = std::min(point.nearest, hit.distance);
    }
    point.frontFraction = met > 0 ? float(fronts) / float(met) : 0.0f;
    return float(seen) >= kMinEnclosed * kDirections && point.nearest > kShoulder * point.roomHeight;
}

void addColumn(const RayScene& rays, const Bounds& bounds, glm::vec2 at, std::vector<StandPoint>& points) {
    const std::vector<float> heights = crossings(rays, bounds, at.x, at.y);
    const float least = 0.05f * (bounds.high.y - bounds.low.y);
    for (size_t i = 0; i + 1 < heights.size(); ++i) {
        StandPoint point;
        point.floorHeight = heights[i + 1];
        point.roomHeight = heights[i] - heights[i + 1];
        if (point.roomHeight < least) continue;
        point.eye = {at.x, point.floorHeight + eyeHeight(point.roomHeight), at.y};
        if (lookAround(rays, point)) points.push_back(point);
    }
}

// The floor on which most points stand: not tables, nor other storeys.
std::vector<StandPoint> onMainFloor(const std::vector<StandPoint>& points, float tolerance) {
    size_t most = 0;
    float floor = 0;
    for (const StandPoint& candidate : points) {
        const auto count = size_t(std::count_if(points.begin(), points.end(), [&](const StandPoint& p) {
            return std::abs(p.floorHeight - candidate.floorHeight) <= tolerance;
        }));
        if (count > most || (count == most && candidate.floorHeight < floor)) {
            most = count;
            floor = candidate.floorHeight;
        }
    }
    std::vector<StandPoint> kept;
    for (const StandPoint& p : points)
        if (std::abs(p.floorHeight - floor) <= tolerance) kept.push_back(p);
    return kept;
}

}  // namespace

std::vector<bool> trianglesWithoutGround(const Scene& scene) {
    std::vector<bool> counts(scene.triangles.size(), true);
    const Bounds all = boundsOf(scene);
    if (all.empty()) return counts;
    const float top = all.low.y + kGroundThickness * (all.high.y - all.low.y);
    Bounds rest;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const std::array<glm::vec3, 3> corners = cornersOf(scene, t);
        counts[t] = std::any_of(corners.begin(), corners.end(), [&](glm::vec3 p) { return p.y > top; });
        if (!counts[t]) continue;
        for (const glm::vec3& corner : corners) rest.add(corner);
    }
    const glm::vec3 extent = all.high - all.low, ofRest = rest.high - rest.low;
    const bool ground =
        !rest.empty() && std::max(extent.x, extent.z) > kGroundOverhang * std::max(ofRest.x, ofRest.z);
    if (!ground) counts.assign(counts.size(), true);
    return counts;
}

Bounds boundsWithoutGround(const Scene& scene) {
    const std::vector<bool> counts = trianglesWithoutGround(scene);
    Bounds bounds;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        if (counts[t])
            for (const glm::vec3& corner : cornersOf(scene, t)) bounds.add(corner);
    return bounds;
}

namespace {

struct Stands {
    std::vector<StandPoint> all;  // [column], of all storeys
    std::vector<StandPoint> onMainFloor;
};

// Nowhere, where the scene has no inside.
Stands findStands(const RayScene& rays, const Bounds& bounds) {
    std::vector<std::vector<StandPoint>> columns(size_t(kColumns) * kColumns);
    tbb::parallel_for(size_t(0), columns.size(), [&](size_t i) {
        const glm::vec2 unit((float(i % kColumns) + 0.5f) / kColumns,
                             (float(i / kColumns) + 0.5f) / kColumns);
        const glm::vec2 low(bounds.low.x, bounds.low.z), high(bounds.high.x, bounds.high.z);
        addColumn(rays, bounds, glm::mix(low, high, unit), columns[i]);
    });
    std::vector<StandPoint> all;
    for (const auto& column : columns) all.insert(all.end(), column.begin(), column.end());
    std::vector<StandPoint> points = all;
    std::erase_if(points, [](const StandPoint& p) { return p.frontFraction < kMinFronts; });
    const bool outward = points.size() < kMinPoints;
    if (outward) points = all;
    float highest = 0, fronts = 0;
    for (const StandPoint& p : points) highest = std::max(highest, p.roomHeight);
    const float height = bounds.high.y - bounds.low.y;
    const float leastHeight = kMinRoomHeight * (meterIn(highest) > 0 ? highest : height);
    std::erase_if(points, [&](const StandPoint& p) { return p.roomHeight < leastHeight; });
    const std::vector<StandPoint> onMain = onMainFloor(points, 0.03f * height);
    for (const StandPoint& p : onMain) fronts += p.frontFraction;
    const float leastFronts = outward && meterIn(highest) > 0 ? kMinFrontsInMeters : kMinFronts;
    if (onMain.size() < kMinPoints || fronts < leastFronts * float(onMain.size())) return {};
    return {points, onMain};
}

// Whether two boxes of one row of the grid are of one storey, one beside the other.
bool hangTogether(const Bounds& a, const Bounds& b, float rowMeters) {
    const float common = std::min(a.high.y, b.high.y) - std::max(a.low.y, b.low.y);
    return std::abs(a.low.z - b.low.z) < 0.25f * rowMeters && a.low.x <= b.high.x && b.low.x <= a.high.x &&
           2 * common > std::max(a.high.y - a.low.y, b.high.y - b.low.y);
}

}  // namespace

std::vector<StandPoint> standPoints(const RayScene& rays) {
    const Bounds bounds = boundsWithoutGround(rays.scene());
    return bounds.empty() ? std::vector<StandPoint>() : findStands(rays, bounds).onMainFloor;
}

std::vector<StandPoint> standPointsOfAllStoreys(const RayScene& rays) {
    const Bounds bounds = boundsWithoutGround(rays.scene());
    return bounds.empty() ? std::vector<StandPoint>() : findStands(rays, bounds).all;
}

std::vector<Bounds> roomBoxes(const RayScene& rays) {
    const Bounds bounds = boundsWithoutGround(rays.scene());
    if (bounds.empty()) return {};
    const glm::vec3 step = (bounds.high - bounds.low) / float(kColumns);
    std::vector<Bounds> boxes;
    for (const StandPoint& point : findStands(rays, bounds).all) {
        const glm::vec3 reach = step + kShoulder * point.roomHeight;
        Bounds box;
        box.add({point.eye.x - reach.x, point.floorHeight, point.eye.z - reach.z});
        box.add({point.eye.x + reach.x, point.floorHeight + point.roomHeight, point.eye.z + reach.z});
        const auto beside = std::find_if(boxes.begin(), boxes.end(), [&](const Bounds& other) {
            return hangTogether(box, other, step.z);
        });
        if (beside == boxes.end()) {
            boxes.push_back(box);
        } else {
            beside->add(box.low);
            beside->add(box.high);
        }
    }
    return boxes;
}

}  // namespace phat
