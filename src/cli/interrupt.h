#pragma once
// Ctrl-C, SIGTERM and the end of the terminal as a flag that long work can poll.

namespace phat {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag, the second one ends the program at once with exit
/// code 130. Those that the program was started to ignore stay ignored.
void catchInterrupts();

/// Whether one has come.
bool interruptRequested();

}  // namespace phat
