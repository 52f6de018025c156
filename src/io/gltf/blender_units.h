#pragma once
// Lights that Blender's exporter wrote in another unit than its emissive materials.

#include <optional>
#include <string>

#include "core/scene/scene.h"
#include "io/gltf/gltf_source.h"

namespace phat {

/// A line for the user where a file of Blender's exporter has lights as its lighting mode Standard (or Raw)
/// writes them: in candela and lux at 683 lm/W, while emission stays as it is in Blender. `scene`: as it was
/// loaded, without lights that were added.
std::optional<std::string> blenderUnitsNote(const GltfSource& source, const Scene& scene);

}  // namespace phat
