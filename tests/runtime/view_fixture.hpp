#pragma once
// A view for tests of what is found about its receivers.
#include "runtime/scene/scene_view.hpp"

namespace gnomon::test {

/// Looks along -z from the origin, a pixel a milliradian.
inline CameraView camera()
{
    CameraView view;
    view.area = {{0, 0}, {640, 640}};
    view.constants.rayCornerWs = glm::vec4(-0.32f, 0.32f, -1.0f, 0.0f);
    view.constants.rayDxWs = glm::vec4(0.001f, 0.0f, 0.0f, 0.0f);
    view.constants.rayDyWs = glm::vec4(0.0f, -0.001f, 0.0f, 0.0f);
    view.constants.pixelSize = 0.001f;
    return view;
}

} // namespace gnomon::test
