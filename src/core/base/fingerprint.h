#pragma once
// A number by which contents are told apart.

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace phat {

/// A fingerprint of 64 bits (not cryptographic): order and lengths of the pieces count.
class Fingerprint {
  public:
    void add(std::span<const uint8_t> bytes);
    void add(const std::string& text);
    void add(uint64_t number);
    /// Bit by bit.
    void add(float number);
    /// All elements as they lie in memory. pre: their type has no padding.
    template <typename Value>
    void addAll(const std::vector<Value>& values) {
        static_assert(std::is_trivially_copyable_v<Value>);
        add(std::span(reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(Value)));
    }
    uint64_t value() const { return state_; }

  private:
    uint64_t state_ = 0;
};

}  // namespace phat
