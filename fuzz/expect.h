#pragma once
// A promise that a reader has not kept ends the run of the fuzzer, and fails a test.

#include <stdexcept>
#include <string>

namespace phat::fuzz {

inline void expect(bool holds, const char* what) {
    if (!holds) throw std::logic_error(std::string("broken promise: ") + what);
}

}  // namespace phat::fuzz
