#include "cli/count_option.h"

#include <fmt/format.h>

#include <cmath>

namespace phat {

uint64_t parseCount(const CLI::Option* option, double low, double high) {
    const auto text = option->as<std::string>();
    char* end = nullptr;
    double value = std::strtod(text.c_str(), &end);
    const std::string unit = end;
    if (unit == "k" || unit == "K") value *= 1e3;
    if (unit == "M") value *= 1e6;
    const bool known = unit.empty() || unit == "k" || unit == "K" || unit == "M";
    if (end == text.c_str() || !known || !(value >= low && value <= high) || value != std::floor(value))
        throw CLI::ValidationError(
            option->get_name(),
            fmt::format("\"{}\" is not a count from {:.0f} to {:.0f} (1500, 500k, 2M)", text, low, high));
    return uint64_t(value);
}

}  // namespace phat
