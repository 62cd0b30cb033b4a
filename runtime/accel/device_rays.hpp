#pragma once
// Rays on the device: acceleration structures of the meshes that lights want traced, and one of the frame's casters.
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "runtime/accel/compacted_sizes.hpp"
#include "runtime/passes/pass_builder.hpp"
#include "runtime/vk/device_table.hpp"

namespace gnomon {

/// What was counted of a light's casters, so that it is counted again only when it may be different.
struct UnbuiltCasters {
    struct Part {
        std::uint64_t stamp = 0; ///< LightCasters::staticStamp or dynamicStamp.
        std::uint32_t casters = 0;
        std::uint64_t triangles = 0;
    };
    Part statics, dynamics;
    std::uint64_t asOf = 0; ///< Of structures built and lost.
    std::uint64_t turn = 0; ///< Of the newest answer.
    std::uint32_t answer = 0;
};

/// A structure for each mesh and a top level over the casters of the lights that trace. All are persistent buffers of
/// the pool: counted in the memory limit, given back when no frame has used them for a second, taken back with a frame
/// that is dropped. A mesh is built when a light wants it. One that deforms is refitted in the frame that sees its new
/// positions; of others a copy without the room that the build left unused takes the structure's place as soon as the
/// device has said how large that is. One thread, the frame's.
class DeviceRays {
public:
    /// @param inFrame whatever is missing is built in the frame that needs it, however much that is
    DeviceRays(const DeviceTable& vk, bool inFrame) : vk_(vk), inFrame_(inFrame), sizes_(vk) {}

    /// A frame begins, or is tried again.
    void begin();

    /// Triangles that a frame builds beside all else it does; more is spread over frames. 2 ms at 131 million a second.
    /// 2 ms is what a frame's builds are to take at most by A. Dunn, "Tips and Tricks: Ray Tracing Best Practices"
    /// (NVIDIA, 2019). A GPU of 2013 made almost 40 million triangles a second into trees of high quality (T. Karras
    /// and T. Aila, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", HPG 2013): 7 ms there.
    /// Builds of drivers have not been measured on a GPU.
    static constexpr std::uint32_t kBuiltPerFrame = 1u << 18;

    /// How many of a light's casters have to be built before it can be traced; 0: what is missing, the frame builds.
    /// That takes of kBuiltPerFrame, so the lights of a frame are asked in the order in which they may have it.
    /// @param known of the same light, from frame to frame
    std::uint32_t unbuilt(const PassBuilder& passes, const LightCasters& casters, UnbuiltCasters& known);
    /// The frame traces these. Before declare().
    void need(const LightCasters& casters);
    /// They are to be traced soon.
    void want(const LightCasters& casters);
    /// The builds of all that is needed, once a frame, and the scene to trace. Null where a buffer could not be made,
    /// as the builder knows, or `casters` are not all among what was needed.
    const TracedScene* declare(PassBuilder& passes, const LightCasters& casters);
    /// Builds some of what is wanted, as much as there is time for, in a task of no light.
    void declareWanted(PassBuilder& passes);

private:
    struct MeshStructure {
        std::uint64_t used = 0;                                     ///< Newest turn that declared it.
        std::uint64_t positions = 0;                                ///< MeshView::revision then.
        std::uint64_t faces = 0;                                    ///< MeshView::faces, of the sizes.
        bool deforms = false;                                       ///< The positions have changed: it can be refitted.
        VkDeviceSize size = 0, buildScratch = 0, updateScratch = 0; ///< Bytes.
        VkDeviceSize compactSize = 0;                               ///< Bytes of the copy; 0: not known.
        std::uint64_t compactStamp = 0;                             ///< contentOf() the mesh that has this size.
        VkDeviceAddress address = 0;                                ///< In the turn `used`; 0: it could not be made.

        BufferInfo whole(std::uint32_t mesh) const;   ///< As it is built.
        BufferInfo compact(std::uint32_t mesh) const; ///< The copy.
    };
    struct Build {
        VkAccelerationStructureGeometryKHR triangles{};
        std::uint32_t count = 0; ///< Of them.
        BufferId structure;
        bool deforms = false, refit = false;
        VkDeviceSize scratch = 0;    ///< Bytes.
        std::uint64_t sizeQuery = 0; ///< CompactedSizes; 0: none.
    };
    struct Compaction {
        BufferId from, to;
    };
    struct SizeAsked {
        BufferId structure;
        std::uint64_t query; ///< CompactedSizes
    };
    /// Stamp of a mesh's structure: a copy on the CPU that has arrived may number triangles again, at the same
    /// revision.
    static std::uint64_t contentOf(const MeshView& mesh);
    /// What is known of a caster in one turn.
    struct Checked {
        std::uint64_t turn = 0;
        bool missing = false;
    };
    bool isBuilt(const PassBuilder& passes, const Caster& caster) const;
    bool isMissing(const PassBuilder& passes, const Caster& caster);
    UnbuiltCasters::Part count(const PassBuilder& passes, std::span<const Caster* const> casters, std::uint64_t stamp);
    bool isNeeded(const Caster& caster) const;
    void findSizes(MeshStructure& structure, const MeshView& mesh) const;
    void findTopSizes(std::uint32_t instances);
    bool declareScene(PassBuilder& passes);
    bool declareMesh(PassBuilder& passes, const MeshView& mesh);
    bool declareCompact(PassBuilder& passes, const MeshView& mesh, MeshStructure& structure);
    void askSize(PassBuilder& passes, const MeshView& mesh, const MeshStructure& structure, KeptParts parts);
    void declareCompactions(PassBuilder& passes, std::uint32_t variant);
    void declareSizes(PassBuilder& passes, std::uint32_t variant);
    bool declareBuilds(PassBuilder& passes, std::uint32_t variant);
    bool declareTopLevel(PassBuilder& passes);
    void forgetTurn();
    void forgetUnused();

    const DeviceTable& vk_;
    bool inFrame_;
    std::uint64_t turn_ = 0;       ///< Counts begin().
    std::uint64_t builtEver_ = 0;  ///< Structures of meshes, refits and copies, too.
    std::uint64_t builtAnew_ = 0;  ///< Without these.
    std::uint64_t promised_ = 0;   ///< Triangles of this turn, to lights that unbuilt() lets.
    std::uint64_t building_ = 0;   ///< Triangles of this turn, refits not counted.
    std::vector<Checked> checked_; ///< By Caster::index.
    std::unordered_map<std::uint32_t, MeshStructure> meshes_; ///< By MeshView::id.
    std::size_t forgetAt_ = 64;                               ///< As many of these.
    std::vector<std::uint64_t> neededIn_;                     ///< By Caster::index: the newest turn.
    std::vector<const Caster*> needed_, wanted_;              ///< Of this turn.
    std::vector<Build> builds_;                               ///< Under declaration.
    std::vector<Compaction> compactions_;                     ///< Likewise.
    std::vector<SizeAsked> asked_;                            ///< Likewise.
    CompactedSizes sizes_;
    std::uint32_t topInstances_ = 0;            ///< At most, of the sizes below.
    VkDeviceSize topSize_ = 0, topScratch_ = 0; ///< Bytes.
    TracedScene scene_;
    bool declared_ = false;
    bool tried_ = false; ///< declare() has been called in this turn.
};

} // namespace gnomon
