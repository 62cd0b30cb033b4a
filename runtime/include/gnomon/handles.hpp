/** \file handles.hpp
\brief Results and owned handles of the C++ layer. Included by gnomon.hpp, not by hosts.
*/
#ifndef GNOMON_HANDLES_HPP
#define GNOMON_HANDLES_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#if defined(__cpp_exceptions)
#include <stdexcept>
#endif

#include <gnomon/gnomon.h>

namespace gn {

#if defined(__cpp_exceptions)
/** Thrown by gn::Status::require() and gn::Result::value() alone. */
class Failure : public std::runtime_error {
public:
    /** Of a failed call. */
    Failure(GnResult status, const char* message) : std::runtime_error(message), status_(status) {}
    /** The call's result; negative. */
    GnResult status() const noexcept { return status_; }

private:
    GnResult status_;
};
#endif

/** What every call returns. */
class [[nodiscard]] Status {
public:
    /** A result and its sentence. */
    Status(GnResult status, const char* message) noexcept : status_(status), message_(message) {}
    /** No failure; status() may have a remark, such as #GN_NOT_READY. */
    explicit operator bool() const noexcept { return status_ >= 0; }
    /** What the C function returned. */
    GnResult status() const noexcept { return status_; }
    /** Why it failed; empty where it did not. Valid until the thread's next call on the context. */
    const char* message() const noexcept { return message_; }
#if defined(__cpp_exceptions)
    /** Throws gn::Failure where the call failed. */
    void require() const
    {
        if (status_ < 0) throw Failure(status_, message_);
    }
#endif

private:
    GnResult status_;
    const char* message_;
};

/** What a call returned, and its value; of a call that failed the value is zero or null. */
template <typename T>
class [[nodiscard]] Result : public Status {
public:
    /** A result with its value. */
    Result(GnResult status, const char* message, T value) noexcept : Status(status, message), value_(std::move(value))
    {
    }
    /** The value, whatever the status. */
    T& operator*() noexcept { return value_; }
    /** The value, whatever the status. */
    const T& operator*() const noexcept { return value_; }
    /** The value, whatever the status. */
    T* operator->() noexcept { return &value_; }
    /** The value, whatever the status. */
    const T* operator->() const noexcept { return &value_; }
#if defined(__cpp_exceptions)
    /** Moves the value out, or throws gn::Failure where the call failed. */
    T value()
    {
        require();
        return std::move(value_);
    }
#endif

private:
    T value_;
};

/** \cond */
namespace detail {

inline Status done(GnContext context, GnResult status) noexcept
{
    return {status, status < 0 ? gnGetLastError(context) : ""};
}

template <typename T>
Result<T> done(GnContext context, GnResult status, T value) noexcept
{
    return {status, status < 0 ? gnGetLastError(context) : "", std::move(value)};
}

/// call(pOut) fills a structure.
template <typename T, typename Call>
Result<T> filled(GnContext context, Call&& call) noexcept
{
    T out{};
    const GnResult status = call(&out);
    return done(context, status, out);
}

/// call(pCount, pOut) fills an array: what of `room` it has filled. Without room: nothing, and #GN_INCOMPLETE.
template <typename Size, typename T, typename Call>
Result<std::span<T>> listed(GnContext context, std::span<T> room, Call&& call) noexcept
{
    Size count = static_cast<Size>(room.size());
    const GnResult status = call(&count, room.empty() ? nullptr : room.data());
    const bool less = status == GN_SUCCESS && count > room.size();
    const bool any = status >= 0 && !less;
    // Bytes are written as a whole or not at all; of a list, what fits.
    const bool whole = sizeof(T) > 1 || status != GN_INCOMPLETE;
    const std::size_t written = any && whole ? std::min<std::size_t>(count, room.size()) : 0;
    return done(context, less ? GN_INCOMPLETE : status, room.first(written));
}

/// The same call without an array: how many elements there are.
template <typename Size, typename Call>
Result<Size> counted(GnContext context, Call&& call) noexcept
{
    Size count = 0;
    const GnResult status = call(&count, nullptr);
    return done(context, status, count);
}

/// Owns one handle of a context. It knows how to destroy and how to move.
template <typename Handle, void(GN_CALL* Destroy)(GnContext, Handle)>
class Owned {
public:
    Owned() noexcept = default;
    Owned(GnContext context, Handle handle) noexcept : context_(context), handle_(handle) {}
    Owned(Owned&& other) noexcept
        : context_(other.context_), handle_(std::exchange(other.handle_, Handle{VK_NULL_HANDLE}))
    {
    }
    Owned& operator=(Owned&& other) noexcept
    {
        if (this != &other) {
            reset();
            context_ = other.context_;
            handle_ = std::exchange(other.handle_, Handle{VK_NULL_HANDLE});
        }
        return *this;
    }
    ~Owned() { reset(); }

    Handle get() const noexcept { return handle_; }
    GnContext context() const noexcept { return context_; }
    explicit operator bool() const noexcept { return handle_ != Handle{VK_NULL_HANDLE}; }
    /// Destroys it now.
    void reset() noexcept
    {
        if (*this) Destroy(context_, std::exchange(handle_, Handle{VK_NULL_HANDLE}));
    }
    /// Hands it out, to be destroyed by the caller.
    [[nodiscard]] Handle release() noexcept { return std::exchange(handle_, Handle{VK_NULL_HANDLE}); }

protected:
    Status done(GnResult status) const noexcept { return detail::done(context_, status); }

private:
    GnContext context_ = nullptr;
    Handle handle_ = VK_NULL_HANDLE;
};

/// Vertices that begin with their position as three floats.
template <typename Vertex>
constexpr void checkVertex() noexcept
{
    static_assert(std::is_trivially_copyable_v<Vertex> && sizeof(Vertex) >= 3 * sizeof(float) &&
                      sizeof(Vertex) % sizeof(float) == 0 && alignof(Vertex) >= alignof(float),
                  "a vertex begins with three floats, and its size is a multiple of a float's");
}

} // namespace detail
/** \endcond */

} // namespace gn
#endif /* GNOMON_HANDLES_HPP */
