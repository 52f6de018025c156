#include "cli/size_option.h"

#include <fmt/format.h>

#include <cstdio>

namespace phat {

glm::ivec2 parseSize(const CLI::Option* option) {
    const auto text = option->as<std::string>();
    glm::ivec2 size(0);
    char end = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &size.x, &size.y, &end) != 2 || size.x < 1 || size.y < 1 ||
        size.x > kMaxPictureSide || size.y > kMaxPictureSide)
        throw CLI::ValidationError(
            option->get_name(), fmt::format("\"{}\" is not WxH, each from 1 to {}", text, kMaxPictureSide));
    return size;
}

}  // namespace phat
