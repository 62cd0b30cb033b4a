#pragma once

#include "demo/io/outcome.hpp"

#include <filesystem>

namespace gnomon::demo {

/// Whether every index of a glTF file (.gltf, .glb) names a vertex. Assimp drops triangles that do not without a word,
/// so this is asked before. Succeeds for other files, and where there is nothing to look up: what else is wrong with
/// the file is for the importer to say. The error names mesh, primitive, index and bound, but not the file.
Status checkGltfIndices(const std::filesystem::path& file);

} // namespace gnomon::demo
