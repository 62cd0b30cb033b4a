#pragma once

#include "demo/io/outcome.hpp"

#include <filesystem>

namespace gnomon::demo {

/// Whether every index of a glTF file (.gltf, .glb) names a vertex, and nodes are trees that are not too deep. Assimp
/// drops triangles that do not without a word, and follows nodes until its stack or the memory ends, so this is asked
/// before. Succeeds for other files, and where there is nothing to look up: what else is wrong with the file is for the
/// importer to say. The error names mesh, primitive, index and bound, or the node, but not the file.
Status checkGltf(const std::filesystem::path& file);

} // namespace gnomon::demo
