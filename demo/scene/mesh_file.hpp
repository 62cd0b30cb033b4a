#pragma once

#include "demo/io/outcome.hpp"
#include "demo/scene/scene.hpp"

#include <filesystem>

/// Meshes from OBJ, PLY, 3DS and glTF files, through Assimp.
namespace gnomon::demo {

/// Which of a file's axes points up. It is turned to +y before anything else.
enum class UpAxis : uint8_t { Y, Z, MinusZ };

struct MeshFileOptions {
    UpAxis up = UpAxis::Y;
    float fitHeight = 0.0f; ///< > 0: scaled to this height in metres, centred in x and z, standing on y = 0.
};

struct ImportedMesh {
    Mesh mesh;
    uint32_t weldedVertices = 0;   ///< Vertices that shared a position with an earlier one.
    uint32_t droppedTriangles = 0; ///< Zero-area ones, before or after welding.
};

/// All sub-meshes as one, node transforms applied (where one mirrors, triangles are turned round: their fronts stay
/// fronts), vertices with equal positions welded, zero-area triangles dropped. An index that names no vertex is an
/// error. One call at a time: the log of Assimp is the process's.
Outcome<ImportedMesh> importMesh(const std::filesystem::path& file, const MeshFileOptions& options = {});

/** \brief Finds the file a scene speaks of.
`glmark2:NAME` is looked for in $GNOMON_DATA_DIR/models and /usr/share/glmark2/models; a relative path in
`sceneFolder`, then in $GNOMON_DATA_DIR. Fails with the list of places that were tried.
*/
Outcome<std::filesystem::path> findMeshFile(const std::string& reference, const std::filesystem::path& sceneFolder);

/// Position-equal vertices become one; indices follow. \return how many vertices went away.
uint32_t weldPositions(Mesh& mesh);

/// Drops triangles whose double-precision area is zero, and vertices nothing uses any more. \return triangles dropped.
uint32_t dropZeroArea(Mesh& mesh);

} // namespace gnomon::demo
