#include "io/phat/bake_record.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/base/json_depth.h"

namespace phat {

const std::map<std::string, Directions>& directionNames() {
    static const std::map<std::string, Directions> names = {{"guided", Directions::guided},
                                                            {"photons", Directions::photons},
                                                            {"nearest-photon", Directions::nearestPhoton},
                                                            {"uniform", Directions::uniform},
                                                            {"cosine", Directions::cosine}};
    return names;
}

const std::map<std::string, RadianceSource>& radianceNames() {
    static const std::map<std::string, RadianceSource> names = {{"texels", RadianceSource::texels},
                                                                {"path", RadianceSource::path},
                                                                {"photons", RadianceSource::photons},
                                                                {"splat", RadianceSource::splat}};
    return names;
}

const std::map<std::string, PhatexelStorage>& storageNames() {
    static const std::map<std::string, PhatexelStorage> names = {{"packed", PhatexelStorage::packed},
                                                                 {"paper", PhatexelStorage::paper}};
    return names;
}

BakeRecord recordOf(const BakeSettings& s, const std::string& source, const std::string& environment,
                    PhatexelStorage storage, const std::string& variant, int probes) {
    using nlohmann::json;
    json line = {{"samples", s.layers},
                 {"photons", s.photons.count},
                 {"directions", nameOf(directionNames(), s.directions)},
                 {"radiance", nameOf(radianceNames(), s.radiance)},
                 {"bounces", s.maxBounces},
                 {"gatherNeighbors", s.density.neighbors},
                 {"paths", s.pathsPerPhatexel},
                 {"gutter", s.atlas.gutterTexels},
                 {"glossyDensity", s.atlas.glossyDensity},
                 {"seed", s.seed}};
    if (s.atlas.texelSizeMeters > 0)
        line["texelSize"] = s.atlas.texelSizeMeters;
    else
        line["resolution"] = s.atlas.texelBudget;
    if (s.dynamic) line["dynamic"] = true;
    if (probes > 0) line["probes"] = probes;
    if (s.atlas.useUvSet >= 0) line["useUv"] = s.atlas.useUvSet;
    if (storage != PhatexelStorage::packed) line["storage"] = nameOf(storageNames(), storage);
    if (!environment.empty()) line["environment"] = std::filesystem::path(environment).filename().string();
    if (!variant.empty()) line["variant"] = variant;
    return {"phatextures " PHAT_VERSION, std::filesystem::path(source).filename().string(),
            line.dump(-1, ' ', false, json::error_handler_t::replace), s.seed, storage};
}

nlohmann::json settingsJson(const std::string& settings) {
    using nlohmann::json;
    json parsed = json::parse(settings, nullptr, false);
    return parsed.is_object() && !isNestedTooDeeply(settings) ? parsed : json::object();
}

BakeSettings settingsOf(const BakeRecord& record) {
    using nlohmann::json;
    BakeSettings s;
    s.seed = s.photons.seed = record.seed;
    const json line = settingsJson(record.settings);
    const auto number = [&](const char* key, auto& value, uint64_t low, uint64_t high) {
        const auto it = line.find(key);
        if (it == line.end() || !it->is_number_unsigned()) return;
        if (const uint64_t found = it->get<uint64_t>(); found >= low && found <= high)
            value = static_cast<std::remove_reference_t<decltype(value)>>(found);
    };
    const auto name = [&](const char* key, const auto& names, auto& value) {
        const auto it = line.find(key);
        if (it == line.end() || !it->is_string()) return;
        if (const auto found = names.find(it->template get<std::string>()); found != names.end())
            value = found->second;
    };
    number("samples", s.layers, 1, 64);
    number("photons", s.photons.count, 1, uint64_t(1) << 32);
    number("bounces", s.maxBounces, 1, 1000);
    number("paths", s.pathsPerPhatexel, 1, 65'536);
    // Photons follow the flag, not its default.
    if (s.maxBounces != BakeSettings().maxBounces) s.photons.maxBounces = s.maxBounces;
    const auto dynamic = line.find("dynamic");
    s.dynamic = dynamic != line.end() && dynamic->is_boolean() && dynamic->get<bool>();
    name("directions", directionNames(), s.directions);
    name("radiance", radianceNames(), s.radiance);
    return s;
}

}  // namespace phat
