#pragma once
// The host's depth and normals as methods read them: one 2D image of D32_SFLOAT values that belong to a near plane
// across the view, and one of 16-bit or 32-bit floats. What is not so is copied, once a view.
#include <array>
#include <string>

#include "gnomon/gnomon.h"
#include "runtime/base/result.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/vk/pipeline_store.hpp"

namespace gnomon {

/// Lights in a texel of packed visibility.
constexpr std::uint32_t kPackedLights = 4;

/// Whether methods read a copy.
bool copiesDepth(const CameraView& view);
bool copiesNormals(const CameraView& view);

/// The pipelines that copy. Each is made when a view first wants it.
class HostImages {
public:
    void describe(PipelineStore& store);

    /// @return the copy; its pass is declared. @param host the host's image
    Result<ImageId> copyDepth(PassGraph& graph, const CameraView& view, ImageId host);
    Result<ImageId> copyNormals(PassGraph& graph, const CameraView& view, ImageId host);

    /// What methods write in place of a packed visibility image: a layer a light.
    Result<ImageId> layersFor(PassGraph& graph, const CameraView& view, std::uint32_t lights);
    /// Declares the passes that pack them.
    void pack(PassGraph& graph, const CameraView& view, ImageId layers, ImageId packed, std::uint32_t lights);

private:
    struct Copy {
        const char* name;
        VkFormat format;
        std::uint32_t way;
    };
    static constexpr std::uint32_t kKinds = 4; ///< Layered or not, of several samples or not.
    Result<ImageId> declare(PassGraph& graph, const CameraView& view, ImageId host, std::uint32_t pipeline,
                            const Copy& copy);

    /// @return why the pipeline cannot be made, or empty
    std::string make(std::uint32_t pipeline);

    PipelineStore* store_ = nullptr;
    std::array<PipelineId, 2 * kKinds + 1> pipelines_; ///< The last one packs.
};

} // namespace gnomon
