#pragma once

#include <string>

namespace phat {

/// shaders/ as installed beside the program, or where it was built.
std::string shaderFolder();
/// The built page of `phat web`, likewise.
std::string siteFolder();
/// scenes/, likewise.
std::string sceneFolder();

}  // namespace phat
