#pragma once
// Hosts with targets and cameras of every kind, and one scene that all of them look at.
#include <functional>
#include <string>

#include "device/fixture.hpp"
#include "runtime/brute_force.hpp"

namespace gnomon::test {

/// A camera beside the plain one.
struct Lens {
    const char* name;
    std::function<void(demo::CameraMatrices&)> bend; ///< Its projection, before clipFromEye is made of it.
    GnDepthConvention convention;
};

/// A spot, a bulb and the sun over the small scene; sources of no size, or of 0.4 m.
Scene targetScene(demo::DepthConvention convention, float radius = 0.0f);
/// The frame's options for a camera through the lens.
FrameOptions through(const Lens& lens, const FrameOptions& rest = {});
/// Perspectives and orthographic cameras that scenes of the convention can be drawn with, the plain one first.
std::vector<Lens> lensesFor(demo::DepthConvention convention);

/// The newest frame's view 0 as the brute force knows cameras. @param step of the depth format's integers
brute::View bruteView(const Host& host, const Lens& lens, double step);
brute::Light bruteLight(const Host& host, size_t light);
std::vector<brute::Triangle> bruteTriangles(const Host& host);

/// What values of a depth format are apart; 0 for floats.
double stepOf(VkFormat format);
/// Whether the device can draw into and sample images of the format with so many samples.
bool drawable(VkFormat format, uint32_t samples = 1);

/// Pins the lights that the method serves to it. @return how many
size_t pinServed(Host& host, const GnMethodInfo& method);
/// Texels that differ by more than a quarter of the light.
size_t farApart(const Image8& a, const Image8& b);

} // namespace gnomon::test
