#pragma once
// What other programs made compact or clever, as plain glTF: from here on, the loader and the rewriter see
// the same file, and the baked file needs no decoder. Each step changes the JSON of an open file in place and
// keeps the bytes that it makes as further buffers. A file that uses none of this stays as it is.

#include <string>
#include <vector>

#include "io/gltf/gltf_problem.h"
#include "io/gltf/gltf_source.h"

namespace phat::gltf {

/// All the steps below, in the order in which they depend on each other. `variant`: of
/// KHR_materials_variants; empty: the materials that the primitives have of their own. pre: the buffers are
/// read. Throws std::runtime_error, in which case `source` is left half changed.
void makePlain(GltfSource& source, const std::string& variant, MemoryBudget& budget, Notes& notes);

/// Lights and cameras that the specification does not allow are taken off their nodes.
void mendLightsAndCameras(nlohmann::json& gltf, Notes& notes);

/// Textures that have a PNG or JPEG beside their KTX2 (KHR_texture_basisu) have it alone.
void takeBasisFallbacks(nlohmann::json& gltf, Notes& notes);

/// BufferViews of EXT_meshopt_compression and, where the two agree, KHR_meshopt_compression.
void decodeMeshopt(GltfSource& source, MemoryBudget& budget);

/// Primitives of KHR_draco_mesh_compression.
void decodeDraco(GltfSource& source, MemoryBudget& budget);

/// KHR_materials_variants: gives each primitive the material that it has in the variant of that name.
void chooseVariant(nlohmann::json& gltf, const std::string& variant);

/// KHR_materials_pbrSpecularGlossiness as metallic-roughness with KHR_materials_specular and _ior.
/// source: glTF, KHR_materials_specular, section "Conversions": F0 and diffuse colour stay what they were.
void convertSpecularGlossiness(GltfSource& source, MemoryBudget& budget, Notes& notes);

/// EXT_mesh_gpu_instancing: a child node for each instance, after all the nodes of the file.
void expandInstances(GltfSource& source, MemoryBudget& budget);

/// Skinned and morphed meshes of the shown nodes, at the pose that the file says, as meshes without either. A
/// skinned mesh moves to a new root node, because its own node's transform means nothing (specification,
/// section 3.7.3.3).
void applyPose(GltfSource& source, MemoryBudget& budget, Notes& notes);

}  // namespace phat::gltf
