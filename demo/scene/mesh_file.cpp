#include "demo/scene/mesh_file.hpp"

#include "demo/scene/gltf_indices.hpp"

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <unordered_map>

namespace gnomon::demo {
namespace {

namespace fs = std::filesystem;

struct PositionHash {
    size_t operator()(const glm::vec3& p) const noexcept
    {
        // Positions are compared bit for bit after -0 became +0; three odd multipliers spread the words.
        const auto word = [](float value) { return uint64_t(std::bit_cast<uint32_t>(value)); };
        const uint64_t h =
            word(p.x) * 0x9e3779b97f4a7c15u ^ word(p.y) * 0xc2b2ae3d27d4eb4fu ^ word(p.z) * 0x165667b19e3779f9u;
        return static_cast<size_t>(h ^ (h >> 29));
    }
};

/// Readers of some formats hand on indices as the file has them, and post-processing looks the vertices up.
Status checkIndices(const aiMesh& part)
{
    for (unsigned f = 0; f < part.mNumFaces; ++f)
        for (unsigned corner = 0; corner < part.mFaces[f].mNumIndices; ++corner)
            if (const unsigned vertex = part.mFaces[f].mIndices[corner]; vertex >= part.mNumVertices)
                return Status::failure("mesh '" + std::string(part.mName.C_Str()) + "': face " + std::to_string(f) +
                                       " names vertex " + std::to_string(vertex) + " of " +
                                       std::to_string(part.mNumVertices) + ", counted from 0");
    return Done{};
}

/// Listens to Assimp while it lives: some readers put another vertex in place of one that is not there, or leave the
/// face out, and only say so.
class VertexComplaints final : public Assimp::LogStream {
public:
    VertexComplaints()
    {
        Assimp::DefaultLogger::create(nullptr, Assimp::Logger::NORMAL, 0);
        Assimp::DefaultLogger::get()->attachStream(this, Assimp::Logger::Warn | Assimp::Logger::Err);
    }
    ~VertexComplaints() override
    {
        Assimp::DefaultLogger::get()->detachStream(this, Assimp::Logger::Warn | Assimp::Logger::Err);
        Assimp::DefaultLogger::kill();
    }
    VertexComplaints(const VertexComplaints&) = delete;
    VertexComplaints& operator=(const VertexComplaints&) = delete;

    void write(const char* message) override
    {
        const std::string_view line(message);
        if (first_.empty() && line.find("ertex index") != std::string_view::npos)
            first_ =
                line.substr(line.find(": ") + 2, line.find_last_not_of("\r\n") - line.find(": ") - 1); // "Warn, T0: "
    }
    const std::string& first() const { return first_; } ///< Empty: none.

private:
    std::string first_;
};

bool appendSubMesh(Mesh& mesh, const aiMesh& part, const aiMatrix4x4& worldFromPart)
{
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
        const aiVector3D p = worldFromPart * part.mVertices[v];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
        mesh.positions.emplace_back(p.x, p.y, p.z);
    }
    // A mirror turns the order of corners round: the outside stays outside.
    const bool mirrors = worldFromPart.Determinant() < 0.0f;
    for (unsigned f = 0; f < part.mNumFaces; ++f)
        if (part.mFaces[f].mNumIndices == 3)
            for (unsigned corner = 0; corner < 3; ++corner)
                mesh.indices.push_back(first + part.mFaces[f].mIndices[mirrors ? 2 - corner : corner]);
    return true;
}

/// All meshes of a node and of those below it, in world space. False: a position is not finite.
bool appendNode(Mesh& mesh, const aiScene& scene, const aiNode& node, const aiMatrix4x4& worldFromParent)
{
    const aiMatrix4x4 worldFromNode = worldFromParent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m)
        if (!appendSubMesh(mesh, *scene.mMeshes[node.mMeshes[m]], worldFromNode)) return false;
    for (unsigned child = 0; child < node.mNumChildren; ++child)
        if (!appendNode(mesh, scene, *node.mChildren[child], worldFromNode)) return false;
    return true;
}

void fitToHeight(Mesh& mesh, float height)
{
    glm::vec3 low = mesh.positions.front(), high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const float extent = high.y - low.y;
    const float scale = extent > 0.0f ? height / extent : 1.0f;
    const glm::vec3 foot((low.x + high.x) * 0.5f, low.y, (low.z + high.z) * 0.5f);
    for (glm::vec3& p : mesh.positions)
        p = (p - foot) * scale;
}

std::optional<fs::path> dataFolder()
{
    const char* folder = std::getenv("GNOMON_DATA_DIR");
    if (folder == nullptr || *folder == '\0') return std::nullopt;
    return fs::path(folder);
}

} // namespace

