#pragma once

#include <optional>
#include <string>
#include <utility>

namespace gnomon::demo {

/// A value, or one sentence that names the input at fault.
template <typename T>
class [[nodiscard]] Outcome {
public:
    Outcome(T value) : value_(std::move(value)) {}

    static Outcome failure(std::string message)
    {
        Outcome outcome;
        outcome.error_ = std::move(message);
        return outcome;
    }

    explicit operator bool() const noexcept { return value_.has_value(); }
    T& operator*() noexcept { return *value_; }
    const T& operator*() const noexcept { return *value_; }
    T* operator->() noexcept { return &*value_; }
    const T* operator->() const noexcept { return &*value_; }

    /// Empty on success.
    const std::string& error() const noexcept { return error_; }

private:
    Outcome() = default;
    std::optional<T> value_;
    std::string error_;
};

/// For functions that have nothing to return but the reason they failed.
struct Done {};
using Status = Outcome<Done>;

} // namespace gnomon::demo
