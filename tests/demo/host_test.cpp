// The host itself: what it draws is what the scene says, whoever shades it.
#include "host_fixture.hpp"

#include <cmath>
#include <limits>

#include "shaders/demo/frame.h"

namespace gnomon::demo {
namespace {

struct Hit {
    double linearDepth = std::numeric_limits<double>::infinity();
    glm::dvec3 normal{0.0};
};

/// Nearest triangle along a view ray of linear depth 1, in double, by Moeller and Trumbore.
Hit trace(const Scene& scene, const SceneState& state, const glm::dvec3& eye, const glm::dvec3& ray)
{
    Hit nearest;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
        for (size_t k = 0; k < mesh.indices.size(); k += 3) {
            const auto corner = [&](size_t c) {
                return state.instances[i].apply(mesh.positions[mesh.indices[k + c]]) - eye;
            };
            const glm::dvec3 a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a;
            const glm::dvec3 p = glm::cross(ray, e2);
            const double det = glm::dot(e1, p);
            if (det == 0.0) continue;
            const double u = glm::dot(-a, p) / det;
            const glm::dvec3 q = glm::cross(-a, e1);
            const double v = glm::dot(ray, q) / det, t = glm::dot(e2, q) / det;
            if (u < 0.0 || v < 0.0 || u + v > 1.0 || t <= 0.0 || t >= nearest.linearDepth) continue;
            glm::dvec3 normal = glm::normalize(glm::cross(e1, e2));
            nearest = {t, glm::dot(normal, ray) < 0.0 ? normal : -normal};
        }
    }
    return nearest;
}

/// Share of pixels whose depth or normal differs from traced triangles; edges may differ by a pixel.
double differingShare(const Scene& scene, Session& session)
{
    const ImageF depth = session.renderer.readDepth(), normals = session.renderer.readNormals();
    const CameraMatrices& camera = session.renderer.camera();
    uint32_t differing = 0;
    for (uint32_t y = 0; y < depth.height; ++y) {
        for (uint32_t x = 0; x < depth.width; ++x) {
            const glm::dvec3 ray = glm::dvec3(camera.rayCorner) + (x + 0.5) * glm::dvec3(camera.rayDx) +
                                   (y + 0.5) * glm::dvec3(camera.rayDy);
            const Hit hit = trace(scene, session.renderer.state(), camera.eye, ray);
            const float d = *depth.at(x, y);
            const bool sky = d == camera.skyDepth;
            if (sky || std::isinf(hit.linearDepth)) {
                differing += sky != std::isinf(hit.linearDepth);
                continue;
            }
            const double linear = double(camera.depthScale) / (double(d) + double(camera.depthAdd));
            const float* n = normals.at(x, y);
            const double off = glm::length(glm::dvec3(n[0], n[1], n[2]) - hit.normal);
            // Normals are half floats (11 bits); depths have 24, and interpolation costs a few of them.
            differing += std::abs(linear - hit.linearDepth) > 1e-4 * hit.linearDepth || off > 2e-3;
        }
    }
    return double(differing) / (double(depth.width) * depth.height);
}

} // namespace

TEST_CASE("depth and geometric normals are those of the triangles under the pixel centres")
{
    for (const DepthConvention convention : {DepthConvention::ReversedInfinite, DepthConvention::Standard}) {
        Scene scene = boxOnFloor();
        scene.depth.convention = convention;
        Session session(testDevice(), scene, {});
        drawFrame(session);
        CHECK(differingShare(scene, session) < 0.002); // 12 of 6144 pixels, at edges
    }
    checkSilence();
}

TEST_CASE("a million metres from the origin the picture is the same")
{
    const Scene near = boxOnFloor(), far = boxOnFloor(glm::dvec3(1e6, 0.0, -1e6));
    Session nearSession(testDevice(), near, {}), farSession(testDevice(), far, {});
    drawFrame(nearSession);
    drawFrame(farSession);
    const Image8 a = nearSession.renderer.readColour(), b = farSession.renderer.readColour();
    size_t differing = 0;
    for (size_t i = 0; i < a.texels.size(); ++i)
        differing += std::abs(int(a.texels[i]) - int(b.texels[i])) > 2;
    CHECK(differing < a.texels.size() / 500); // doubles at 10^6 keep 10^-10 m; only edge pixels may flip
    checkSilence();
}

TEST_CASE("each of 30 720 instances has its own colour, and one more is an error that names the limit")
{
    Scene few = boxOnFloor();
    few.instances[1].albedo = {0.9f, 0.1f, 0.1f};
    Scene many = few;
    Instance behind = few.instances[1];
    behind.albedo = {0.1f, 0.1f, 0.9f};
    behind.pose.position.z = 300.0; // the eye and the lamp
    many.instances.insert(many.instances.begin(), gpu::MAX_DEMO_INSTANCES - 2, behind);
    Session fewSession(testDevice(), few, {}), manySession(testDevice(), many, {});
    drawFrame(fewSession);
    drawFrame(manySession);
    const Image8 a = fewSession.renderer.readColour(), b = manySession.renderer.readColour();
    CHECK(a.texels == b.texels);
    size_t red = 0;
    for (size_t i = 0; i < a.texels.size(); i += 4)
        red += a.texels[i] > 2 * a.texels[i + 2];
    CHECK(red > 100);
    many.instances.push_back(behind);
    CHECK_THROWS_WITH_AS(Session(testDevice(), many, {}), "scene 'box on floor' has more than 30720 instances",
                         HostError);
    checkSilence();
}

TEST_CASE("two views of one frame each show their own camera")
{
    const Scene scene = boxOnFloor();
    Session both(testDevice(), scene, {.viewCount = 2}), alone(testDevice(), scene, {});
    CameraState second = both.camera(0.0);
    second.eye.x += 3.0;
    const CameraState cameras[] = {both.camera(0.0), second};
    drawFrame(both, {.cameras = cameras, .shadows = &both.shadows});
    drawFrame(alone, {.cameras = {&second, 1}, .shadows = &alone.shadows});
    CHECK(both.renderer.readColour(1).texels == alone.renderer.readColour(0).texels);
    CHECK(both.renderer.readColour(0).texels != both.renderer.readColour(1).texels);
    checkSilence();
}

TEST_CASE("resizing in every frame with three in flight gives the picture of a renderer of that size")
{
    const Scene scene = boxOnFloor();
    Session session(testDevice(), scene, {.framesInFlight = 3});
    for (uint32_t i = 0; i < 24; ++i) {
        session.renderer.resize({60 + i * 7 % 50, 40 + i * 11 % 30});
        drawFrame(session, {.shadows = &session.shadows, .recorded = i % 2 == 1});
    }
    session.renderer.resize({96, 64});
    drawFrame(session, {.shadows = &session.shadows});
    Session fresh(testDevice(), scene, {});
    drawFrame(fresh, {.shadows = &fresh.shadows});
    CHECK(session.renderer.readDepth().texels == fresh.renderer.readDepth().texels);
    CHECK(session.renderer.readColour().width == 96);
    checkSilence();
}

TEST_CASE("a scene with more lights than the view holds is an error that names both numbers")
{
    Scene scene = boxOnFloor();
    Session session(testDevice(), scene, {});
    scene.lights.push_back(scene.lights[0]); // after the session was made for one
    CHECK_THROWS_AS(drawFrame(session), HostError);
}

} // namespace gnomon::demo
