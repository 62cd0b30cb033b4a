// What the shaders of the stranger's renderer read in a frame: shaders/frame.h, std140.
#ifndef GNOMON_TESTS_HOST_FRAME_DATA_HPP
#define GNOMON_TESTS_HOST_FRAME_DATA_HPP

#include "meshes.hpp"

namespace stranger {

struct FrameData {
    float clipFromWorld[16]; ///< Column-major.
    float eye[3], near;      ///< World; metres.
    float viewRight[3], clipPerViewX;
    float viewUp[3], clipPerViewY;
    float viewBack[3], unused;
    struct {
        float position[3], range;
        float colour[4];
    } lamps[kLampCount];
};
static_assert(sizeof(FrameData) == 128 + 32 * kLampCount);

/// A camera that sways before the statue. Depth is reversed and has no far plane; clip y goes down the picture.
/// \param aspect Width by height of the picture.
FrameData frameDataAt(double seconds, float aspect);
/// Column-major clipFromView of it.
void fillProjection(const FrameData& data, float projection[16]);

} // namespace stranger
#endif
