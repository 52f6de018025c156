#pragma once
// The report at the end of a bake.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "core/bake/bake.h"
#include "io/phat/earlier_file.h"

namespace phat {

/// A line where the atlas has other than about the number of texels that was asked for.
std::optional<std::string> resolutionNote(const Bake& result, const AtlasSettings& asked);

/// The output of `phat bake --json`. pre: `output` is written.
nlohmann::json reportOf(const std::string& output, const Bake& result, size_t resumedParts,
                        const std::vector<StageTime>& stageTimes, const std::vector<std::string>& notes);

/// What BakeSettings::dynamic costs: `dynamic` of the output.
nlohmann::json dynamicReport(const Bake& result);

/// What it has of an earlier bake: `kept` of the output.
nlohmann::json keptReport(const Bake& result, const EarlierFile& earlier);

/// The report in a few lines on stdout, without the notes that were `printed` before.
void printReport(const nlohmann::json& report, const std::vector<std::string>& printed);

}  // namespace phat
