#pragma once

#include <string>

namespace phat {

/// shaders/ as installed beside the program, or where it was built.
std::string shaderFolder();

}  // namespace phat
