#include "core/base/fingerprint.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/random.h"

namespace phat {

void Fingerprint::add(std::span<const uint8_t> bytes) {
    state_ = hashOf(state_, bytes.size());
    for (size_t at = 0; at < bytes.size(); at += 8) {
        uint64_t word = 0;
        std::memcpy(&word, bytes.data() + at, std::min<size_t>(8, bytes.size() - at));
        state_ = mixBits(state_ + word + 0x9e3779b97f4a7c15ull);
    }
}

void Fingerprint::add(const std::string& text) {
    add({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

void Fingerprint::add(uint64_t number) {
    state_ = hashOf(state_, number);
}

void Fingerprint::add(float number) {
    add(uint64_t(std::bit_cast<uint32_t>(number)));
}

}  // namespace phat
