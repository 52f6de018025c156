#pragma once
// Text of a file on its way to a terminal.

#include <string>

namespace phat {

/// On one line, without control characters: names come from files, and a terminal obeys what they hold.
/// Characters after the first `most` bytes are left out.
std::string printable(std::string text, size_t most = std::string::npos);

}  // namespace phat
