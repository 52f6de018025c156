#pragma once
// The parts of a BRDF that a component of a picture shows, as BRDFs that every estimator can use.

#include "core/render/picture.h"
#include "core/scene/brdf.h"

namespace phat {

/// Whether a component has the light that was never reflected before the visible surface.
inline bool showsDirect(Component component) {
    return component == Component::all || component == Component::direct;
}
inline bool showsGlossyIndirect(Component component) {
    return component != Component::direct && component != Component::diffuseIndirect;
}
inline bool showsDiffuseIndirect(Component component) {
    return component != Component::direct && component != Component::glossyIndirect;
}

/// Whether any light can be reflected at all.
inline bool reflects(const Brdf& brdf) {
    return maxComponent(brdf.diffuseColor + brdf.f0) + brdf.f90 + brdf.clearcoat > 0.0f;
}

/// The BRDF with the lobes that reflect a component's indirect light, each worth for `towardEye` (local) what
/// it is worth in the whole; black for Component::direct.
inline Brdf indirectLobes(Brdf brdf, glm::vec3 towardEye, Component component) {
    if (!showsGlossyIndirect(component)) {
        // What the layers above let through depends on the eye alone and becomes part of the colour.
        brdf.diffuseColor *= clearcoatTransmission(brdf, towardEye) * diffuseWeight(brdf, towardEye.z);
        brdf.f0 = glm::vec3(0);
        brdf.f90 = 0;
        brdf.clearcoat = 0;
    }
    if (!showsDiffuseIndirect(component)) brdf.diffuseColor = glm::vec3(0);
    return brdf;
}

}  // namespace phat
