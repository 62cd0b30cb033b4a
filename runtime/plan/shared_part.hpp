#pragma once
// Work for all lights of a view together.
#include <cstdint>
#include <span>

#include "runtime/base/method_set.hpp"

namespace gnomon::plan {

inline constexpr uint32_t kNone = UINT32_MAX;
inline constexpr uint32_t kMaxParts = 32; ///< Bits of a mask.

/// A copy of a view's depth, say: paid once if any light's method needs it.
struct SharedPart {
    double ms = 0.0;   ///< >= 0, finite.
    MethodSet methods; ///< Those that need it.
};

/// What those of `methods` need together.
inline double partsMs(std::span<const SharedPart> parts, const MethodSet& methods) noexcept
{
    double sum = 0.0;
    for (const SharedPart& part : parts)
        if (part.methods.meets(methods)) sum += part.ms;
    return sum;
}

} // namespace gnomon::plan
