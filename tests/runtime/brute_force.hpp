#pragma once
// The answers every tracing method is held against: double precision, from matrices, depth values and triangles alone.
// Shares no code with the shaders' receiver, the ray scene or the resolve passes; only the words of the definitions.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/scene_view.hpp"

namespace gnomon::brute {

struct Triangle {
    glm::dvec3 a, b, c; ///< World.
};

/// A camera as the host describes it (GnViewFrame), not as the runtime digests it; of any invertible projection.
struct View {
    glm::dvec3 eye{0.0};
    std::array<float, 9> viewFromWorld{1, 0, 0, 0, 1, 0, 0, 0, 1}; ///< Row-major rotation.
    std::array<float, 16> projection{};                            ///< Column-major clipFromView.
    int width = 0, height = 0;
    GnDepthConvention convention = GN_DEPTH_REVERSED_INFINITE;
    double step = 0.0; ///< What values of an image of integers are apart.
};

struct Light {
    GnLightType type = GN_LIGHT_TYPE_DIRECTIONAL;
    glm::dvec3 position{0.0};
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< The way light travels, any length.
    double range = 0.0;                   ///< 0: unlimited.
    double coneAngle = 0.0;               ///< Spot: half angle, radians.
};

/// Triangles to ask for occlusion.
class Scene {
public:
    explicit Scene(std::vector<Triangle> triangles);
    /// Whether any triangle, seen from either side, lies at 0 <= t <= tEnd on origin + t * direction. Of long and thin
    /// triangles those count that the origin is not on, by the rule of ray_traced.md.
    bool blocked(const glm::dvec3& origin, const glm::dvec3& direction, double tEnd) const;

private:
    struct Node {
        glm::dvec3 lower, upper;
        std::uint32_t first, count; ///< Leaf: triangles. Inner (count 0): children are at first and first + 1.
    };
    void split(std::uint32_t node, std::uint32_t first, std::uint32_t count);
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

/// World triangles of casters; their coordinates are relative to the frame's origin, which is given as zero here.
std::vector<Triangle> trianglesOf(std::span<const Caster> casters, std::uint32_t lightMask = 0xffffffffu);

enum class State : std::uint8_t { sky, unreached, away, asked };

struct Answer {
    State state = State::sky;
    bool lit = true; ///< Of asked pixels; sky and unreached ones are lit, those facing away are not.
    bool grazing = false;
    bool ambiguous = false;
    double offset = 0.0; ///< Metres.
    glm::dvec3 receiver{0.0};
};

/// One pixel. Where the host has not `given` the normal, every reached pixel is asked: it only says where rays start.
Answer answerAt(const View& view, const Light& light, const Scene& scene, int x, int y, float depth,
                const glm::dvec3& normal, bool given = true);

/// The depth value and the normal that a rasteriser would leave at a pixel centre: nearest triangle along the view ray.
/// The normal is the one the triangle's winding names, whichever side is seen.
struct Surface {
    float depth = 0.0f;
    glm::dvec3 normal{0.0};
};
Surface surfaceAt(const View& view, std::span<const Triangle> triangles, int x, int y);
/// Where a pixel's depth value lies in the world.
glm::dvec3 placeOf(const View& view, int x, int y, float depth);

} // namespace gnomon::brute
