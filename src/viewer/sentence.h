#pragma once
// Error messages for the window.

#include <exception>
#include <new>
#include <string>

namespace phat {

inline std::string sentenceOf(const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error)) return "There is not enough memory.";
    return error.what();
}

}  // namespace phat
