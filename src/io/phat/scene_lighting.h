#pragma once
// What lights a scene besides its file: a sky, an environment, and a light where there is none at all.

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/scene/daylight.h"
#include "core/scene/rays.h"
#include "io/gltf/gltf_loader.h"

namespace phat {

enum class SkyChoice : uint8_t { automatic, none, given };

/// As it is asked for by flags.
struct SceneLighting {
    std::string environment;    // file; empty: none
    float rotationDegrees = 0;  // of the environment, clockwise as seen from above
    float intensity = 1;        // its radiance is multiplied by this
    SkyChoice sky = SkyChoice::automatic;
    Daylight daylight;                          // of SkyChoice::given, and of the automatic one
    std::vector<NamedPhotometry> photometries;  // of lights of the file

    /// Whether it replaces the light that a bake was made with.
    bool asked() const { return !environment.empty() || sky == SkyChoice::given; }
};

/// What was added to a scene.
struct AddedLighting {
    std::vector<std::string> lines;  // for the user
    std::string sky;                 // for the bake's record: "sun=210,40,turbidity=3", "work light" or empty
    std::shared_ptr<const RayScene::Bvh> bvh;  // of the scene, where the question what lights it needed one
};

/// The rays of a scene that `added` was added to. `scene` must outlive them.
RayScene raysOf(const Scene& scene, const AddedLighting& added);

/// Adds what was asked for. A scene in which nothing emits light, or
/// nothing that would light what is seen, gets a clear sky with a sun; a room that no
/// daylight enters, a point light under its ceiling ("work light") instead. The lights are appended to
/// `scene.lights`, with nodes past the file's. Throws FileError for the environment.
AddedLighting addLighting(const SceneLighting& lighting, Scene& scene);

/// Writes the lights whose nodes are past the file's into its JSON, as KHR_lights_punctual.
void writeAddedLights(const Scene& scene, nlohmann::json& gltf);

/// Gives the suns that an earlier bake added their size, which KHR_lights_punctual has no place for.
void restoreAddedLights(const nlohmann::json& gltf, Scene& scene);

/// Takes the lights out that an earlier bake added.
void removeAddedLights(nlohmann::json& gltf);

/// Adds the lighting to the settings of a record, one line of JSON.
std::string settingsWithLighting(const std::string& settings, const SceneLighting& lighting,
                                 const std::string& sky);

}  // namespace phat
