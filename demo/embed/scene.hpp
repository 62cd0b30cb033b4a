// What is seen: a model from a file on a floor, a pane of glass beside it, three lights, a camera. No Vulkan.
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <glm/glm.hpp>

namespace embed {

struct Object {
    const char* name;
    glm::vec4 colour;                                          // a below 1: glass
    uint32_t firstVertex, vertexCount, firstIndex, indexCount; // indices count from firstVertex
};

struct Scene {
    std::vector<glm::vec3> positions; // world, metres, y up; fronts are counter-clockwise
    std::vector<uint32_t> indices;
    std::vector<Object> objects; // the glass last

    void add(const char* name, glm::vec4 colour, const std::vector<glm::vec3>& at, const std::vector<uint32_t>& of)
    {
        objects.push_back({name, colour, uint32_t(positions.size()), uint32_t(at.size()), uint32_t(indices.size()),
                           uint32_t(of.size())});
        positions.insert(positions.end(), at.begin(), at.end());
        indices.insert(indices.end(), of.begin(), of.end());
    }
};

/// \param file Any that Assimp reads (glTF, OBJ, ...). The model is scaled to a height of 2 m and put on the floor.
inline Scene loadScene(const std::string& file)
{
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* model = importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                                       aiProcess_FindDegenerates | aiProcess_SortByPType);
    std::vector<glm::vec3> at;
    std::vector<uint32_t> of;
    glm::vec3 low(HUGE_VALF), high(-HUGE_VALF);
    for (unsigned m = 0; model && m < model->mNumMeshes; ++m) {
        const aiMesh& mesh = *model->mMeshes[m];
        for (unsigned i = 0; i < 3 * mesh.mNumFaces; ++i)
            of.push_back(uint32_t(at.size()) + mesh.mFaces[i / 3].mIndices[i % 3]);
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            at.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
            low = glm::min(low, at.back());
            high = glm::max(high, at.back());
        }
    }
    if (of.empty()) throw std::runtime_error(file + ": no triangles. " + importer.GetErrorString());
    for (glm::vec3& p : at)
        p = (p - glm::vec3(0.5f * (low.x + high.x), low.y, 0.5f * (low.z + high.z))) * (2.0f / (high.y - low.y));

    Scene scene;
    const std::vector<uint32_t> quad{0, 1, 2, 0, 2, 3};
    scene.add("floor", {0.7f, 0.68f, 0.62f, 1.0f}, {{-8, 0, -8}, {-8, 0, 8}, {8, 0, 8}, {8, 0, -8}}, quad);
    scene.add("model", {0.85f, 0.5f, 0.35f, 1.0f}, at, of);
    scene.add("glass", {0.5f, 0.8f, 0.75f, 0.6f},
              {{0.9f, 0.1f, 2.2f}, {2.3f, 0.1f, 1.2f}, {2.3f, 1.5f, 1.2f}, {0.9f, 1.5f, 2.2f}}, quad);
    return scene;
}

struct Light { // as in shaders.glsl
    glm::vec4 positionAndRange, direction, colour;
};
inline constexpr std::array kLightNames{"sun", "spot", "lamp"}; // in the order of GnLightType
constexpr uint32_t kLights = kLightNames.size();
using Lights = std::array<Light, kLights>;

inline Lights lightsAt(double seconds)
{
    const glm::vec3 spot(3.5f, 4.5f, 2.5f);
    const float angle = 0.7f * float(seconds) + 2.4f;
    return {Light{glm::vec4(0.0f), {glm::normalize(glm::vec3(0.5f, -1.0f, -0.7f)), -1.0f}, {0.5f, 0.45f, 0.38f, 0.0f}},
            Light{{spot, 12.0f}, {glm::normalize(-spot), std::cos(0.35f)}, {1.2f, 0.9f, 0.5f, 1.0f}},
            Light{{2.2f * std::cos(angle), 1.5f, 2.2f * std::sin(angle), 7}, {0, 0, 0, -1}, {0.4f, 0.6f, 1.4f, 1.0f}}};
}

struct Camera {
    glm::vec3 eye;           // world, metres
    glm::mat3 worldFromView; // columns: right, up, back
    glm::mat4 clipFromView;  // reversed depth without a far plane; clip y goes down the image
    glm::mat4 clipFromWorld;
};

/// Looks at the model from a sphere about it. Radians, metres.
constexpr float kYaw = 0.6f, kPitch = 0.35f, kDistance = 4.6f; // at first
inline Camera orbit(float yaw, float pitch, float distance, float aspect)
{
    const glm::vec3 back(std::cos(pitch) * std::sin(yaw), std::sin(pitch), std::cos(pitch) * std::cos(yaw));
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back));
    const glm::mat3 worldFromView(right, glm::cross(back, right), back);
    const glm::vec3 eye = glm::vec3(0, 0.9f, 0) + distance * back;
    glm::mat4 viewFromWorld(glm::transpose(worldFromView));
    viewFromWorld[3] = viewFromWorld * glm::vec4(-eye, 0) + glm::vec4(0, 0, 0, 1);
    const glm::mat4 clipFromView({1.9f / aspect, 0, 0, 0}, {0, -1.9f, 0, 0}, {0, 0, 0, -1}, {0, 0, 0.1f, 0});
    return {eye, worldFromView, clipFromView, clipFromView * viewFromWorld};
}

} // namespace embed
