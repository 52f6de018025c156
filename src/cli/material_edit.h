#pragma once
// --set MATERIAL.property=value

#include <string>
#include <vector>

#include "core/scene.h"

namespace phat {

/// Applies one "NAME.property=value" to every material of that name ("*": all). Properties: baseColor=r,g,b
/// (or one grey), metallic, roughness, specular, specularColor, ior, clearcoat, clearcoatRoughness,
/// emission=r,g,b. Throws std::invalid_argument that lists what exists.
void editMaterial(const std::string& assignment, std::vector<Material>& materials);

}  // namespace phat
