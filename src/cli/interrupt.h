#pragma once
// Ctrl-C and SIGTERM as a question that long work can ask.

namespace phat {

/// From now on SIGINT and SIGTERM only set a flag, the second one ends the program at once with exit code
/// 130.
void catchInterrupts();

/// Whether one has come.
bool interruptRequested();

}  // namespace phat
