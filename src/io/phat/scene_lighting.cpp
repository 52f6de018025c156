#include "io/phat/scene_lighting.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/scene/default_camera.h"
#include "core/scene/enclosure.h"
#include "core/scene/environment_sampling.h"
#include "core/scene/seen_light.h"
#include "io/phat/bake_record.h"

namespace phat {
namespace {

using nlohmann::json;

constexpr const char* kLightExtension = "KHR_lights_punctual";
constexpr const char* kMark = "phatAddedLight";  // in the extras of nodes

// Less of what the eye sees than this in daylight: a room without windows, whatever leaks at its edges.
constexpr float kMinDaylight = 0.002f;

enum class OwnLight : uint8_t { none, decoration, light };

// Labels, screens and dials that shine and light next to nothing of what is seen are no light to see by.
constexpr float kMinLit = 0.2f;

// The rays of a scene whose lights may change, but not its surfaces; made when they are first asked for.
class LazyRays {
  public:
    explicit LazyRays(const Scene& scene) : scene_(scene) {}
    const RayScene& get() {
        if (!rays_) rays_.emplace(scene_);
        return *rays_;
    }
    std::shared_ptr<const RayScene::Bvh> bvh() const { return rays_ ? rays_->bvh() : nullptr; }

  private:
    const Scene& scene_;
    std::optional<RayScene> rays_;
};

OwnLight ownLightOf(const Scene& scene, LazyRays& lazyRays) {
    const LightSampler lights(scene);
    if (luminance(lights.powerPunctual()) > 0 || scene.environment) return OwnLight::light;
    if (!lights.hasArea()) return OwnLight::none;
    const RayScene& rays = lazyRays.get();
    const Camera camera = scene.cameras.empty() ? defaultView(rays, lights).camera : scene.cameras.front();
    return litFraction(rays, lights, camera) < kMinLit ? OwnLight::decoration : OwnLight::light;
}

void addLight(Scene& scene, PunctualLight light, const char* name) {
    light.name = name;
    light.node = uint32_t(scene.nodes.size());
    SceneNode node;
    node.name = name;
    node.translation = light.position;
    scene.nodes.push_back(node);
    scene.lights.push_back(std::move(light));
}

std::string addDaylight(const Daylight& day, Scene& scene) {
    scene.environment = skyEnvironment(day);
    addLight(scene, sunLight(day), "sun");
    return fmt::format("sun={},{},turbidity={}", day.sun.azimuthDegrees, day.sun.elevationDegrees,
                       day.turbidity);
}

// Under the ceiling, between the eye and what it looks at. Surfaces at the usual distance get an irradiance
// of about 1 W/m2, whatever the unit of the room.
PunctualLight workLight(const RayScene& rays, const Camera& camera) {
    constexpr float kTowardTarget = 0.4f, kTowardCeiling = 0.7f;
    const float far = boundsOf(rays.scene()).diagonal();
    const auto reach = [&](glm::vec3 from, glm::vec3 direction) {
        const Hit hit = rays.closestHit(from, direction);
        return hit ? hit.distance : far;
    };
    // A step beyond a surface would lead into another room.
    const auto step = [&](glm::vec3 from, glm::vec3 direction, float fraction) {
        const float free = reach(from, direction);
        return from + direction * (free < far ? fraction * free : 0.0f);
    };
    PunctualLight light;
    const glm::vec3 eye(camera.worldFromCamera[3]), forward = -glm::vec3(camera.worldFromCamera[2]);
    light.position = step(step(eye, forward, kTowardTarget), {0, 1, 0}, kTowardCeiling);
    constexpr int kDirections = 64;
    std::vector<float> distances;
    for (int i = 0; i < kDirections; ++i)
        distances.push_back(reach(light.position, spherePoint(i, kDirections)));
    std::nth_element(distances.begin(), distances.begin() + kDirections / 2, distances.end());
    light.intensity = glm::vec3(square(distances[kDirections / 2]));
    return light;
}

struct Inside {
    Camera camera;
    bool dark = false;  // whether no daylight reaches what it sees
};

Inside insideOf(const RayScene& rays) {
    const Scene& scene = rays.scene();
    Inside inside{scene.cameras.empty() ? defaultView(rays, LightSampler(scene)).camera
                                        : scene.cameras.front()};
    inside.dark = daylightFraction(rays, inside.camera) < kMinDaylight;
    return inside;
}

constexpr const char* kHelp = "add a light or an emissive material to the file";

void lightUnlitScene(const SceneLighting& lighting, OwnLight own, const RayScene& rays, Scene& scene,
                     AddedLighting& added) {
    const char* missing = own == OwnLight::none
                              ? "no light in the file"
                              : "what shines in the file lights next to nothing of what is seen";
    const Inside inside = insideOf(rays);
    if (!inside.dark) {
        const SunPosition& sun = lighting.daylight.sun;
        added.sky = addDaylight(lighting.daylight, scene);
        added.lines.push_back(fmt::format(
            "{}: lit by a clear sky, the sun at azimuth {:g}, elevation {:g} degrees; choose with "
            "--sky or --environment",
            missing, sun.azimuthDegrees, sun.elevationDegrees));
        return;
    }
    const PunctualLight light = workLight(rays, inside.camera);
    addLight(scene, light, "work light");
    added.sky = "work light";
    added.lines.push_back(
        fmt::format("{}, and no daylight reaches the inside: lit by a work light at ({:.3g} {:.3g} {:.3g}); "
                    "{}, or choose with --sky or --environment",
                    missing, light.position.x, light.position.y, light.position.z, kHelp));
}

void addEnvironment(const SceneLighting& lighting, Scene& scene, AddedLighting& added) {
    Environment environment = loadEnvironment(lighting.environment, &added.lines);
    if (lighting.intensity != 1)
        for (glm::vec3& pixel : environment.radiance.pixels) pixel *= lighting.intensity;
    const auto columns =
        int(std::lround(double(lighting.rotationDegrees) / 360 * environment.radiance.width));
    scene.environment = columns != 0 ? turned(environment, columns) : std::move(environment);
}

// A light's node looks along -z.
std::array<float, 4> rotationToward(glm::vec3 direction) {
    const glm::dvec3 from(0, 0, -1), to(direction);
    const double cosine = glm::dot(from, to);
    glm::dquat q(1 + cosine, glm::cross(from, to));
    q = cosine < -1 + 1e-9 ? glm::dquat(0, 0, 1, 0) : glm::normalize(q);
    return {float(q.x), float(q.y), float(q.z), float(q.w)};
}

bool isAdded(const json& node) {
    const auto extras = node.find("extras");
    return extras != node.end() && extras->is_object() && extras->contains(kMark);
}

json lightOf(const PunctualLight& light) {
    const char* type = light.type == PunctualLight::Type::directional ? "directional" : "point";
    const float intensity = maxComponent(light.intensity);
    const glm::vec3 color = light.intensity / intensity;
    return {{"name", light.name},
            {"type", type},
            {"intensity", intensity},
            {"color", {color.r, color.g, color.b}}};
}

}  // namespace

AddedLighting addLighting(const SceneLighting& lighting, Scene& scene) {
    AddedLighting added;
    LazyRays rays(scene);
    const OwnLight own = scene.triangles.empty() ? OwnLight::light : ownLightOf(scene, rays);
    if (lighting.asked()) {
        if (!lighting.environment.empty()) addEnvironment(lighting, scene, added);
        if (lighting.sky == SkyChoice::given) added.sky = addDaylight(lighting.daylight, scene);
        if (own != OwnLight::light && insideOf(rays.get()).dark)
            added.lines.push_back(
                fmt::format("nothing reaches the inside: {}, or leave --sky and --environment away", kHelp));
    } else if (own != OwnLight::light && lighting.sky == SkyChoice::automatic) {
        lightUnlitScene(lighting, own, rays.get(), scene, added);
    } else if (own == OwnLight::none) {
        added.lines.push_back("nothing emits light, so that all is black; without --sky none it is lit");
    }
    added.bvh = rays.bvh();
    return added;
}

RayScene raysOf(const Scene& scene, const AddedLighting& added) {
    return added.bvh ? RayScene(scene, added.bvh) : RayScene(scene);
}

void writeAddedLights(const Scene& scene, json& gltf) {
    const size_t fileNodes = gltf.contains("nodes") ? gltf["nodes"].size() : 0;
    bool any = false;
    for (const PunctualLight& light : scene.lights) {
        if (light.node < fileNodes) continue;
        any = true;
        json& lights = gltf["extensions"][kLightExtension]["lights"];
        json node = {{"name", light.name},
                     {"extensions", {{kLightExtension, {{"light", lights.size()}}}}},
                     {"extras", {{kMark, true}}}};
        if (light.type == PunctualLight::Type::directional)
            node["rotation"] = rotationToward(light.direction);
        else
            node["translation"] = {light.position.x, light.position.y, light.position.z};
        lights.push_back(lightOf(light));
        if (gltf.contains("scenes"))
            gltf["scenes"].at(gltf.value("scene", size_t(0)))["nodes"].push_back(gltf["nodes"].size());
        gltf["nodes"].push_back(std::move(node));
    }
    if (!any) return;
    json& used = gltf["extensionsUsed"];
    if (std::find(used.begin(), used.end(), json(kLightExtension)) == used.end())
        used.push_back(kLightExtension);
}

void restoreAddedLights(const json& gltf, Scene& scene) {
    for (PunctualLight& light : scene.lights)
        if (light.type == PunctualLight::Type::directional && isAdded(gltf.at("nodes").at(light.node)))
            light.angularRadius = kSunAngularRadius;
}

void removeAddedLights(json& gltf) {
    if (!gltf.contains("nodes")) return;
    for (json& node : gltf["nodes"]) {
        if (!isAdded(node)) continue;
        node.erase("extras");
        if (node.contains("extensions")) node["extensions"].erase(kLightExtension);
    }
}

std::string settingsWithLighting(const std::string& settings, const SceneLighting& lighting,
                                 const std::string& sky) {
    json line = settingsJson(settings);
    if (!sky.empty()) line["sky"] = sky;
    if (sky.empty() && lighting.sky == SkyChoice::none) line["sky"] = "none";
    if (lighting.rotationDegrees != 0) line["environmentRotation"] = lighting.rotationDegrees;
    if (lighting.intensity != 1) line["environmentIntensity"] = lighting.intensity;
    return line.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace phat
