#pragma once
// Ctrl-C and SIGTERM as a flag that long work can poll.

namespace phat {

/// From now on SIGINT and SIGTERM only set a flag, the second one ends the program at once with exit code
/// 130.
void catchInterrupts();

/// Whether one has come.
bool interruptRequested();

}  // namespace phat
