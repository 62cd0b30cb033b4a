#pragma once
// Barriers follow from declared accesses; nobody writes one by hand.
#include <vector>

#include "runtime/passes/resources.hpp"
#include "runtime/vk/device_table.hpp"

namespace gnomon {

struct AccessTraits;

/// Collects what a batch of passes needs and records it as one vkCmdPipelineBarrier2.
class BarrierBatch {
public:
    explicit BarrierBatch(const DeviceTable& vk) : vk_(vk) {}

    /// The layers will be used as `use` says by some pass of the batch. Passes of one batch agree on the layout.
    void image(PooledImage& image, std::uint32_t layer, std::uint32_t layerCount, const AccessTraits& use);
    void buffer(PooledBuffer& buffer, const AccessTraits& use);
    /// What the GPU wrote in readback buffers becomes visible to the CPU.
    void toHost();
    /// Transfers of the batch write over those of earlier frames, as progress marks do. The host has waited for these
    /// frames, which ends them, but not for the validation layer.
    void afterTransfers();
    /// Everything before ends before anything after begins: timed frames.
    void full(VkCommandBuffer cmd);
    /// Records what is needed before the batch; the states are as after it.
    void record(VkCommandBuffer cmd);
    /// Forgets what was collected and not recorded, as after a failure.
    void clear();

private:
    struct Layer {
        PooledImage* image;
        std::uint32_t layer;
    };
    void flush(PooledImage& image, std::uint32_t layer);
    void flush(PooledBuffer& buffer);
    void add(PooledImage& image, std::uint32_t layer, VkPipelineStageFlags2 source);
    const DeviceTable& vk_;
    std::vector<Layer> layers_; // used by the batch
    std::vector<PooledBuffer*> buffers_;
    std::vector<VkImageMemoryBarrier2> images_;
    VkMemoryBarrier2 memory_{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
};

} // namespace gnomon
