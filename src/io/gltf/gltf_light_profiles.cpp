#include "io/gltf/gltf_light_profiles.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "io/gltf/gltf_container.h"
#include "io/gltf/gltf_json.h"
#include "io/ies/ies_photometry.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kMimeType = "application/x-ies-lm-63";
// Largest factor that a lamp's intensity survives in a float.
constexpr double kMaxMultiplier = 1e12;

double multiplierOf(const json& extension, uint64_t node) {
    const auto found = extension.find("multiplier");
    if (found == extension.end()) return 1;
    const double value = found->is_number() ? found->get<double>() : std::nan("");
    if (!(value >= 0 && value <= kMaxMultiplier))
        throw Problem(
            fmt::format("node {}: the multiplier of its light profile is no number from 0 on", node));
    return value;
}

glm::dvec3 colorOf(const json& extension, uint64_t node) {
    glm::dvec3 color(1);
    const auto found = extension.find("color");
    if (found == extension.end()) return color;
    if (!found->is_array() || found->size() != 3)
        throw Problem(fmt::format("node {}: the colour of its light profile has not three parts", node));
    for (int c = 0; c < 3; ++c) {
        const json& part = (*found)[size_t(c)];
        color[c] = part.is_number() ? std::clamp(part.get<double>(), 0.0, 1.0) : 1.0;
    }
    return color;
}

void setPhotometry(PunctualLight& light, SharedValue<Photometry> photometry, glm::dvec3 color,
                   double multiplier) {
    light.type = PunctualLight::Type::point;
    light.rangeMeters = 0;
    light.intensity = glm::vec3(color * (multiplier * double(photometry->web().peakCandela)));
    light.photometry = std::move(photometry);
}

std::string base64Of(std::span<const uint8_t> bytes) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t three = 0;
        for (size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k < bytes.size() + 1 ? kDigits[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

// The number that the file has for a profile of these bytes from now on.
size_t addProfile(json& gltf, const std::string& name, std::span<const uint8_t> bytes) {
    json& profiles = gltf["extensions"][kLightProfiles]["lights"];
    json profile = {{"name", name}, {"uri", fmt::format("data:{};base64,{}", kMimeType, base64Of(bytes))}};
    for (size_t i = 0; i < profiles.size(); ++i)
        if (profiles[i] == profile) return i;
    profiles.push_back(std::move(profile));
    return profiles.size() - 1;
}

std::string joinedNames(const Scene& scene) {
    std::string names;
    for (const PunctualLight& light : scene.lights)
        if (light.type != PunctualLight::Type::directional)
            names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", light.name);
    return names.empty() ? "it has no point or spot light" : "there are " + names;
}

void attach(const NamedPhotometry& named, const SharedValue<Photometry>& photometry, GltfSource& source,
            PunctualLight& light) {
    json& gltf = source.json;
    const float brightest = maxComponent(light.intensity);
    const glm::dvec3 color = brightest > 0 ? glm::dvec3(light.intensity / brightest) : glm::dvec3(1);
    // The file's candela are those of the coloured light.
    const double multiplier = named.multiplier / double(luminance(glm::vec3(color)));
    setPhotometry(light, photometry, color, multiplier);
    json& node = gltf["nodes"].at(light.node);
    eraseExtension(node, "KHR_lights_punctual");
    node["extensions"][kLightProfiles] = {{"light", addProfile(gltf, photometry->web().name, named.bytes)},
                                          {"multiplier", multiplier},
                                          {"color", {color.r, color.g, color.b}}};
    useExtension(gltf, kLightProfiles);
}

}  // namespace

std::string LightProfiles::nameOf(uint64_t profile) const {
    const json& entry = source_.json.at("extensions").at(kLightProfiles).at("lights").at(profile);
    if (const auto name = entry.find("name"); name != entry.end() && name->is_string() && !name->empty())
        return name->get<std::string>();
    if (const auto uri = entry.find("uri");
        uri != entry.end() && uri->is_string() && !isDataUri(uri->get<std::string>()))
        return uri->get<std::string>();
    return fmt::format("light profile {}", profile);
}

SharedValue<Photometry> LightProfiles::photometryOf(uint64_t profile) {
    const auto [found, isNew] = read_.try_emplace(profile);
    if (!isNew) return found->second;
    budget_.charge(kMaxPhotometryBytes, "its light profiles");
    const std::string name = nameOf(profile);
    try {
        const json& entry = source_.json["extensions"][kLightProfiles]["lights"][profile];
        std::vector<uint8_t> file;
        std::span<const uint8_t> bytes;
        if (entry.contains("uri")) {
            file = readUri(entry["uri"].get<std::string>(), gltfFolder(source_), budget_.left());
            bytes = file;
        } else {
            bytes = bufferViewBytes(source_, wholeNumber(entry, "bufferView"));
        }
        found->second = photometryOfIes(bytes, name);
    } catch (const std::runtime_error& error) {
        notes_.lines.push_back(
            fmt::format("the light profile {} \"{}\" cannot be used and its lights are left out: it {}",
                        profile, shortUri(name), error.what()));
    }
    return found->second;
}

bool LightProfiles::give(uint64_t node, PunctualLight& light) {
    const json* extension = findExtension(gltfItem(source_.json, "nodes", node), kLightProfiles);
    if (!extension) return false;
    const json* all = findExtension(source_.json, kLightProfiles);
    const uint64_t profile = wholeNumber(*extension, "light");
    if (!all || profile >= countOf(*all, "lights") || !all->at("lights")[profile].is_object())
        throw Problem(fmt::format("node {}: no such light profile", node));
    const SharedValue<Photometry> photometry = photometryOf(profile);
    if (!photometry) return false;
    setPhotometry(light, photometry, colorOf(*extension, node), multiplierOf(*extension, node));
    if (light.name.empty()) light.name = nameOf(profile);
    return true;
}

void attachPhotometries(const std::vector<NamedPhotometry>& photometries, GltfSource& source, Scene& scene) {
    for (const NamedPhotometry& named : photometries) {
        const SharedValue<Photometry> photometry =
            photometryOfIes(named.bytes, std::filesystem::path(named.path).filename().string());
        bool any = false;
        for (PunctualLight& light : scene.lights) {
            if (light.name != named.light || light.type == PunctualLight::Type::directional) continue;
            attach(named, photometry, source, light);
            any = true;
        }
        if (!any)
            throw Problem(fmt::format("has no point or spot light \"{}\" for the photometry of {}; {}",
                                      named.light, named.path, joinedNames(scene)));
    }
}

void writeProfileIntensity(json& node, const PunctualLight& light) {
    json& extension = node["extensions"][kLightProfiles];
    const float brightest = maxComponent(light.intensity);
    const glm::vec3 color = brightest > 0 ? light.intensity / brightest : glm::vec3(1);
    extension["multiplier"] = brightest / light.photometry->web().peakCandela;
    extension["color"] = {color.r, color.g, color.b};
}

}  // namespace phat::gltf
