#pragma once
// Embree 3.13 or 4, whichever cmake/GnomonEmbree.cmake found: what differs between them, and how a thread has to be
// when it calls Embree. The library includes it in this folder only.
#if GNOMON_EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif
#include <tbb/task_arena.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace gnomon {

/// How Embree is asked for occlusion. A filter gets a pointer to it as its `context`.
/// Never with the coherent flag: with it rtcOccluded16 of Embree 3.13.5 does not return from some packets of diverging
/// rays against several instances (AVX-512; rays_test finds one), and on tiles of a screen it gains nothing: 100
/// million rays a second with and without.
class EmbreeQuery {
public:
#if GNOMON_EMBREE_MAJOR == 3
    static constexpr RTCSceneFlags kSceneFlag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION; ///< Of scenes that filter.

    EmbreeQuery()
    {
        rtcInitIntersectContext(&context_);
    }
    void setFilter(RTCFilterFunctionN filter)
    {
        context_.filter = filter;
    }
    /// @param valid -1: a ray, 0: none
    void occluded(const int* valid, RTCScene scene, RTCRay16& rays)
    {
        rtcOccluded16(valid, scene, &context_, &rays);
    }
    void occluded(const int* valid, RTCScene scene, RTCRay8& rays)
    {
        rtcOccluded8(valid, scene, &context_, &rays);
    }
    void occluded(const int* valid, RTCScene scene, RTCRay4& rays)
    {
        rtcOccluded4(valid, scene, &context_, &rays);
    }

private:
    RTCIntersectContext context_; // first, as in the other version: Embree hands back a pointer to it
#else
    static constexpr RTCSceneFlags kSceneFlag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

    EmbreeQuery()
    {
        rtcInitRayQueryContext(&context_);
        rtcInitOccludedArguments(&arguments_);
    }
    void setFilter(RTCFilterFunctionN filter)
    {
        arguments_.filter = filter;
        arguments_.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    }
    void occluded(const int* valid, RTCScene scene, RTCRay16& rays)
    {
        rtcOccluded16(valid, scene, &rays, arguments());
    }
    void occluded(const int* valid, RTCScene scene, RTCRay8& rays)
    {
        rtcOccluded8(valid, scene, &rays, arguments());
    }
    void occluded(const int* valid, RTCScene scene, RTCRay4& rays)
    {
        rtcOccluded4(valid, scene, &rays, arguments());
    }

private:
    RTCOccludedArguments* arguments() // may have been copied since
    {
        arguments_.context = &context_;
        return &arguments_;
    }
    RTCRayQueryContext context_;
    RTCOccludedArguments arguments_;
#endif
};

/// Embree's results must not follow the floating-point mode of the host's threads: round to nearest, nothing traps,
/// denormals flushed (as Embree's manual asks for; a denormal reciprocal direction costs a hundred cycles a box).
class EmbreeFloatMode {
public:
#if defined(__SSE2__)
    EmbreeFloatMode() : saved_(_mm_getcsr())
    {
        _mm_setcsr(0x1f80u | 0x8000u | 0x0040u);
    }
    ~EmbreeFloatMode()
    {
        _mm_setcsr(saved_);
    }

private:
    unsigned saved_;
#else
    EmbreeFloatMode() {}
    ~EmbreeFloatMode() {}

public:
#endif
    EmbreeFloatMode(const EmbreeFloatMode&) = delete;
    EmbreeFloatMode& operator=(const EmbreeFloatMode&) = delete;
};

/// Builds on the calling thread alone: without an arena of one Embree would start TBB's workers beside the host's.
template <typename Body>
void buildHere(Body&& body)
{
    tbb::task_arena alone(1, 1);
    alone.execute(body);
}

} // namespace gnomon
