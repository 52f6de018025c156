#include "cli/site_folder.h"

#include <filesystem>
#include <fstream>

#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/phat/phat_payload.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

constexpr const char* kList = "phat-web.txt";
constexpr const char* kFirstLine =
    "Files that `phat web` wrote. It replaces and removes these, and no others:";

bool isFileName(const std::string& name) {
    return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

// The files of an older page. Throws unless it is one.
std::set<std::string> readList(const std::string& path) {
    std::ifstream file(path + "/" + kList);
    std::string line;
    if (!std::getline(file, line) || line != kFirstLine)
        throw FileError(path, "has files in it that are not of a page; name an empty or a new folder");
    std::set<std::string> names;
    while (std::getline(file, line))
        if (isFileName(line)) names.insert(line);
    return names;
}

}  // namespace

SiteFolder::SiteFolder(const std::string& path, const std::string& input, const std::set<std::string>& names)
    : path_(path) {
    std::error_code error;
    if (fs::exists(path, error) && !fs::is_directory(path, error)) throw FileError(path, "is not a folder");
    if (fs::is_directory(path, error) && !fs::is_empty(path, error) && !error) old_ = readList(path);
    if (!error) checkOwn(input);
    for (const std::string& name : names)
        if (!old_.contains(name) && fs::exists(fs::symlink_status(file(name), error)))
            throw FileError(file(name), "is not a page's own, and a page would replace it");
    fs::create_directories(path, error);
    if (error) throw FileError(path, "cannot be created: " + error.message());
    for (const std::string& name : names) checkReplaceable(file(name));
}

void SiteFolder::checkOwn(const std::string& input) const {
    std::error_code error;
    for (const std::string& name : old_)
        if (fs::equivalent(file(name), input, error))
            throw FileError(input, "is a part of the page that would be replaced; name another folder");
}

void SiteFolder::writeList(const std::set<std::string>& names) const {
    std::string text = std::string(kFirstLine) + "\n";
    for (const std::string& name : names) text += name + "\n";
    replaceFile(file(kList), bytesOf(std::span<const char>(text)));
}

void SiteFolder::write(const std::vector<SiteFile>& files) {
    std::set<std::string> names, all = old_;
    for (const SiteFile& each : files) names.insert(each.name);
    all.insert(names.begin(), names.end());
    // Listed first, so that the folder is known as a page's own wherever the program stops.
    writeList(all);
    for (const SiteFile& each : files) replaceFile(file(each.name), each.bytes);
    std::error_code ignored;
    for (const std::string& name : old_)
        if (!names.contains(name)) fs::remove(file(name), ignored);
    writeList(names);
}

}  // namespace phat
