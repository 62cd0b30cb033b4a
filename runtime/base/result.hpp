#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "gnomon/gnomon.h"

namespace gnomon {

/// A failure: the code the C API returns and a sentence that names the value at fault.
struct Error {
    GnResult result = GN_ERROR_UNKNOWN;
    const char* id = "Unknown"; ///< Stable message identifier, static storage.
    std::string text;
};

/// @param kind "mesh", "instance", "light" or "view"
inline Error invalidHandle(const char* kind)
{
    return {GN_ERROR_INVALID_HANDLE, "InvalidHandle",
            std::string("the ") + kind + " is null, was destroyed or belongs to another context"};
}

/// @param member where the bits were given, `bits` the type that has the known ones
inline Error unknownFlags(const char* member, VkFlags64 unknown, const char* bits)
{
    return {GN_ERROR_OUT_OF_RANGE, "UnknownFlags",
            std::string(member) + " has the bits " + std::to_string(unknown) + ", which are none of " + bits};
}

/// A value, or why there is none. What can fail because of the host's input or the device returns this; an assertion
/// guards our own mistakes.
template <typename T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::move(value)) {}
    Result(Error error) : state_(std::move(error)) {}

    explicit operator bool() const noexcept { return state_.index() == 0; }
    T& operator*() { return std::get<0>(state_); }
    const T& operator*() const { return std::get<0>(state_); }
    T* operator->() { return &std::get<0>(state_); }
    const T* operator->() const { return &std::get<0>(state_); }
    const Error& error() const { return std::get<1>(state_); }
    Error& error() { return std::get<1>(state_); }

private:
    std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    explicit operator bool() const noexcept { return !error_; }
    const Error& error() const { return *error_; }

private:
    std::optional<Error> error_;
};

} // namespace gnomon
