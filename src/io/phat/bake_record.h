#pragma once
// The record of how a file was baked.

#include <algorithm>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/bake/bake.h"
#include "io/phat/baked_file.h"

namespace phat {

/// The names that flags and files use.
const std::map<std::string, Directions>& directionNames();
const std::map<std::string, RadianceSource>& radianceNames();
const std::map<std::string, PhatexelStorage>& storageNames();

/// pre: one of the names is that of `value`.
template <class T>
std::string nameOf(const std::map<std::string, T>& names, T value) {
    return std::find_if(names.begin(), names.end(), [&](const auto& pair) { return pair.second == value; })
        ->first;
}

/// `environment`: the sky's file, `variant`: of the materials; empty if none was given. `probes`: how many
/// were asked for.
BakeRecord recordOf(const BakeSettings& settings, const std::string& source, const std::string& environment,
                    PhatexelStorage storage = PhatexelStorage::packed, const std::string& variant = {},
                    int probes = 0);

/// The settings in a record; missing or invalid ones have their defaults.
BakeSettings settingsOf(const BakeRecord& record);
/// BakeRecord::settings; an empty object where they are none.
nlohmann::json settingsJson(const std::string& settings);

}  // namespace phat
