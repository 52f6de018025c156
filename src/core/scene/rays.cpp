#include "core/scene/rays.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <new>
#include <stdexcept>
#include <string>

#include "core/scene/camera_ray.h"
#include "core/scene/length_unit.h"
#include "core/scene/ray_opacity.h"
#include "core/scene/transparency.h"

namespace phat {
namespace {

/// What Embree hands to the filter for one query. The materials come with the query and not with the
/// acceleration structure, which scenes with different materials share.
struct Query : RTCIntersectContext {
    explicit Query(const RayScene& asked) : rays(asked), scene(asked.scene()) {
        rtcInitIntersectContext(this);
    }
    const RayScene& rays;
    const Scene& scene;
};

// Whether it is seen from behind, where it is black.
bool isBlackBack(const RayScene& rays, const Hit& hit) {
    return isCulled(rays.scene(), hit) && rays.glassOf(hit.triangle) == Glass::none;
}

// Embree's geometric normal follows the winding: against the ray means the front was hit.
float facingOf(const RTCHit& hit, glm::vec3 direction) {
    return hit.Ng_x * direction.x + hit.Ng_y * direction.y + hit.Ng_z * direction.z;
}

Hit hitOf(const RTCHit& hit, float distance, glm::vec3 direction) {
    return {distance, hit.primID, {hit.u, hit.v}, facingOf(hit, direction) > 0.0f};
}

void filterBlackBacks(const RTCFilterFunctionNArguments* arguments) {
    const RayScene& rays = static_cast<const Query*>(arguments->context)->rays;
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const RTCHit hit = rtcGetHitFromHitN(arguments->hit, arguments->N, i);
        const RTCRay ray = rtcGetRayFromRayN(arguments->ray, arguments->N, i);
        if (isBlackBack(rays, hitOf(hit, ray.tfar, {ray.dir_x, ray.dir_y, ray.dir_z})))
            arguments->valid[i] = 0;
    }
}

void filterTransparent(const RTCFilterFunctionNArguments* arguments) {
    const Scene& scene = static_cast<const Query*>(arguments->context)->scene;
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const RTCHit hit = rtcGetHitFromHitN(arguments->hit, arguments->N, i);
        const RTCRay ray = rtcGetRayFromRayN(arguments->ray, arguments->N, i);
        if (passesThrough(scene, hit.primID, {hit.u, hit.v}, {ray.org_x, ray.org_y, ray.org_z},
                          {ray.dir_x, ray.dir_y, ray.dir_z}))
            arguments->valid[i] = 0;
    }
}

// Embree returns no errors: without this, a scene that it had no memory for would be an empty one.
void throwDeviceError(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error == RTC_ERROR_UNSUPPORTED_CPU)
        throw std::runtime_error("Embree does not support this processor");
    if (error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree failed with error " + std::to_string(int(error)));
}

}  // namespace

struct RayScene::Bvh {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = nullptr;
    float unitMeters = 1;

    Bvh() = default;
    Bvh(const Bvh&) = delete;
    Bvh& operator=(const Bvh&) = delete;
    ~Bvh() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

std::shared_ptr<const RayScene::Bvh> RayScene::buildBvh(const Scene& scene) {
    auto bvh = std::make_shared<Bvh>();
    if (!bvh->device) {
        throwDeviceError(nullptr);
        throw std::runtime_error("Embree cannot start on this machine");
    }
    bvh->unitMeters = lengthUnit(scene);
    bvh->scene = rtcNewScene(bvh->device);
    // Without the robust mode rays slip between adjacent triangles.
    rtcSetSceneFlags(bvh->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);

    RTCGeometry mesh = rtcNewGeometry(bvh->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes at the last vertex, so it gets a copy of its own with its own padding.
    if (!scene.triangles.empty()) {
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), scene.positions.size()));
        auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
            mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), scene.triangles.size()));
        if (!vertices || !indices) throw std::bad_alloc();
        std::copy_n(&scene.positions[0].x, scene.positions.size() * 3, vertices);
        std::copy_n(&scene.triangles[0].x, scene.triangles.size() * 3, indices);
    }
    if (hasTransparency(scene)) {
        rtcSetGeometryIntersectFilterFunction(mesh, filterTransparent);
        rtcSetGeometryOccludedFilterFunction(mesh, filterTransparent);
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(bvh->scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(bvh->scene);
    throwDeviceError(bvh->device);
    return bvh;
}

namespace {

RTCRay makeRay(glm::vec3 origin, glm::vec3 direction, float maxDistance) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tnear = 0.0f;
    ray.tfar = maxDistance;
    ray.mask = ~0u;
    return ray;
}

}  // namespace

