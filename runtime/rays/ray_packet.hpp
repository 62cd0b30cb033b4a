#pragma once
// Sixteen shadow rays side by side as Embree's RTCRay16 has them. Nothing inline here: files of several instruction
// sets include it, the linker would keep one copy, and a processor without AVX might meet the AVX one.
#include <stdint.h>

namespace gnomon {

struct alignas(64) RayPacket {
    static constexpr uint32_t kWidth = 16;
    float origin[3][kWidth]; ///< World, relative to the frame's origin; the receiver's offset is applied.
    float start[kWidth];     ///< The tracer's own, as are `time`, `mask`, `id` and `flags`.
    float direction[3][kWidth];
    float time[kWidth];
    float tfar[kWidth]; ///< As ShadowRay has it. Asked: -infinity if something blocks the ray, else what it was.
    uint32_t mask[kWidth], id[kWidth], flags[kWidth];
    int32_t there[kWidth]; ///< -1: a ray, whose tfar is not negative; 0: none, and the lane may be anything.
};

} // namespace gnomon
