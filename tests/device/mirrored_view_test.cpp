// Cameras that mirror, as planar reflections have them: the picture is the plain camera's, turned over, whatever the
// method.
#include <algorithm>
#include <cmath>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

enum class Mirror { right, down, view, twice };

/// The same eye; right for left, bottom for top, or both.
void mirror(demo::CameraMatrices& camera, Mirror how)
{
    if (how == Mirror::right || how == Mirror::twice) camera.projection[0] *= -1.0f;
    if (how == Mirror::down || how == Mirror::twice) camera.projection[1] *= -1.0f;
    if (how == Mirror::view)
        for (int column = 0; column < 3; ++column)
            camera.viewFromWorld[column].x *= -1.0f;
    camera.clipFromEye = camera.projection * glm::mat4(camera.viewFromWorld);
}

Image8 turnedOver(const Image8& picture, Mirror how)
{
    const bool sideways = how != Mirror::down, upright = how == Mirror::down || how == Mirror::twice;
    Image8 out = picture;
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x)
            out.texels[size_t{y} * picture.width + x] =
                *picture.at(sideways ? picture.width - 1 - x : x, upright ? picture.height - 1 - y : y);
    return out;
}

/// Texels that differ by more than a quarter of the light.
size_t farApart(const Image8& a, const Image8& b)
{
    size_t count = 0;
    for (size_t i = 0; i < a.texels.size(); ++i)
        count += std::abs(a.texels[i] - b.texels[i]) > 64;
    return count;
}

/// A spot, a bulb above an upright edge of the box that points into it, and the sun.
Scene mirroredScene(demo::DepthConvention convention)
{
    Scene scene = smallScene();
    scene.depth = {.convention = convention, .nearPlane = 0.1f, .farPlane = 200.0f};
    scene.lights.push_back(pointLight("bulb", {2.0, 5.0, -0.25}, true));
    scene.lights.push_back(scene.lights[0]);
    scene.lights[2].name = "sun";
    scene.lights[2].kind = demo::LightKind::Directional;
    for (size_t i = 0; i < 2; ++i)
        scene.lights[i].radius = 0.4f;
    return scene;
}

/// Pinned for all its lights. @param eye of the camera
void checkPictures(Host& host, const demo::CameraState& eye)
{
    const std::vector<demo::CameraState> cameras{eye};
    host.require(host.draw({.cameras = &cameras}));
    const std::vector<Image8> plain = host.pictures();
    for (const Mirror how : {Mirror::right, Mirror::down, Mirror::view, Mirror::twice}) {
        CAPTURE(static_cast<int>(how));
        const auto lens = [how](demo::CameraMatrices& camera) { mirror(camera, how); };
        host.require(host.draw({.cameras = &cameras, .lens = lens}));
        const std::vector<Image8> mirrored = host.pictures();
        for (size_t light = 0; light < plain.size(); ++light) {
            CAPTURE(light);
            CHECK(plain[light].texels.size() - lit(plain[light]) > 300);
            // Of the sun's pixels one lies on a border so exactly that rounding decides.
            CHECK(farApart(mirrored[light], turnedOver(plain[light], how)) <= 4);
        }
    }
}

constexpr demo::DepthConvention kConventions[] = {demo::DepthConvention::ReversedInfinite,
                                                  demo::DepthConvention::Standard};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a camera that mirrors shows the mirrored picture, by every volume method")
{
    for (const std::string name : {"ray_traced", "stencil_volume", "all_edges_volume", "octree_volume", "angular_spans",
                                   "chan_durand", "mccool", "projected_planar"}) {
        CAPTURE(name);
        for (const auto convention : kConventions) {
            Host host(mirroredScene(convention));
            host.pinAll(name.c_str());
            checkPictures(host, demo::cameraAt(host.scene, 0.0));
            for (size_t light = 0; light < host.lights.size(); ++light)
                CHECK(std::string(host.decision(light).pMethod) == name);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "it does so by penumbra_wedges, from outside of penumbrae and from within")
{
    const std::string name = "penumbra_wedges";
    for (const auto convention : kConventions) {
        Scene scene = mirroredScene(convention);
        scene.lights.pop_back(); // not the sun
        Host host(std::move(scene));
        host.pinAll(name.c_str());
        demo::CameraState eye = demo::cameraAt(host.scene, 0.0);
        checkPictures(host, eye);
        for (const double x : {0.7, 1.4, 2.1}) { // behind the box as the spot sees it
            CAPTURE(x);
            eye.eye = {x, 0.5, -1.3};
            eye.target = {-0.5, 0.0, -1.6};
            checkPictures(host, eye);
        }
        for (size_t light = 0; light < host.lights.size(); ++light)
            CHECK(std::string(host.decision(light).pMethod) == name);
    }
}
