#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace phat {

/// An option's value as a count: 250000, 500k, 1.5M. Throws CLI::ValidationError outside [low, high].
uint64_t parseCount(const CLI::Option* option, double low, double high);

}  // namespace phat
