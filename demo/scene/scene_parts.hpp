#pragma once

#include "demo/scene/scene.hpp"
#include "demo/scene/scene_file.hpp"
#include "demo/scene/scene_shape.hpp"
#include "demo/scene/yaml_reader.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The loader's own pieces, one per kind of entry in a scene file.
namespace gnomon::demo {

using shapes::kMostInstances;
using shapes::kMostLights;
using shapes::kMostTrianglesPerMesh;

/// "meshes: NAME: {...}". Notes of file imports are appended to `notes`.
Mesh readMesh(const ReadContext& context, const std::string& name, const YamlNode& node,
              const std::filesystem::path& folder, const SceneFileOptions& options, std::vector<std::string>& notes);

/// Appends a light, or the copies that its `repeat` or `ring` asks for. Names of lights read so far are taken.
void readLight(ReadContext context, const YamlNode& node, std::vector<Light>& lights, double framesPerSecond);

std::vector<CameraKey> readCamera(const ReadContext& context, const YamlNode& node);

/// A unit vector along what the node holds; a zero vector is an error.
glm::dvec3 readDirection(const ReadContext& context, const YamlNode& node, const std::string& name);

/// From "at", "rotate" and "scale".
Pose readPose(MapReader& map);

/// One of the things that an entry stands for.
struct Copy {
    std::string suffix;     ///< Of its name; empty where there is one thing only.
    glm::dvec3 offset{0.0}; ///< From where the entry says.
    glm::dquat turn{1.0, 0.0, 0.0, 0.0};
    std::optional<glm::dvec3> center; ///< What it is turned about; its own origin where there is none.
    double scale = 1.0;

    glm::dvec3 place(const glm::dvec3& position) const;
};

/// From "repeat", a grid, or "ring", a circle; without either, one. \param strewn whether the copies of a grid may be
/// turned and scaled at random.
std::vector<Copy> readCopies(MapReader& map, bool strewn);

/// From "orbit"; without it, none.
Orbit readOrbit(MapReader& map, double framesPerSecond);

/// "degrees_per_second" or "degrees_per_frame", one of them. In radians per second.
double readTurnRate(MapReader& map, double framesPerSecond);

/// Radians from a number of degrees.
double toRadians(double degrees) noexcept;

/// Checks that a key's time comes after that of the key before it.
template <typename Key>
void requireLater(const ReadContext& context, const YamlNode& node, const std::vector<Key>& keys, double time)
{
    if (!keys.empty() && time <= keys.back().time) raise(context, node, "times of keys must increase");
}

} // namespace gnomon::demo
