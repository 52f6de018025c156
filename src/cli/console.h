#pragma once
// Standard output and standard error, which may be closed, full, or gone with their terminal.

#include <string>

namespace phat {

/// Before anything is opened: no file gets the number of a closed standard stream, and a reader that has gone
/// is an error of the write and no signal.
void secureStandardStreams();

/// Writes to standard error, at once. What cannot be written is lost: the work is worth more than its
/// progress.
void tell(const std::string& text);

/// Throws std::runtime_error where a part of standard output could not be written.
void finishOutput();

}  // namespace phat
