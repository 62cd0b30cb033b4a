#pragma once
// How this thread has to be when it calls Embree. Included by the files of this folder that do, and by nothing else.
#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace gnomon {

/// Embree's results must not follow the floating-point mode of the host's threads: round to nearest, nothing traps,
/// denormals flushed (as Embree's manual asks for; a denormal reciprocal direction costs a hundred cycles a box).
class FloatMode {
public:
#if defined(__SSE2__)
    FloatMode() : saved_(_mm_getcsr())
    {
        _mm_setcsr(0x1f80u | 0x8000u | 0x0040u);
    }
    ~FloatMode()
    {
        _mm_setcsr(saved_);
    }

private:
    unsigned saved_;
#else
    FloatMode() {}
    ~FloatMode() {}

public:
#endif
    FloatMode(const FloatMode&) = delete;
    FloatMode& operator=(const FloatMode&) = delete;
};

/// Builds on the calling thread alone: without an arena of one Embree would start TBB's workers beside the host's.
template <typename Body>
void buildHere(Body&& body)
{
    tbb::task_arena alone(1, 1);
    alone.execute(body);
}

} // namespace gnomon
