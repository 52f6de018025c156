#include "cli/data_folders.h"

#include <filesystem>

namespace phat {
namespace {

std::string installedOr(const char* name, const char* built) {
    std::error_code ignored;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
    const auto installed = program.parent_path().parent_path() / "share/phatextures" / name;
    return std::filesystem::is_directory(installed, ignored) ? installed.string() : built;
}

}  // namespace

std::string shaderFolder() {
    return installedOr("shaders", PHAT_SHADER_DIR);
}

std::string siteFolder() {
    return installedOr("site", PHAT_SITE_DIR);
}

std::string sceneFolder() {
    return installedOr("scenes", PHAT_SCENE_DIR);
}

}  // namespace phat
