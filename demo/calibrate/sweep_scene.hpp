#pragma once
// The scene that calibration measures: many small worlds side by side, each with its own number of triangles, and one
// moment in time per point of the sweep. Lights live in one second only, the camera jumps from world to world.

#include <cstdint>
#include <span>
#include <vector>

#include "demo/scene/scene.hpp"

namespace gnomon::demo {

/// What moves at a point.
enum class SweepMotion : uint8_t { nothing, casters, light };

/// One workload. A point's lights are those present at `time`.
struct SweepPoint {
    double time = 0.0; ///< Seconds; the point owns [time, time + 1).
    LightKind kind = LightKind::Spot;
    SweepMotion motion = SweepMotion::nothing;
    uint32_t lights = 1;
    uint32_t mapSide = 1024; ///< For methods with maps.
    uint32_t width = 1280, height = 720;
    bool soft = false; ///< Lights have a radius: what penumbrae cost shows at these points, errors at the others.
};

struct Sweep {
    Scene scene;
    std::vector<SweepPoint> points;
};

inline constexpr uint32_t kSweepLights = 3; ///< At most, in one point.

/// A low-discrepancy set: every prefix of the points of one kind of light covers the range evenly. Points of the kinds
/// take turns. The same numbers in every build.
Sweep makeSweep(uint32_t pointsPerKind);

/// Coordinate `axis` of point `index` in the additive sequence of `axes` dimensions, in [0, 1).
double sweepCoordinate(uint32_t index, uint32_t axis, uint32_t axes);

} // namespace gnomon::demo
