#pragma once
// The record of how a file was baked.

#include <map>
#include <string>

#include "core/bake/bake.h"
#include "io/phat/baked_file.h"

namespace phat {

/// The names that flags and files use.
const std::map<std::string, Directions>& directionNames();
const std::map<std::string, RadianceSource>& radianceNames();

/// `environment`: the sky's file, empty if none was given.
BakeRecord recordOf(const BakeSettings& settings, const std::string& source, const std::string& environment);

/// The settings in a record; missing or invalid ones have their defaults.
BakeSettings settingsOf(const BakeRecord& record);

}  // namespace phat