Hit RayScene::closestHit(glm::vec3 origin, glm::vec3 direction, float maxDistance) const {
    assert(isUnit(direction));
    RTCRayHit query;
    query.ray = makeRay(origin, direction, maxDistance);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    Query context(*this);
    rtcIntersect1(bvh_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};

    const float distance = query.ray.tfar;
    const Hit hit = hitOf(query.hit, distance, direction);
    if (!isBlackBack(*this, hit)) return hit;

    // Where a front coincides with it, as on a leaf of two layers, which of them is met is a matter of
    // rounding.
    const glm::vec3 position = origin + distance * direction;
    const glm::vec3 normal = glm::normalize(glm::vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z));
    constexpr float kMinCosine = 0.05f, kRounding = 0x1p-21f;
    const float rounding = kRounding * (distance + maxComponent(glm::abs(position))) /
                           std::max(glm::dot(normal, direction), kMinCosine);
    query.ray = makeRay(origin, direction, std::min(distance + rounding, maxDistance));
    query.ray.tnear = std::max(distance - rounding, 0.0f);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    context.filter = filterBlackBacks;
    rtcIntersect1(bvh_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    return hitOf(query.hit, query.ray.tfar, direction);
}

bool RayScene::anyHit(glm::vec3 origin, glm::vec3 direction, float maxDistance) const {
    assert(isUnit(direction));
    RTCRay ray = makeRay(origin, direction, maxDistance);
    Query context(*this);
    rtcOccluded1(bvh_->scene, &context, &ray);
    return ray.tfar < 0.0f;
}

std::vector<uint32_t> RayScene::trianglesNear(glm::vec3 point, float radius) const {
    std::vector<uint32_t> found;
    RTCPointQuery query{point.x, point.y, point.z, 0.0f, radius};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    const auto keep = [](RTCPointQueryFunctionArguments* arguments) {
        static_cast<std::vector<uint32_t>*>(arguments->userPtr)->push_back(arguments->primID);
        return false;  // the radius stays
    };
    rtcPointQuery(bvh_->scene, &query, &context, keep, &found);
    std::sort(found.begin(), found.end());
    return found;
}

float RayScene::unitMeters() const {
    return bvh_->unitMeters;
}

glm::vec3 RayScene::offsetOrigin(glm::vec3 position, glm::vec3 normal) const {
    return phat::offsetOrigin(position, normal, bvh_->unitMeters);
}

glm::vec3 offsetOrigin(glm::vec3 p, glm::vec3 normal, float unitMeters) {
    assert(isUnit(normal));
    // Far from the origin step by units in the last place; near it by a fixed part of the scene, whose other
    // coordinates the rounding comes from.
    const float origin = unitMeters / 32.0f, step = unitMeters / 65536.0f;
    constexpr float kIntScale = 256.0f;
    glm::vec3 moved;
    for (int axis = 0; axis < 3; ++axis) {
        const int32_t ulps = int32_t(kIntScale * normal[axis]);
        const int32_t bits = std::bit_cast<int32_t>(p[axis]) + (p[axis] < 0.0f ? -ulps : ulps);
        moved[axis] = std::abs(p[axis]) < origin ? p[axis] + step * normal[axis] : std::bit_cast<float>(bits);
    }
    return moved;
}

}  // namespace phat
