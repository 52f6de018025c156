#pragma once
// Output files that are either wholly there or not at all.

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace phat {

/// Calls `write` with the path of a new empty file beside `path`, then renames that to `path`; a symbolic
/// link is followed, also to a file that is yet to be made; an old file's permissions stay. When `write`
/// throws, the new file is removed and an old one at `path` stays as it was. New files that earlier runs have
/// left, because they were killed, are removed. Throws FileError, also when `path` is a folder or a device,
/// and whatever `write` throws.
void replaceFile(const std::string& path, const std::function<void(const std::string& temporaryPath)>& write);

/// The same for bytes that are already in memory.
void replaceFile(const std::string& path, std::span<const uint8_t> bytes);

/// Throws as replaceFile would before it writes: for work that should not begin when its result cannot be
/// written.
void checkReplaceable(const std::string& path);

/// `path` with a suffix, cut before it where the name would be longer than file systems allow.
std::string nameBeside(const std::string& path, const std::string& suffix);

}  // namespace phat
