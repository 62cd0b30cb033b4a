#include "demo/scene/mesh_file.hpp"
#include "demo/scene/primitives.hpp"
#include "demo/scene/scene_parts.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace gnomon::demo {
namespace {

/// Width and depth or width and height, as `size: [a, b]`.
void readSize(MapReader& map, float& first, float& second)
{
    const auto size = map.numbers("size");
    if (!size) return;
    first = static_cast<float>((*size)[0]);
    second = static_cast<float>((*size)[1]);
}

void readCells(MapReader& map, uint32_t& columns, uint32_t& rows)
{
    const auto cells = map.integers("cells");
    if (!cells) return;
    columns = (*cells)[0];
    rows = (*cells)[1];
}

void requireTriangles(MapReader& map, uint64_t count)
{
    if (count > kMostTrianglesPerMesh)
        raise(map.context(), map.node(),
              std::to_string(count) + " triangles are more than the limit of " + std::to_string(kMostTrianglesPerMesh));
}

/// Reads the shape's keys first, then checks them, and only then builds.
template <typename Make>
Mesh built(MapReader& map, const SceneFileOptions& options, uint64_t triangles, Make make)
{
    map.finish();
    requireTriangles(map, triangles);
    return options.buildMeshes ? make() : Mesh{};
}

Mesh readPlane(MapReader& map, const SceneFileOptions& options)
{
    PlaneShape s;
    readSize(map, s.width, s.depth);
    readCells(map, s.columns, s.rows);
    return built(map, options, 2ull * s.columns * s.rows, [&] { return makePlane(s); });
}

Mesh readBox(MapReader& map, const SceneFileOptions& options)
{
    const BoxShape s{glm::vec3(map.vector("size", glm::dvec3(1.0)))};
    return built(map, options, 12, [&] { return makeBox(s); });
}

Mesh readSphere(MapReader& map, const SceneFileOptions& options)
{
    SphereShape s;
    s.radius = map.numberF("radius", s.radius);
    s.slices = map.integer("slices", s.slices);
    s.stacks = map.integer("stacks", s.stacks);
    return built(map, options, 2ull * s.slices * (s.stacks - 1), [&] { return makeSphere(s); });
}

Mesh readTorus(MapReader& map, const SceneFileOptions& options)
{
    TorusShape s;
    s.radius = map.numberF("radius", s.radius);
    s.tube = map.numberF("tube", s.tube, {.high = s.radius, .highOpen = true});
    s.ringSegments = map.integer("ring_segments", s.ringSegments);
    s.tubeSegments = map.integer("tube_segments", s.tubeSegments);
    return built(map, options, 2ull * s.ringSegments * s.tubeSegments, [&] { return makeTorus(s); });
}

Mesh readTorusKnot(MapReader& map, const SceneFileOptions& options)
{
    TorusKnotShape s;
    s.radius = map.numberF("radius", s.radius);
    s.sweep = map.numberF("sweep", s.sweep, {.high = s.radius, .highOpen = true});
    s.tube = map.numberF("tube", s.tube, {.high = s.sweep, .highOpen = true});
    s.p = map.integer("p", s.p);
    s.q = map.integer("q", s.q);
    s.knotSegments = map.integer("knot_segments", s.knotSegments);
    s.tubeSegments = map.integer("tube_segments", s.tubeSegments);
    if (std::gcd(s.p, s.q) != 1) raise(map.context(), map.node(), "p and q must have no common factor");
    return built(map, options, 2ull * s.knotSegments * s.tubeSegments, [&] { return makeTorusKnot(s); });
}

Mesh readCylinder(MapReader& map, const SceneFileOptions& options)
{
    CylinderShape s;
    s.radius = map.numberF("radius", s.radius);
    s.topRadius = map.numberF("top_radius", s.radius);
    s.height = map.numberF("height", s.height);
    s.segments = map.integer("segments", s.segments);
    s.rings = map.integer("rings", s.rings);
    return built(map, options, 2ull * s.segments * (s.rings + 1), [&] { return makeCylinder(s); });
}

Mesh readColumn(MapReader& map, const SceneFileOptions& options)
{
    ColumnShape s;
    s.radius = map.numberF("radius", s.radius);
    s.height = map.numberF("height", s.height, {.low = 2.0 * s.radius, .lowOpen = true});
    s.segments = map.integer("segments", s.segments);
    s.rings = map.integer("rings", s.rings);
    return built(map, options, 2ull * s.segments * (s.rings + 5), [&] { return makeColumn(s); });
}

Mesh readArch(MapReader& map, const SceneFileOptions& options)
{
    ArchShape s;
    s.innerRadius = map.numberF("inner_radius", s.innerRadius);
    s.outerRadius = map.numberF("outer_radius", s.outerRadius, {.low = s.innerRadius, .lowOpen = true});
    s.depth = map.numberF("depth", s.depth);
    s.segments = map.integer("segments", s.segments);
    return built(map, options, 8ull * s.segments + 4, [&] { return makeArch(s); });
}

Mesh readTerrain(MapReader& map, const SceneFileOptions& options)
{
    TerrainShape s;
    readSize(map, s.width, s.depth);
    s.height = map.numberF("height", s.height);
    // Lattice coordinates must stay well inside 32 bits.
    s.featureSize = map.numberF("feature_size", s.featureSize, {.low = 1e-4 * double(std::max(s.width, s.depth))});
    s.thickness = map.numberF("thickness", s.thickness);
    readCells(map, s.columns, s.rows);
    s.seed = map.integer("seed", s.seed);
    const uint64_t walls = s.thickness > 0.0f ? 6ull * (s.columns + s.rows) : 0;
    return built(map, options, 2ull * s.columns * s.rows + walls, [&] { return makeTerrain(s); });
}

Mesh readCloth(MapReader& map, const SceneFileOptions& options)
{
    ClothShape s;
    readSize(map, s.width, s.height);
    s.amplitude = map.numberF("amplitude", s.amplitude);
    s.folds = map.numberF("folds", s.folds);
    readCells(map, s.columns, s.rows);
    return built(map, options, 2ull * s.columns * s.rows, [&] { return makeCloth(s); });
}

Mesh readCard(MapReader& map, const SceneFileOptions& options)
{
    CardShape s;
    readSize(map, s.width, s.height);
    return built(map, options, 2, [&] { return makeCard(s); });
}

Mesh readLeaves(MapReader& map, const SceneFileOptions& options)
{
    LeavesShape s;
    s.size = glm::vec3(map.vector("size", glm::dvec3(s.size)));
    s.length = map.numberF("length", s.length);
    s.width = map.numberF("width", s.width);
    s.count = map.integer("count", s.count);
    s.seed = map.integer("seed", s.seed);
    s.closed = map.boolean("closed", s.closed);
    s.blades = map.integer("blades", s.blades, {.high = s.closed ? 1.0 : 8.0});
    return built(map, options, (s.closed ? 8ull : 2ull * s.blades) * s.count, [&] { return makeLeaves(s); });
}

Mesh readBuilding(MapReader& map, const SceneFileOptions& options)
{
    BuildingShape s;
    readSize(map, s.width, s.depth);
    s.storey = map.numberF("storey", s.storey);
    s.floors = map.integer("floors", s.floors);
    s.bays = map.integer("bays", s.bays);
    s.sideBays = map.integer("side_bays", s.sideBays);
    // Between the walls, windows need room.
    s.recess = map.numberF("recess", s.recess, {.high = 0.25 * double(std::min(s.width, s.depth))});
    return built(map, options, triangleCount(s), [&] { return makeBuilding(s); });
}

struct ShapeReader {
    std::string_view key;
    Mesh (*read)(MapReader& map, const SceneFileOptions& options);
};

constexpr std::array kShapes = {
    ShapeReader{"plane", readPlane},
    ShapeReader{"box", readBox},
    ShapeReader{"sphere", readSphere},
    ShapeReader{"torus", readTorus},
    ShapeReader{"torus_knot", readTorusKnot},
    ShapeReader{"cylinder", readCylinder},
    ShapeReader{"column", readColumn},
    ShapeReader{"arch", readArch},
    ShapeReader{"terrain", readTerrain},
    ShapeReader{"cloth", readCloth},
    ShapeReader{"card", readCard},
    ShapeReader{"leaves", readLeaves},
    ShapeReader{"building", readBuilding},
};

/// "SHAPE: {...}", one of the keys of a map; null where there is none, or more.
const ShapeReader* findShape(MapReader& map)
{
    const ShapeReader* chosen = nullptr;
    uint32_t count = 0;
    for (const ShapeReader& shape : kShapes)
        if (map.has(shape.key)) {
            chosen = &shape;
            ++count;
        }
    return count == 1 ? chosen : nullptr;
}

/// The value may be left empty for all defaults.
Mesh readShape(MapReader& map, const ShapeReader& shape, const SceneFileOptions& options)
{
    YamlNode settings = *map.find(shape.key);
    if (settings.kind == YamlNode::Kind::Null) settings.kind = YamlNode::Kind::Map;
    MapReader reader(map.context(), settings, *shapes::kPart.at(shape.key).shape, std::string(shape.key));
    return shape.read(reader, options);
}

/// "parts: [{SHAPE: {...}, at, rotate, scale}, ...]": shapes put together.
Mesh readParts(const ReadContext& context, const YamlNode& list, const SceneFileOptions& options)
{
    if (list.kind != YamlNode::Kind::Sequence || list.children.empty())
        raise(context, list, "parts must be a list of at least one part");
    Mesh whole;
    for (const YamlNode& node : list.children) {
        MapReader map(context, node, shapes::kPart, "a part");
        const ShapeReader* shape = findShape(map);
        Instance part;
        part.pose = readPose(map);
        map.finish();
        if (shape == nullptr) raise(context, node, "a part must have exactly one shape");
        append(whole, readShape(map, *shape, options), instanceAt(part, 0.0));
        if (whole.triangleCount() > kMostTrianglesPerMesh)
            raise(context, node,
                  "with this part the mesh has more than " + std::to_string(kMostTrianglesPerMesh) + " triangles");
    }
    return whole;
}

Mesh readFile(MapReader& map, const YamlNode& fileNode, const std::string& name, const std::filesystem::path& folder,
              const SceneFileOptions& options, std::vector<std::string>& notes)
{
    const std::string reference = readText(map.context(), fileNode, "file");
    MeshFileOptions import;
    import.up = static_cast<UpAxis>(map.word("up", static_cast<size_t>(import.up)));
    import.fitHeight = map.numberF("fit_height", 0.0f);
    map.finish();
    if (!options.buildMeshes) return {};
    const auto path = findMeshFile(reference, folder);
    if (!path) raise(map.context(), fileNode, path.error());
    auto imported = importMesh(*path, import);
    if (!imported) raise(map.context(), fileNode, imported.error());
    if (imported->mesh.triangleCount() > kMostTrianglesPerMesh) requireTriangles(map, imported->mesh.triangleCount());
    if (imported->droppedTriangles > 0)
        notes.push_back("mesh '" + name + "': dropped " + std::to_string(imported->droppedTriangles) +
                        " zero-area triangles of " + path->string());
    return std::move(imported->mesh);
}

} // namespace

Mesh readMesh(const ReadContext& context, const std::string& name, const YamlNode& node,
              const std::filesystem::path& folder, const SceneFileOptions& options, std::vector<std::string>& notes)
{
    MapReader map(context, node, shapes::kMesh, "a mesh");
    Mesh mesh;
    if (const YamlNode* file = map.find("file")) {
        mesh = readFile(map, *file, name, folder, options, notes);
    } else if (const YamlNode* parts = map.find("parts")) {
        map.finish();
        mesh = readParts(context, *parts, options);
    } else {
        const ShapeReader* shape = findShape(map);
        map.finish();
        if (shape == nullptr) raise(context, node, "a mesh must have exactly one of 'file', 'parts' or a shape");
        mesh = readShape(map, *shape, options);
    }
    mesh.name = name;
    return mesh;
}

} // namespace gnomon::demo
