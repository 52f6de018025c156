#include "cli/owned_folder.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/phat/phat_payload.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

std::string firstLine(const FolderOwner& owner) {
    return fmt::format("Files that `{}` wrote. It replaces and removes these, and no others:", owner.command);
}

bool isFileName(const std::string& name) {
    return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

}  // namespace

// The files of an older output. Throws unless the folder is one.
std::set<std::string> OwnedFolder::readList() const {
    std::ifstream stream(file(owner_.list));
    std::string line;
    if (!std::getline(stream, line) || line != firstLine(owner_))
        throw FileError(path_,
                        fmt::format("has files in it that are not of a {}; name an empty or a new folder",
                                    owner_.content));
    std::set<std::string> names;
    while (std::getline(stream, line))
        if (isFileName(line)) names.insert(line);
    return names;
}

OwnedFolder::OwnedFolder(const FolderOwner& owner, const std::string& path, const std::string& input,
                         const std::set<std::string>& names)
    : owner_(owner), path_(path) {
    std::error_code error;
    if (fs::exists(path, error) && !fs::is_directory(path, error)) throw FileError(path, "is not a folder");
    if (fs::is_directory(path, error) && !fs::is_empty(path, error) && !error) old_ = readList();
    if (!error) checkOwn(input);
    for (const std::string& name : names)
        if (!old_.contains(name) && fs::exists(fs::symlink_status(file(name), error)))
            throw FileError(file(name),
                            fmt::format("is not a {0}'s own, and a {0} would replace it", owner_.content));
    fs::create_directories(path, error);
    if (error) throw FileError(path, "cannot be created: " + error.message());
    for (const std::string& name : names) checkReplaceable(file(name));
}

void OwnedFolder::checkOwn(const std::string& input) const {
    std::error_code error;
    for (const std::string& name : old_)
        if (fs::equivalent(file(name), input, error))
            throw FileError(input,
                            fmt::format("is a part of the {} that would be replaced; name another folder",
                                        owner_.content));
}

void OwnedFolder::writeList(const std::set<std::string>& names) const {
    std::string text = firstLine(owner_) + "\n";
    for (const std::string& name : names) text += name + "\n";
    replaceFile(file(owner_.list), bytesOf(std::span<const char>(text)));
}

void OwnedFolder::write(const std::vector<OutputFile>& files) {
    std::set<std::string> names, all = old_;
    for (const OutputFile& each : files) names.insert(each.name);
    all.insert(names.begin(), names.end());
    // Listed first, so that the folder is known as the owner's wherever the program stops.
    writeList(all);
    for (const OutputFile& each : files) replaceFile(file(each.name), each.bytes);
    std::error_code ignored;
    for (const std::string& name : old_)
        if (!names.contains(name)) fs::remove(file(name), ignored);
    writeList(names);
}

}  // namespace phat
