#include <fmt/format.h>

#include <cmath>
#include <set>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_plain.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kLights = "KHR_lights_punctual";
constexpr double kPi = 3.14159265358979;
// Largest intensity or length that survives being squared in a float.
constexpr double kMaxNumber = 1e18;

// NaN where it is no number.
double numberOf(const json& object, const char* key, double fallback) {
    const auto found = object.find(key);
    if (found == object.end()) return fallback;
    return found->is_number() ? found->get<double>() : std::nan("");
}

bool isWithin(double value, double low, double high) {
    return value >= low && value <= high;
}

// Why a light cannot be used; empty: it can.
std::string faultOfLight(const json& light) {
    if (!light.is_object() || !light.contains("type") || !light["type"].is_string()) return "it has no type";
    const std::string type = light["type"];
    if (type != "point" && type != "spot" && type != "directional")
        return fmt::format("its type \"{}\" is unknown", type.substr(0, 40));
    if (!isWithin(numberOf(light, "intensity", 1), 0, kMaxNumber))
        return "its intensity is negative or no number";
    if (const auto color = light.find("color"); color != light.end()) {
        if (!color->is_array() || color->size() != 3) return "its colour has not three parts";
        for (const json& part : *color)
            if (!part.is_number() || !isWithin(part.get<double>(), -kMaxNumber, kMaxNumber))
                return "its colour is out of range";
    }
    return "";
}

std::string faultOfCamera(const json& camera) {
    const std::string type = camera.is_object() && camera.contains("type") && camera["type"].is_string()
                                 ? camera["type"].get<std::string>()
                                 : "";
    if (type != "perspective" && type != "orthographic") return "its type is unknown";
    const auto lens = camera.find(type);
    if (lens == camera.end() || !lens->is_object()) return "it has no lens";
    if (type == "perspective") {
        if (!isWithin(numberOf(*lens, "yfov", 0), 1e-6, 3.14159))
            return "its field of view is not between 0 and pi";
        if (!isWithin(numberOf(*lens, "aspectRatio", 0), 0, 1e6)) return "its aspect ratio is out of range";
        return isWithin(numberOf(*lens, "znear", 0.01), 0, kMaxNumber) ? ""
                                                                       : "its near plane is out of range";
    }
    for (const char* key : {"xmag", "ymag"})
        if (!isWithin(std::abs(numberOf(*lens, key, 0)), 1e-18, kMaxNumber))
            return "its size is out of range";
    return isWithin(numberOf(*lens, "znear", 0.01), -kMaxNumber, kMaxNumber)
               ? ""
               : "its near plane is out of range";
}

// A range is a positive number; one beyond every distance that a scene can have is none.
void mendRange(json& light, size_t index, Notes& notes) {
    if (!light.is_object() || !light.contains("range")) return;
    const double range = numberOf(light, "range", 0);
    if (isWithin(range, 0, kMaxNumber)) return;
    if (!(range > kMaxNumber))
        notes.lines.push_back(
            fmt::format("the range of light {} is no positive number and is ignored", index));
    light.erase("range");
}

// A cone's outer angle is at most a right one, and its inner angle no larger; one that says nothing of use is
// glTF's default.
void mendCone(json& light, size_t index, Notes& notes) {
    if (!light.is_object() || light.value("type", json()) != "spot") return;
    json& spot = light["spot"];
    if (!spot.is_object()) spot = json::object();
    constexpr double kDefaultOuter = kPi / 4, kMaxOuter = kPi / 2, kRounding = 1e-5;
    const double inner = numberOf(spot, "innerConeAngle", 0);
    const double outer = numberOf(spot, "outerConeAngle", kDefaultOuter);
    const double mendedOuter = outer > 0 ? std::min(outer, kMaxOuter) : kDefaultOuter;
    const double mendedInner = inner > 0 ? std::min(inner, mendedOuter) : 0.0;
    if (mendedOuter == outer && mendedInner == inner) return;
    spot["outerConeAngle"] = mendedOuter;
    spot["innerConeAngle"] = mendedInner;
    if (std::abs(mendedOuter - outer) <= kRounding && std::abs(mendedInner - inner) <= kRounding) return;
    notes.lines.push_back(
        fmt::format("the cone angles of light {} are out of range or order and are taken as {:.3g} to {:.3g}",
                    index, mendedInner, mendedOuter));
}

// What nodes refer to by `referenceOf(node)` is taken off them where it is one of `broken`.
template <class ReferenceOf, class TakeOff>
void takeOffNodes(json& gltf, const std::set<size_t>& broken, const ReferenceOf& referenceOf,
                  const TakeOff& takeOff) {
    for (size_t n = 0; !broken.empty() && n < countOf(gltf, "nodes"); ++n) {
        json& node = gltf["nodes"][n];
        const json* reference = node.is_object() ? referenceOf(node) : nullptr;
        if (reference && reference->is_number_unsigned() && broken.contains(reference->get<size_t>()))
            takeOff(node);
    }
}

void mendLights(json& gltf, Notes& notes) {
    if (!findExtension(gltf, kLights)) return;
    json& extension = gltf["extensions"][kLights];
    std::set<size_t> broken;
    for (size_t i = 0; i < countOf(extension, "lights"); ++i) {
        json& light = extension["lights"][i];
        if (const std::string fault = faultOfLight(light); !fault.empty()) {
            notes.lines.push_back(fmt::format("light {} is left out: {}", i, fault));
            light = {{"type", "point"}};
            broken.insert(i);
        }
        mendRange(light, i, notes);
        mendCone(light, i, notes);
    }
    const auto lightOf = [](const json& node) -> const json* {
        const json* own = findExtension(node, kLights);
        return own && own->contains("light") ? &own->at("light") : nullptr;
    };
    takeOffNodes(gltf, broken, lightOf, [](json& node) { eraseExtension(node, kLights); });
}

void mendCameras(json& gltf, Notes& notes) {
    std::set<size_t> broken;
    for (size_t i = 0; i < countOf(gltf, "cameras"); ++i) {
        json& camera = gltf["cameras"][i];
        const std::string fault = faultOfCamera(camera);
        if (fault.empty()) continue;
        notes.lines.push_back(fmt::format("camera {} is left out: {}", i, fault));
        camera = {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.01}}}};
        broken.insert(i);
    }
    const auto cameraOf = [](const json& node) -> const json* {
        return node.contains("camera") ? &node["camera"] : nullptr;
    };
    takeOffNodes(gltf, broken, cameraOf, [](json& node) { node.erase("camera"); });
}

}  // namespace

void mendLightsAndCameras(json& gltf, Notes& notes) {
    mendLights(gltf, notes);
    mendCameras(gltf, notes);
}

void takeBasisFallbacks(json& gltf, Notes& notes) {
    constexpr const char* kBasis = "KHR_texture_basisu";
    bool needed = false;
    for (size_t i = 0; i < countOf(gltf, "textures"); ++i) {
        json& texture = gltf["textures"][i];
        if (!texture.is_object() || !findExtension(texture, kBasis)) continue;
        if (texture.contains("source")) {
            eraseExtension(texture, kBasis);
            ++notes.basisFallbacks;
        } else {
            needed = true;
        }
    }
    if (!needed) forgetExtension(gltf, kBasis);
}

}  // namespace phat::gltf
