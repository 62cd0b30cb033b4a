#pragma once
// The frames of a run: the path of the scene with a fixed time step, or every so many of its frames.
#include <algorithm>
#include <cmath>

#include "demo/scene/scene.hpp"

namespace gnomon::demo {

struct ComparePath {
    const Scene& scene;
    uint32_t stride = 1; ///< In frames of the scene.
    uint32_t frames = 0;

    /// \param seconds of the scene's time; 0: its length
    ComparePath(const Scene& of, double seconds, uint32_t every)
        : scene(of), stride(every),
          frames(framesIn(seconds > 0.0 ? seconds * of.framesPerSecond : double(of.frames), every))
    {
    }
    /// The same frames of another form of the scene.
    ComparePath(const Scene& of, const ComparePath& other) : scene(of), stride(other.stride), frames(other.frames) {}

    double time(uint32_t frame) const { return frameTime(scene, frame * stride); }
    /// A run begins with a view that nothing is known of.
    bool cut(uint32_t frame) const { return frame == 0 || cameraCutsBetween(scene, time(frame - 1), time(frame)); }
    /// The first frame after the first second, which is for learning.
    size_t afterFirstSecond() const
    {
        uint32_t frame = 0;
        while (frame < frames && time(frame) < time(0) + 1.0)
            ++frame;
        return frame;
    }

private:
    /// Frames whose time is below the end; 2 at least, since one has no other to be held against.
    static uint32_t framesIn(double sceneFrames, uint32_t every)
    {
        constexpr double rounding = 1e-6; // of seconds times frames a second
        return std::max(2u, static_cast<uint32_t>(std::ceil(sceneFrames / every - rounding)));
    }
};

} // namespace gnomon::demo
