#include "algorithms/shared/cube_faces.hpp"

#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/map_lookup.hpp"

namespace gnomon {

namespace {

constexpr LayerNames kNames{"cube_faces.casters", "cube_faces.statics", "cube_faces.copy_statics"}; // of all faces

constexpr std::uint32_t kAllFaces = 0x3f;

} // namespace

std::span<LightFit> fitCubeFaces(Clamped clamped, const ShadowTask& task, std::uint32_t resolution, FrameArena& arena,
                                 std::uint32_t borderTexels)
{
    const Aabb bounds = sceneBounds(*task.casters);
    const std::span<LightFit> faces = arena.array<LightFit>(6);
    const float limit = nearLimit(clamped, task);
    for (std::uint32_t face = 0; face < 6; ++face) {
        faces[face] = fitCubeFace(*task.light, bounds, face, resolution, static_cast<float>(borderTexels));
        if (clamped != Clamped::none) raiseNearEnd(faces[face], resolution, limit);
    }
    return faces;
}

std::uint32_t neededCubeFaces(const ShadowTask& task)
{
    const Frustum visible = frustumOf(*task.view, *task.light);
    std::uint32_t needed = 0;
    for (std::uint32_t face = 0; face < 6; ++face)
        if (meetsPyramid(visible, task.light->position(), cubeFaceEdges(face))) needed |= 1u << face;
    return needed;
}

CubeMap declareCubeMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                       std::uint32_t resolution, std::uint32_t borderTexels, MapCulling culling)
{
    FrameArena& arena = passes.arena();
    const std::span<const LightFit> faces = fitCubeFaces(pipelines.clamped, task, resolution, arena, borderTexels);
    KeptMap map(passes, {.name = "cube_faces.depth",
                         .staticsName = "cube_faces.statics",
                         .stampName = "cube_faces.stamp",
                         .format = kMapFormat,
                         .resolution = resolution,
                         .layers = 6,
                         .form = borderForm(borderTexels),
                         .scope = culling == MapCulling::shadows ? Scope::task : Scope::light});
    const std::uint32_t needed = culling < MapCulling::parts ? kAllFaces : neededCubeFaces(task);
    const Frustum visible = frustumOf(*task.view, *task.light);
    // A texel spans 2 / resolution radians at most; filters stay within the border.
    const float reach = 2.0f * (static_cast<float>(borderTexels) + 1.0f) / static_cast<float>(resolution);
    const std::span<std::uint64_t> stamps = arena.array<std::uint64_t>(6);
    const std::span<KeptParts> parts = arena.array<KeptParts>(6);
    for (std::uint32_t face = 0; face < 6; ++face) {
        if ((needed >> face & 1) == 0) continue;
        // The light's revision stands for the position; of the fit, only the ends depend on casters.
        const std::uint64_t projection = Stamp().add(faces[face].nearWs).add(faces[face].farWs).value();
        const std::span<const Plane> volume =
            culling == MapCulling::none ? std::span<const Plane>() : faces[face].volume;
        const auto drawn = [&](std::span<const Caster* const> casters) {
            return castersSeen(culling, visible, task.light->position(), reach, castersIn(casters, volume, arena),
                               arena);
        };
        const LayerContent content =
            layerContent(*task.light, drawn(task.casters->statics), drawn(task.casters->dynamics), projection);
        stamps[face] = content.stamp;
        parts[face] =
            map.update(face, kNames, content, DepthCasters(pipelines, faces[face], task, resolution, arena, volume));
    }
    return {map.image(), faces.data(), resolution, needed, stamps.data(), parts.data()};
}

} // namespace gnomon
