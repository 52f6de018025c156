#include "io/base/content_name.h"

#include <fmt/format.h>
#include <zlib.h>

namespace phat {

std::string contentHash(std::span<const uint8_t> bytes) {
    return fmt::format("{:08x}", uint32_t(crc32_z(0, bytes.data(), bytes.size())));
}

std::string contentName(const std::string& stem, std::span<const uint8_t> bytes,
                        const std::string& extension) {
    return fmt::format("{}.{}.{}", stem, contentHash(bytes), extension);
}

}  // namespace phat
