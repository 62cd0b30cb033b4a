#include "demo/scene/scene.hpp"

#include <algorithm>

namespace gnomon::demo {
namespace {

constexpr const char* kMergedName = "merged";

bool canMerge(const Instance& instance)
{
    return instance.isStatic && !instance.alphaTested && !instance.hostDrawn && instance.casterMask == 0xffffffffu &&
           instance.sides == Sides::ByMesh;
}

/// Keeps the meshes that instances use, in their order.
void dropUnusedMeshes(Scene& scene)
{
    std::vector<uint32_t> number(scene.meshes.size(), UINT32_MAX);
    for (const Instance& instance : scene.instances)
        number[instance.mesh] = 0;
    std::vector<Mesh> kept;
    for (size_t i = 0; i < number.size(); ++i) {
        if (number[i] == UINT32_MAX) continue;
        number[i] = static_cast<uint32_t>(kept.size());
        kept.push_back(std::move(scene.meshes[i]));
    }
    for (Instance& instance : scene.instances)
        instance.mesh = number[instance.mesh];
    scene.meshes = std::move(kept);
}

} // namespace

void append(Mesh& mesh, const Mesh& part, const Transform& transform)
{
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const glm::vec3& position : part.positions)
        mesh.positions.emplace_back(transform.apply(position));
    for (size_t i = 0; i < part.indices.size(); ++i)
        mesh.indices.push_back(first + part.indices[transform.cornerOf(i)]);
}

void mergeStatics(Scene& scene)
{
    Mesh merged;
    merged.name = kMergedName;
    glm::vec3 albedo(0.0f);
    std::vector<Instance> kept;
    for (const Instance& instance : scene.instances) {
        if (!canMerge(instance)) {
            kept.push_back(instance);
            continue;
        }
        const size_t before = merged.triangleCount();
        append(merged, scene.meshes[instance.mesh], instanceAt(instance, 0.0));
        albedo += instance.albedo * static_cast<float>(merged.triangleCount() - before);
    }
    if (merged.indices.empty()) return;
    Instance whole;
    whole.name = kMergedName;
    whole.mesh = static_cast<uint32_t>(scene.meshes.size());
    whole.isStatic = true;
    whole.albedo = albedo / static_cast<float>(merged.triangleCount());
    kept.insert(kept.begin(), whole);
    scene.meshes.push_back(std::move(merged));
    scene.instances = std::move(kept);
    dropUnusedMeshes(scene);
}

} // namespace gnomon::demo
