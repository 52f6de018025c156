#include "cli/shader_folder.h"

#include <filesystem>

namespace phat {

std::string shaderFolder() {
    std::error_code ignored;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
    const auto installed = program.parent_path().parent_path() / "share/phatextures/shaders";
    return std::filesystem::is_directory(installed, ignored) ? installed.string() : PHAT_SHADER_DIR;
}

}  // namespace phat