uint32_t weldPositions(Mesh& mesh)
{
    std::unordered_map<glm::vec3, uint32_t, PositionHash> firstAt;
    firstAt.reserve(mesh.positions.size());
    std::vector<glm::vec3> unique;
    std::vector<uint32_t> newIndex(mesh.positions.size());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::vec3 position = mesh.positions[i] + glm::vec3(0.0f); // -0 + 0 = +0
        const auto [entry, isNew] = firstAt.try_emplace(position, static_cast<uint32_t>(unique.size()));
        if (isNew) unique.push_back(position);
        newIndex[i] = entry->second;
    }
    for (uint32_t& index : mesh.indices)
        index = newIndex[index];
    const auto removed = static_cast<uint32_t>(mesh.positions.size() - unique.size());
    mesh.positions = std::move(unique);
    return removed;
}

uint32_t dropZeroArea(Mesh& mesh)
{
    std::vector<uint32_t> kept;
    kept.reserve(mesh.indices.size());
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                         c = mesh.positions[mesh.indices[i + 2]];
        const glm::dvec3 doubleArea = glm::cross(b - a, c - a);
        if (glm::dot(doubleArea, doubleArea) > 0.0) kept.insert(kept.end(), &mesh.indices[i], &mesh.indices[i] + 3);
    }
    const auto dropped = static_cast<uint32_t>((mesh.indices.size() - kept.size()) / 3);
    mesh.indices = std::move(kept);

    constexpr uint32_t kUnused = ~0u;
    std::vector<uint32_t> newIndex(mesh.positions.size(), kUnused);
    std::vector<glm::vec3> used;
    for (uint32_t& index : mesh.indices) {
        if (newIndex[index] == kUnused) {
            newIndex[index] = static_cast<uint32_t>(used.size());
            used.push_back(mesh.positions[index]);
        }
        index = newIndex[index];
    }
    mesh.positions = std::move(used);
    return dropped;
}

Outcome<ImportedMesh> importMesh(const fs::path& file, const MeshFileOptions& options)
{
    const auto fail = [&file](const std::string& why) {
        return Outcome<ImportedMesh>::failure(file.string() + ": " + why);
    };
    if (const Status checked = checkGltf(file); !checked) return fail(checked.error());
    const VertexComplaints complaints;
    Assimp::Importer importer;
    // Only positions and faces matter; the rest would merely split vertices. Points and lines are dropped.
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                            aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                            aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(file.string(), 0);
    for (unsigned m = 0; scene != nullptr && m < scene->mNumMeshes; ++m)
        if (const Status checked = checkIndices(*scene->mMeshes[m]); !checked) return fail(checked.error());
    if (scene != nullptr)
        scene = importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_SortByPType);
    if (scene == nullptr) return fail(importer.GetErrorString());
    if (!complaints.first().empty()) return fail(complaints.first());

    ImportedMesh result;
    if (!appendNode(result.mesh, *scene, *scene->mRootNode, aiMatrix4x4()))
        return fail("a vertex position is not a finite number");
    const float turn = options.up == UpAxis::Z ? 1.0f : -1.0f; // a quarter turn about x, either way
    if (options.up != UpAxis::Y)
        for (glm::vec3& p : result.mesh.positions)
            p = {p.x, turn * p.z, -turn * p.y};
    result.weldedVertices = weldPositions(result.mesh);
    result.droppedTriangles = dropZeroArea(result.mesh);
    if (result.mesh.indices.empty()) return fail("no triangle of any area");
    if (options.fitHeight > 0.0f) {
        fitToHeight(result.mesh, options.fitHeight);
        // Rounding can bring two close vertices together.
        result.weldedVertices += weldPositions(result.mesh);
        result.droppedTriangles += dropZeroArea(result.mesh);
    }
    result.mesh.name = file.stem().string();
    return result;
}

Outcome<fs::path> findMeshFile(const std::string& reference, const fs::path& sceneFolder)
{
    constexpr std::string_view kGlmark = "glmark2:";
    std::vector<fs::path> candidates;
    if (reference.starts_with(kGlmark)) {
        const std::string name = reference.substr(kGlmark.size());
        if (const auto data = dataFolder()) candidates.push_back(*data / "models" / name);
        candidates.push_back(fs::path("/usr/share/glmark2/models") / name);
    } else {
        candidates.push_back(sceneFolder / reference); // an absolute reference replaces the folder
        if (const auto data = dataFolder()) candidates.push_back(*data / reference);
    }
    std::string tried;
    for (const fs::path& candidate : candidates) {
        std::error_code ignored; // what cannot be examined is not there for us either
        if (fs::is_regular_file(candidate, ignored)) return candidate;
        tried += (tried.empty() ? "" : ", ") + candidate.string();
    }
    return Outcome<fs::path>::failure("mesh file '" + reference + "' not found; tried " + tried);
}

} // namespace gnomon::demo
