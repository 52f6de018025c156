#pragma once
// What a baked file says of its making.

#include <map>
#include <string>

#include "core/bake.h"
#include "io/baked_file.h"

namespace phat {

/// The names that flags and files use.
const std::map<std::string, Directions>& directionNames();
const std::map<std::string, RadianceSource>& radianceNames();

/// `environment`: the sky's file, empty if none was given.
BakeRecord recordOf(const BakeSettings& settings, const std::string& source, const std::string& environment);

}  // namespace phat
