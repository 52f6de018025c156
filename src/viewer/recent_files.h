#pragma once
// Files that were opened before.

#include <string>
#include <vector>

namespace phat {

/// The newest first, at most ten that still exist. Kept in $XDG_STATE_HOME/phatextures/recent, a line each;
/// where nothing can be kept there are none.
std::vector<std::string> recentFiles();
/// Puts a file first.
void rememberFile(const std::string& path);

}  // namespace phat
