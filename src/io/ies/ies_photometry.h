#pragma once
// From the table of a photometric file to a web that light is evaluated by.

#include <cstdint>
#include <span>
#include <string>

#include "core/scene/photometry.h"

namespace phat {

/// Of the grid. The finest tables have half a degree; what is finer is read between its angles.
inline constexpr int kMaxVerticalSteps = 360, kMaxHorizontalSteps = 180;
/// Of a web, with its sums and while it is made.
inline constexpr uint64_t kMaxPhotometryBytes = 24ull * (kMaxVerticalSteps + 1) * kMaxHorizontalSteps;

/// Reads a photometric file in memory; `name` is what the web is called. Directions that the file does not
/// have are dark but for its symmetries. Throws std::runtime_error with what is wrong with it.
Photometry photometryOfIes(std::span<const uint8_t> bytes, const std::string& name);

/// The bytes of a photometric file on disk, which can be read. Throws FileError.
std::vector<uint8_t> readIesFile(const std::string& path);

}  // namespace phat
