#pragma once
// JSON that nobody has checked yet.

#include <string_view>

namespace phat {

/// Whether arrays and objects stand in each other more than 64 deep, to which valid files do not come near:
/// that aims at the stack of recursive functions. The parser itself is not recursive; what prints or copies
/// the parsed values is. pre: `json` is valid.
bool isNestedTooDeeply(std::string_view json);

}  // namespace phat
