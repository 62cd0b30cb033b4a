#pragma once
// The camera of a window: the scene's own until somebody takes it over with keys and mouse.

#include "demo/host/window.hpp"
#include "demo/scene/scene.hpp"

namespace gnomon::demo {

class FlyCamera {
public:
    /// Follows `scripted` until the first key or drag, then flies on from there.
    /// \param seconds since the last call. \param keys, mouse false: they are for something else.
    CameraState update(Window& window, const CameraState& scripted, double seconds, bool keys, bool mouse);
    void followScript() { flying_ = false; }
    bool flying() const { return flying_; }

private:
    void takeOver(const CameraState& from);

    bool flying_ = false;
    glm::dvec3 eye_{0.0};
    double yaw_ = 0.0, pitch_ = 0.0; ///< Radians.
};

} // namespace gnomon::demo
