#pragma once
// A wide scene under a sun, and a camera that walks in it.
#include <glm/geometric.hpp>

#include "device/fixture.hpp"

namespace gnomon::test {

/// A land of posts under one sun, most of it not in view.
inline Scene land()
{
    Scene scene = smallScene();
    for (int i = 1; i < 12; ++i) {
        demo::Instance post = scene.instances[2];
        post.name = "post";
        post.pose.position += 9.0 * i * glm::dvec3(1.0, 0.0, i % 2 ? -0.5 : 0.5);
        scene.instances.push_back(post);
    }
    scene.lights.resize(1);
    scene.lights[0].kind = demo::LightKind::Directional;
    scene.lights[0].direction = glm::normalize(glm::dvec3(0.4, -1.0, 0.3));
    scene.lights[0].isStatic = true;
    return scene;
}

inline demo::CameraState walked(const Scene& scene, double metres)
{
    demo::CameraState camera = demo::cameraAt(scene, 0.0);
    const glm::dvec3 way(metres, 0.0, 0.1 * metres);
    camera.eye += way;
    camera.target += way;
    return camera;
}

} // namespace gnomon::test
