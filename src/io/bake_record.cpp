#include "io/bake_record.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace phat {
namespace {

template <class T>
std::string nameOf(const std::map<std::string, T>& names, T value) {
    return std::find_if(names.begin(), names.end(), [&](const auto& pair) { return pair.second == value; })
        ->first;
}

}  // namespace

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

BakeRecord recordOf(const BakeSettings& s, const std::string& source, const std::string& environment) {
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
    if (s.atlas.useUvSet >= 0) line["useUv"] = s.atlas.useUvSet;
    if (!environment.empty()) line["environment"] = std::filesystem::path(environment).filename().string();
    return {"phatextures " PHAT_VERSION, std::filesystem::path(source).filename().string(),
            line.dump(-1, ' ', false, json::error_handler_t::replace), s.seed};
}

}  // namespace phat
