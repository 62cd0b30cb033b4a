#pragma once

#include "demo/scene/scene.hpp"
#include "demo/scene/scene_file.hpp"
#include "demo/scene/yaml_reader.hpp"

#include <filesystem>

/// The loader's own pieces, one per kind of entry in a scene file.
namespace gnomon::demo {

// Bounds of what a file may ask for, far above any sensible scene: a typing error must not eat the memory.
inline constexpr uint32_t kMostTrianglesPerMesh = 4'000'000;
inline constexpr uint32_t kMostInstances = 100'000;
inline constexpr uint32_t kMostLights = 4096;

/// "meshes: NAME: {...}". Notes of file imports are appended to `notes`.
Mesh readMesh(const ReadContext& context, const std::string& name, const YamlNode& node,
              const std::filesystem::path& folder, const SceneFileOptions& options, std::vector<std::string>& notes);

/// \param before the lights read so far, whose names are taken.
Light readLight(ReadContext context, const YamlNode& node, const std::vector<Light>& before, double framesPerSecond);

std::vector<CameraKey> readCamera(const ReadContext& context, const YamlNode& node);

/// A unit vector along what the node holds; a zero vector is an error.
glm::dvec3 readDirection(const ReadContext& context, const YamlNode& node, const std::string& name);

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
