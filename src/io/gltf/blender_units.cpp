#include "io/gltf/blender_units.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace phat {
namespace {

// A lamp of P watts is written as P / (4 pi) cd in the mode Unitless, as 683 times that in Standard and as P
// cd in Raw; a sun of strength S as S lux, or 683 S in Standard. These bounds are lamps of 2,500 W and suns
// of 100 in Unitless, ten times what rooms have, and 3.7 W and .15 in Standard. Blender's own new lamp has
// 1,000 W (80 and 54,000 cd), its sun 1.
constexpr float kMaxCandela = 200, kMaxLux = 100;

bool isOfBlender(const nlohmann::json& gltf) {
    const auto asset = gltf.find("asset");
    if (asset == gltf.end() || !asset->is_object()) return false;
    const auto generator = asset->find("generator");
    return generator != asset->end() && generator->is_string() &&
           generator->get_ref<const std::string&>().find("Blender") != std::string::npos;
}

}  // namespace

std::optional<std::string> blenderUnitsNote(const GltfSource& source, const Scene& scene) {
    if (!isOfBlender(source.json)) return {};
    for (const PunctualLight& light : scene.lights) {
        if (light.photometry) continue;  // its file says what it emits
        const bool sun = light.type == PunctualLight::Type::directional;
        const float intensity = maxComponent(light.intensity);
        if (intensity <= (sun ? kMaxLux : kMaxCandela)) continue;
        return fmt::format(
            "light \"{}\" has {:.0f} {}: Blender's lighting mode Standard makes lights 683 times as bright "
            "as surfaces that emit; if these look dark, export again with File > Export > glTF 2.0 > Data > "
            "Lighting > Unitless",
            light.name, intensity, sun ? "lux" : "candela");
    }
    return {};
}

}  // namespace phat
