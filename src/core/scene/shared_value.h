#pragma once
// Large values that the copies of a scene have in common.

#include <memory>
#include <utility>

namespace phat {

/// A value, or none, that cannot be changed, only replaced: copies share it.
template <typename T>
class SharedValue {
  public:
    SharedValue() = default;
    SharedValue(T value) : value_(std::make_shared<const T>(std::move(value))) {}

    /// Whether it is the same value, not an equal one.
    bool operator==(const SharedValue&) const = default;

    explicit operator bool() const { return value_ != nullptr; }
    /// pre: there is a value.
    const T& operator*() const { return *value_; }
    const T* operator->() const { return value_.get(); }
    operator const T&() const { return *value_; }

  private:
    std::shared_ptr<const T> value_;
};

}  // namespace phat
