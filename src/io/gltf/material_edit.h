#pragma once
// Changes of materials as text: MATERIAL.property=value, as --set takes them.

#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

/// Applies one "NAME.property=value" to every material of that name ("*": all; one with "=" in it in
/// double quotes). Properties: baseColor=r,g,b
/// (or one grey), metallic, roughness, normalScale, specular, specularColor, ior, clearcoat,
/// clearcoatRoughness, emission=r,g,b. Throws std::invalid_argument that lists what exists.
void editMaterial(const std::string& assignment, std::vector<Material>& materials);

/// The edits that turn `from` into `to`, to the last bit of a float; what editMaterial cannot change is left
/// out. pre: as many materials in both.
std::vector<std::string> materialEdits(const std::vector<Material>& from, const std::vector<Material>& to);

}  // namespace phat
