#pragma once
// Photometric files of ANSI/IES LM-63: 1986, 1991, 1995, 2002 and 2019.

#include <cstdint>
#include <span>
#include <vector>

namespace phat {

/// How a goniometer's angles lie about a lamp: about the axis that it points along (C), about one across it
/// (B, of floodlights), or about the vertical (A, of headlamps).
enum class GoniometerType : uint8_t { c = 1, b = 2, a = 3 };

/// The table of a file as it is.
struct IesTable {
    GoniometerType type = GoniometerType::c;
    std::vector<double> vertical, horizontal;  // degrees, ascending
    std::vector<double> candela;               // [horizontal][vertical], the file's factors applied
};

/// Throws std::runtime_error with what is wrong with it. TILT data of TILT=INCLUDE is skipped: the lamp hangs
/// as it was measured.
IesTable parseIes(std::span<const uint8_t> bytes);

}  // namespace phat
