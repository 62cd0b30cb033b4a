#pragma once
// Small scenes made in code, and a session on a validated device for them.

#include <doctest/doctest.h>

#include "demo/program/session.hpp"
#include "demo/scene/primitives.hpp"

namespace gnomon::demo {

/// A floor and a box of two metres standing on it; one spot light from the upper left. World offset in metres.
inline Scene boxOnFloor(glm::dvec3 offset = glm::dvec3(0.0))
{
    Scene scene;
    scene.name = "box on floor";
    scene.width = 96;
    scene.height = 64;
    scene.meshes = {makePlane({.width = 20.0f, .depth = 20.0f}), makeBox({.size = glm::vec3(2.0f)})};
    scene.meshes[0].name = "floor";
    scene.meshes[1].name = "box";
    Instance floor, box;
    floor.name = "floor";
    floor.pose.position = offset;
    floor.isStatic = true;
    box.name = "box";
    box.mesh = 1;
    box.pose.position = offset + glm::dvec3(0.0, 1.0, 0.0);
    box.pose.rotation = glm::angleAxis(0.5, glm::dvec3(0.0, 1.0, 0.0));
    scene.instances = {floor, box};
    Light light;
    light.name = "lamp";
    light.position = offset + glm::dvec3(-4.0, 6.0, 2.0);
    light.direction = glm::normalize(glm::dvec3(4.0, -6.0, -2.0));
    light.innerAngle = 0.5f;
    light.outerAngle = 0.6f;
    light.range = 40.0f;
    scene.lights = {light};
    scene.camera = {{.eye = offset + glm::dvec3(1.0, 4.0, 9.0), .target = offset + glm::dvec3(0.0, 1.0, 0.0)}};
    return scene;
}

/// One validated device for the whole program: creating instances under validation takes most of a second. main()
/// destroys it; left to static destruction, the layer's own threads are gone and the process may hang.
inline std::unique_ptr<Device> testDeviceOwner;

inline Device& testDevice()
{
    if (!testDeviceOwner)
        testDeviceOwner = Device::create({.validation = Device::validationPresent()});
    return *testDeviceOwner;
}

/// Fails the test with every message of the validation layer since the last call.
inline void checkSilence()
{
    static size_t seen = 0;
    const std::vector<std::string> messages = testDevice().validation.messages();
    for (; seen < messages.size(); ++seen)
        FAIL_CHECK(messages[seen]);
}

inline void drawFrame(Session& session, const FrameRequest& request = {})
{
    const CameraState camera = session.camera(request.time);
    FrameRequest frame = request;
    if (frame.cameras.empty()) frame.cameras = {&camera, 1};
    session.renderer.draw(frame);
}

} // namespace gnomon::demo
