#pragma once
// A glTF file for programs that know lightmaps and nothing of PHATexels.

#include "io/gltf/gltf_rewrite.h"

namespace phat::gltf {

/// What a rewritten file gets so that a lightmap can be put on it:
/// - the atlas becomes TEXCOORD_1, where engines look for it; the file's other sets, and the materials that
///   name them, move up from there.
/// - `extras.lightmap` of every material of a surface that is lit is the number of its page. A material on
///   several pages is copied, and so is a double-sided one whose sides are parts of their own.
/// Throws std::runtime_error where the file is broken.
void prepareForLightmap(RewrittenGltf& rewritten);

/// Takes out the lights of KHR_lights_punctual, for lightmaps that have their light.
void dropPunctualLights(nlohmann::json& gltf);

}  // namespace phat::gltf
