#pragma once
// Which volumes a light draws in a view, and their drawing into the stencil: for every method that counts crossings.
#include <span>

#include "algorithms/volumes/view_stencil.hpp"
#include "algorithms/volumes/volume_list.hpp"
#include "runtime/algorithm.hpp"

namespace gnomon {

/// How crossings are counted in the stencil.
struct VolumeCounting {
    std::uint8_t bits = 0xff; ///< Of the count, from bit 0 on: it is kept modulo their number, other bits stay.
    std::uint8_t mask = 0;    ///< Count where this bit is set only; 0: everywhere.
    VkFormat color = VK_FORMAT_R8_UNORM; ///< Of the pass, which has an attachment beside the stencil.
};

/// What the device makes corners of.
enum class VolumeShape : std::uint8_t {
    lists,    ///< Silhouettes and caps that the CPU has found (volume_list.hpp).
    allEdges, ///< All edges and faces of the mesh (edge_list.hpp).
};

struct VolumePipelineNames {
    const char *zPass, *zFail;
    const char* caps = nullptr; ///< Of allEdges; lists are drawn with zFail.
};
/// By reversed depth.
struct VolumePipelines {
    VolumeShape shape = VolumeShape::lists;
    PipelineId zPass[2], zFail[2], caps[2];
};
VolumePipelines makeVolumePipelines(const AlgorithmServices& services, const VolumePipelineNames& names,
                                    const VolumeCounting& counting, VolumeShape shape = VolumeShape::lists);

/// A run of indirect commands for one volume.
struct VolumeDraw {
    VolumeSource source;
    Aabb bounds;       ///< Of the source, world.
    BufferId list;     ///< Indices.
    BufferId commands; ///< Of the list itself, unless the method has others made of them.
    std::uint32_t firstCommand = 0, commandCount = 0;
    std::uint32_t times = 1;      ///< Drawn so often.
    BufferId planes;              ///< Of the mesh's faces, where the list's are of another pose.
    std::uint32_t firstPlane = 0; ///< AllEdgesPush::firstPlane
};

/// What is drawn for one light in one view; in the frame's arena.
struct VolumePlan {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    std::span<VolumeDraw> zPass, zFail, caps; ///< zFail: sides.
    VolumeList
        lists[6]; ///< Sides of static casters, of moving ones, caps of either; sides and caps of addMeshVolumes().
    BufferId commands[4];                 ///< Made of those of the lists; null ids: none.
    std::span<const BufferId> meshLists;  ///< Of allEdges.
    std::span<const BufferId> planeLists; ///< Likewise: VolumeDraw::planes.
    BufferId receiverBounds;
    bool bounded = true; ///< Volumes end behind the farthest visible receiver.
    VkRect2D pixels{};   ///< Where the light can reach.
};

/// Declares the lists and picks the volumes that the view can see. z-pass counts those that cannot hold any of the near
/// rectangle, z-fail the others, or all.
/// @param device null: silhouettes are found on the CPU
VolumePlan* planVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, bool bounded,
                        bool zFailForAll, const MeshVolumePipelines* device = nullptr);
/// The same from sides that are declared already, of the static and of the moving casters.
VolumePlan* planVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                        std::span<const VolumeList, 2> sides, bool bounded, bool zFailForAll);

// What planVolumes() is made of, for methods that choose among the volumes themselves.

/// A plan without draws yet, with room for all volumes of the task.
VolumePlan* emptyPlan(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, bool bounded);
/// The draw of the volume whose pieces start here; moves `piece` to the next volume's.
VolumeDraw drawAt(const VolumeList& list, std::uint32_t& piece);
/// Calls choose() with one draw per volume of the list that `wanted(bounds)` of the volume, and of its whole caster,
/// is true of.
template <typename Wanted, typename Choose>
void forDraws(const VolumeList& list, const Wanted& wanted, const Choose& choose)
{
    const Caster* refused = nullptr;
    for (std::uint32_t piece = 0; piece < list.pieces.size();) {
        const Caster* caster = list.pieces[piece].source.caster;
        const bool first = piece == 0 || list.pieces[piece - 1].source.caster != caster;
        if (first && !wanted(caster->bounds)) refused = caster;
        if (caster == refused) {
            ++piece;
            continue;
        }
        const VolumeDraw draw = drawAt(list, piece);
        if (wanted(draw.bounds)) choose(draw);
    }
}
/// Whether z-fail has to count a volume.
bool needsZFail(const VolumePlan& plan, const VolumeDraw& draw);
/// The draw as z-fail counts it.
///
/// An open mesh casts with both sides of its faces, and the host draws both. Before a closed cluster of one, with light
/// and eye outside, that is the same: as many of its faces look towards the light as away. From within it is not, nor
/// where it is turned inside out: then all faces count, and every side twice.
VolumeDraw asFailing(const VolumePlan& plan, VolumeDraw draw);
/// Adds those volumes of a list of sides that the view can see.
void addSides(VolumePlan& plan, const VolumeList& sides, bool zFailForAll);
/// Adds the caps, in task scope, of the draws from `firstFailing` on that z-fail counts. @return their list
/// @param device of declareCaps()
VolumeList addCaps(PassBuilder& passes, const ShadowTask& task, VolumePlan& plan, std::size_t firstFailing,
                   std::uint32_t variant, const MeshVolumePipelines* device = nullptr);
/// Adds the volumes of casters whose positions the GPU alone knows, sides and caps.
void addMeshVolumes(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& device, bool zFailForAll,
                    VolumePlan& plan);
inline void append(std::span<VolumeDraw>& draws, const VolumeDraw& draw)
{
    draws = {draws.data(), draws.size() + 1};
    draws.back() = draw;
}

/// positionEs[i] = dot(rows[i], vec4(positionOs, 1)).
void eyeRows(const Caster& caster, const CameraView& view, glm::vec4 (&rows)[3]);

/// Declares what drawVolumes() reads; the pass tests depth and writes stencil of the view's copy.
void usesVolumes(PassRef& pass, const VolumePlan& plan);

/// Counts all volumes of the plan, within the scissor that is set.
void drawVolumes(PassContext& gpu, const VolumePlan& plan, const VolumePipelines& pipelines);

/// Why a shader cannot read the sides of a task's casters, or null. Static storage.
const char* refusesReadSides(const DeviceTable& vk, const ShadowTask& task);

/// Whether a shader can read all lists of the task's casters, those of caps, too.
bool canReadLists(const DeviceTable& vk, const ShadowTask& task);

/// Why volumes cannot serve the task on this device, or null. Static storage.
const char* refusesVolumes(const DeviceTable& vk, const ShadowTask& task);

} // namespace gnomon
