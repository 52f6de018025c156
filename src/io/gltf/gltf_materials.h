#pragma once
// Materials and their texture slots.

#include "core/scene/scene.h"
#include "io/gltf/gltf_document.h"

namespace phat::gltf {

/// All materials of the file, in its order. TextureSlot::image is an index into the file's images until
/// loadImages turns it into one of Scene::images. Factors outside their range are clamped and counted.
/// Throws Problem.
std::vector<Material> readMaterials(const Document& document, Notes& notes);

/// The material of primitives that have none (specification, section 3.9.6).
Material defaultMaterial();

/// Every slot of a material.
template <typename Use>
void forEachSlot(Material& material, Use use) {
    for (TextureSlot* slot :
         {&material.baseColorTexture, &material.metallicRoughnessTexture, &material.normalTexture,
          &material.emissionTexture, &material.specularTexture, &material.specularColorTexture,
          &material.clearcoatTexture, &material.clearcoatRoughnessTexture, &material.clearcoatNormalTexture,
          &material.transmissionTexture, &material.thicknessTexture}) {
        use(*slot);
    }
}

}  // namespace phat::gltf
