#include "viewer/recent_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "io/base/atomic_file.h"

namespace phat {
namespace {

constexpr size_t kMaxFiles = 10;

std::filesystem::path listPath() {
    if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state)
        return std::filesystem::path(state) / "phatextures/recent";
    const char* home = std::getenv("HOME");
    return home && *home ? std::filesystem::path(home) / ".local/state/phatextures/recent"
                         : std::filesystem::path();
}

}  // namespace

std::vector<std::string> recentFiles() {
    std::vector<std::string> files;
    std::ifstream list(listPath());
    std::error_code ignored;
    for (std::string line; files.size() < kMaxFiles && std::getline(list, line);)
        if (std::filesystem::is_regular_file(line, ignored)) files.push_back(line);
    return files;
}

void rememberFile(const std::string& path) {
    const std::filesystem::path list = listPath();
    if (list.empty()) return;
    const std::string full = std::filesystem::absolute(path).lexically_normal().string();
    std::vector<std::string> files = recentFiles();
    std::erase(files, full);
    files.insert(files.begin(), full);
    if (files.size() > kMaxFiles) files.resize(kMaxFiles);
    std::string text;
    for (const std::string& file : files) text += file + "\n";
    try {
        std::filesystem::create_directories(list.parent_path());
        replaceFile(list.string(), {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
    } catch (const std::exception&) {  // a convenience that must not stop the work
    }
}

}  // namespace phat
