#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

/// What a scene file describes, and what it looks like at a given time. Plain data: nothing here knows Vulkan or the
/// shadow runtime. World space is right-handed, y up, metres; matrices act on column vectors; angles are radians.
namespace gnomon::demo {

struct Mesh {
    std::string name;
    std::vector<glm::vec3> positions; ///< Object space, metres.
    std::vector<uint32_t> indices;    ///< Triangle list, counter-clockwise seen from outside.

    size_t triangleCount() const noexcept { return indices.size() / 3; }
};

struct Pose {
    glm::dvec3 position{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    glm::dvec3 scale{1.0}; ///< No component is 0; negative ones mirror. Of keys, every one has the same signs.
};

/// Which sides of its triangles the host draws. The front is counter-clockwise in object space, mirrored or not.
enum class Sides : uint8_t {
    ByMesh, ///< The front of closed meshes, both sides of open ones.
    Front,
    Both,
};

struct PoseKey {
    double time = 0.0; ///< Seconds, strictly increasing within a track.
    Pose pose;
};

/// Endless turning about an axis through the object's own origin, on top of its pose.
struct Spin {
    glm::dvec3 axis{0.0, 1.0, 0.0}; ///< Unit, object space.
    double radiansPerSecond = 0.0;
};

/// Carries a light or an instance, position and direction, round a world-space axis, on top of the keys.
struct Orbit {
    glm::dvec3 center{0.0};
    glm::dvec3 axis{0.0, 1.0, 0.0}; ///< Unit.
    double radiansPerSecond = 0.0;
};

struct Instance {
    std::string name;
    uint32_t mesh = 0; ///< Index into Scene::meshes.
    Pose pose;         ///< Used while `keys` is empty.
    std::vector<PoseKey> keys;
    Spin spin;
    Orbit orbit;
    bool isStatic = false;    ///< A promise: neither keys, spin nor orbit.
    bool alphaTested = false; ///< The host cuts holes; the pattern is the host's.
    bool hostDrawn = false;   ///< Drawn into shadow maps by the host's own callback.
    Sides sides = Sides::ByMesh;
    uint32_t casterMask = 0xffffffffu;
    glm::vec3 albedo{0.8f}; ///< Linear RGB, for pictures only.
};

enum class LightKind : uint8_t { Directional, Spot, Point };

const char* nameOf(LightKind kind) noexcept;

struct LightKey {
    double time = 0.0; ///< Seconds, strictly increasing.
    glm::dvec3 position{0.0};
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< Unit; the way light travels.
};

struct Light {
    std::string name;
    LightKind kind = LightKind::Spot;
    glm::dvec3 position{0.0};                ///< Meaningless for directional lights.
    glm::dvec3 direction{0.0, -1.0, 0.0};    ///< Unit; the way light travels. Meaningless for point lights.
    float innerAngle = 0.0f;                 ///< Spot: half angle of full intensity, radians.
    float outerAngle = 0.0f;                 ///< Spot: half angle beyond which there is no light, radians, < pi/2.
    float range = 0.0f;                      ///< Metres; 0 for directional lights, which reach everywhere.
    float radius = 0.0f;                     ///< Metres (directional: radians); 0 is a point source. Of a rectangle:
                                             ///< of the disc that has its area.
    glm::vec2 rectangle{0.0f};               ///< Spot: half width and height of its source, metres; 0: it is a sphere.
    glm::dvec3 rectangleAxis{1.0, 0.0, 0.0}; ///< Unit; along its width, as far as that lies across `direction`.
    glm::vec3 colour{1.0f};                  ///< Linear RGB.
    float intensity = 1.0f;                  ///< Multiplies colour; the falloff is the host's.
    float importance = 1.0f;                 ///< > 0; weight in the selector's plan.
    uint32_t casterMask = 0xffffffffu;
    bool isStatic = false; ///< A promise: neither keys nor orbit.
    bool disc = false;     ///< Spot: the source is a disc across `direction`; else, without `rectangle`, a sphere.
    double appear = -std::numeric_limits<double>::infinity();
    double disappear = std::numeric_limits<double>::infinity(); ///< Present in [appear, disappear).
    std::vector<LightKey> keys;
    Orbit orbit;
};

struct CameraKey {
    double time = 0.0; ///< Seconds, strictly increasing.
    glm::dvec3 eye{0.0, 2.0, 8.0};
    glm::dvec3 target{0.0};
    float verticalFov = 0.785398163f; ///< Radians; 45 degrees.
    bool cut = false;                 ///< The previous key holds until this one, then the view jumps.
};

enum class DepthConvention : uint8_t {
    ReversedInfinite, ///< 1 at the near plane, 0 at infinity.
    Standard,         ///< 0 at the near plane, 1 at the far plane.
};

const char* nameOf(DepthConvention convention) noexcept;

struct DepthSettings {
    DepthConvention convention = DepthConvention::ReversedInfinite;
    double nearPlane = 0.1;  ///< Metres.
    double farPlane = 200.0; ///< Metres; read for Standard only.
};

struct Scene {
    std::string name;
    std::string description;
    std::string file; ///< Where it was read from.
    uint32_t width = 1280, height = 720;
    uint32_t frames = 120;
    double framesPerSecond = 60.0; ///< Fixed time step of runs without a window.
    DepthSettings depth;
    glm::vec3 sky{0.30f, 0.38f, 0.50f}; ///< Linear RGB, where nothing is seen; for pictures only.
    float ambient = 1.0f;               ///< Scales the light from everywhere; for pictures only.
    glm::dvec3 center{0.0};             ///< limitLights() turns additional lights about the vertical axis through it.
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Light> lights;
    std::vector<Light> spareLights; ///< Written in the file but not used; limitLights() uses them first.
    std::vector<CameraKey> camera;  ///< Never empty in a loaded scene.
    std::vector<std::string> notes; ///< Remarks of the loader, such as dropped zero-area triangles.
};

/// The object-to-world map: world = linear * object + translation.
struct Transform {
    glm::dmat3 linear{1.0};
    glm::dvec3 translation{0.0};

