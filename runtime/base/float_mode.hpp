#pragma once

/// Keeps the processor's floating-point mode out of decisions.

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#define GNOMON_HAS_MXCSR 1
#endif

namespace gnomon {

/// Puts the calling thread's rounding, denormal and exception mode aside while it lives: to nearest, denormals kept, no
/// traps. A host may have set another (flush-to-zero is common in audio and physics threads), and the same inputs must
/// give the same decision. On processors without MXCSR it does nothing.
///
/// The compiler may move arithmetic across it; what is meant to be covered belongs into functions that are not inlined.
class FloatMode {
public:
#if GNOMON_HAS_MXCSR
    FloatMode() noexcept : host_(_mm_getcsr())
    {
        if ((host_ & kControl) != kStandard) _mm_setcsr(kStandard);
    }
    ~FloatMode()
    {
        if ((host_ & kControl) != kStandard) _mm_setcsr(host_);
    }
#else
    FloatMode() noexcept {}
    ~FloatMode() {}
#endif
    FloatMode(const FloatMode&) = delete;
    FloatMode& operator=(const FloatMode&) = delete;

private:
#if GNOMON_HAS_MXCSR
    static constexpr unsigned kControl = 0xffc0;  ///< All but the sticky flags.
    static constexpr unsigned kStandard = 0x1f80; ///< To nearest, no FTZ, no DAZ, all exceptions masked.
    unsigned host_;
#endif
};

} // namespace gnomon
