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
#include <glm/gtc/matrix_transform.hpp>

namespace embed {

struct Object {
    const char* name;
    glm::vec4 colour;
    uint32_t first, count; // of the scene's corners
};

struct Scene {
    std::vector<glm::vec3> corners;           // three a triangle; world, metres, y up; fronts are counter-clockwise
    std::vector<Object> opaque, glass, cover; // the last: a triangle over the whole picture, in clip space
};

/// \param file Any that Assimp reads (glTF, OBJ, ...). The model is scaled to a height of 2 m and put on the floor.
inline Scene loadScene(const std::string& file)
{
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* model = importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                                       aiProcess_FindDegenerates | aiProcess_SortByPType);
    std::vector<glm::vec3> corners;
    glm::vec3 low(HUGE_VALF), high(-HUGE_VALF);
    for (unsigned m = 0; model && m < model->mNumMeshes; ++m) {
        const aiMesh& mesh = *model->mMeshes[m];
        for (unsigned i = 0; i < 3 * mesh.mNumFaces; ++i) {
            const aiVector3D& corner = mesh.mVertices[mesh.mFaces[i / 3].mIndices[i % 3]];
            corners.emplace_back(corner.x, corner.y, corner.z);
            low = glm::min(low, corners.back());
            high = glm::max(high, corners.back());
        }
    }
    if (corners.empty()) throw std::runtime_error(file + ": no triangles. " + importer.GetErrorString());
    for (glm::vec3& p : corners)
        p = (p - glm::vec3(0.5f * (low.x + high.x), low.y, 0.5f * (low.z + high.z))) * (2.0f / (high.y - low.y));

    Scene scene;
    const auto add = [&scene](const char* name, glm::vec4 colour, const std::vector<glm::vec3>& at) {
        const Object object{name, colour, uint32_t(scene.corners.size()), uint32_t(at.size())};
        scene.corners.insert(scene.corners.end(), at.begin(), at.end());
        return object;
    };
    const auto quad = [](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) { return std::vector{a, b, c, a, c, d}; };
    scene.opaque = {add("floor", {0.7f, 0.68f, 0.62f, 1}, quad({-8, 0, -8}, {-8, 0, 8}, {8, 0, 8}, {8, 0, -8})),
                    add("model", {0.85f, 0.5f, 0.35f, 1}, corners)};
    const auto pane = quad({0.9f, 0.1f, 2.2f}, {2.3f, 0.1f, 1.2f}, {2.3f, 1.5f, 1.2f}, {0.9f, 1.5f, 2.2f});
    scene.glass = {add("glass", {0.5f, 0.8f, 0.75f, 0.6f}, pane)};
    scene.cover = {add("cover", {}, {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}})};
    return scene;
}

struct Light { // as in shaders.glsl
    glm::vec4 position, direction, colour;
};
inline constexpr std::array kLightNames{"sun", "spot", "lamp"}; // in the order of GnLightType
constexpr uint32_t kLights = kLightNames.size();
using Lights = std::array<Light, kLights>;

inline Lights lightsAt(double seconds)
{
    const glm::vec3 sun = glm::normalize(glm::vec3(0.5f, -1.0f, -0.7f)), spot(3.5f, 4.5f, 2.5f);
    const float angle = 0.7f * float(seconds) + 2.4f;
    return {Light{{-sun, 0}, {sun, -1}, {0.5f, 0.45f, 0.38f, 0}},
            Light{{spot, 1}, {glm::normalize(-spot), std::cos(0.35f)}, {1.2f, 0.9f, 0.5f, 12}},
            Light{{2.2f * std::cos(angle), 1.5f, 2.2f * std::sin(angle), 1}, {0, 0, 0, -1}, {0.4f, 0.6f, 1.4f, 7}}};
}

/// Looks at the model from a sphere about it.
struct Camera {
    float yaw = 0.6f, pitch = 0.35f, distance = 4.6f; // radians, metres

    glm::vec3 centre() const { return {0, 0.9f, 0}; }
    glm::vec3 eye() const
    {
        const glm::vec3 back(std::cos(pitch) * std::sin(yaw), std::sin(pitch), std::cos(pitch) * std::cos(yaw));
        return centre() + distance * back;
    }
    glm::mat4 viewFromWorld() const { return glm::lookAt(eye(), centre(), glm::vec3(0, 1, 0)); }
    /// Reversed depth without a far plane; clip y goes down the image. \param aspect Width by height.
    static glm::mat4 clipFromView(float aspect)
    {
        return {{1.9f / aspect, 0, 0, 0}, {0, -1.9f, 0, 0}, {0, 0, 0, -1}, {0, 0, 0.1f, 0}};
    }
};

} // namespace embed