    glm::dvec3 apply(const glm::vec3& positionOs) const { return linear * glm::dvec3(positionOs) + translation; }
    /// Whether triangles go round the other way in the world.
    bool mirrors() const { return glm::determinant(linear) < 0.0; }
    /// Where in a triangle list of the mesh the i-th index of the same list in the world stands.
    size_t cornerOf(size_t i) const { return mirrors() ? i + 2 - 2 * (i % 3) : i; }
    /// Rows of the 3x3 part, row-major, in float: what a 3x4 shadow or GPU transform wants beside the translation.
    std::array<float, 9> linearRowMajor() const;
};

struct LightState {
    bool present = true;
    glm::dvec3 position{0.0};
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< Unit.
};

struct CameraState {
    glm::dvec3 eye{0.0};
    glm::dvec3 target{0.0};
    glm::dvec3 up{0.0, 1.0, 0.0}; ///< Unit and orthogonal to the view direction.
    float verticalFov = 0.785398163f;

    glm::dvec3 forward() const;
};

/// Time of a frame, correctly rounded, so that keys written as frame / fps are hit exactly.
double frameTime(const Scene& scene, uint32_t frame) noexcept;

Transform instanceAt(const Instance& instance, double time);
LightState lightAt(const Light& light, double time);
CameraState cameraAt(const Scene& scene, double time);

/// Whether the view jumps somewhere in (after, upTo].
bool cameraCutsBetween(const Scene& scene, double after, double upTo) noexcept;

/// True where the instance has keys, a spin or an orbit, that is, where its transform changes with time.
bool moves(const Instance& instance) noexcept;
bool moves(const Light& light) noexcept;

/// Triangles drawn in a frame: each mesh counted once per instance.
uint64_t triangleCount(const Scene& scene) noexcept;

/// Number of lights present at a time; `dynamicOnly` leaves out those marked static.
uint32_t lightCountAt(const Scene& scene, double time, bool dynamicOnly) noexcept;

/** \brief Makes the scene have exactly `count` lights.
Keeps the first ones, the rest becoming spare, then takes `spareLights` in their order, then adds copies of the lights
in turn, each turned about the vertical axis through `center` by further multiples of the golden angle, so that no two
coincide; no two have one name. Deterministic.
A scene without any light stays without.
*/
void limitLights(Scene& scene, uint32_t count);

/// Adds the triangles of a mesh where the transform takes them; their fronts stay fronts.
void append(Mesh& mesh, const Mesh& part, const Transform& transform);

/// Makes one mesh in world space, and one instance of it, of all instances that stand still: what programs that export
/// buildings tend to write. Alpha-tested and host-drawn ones stay, and those that lights may leave out.
void mergeStatics(Scene& scene);

/// World to view space: x right, y up, looking along -z. Translate by -eye first where precision matters.
glm::dmat4 viewFromWorld(const CameraState& camera);

/// View to Vulkan clip space (y down, depth in [0, 1] by the scene's convention). \param aspect width / height.
glm::dmat4 clipFromView(const DepthSettings& depth, float verticalFov, double aspect);

} // namespace gnomon::demo
