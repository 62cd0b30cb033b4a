#include "algorithms/omni/cut_casters.hpp"

#include <cstring>

#include "algorithms/shared/caster_lists.hpp"
#include "runtime/passes/pass_context.hpp"

namespace gnomon {

CutCasters CasterCutter::declare(PassBuilder& passes, const LightView& light, std::span<const Caster* const> casters,
                                 std::uint32_t group, std::uint32_t resolution)
{
    coarse_.clear();
    for (const Caster* caster : casters)
        if (!isFine(*caster, light, resolution)) coarse_.push_back(caster);
    if (coarse_.empty()) return {};

    Kept& kept = kept_.find(light.id, group);
    const float angle = maxEdgeAngle(resolution);
    const std::uint64_t stamp = Stamp().add(light.revision).add(angle).add(coarse_).value();
    if (kept.stamp != stamp) {
        kept.stamp = 0; // of half a mesh, should there be no memory for all of it
        cutToAngle(coarse_, light, angle, kept.mesh);
        kept.stamp = stamp;
    }
    const FineMesh* mesh = &kept.mesh;
    const std::uint32_t variant = resolution * 2 + group;
    CutCasters cut;
    cut.closedIndices = mesh->closedIndices;
    cut.openIndices = static_cast<std::uint32_t>(mesh->indices.size()) - mesh->closedIndices;
    cut.vertices = passes.persistent(BufferInfo{.name = "paraboloid.cut_vertices",
                                                .scope = Scope::light,
                                                .size = mesh->vertices.size() * sizeof(glm::vec3),
                                                .place = BufferPlace::upload,
                                                .variant = variant});
    cut.indices = passes.persistent(BufferInfo{.name = "paraboloid.cut_indices",
                                               .scope = Scope::light,
                                               .size = mesh->indices.size() * sizeof(std::uint32_t),
                                               .place = BufferPlace::upload,
                                               .variant = variant});
    const bool verticesDue = passes.stale(cut.vertices, stamp), indicesDue = passes.stale(cut.indices, stamp);
    if (!verticesDue && !indicesDue) {
        passes.kept();
        return cut;
    }
    passes.prepare("paraboloid.cut", Scope::light, variant)
        .writes(cut.vertices)
        .writes(cut.indices)
        .run([=](HostContext& host) {
            std::memcpy(host.write<glm::vec3>(cut.vertices).data(), mesh->vertices.data(),
                        mesh->vertices.size() * sizeof(glm::vec3));
            std::memcpy(host.write<std::uint32_t>(cut.indices).data(), mesh->indices.data(),
                        mesh->indices.size() * sizeof(std::uint32_t));
            host.countIndexList();
        });
    return cut;
}

} // namespace gnomon
