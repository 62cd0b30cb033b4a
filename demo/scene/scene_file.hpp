#pragma once

#include "demo/io/outcome.hpp"
#include "demo/scene/scene.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Scene files: YAML, documented in demo/scenes/README.md. Every error reads "file:line:column: what: why".
namespace gnomon::demo {

struct SceneFileOptions {
    bool buildMeshes = true; ///< false: everything is checked, but meshes stay empty and mesh files are not opened.
};

/** \brief Loads a scene.
\param nameOrPath A path to a file, or the name of a shipped scene ("torus_grid").
*/
Outcome<Scene> loadScene(const std::string& nameOrPath, const SceneFileOptions& options = {});

/// The same for text in memory. \param file Used in messages, and its folder to find mesh and base files.
Outcome<Scene> parseScene(std::string_view text, const std::filesystem::path& file,
                          const SceneFileOptions& options = {});

/// Path of a scene argument. A name is looked for in $GNOMON_DATA_DIR/demo/scenes, beside the executable (scenes/,
/// ../share/gnomon/scenes and ../../demo/scenes), and in the source folder this was built from.
Outcome<std::filesystem::path> findScene(const std::string& nameOrPath);

struct ShippedScene {
    std::string name;
    std::filesystem::path file;
};

/// Every scene a name can reach, sorted by name.
std::vector<ShippedScene> shippedScenes();

} // namespace gnomon::demo
