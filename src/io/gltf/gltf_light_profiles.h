#pragma once
// EXT_lights_ies: lamps that emit what a photometric file says.

#include <map>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_problem.h"
#include "io/gltf/gltf_source.h"

namespace phat::gltf {

inline constexpr const char* kLightProfiles = "EXT_lights_ies";

/// The light profiles of a file, each read when a node first asks for it. pre: the buffers are read.
class LightProfiles {
  public:
    LightProfiles(const GltfSource& source, MemoryBudget& budget, Notes& notes)
        : source_(source), budget_(budget), notes_(notes) {}

    /// Makes `light` what a node's extension says; place and direction are the caller's. False where there is
    /// no such extension, or where its profile cannot be read, which is noted. Throws Problem where the
    /// extension is not what it must be.
    bool give(uint64_t node, PunctualLight& light);
    /// What the profile is called: by itself, or by its file.
    std::string nameOf(uint64_t profile) const;

  private:
    SharedValue<Photometry> photometryOf(uint64_t profile);

    const GltfSource& source_;
    MemoryBudget& budget_;
    Notes& notes_;
    std::map<uint64_t, SharedValue<Photometry>> read_;  // without a value: cannot be read
};

/// Gives each light that a photometry names its photometry, in the scene and in the file that it was loaded
/// from, where it takes the place of KHR_lights_punctual. A light keeps its colour, not its intensity, cone
/// or range. Throws Problem where there is no such light.
void attachPhotometries(const std::vector<NamedPhotometry>& photometries, GltfSource& source, Scene& scene);

/// Writes a light's intensity and colour into its node's extension. pre: it has photometry.
void writeProfileIntensity(nlohmann::json& node, const PunctualLight& light);

}  // namespace phat::gltf
