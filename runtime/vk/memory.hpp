#pragma once
// Images, buffers and the blocks they live in.
#include <cstdint>
#include <mutex>
#include <vector>

#include "runtime/vk/device_table.hpp"

namespace gnomon {

/// A piece of a 64 MiB block, or a block of its own.
struct MemorySlice {
    std::uint32_t block = UINT32_MAX;
    VkDeviceSize offset = 0; ///< In the VkDeviceMemory.
    VkDeviceSize size = 0;
};

/// Where the heap of the memory type that serves best is full, the next best type is taken: slower, but it serves.
enum class MemoryUse : std::uint8_t {
    device,   ///< Device-local.
    upload,   ///< Host-visible and coherent, device-local if that is free.
    readback, ///< Host-visible, coherent and cached.
};

struct GpuImage {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;        ///< 2D array over all layers; depth aspect for depth formats.
    VkImageView stencilView = VK_NULL_HANDLE; ///< 2D, stencil aspect, where the format has one and layers == 1.
    std::vector<VkImageView> layerViews;      ///< 2D, one per layer (attachment: all aspects of the format).
    std::vector<VkImageView> layerSampled;    ///< 2D, one per layer, depth aspect only; equals layerViews where the
                                              ///< format has a single aspect (then not owned twice).
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    std::uint32_t layers = 1;
    VkImageUsageFlags usage = 0;
    MemorySlice memory;
};

struct GpuBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize size = 0;
    std::byte* mapped = nullptr; ///< Null for MemoryUse::device unless the device has one kind of memory only.
    VkAccelerationStructureKHR structure = VK_NULL_HANDLE; ///< That fills the buffer; of createStructure().
    VkDeviceAddress address = 0; ///< Of `structure`, else of the buffer; 0 without SHADER_DEVICE_ADDRESS.
    MemorySlice memory;
};

struct ImageCreate {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    std::uint32_t layers = 1;
    VkImageUsageFlags usage = 0;
    const char* name = "";
    bool concurrent = false; ///< Shared with the host's other queue families (visibility).
};

/// Sub-allocates blocks of 64 MiB, Vulkan's or the host's; never more than the limit in total. Safe from several
/// threads.
class DeviceMemory {
public:
    DeviceMemory(const DeviceTable& vk, VkDeviceSize limit, std::vector<std::uint32_t> sharingFamilies);
    ~DeviceMemory();
    DeviceMemory(const DeviceMemory&) = delete;
    DeviceMemory& operator=(const DeviceMemory&) = delete;

    Result<GpuImage> createImage(const ImageCreate& info);
    Result<GpuBuffer> createBuffer(VkDeviceSize size, VkBufferUsageFlags usage, MemoryUse use, const char* name);
    /// An acceleration structure in a buffer of its own. @pre rayQuery()
    Result<GpuBuffer> createStructure(VkDeviceSize size, VkAccelerationStructureTypeKHR type, const char* name);
    void destroy(GpuImage& image) noexcept; ///< At once; retiring until the GPU is done is the caller's.
    void destroy(GpuBuffer& buffer) noexcept;

    VkDeviceSize used() const noexcept; ///< Bytes in live slices.
    VkDeviceSize held() const noexcept; ///< Bytes of all blocks; this is what the limit bounds.
    VkDeviceSize limit() const noexcept { return limit_; }
    /// The GPU has memory of its own, and upload buffers lie elsewhere: what it reads of them comes over a bus.
    bool uploadIsFar() const noexcept { return uploadIsFar_; }

private:
    struct Block;
    Result<MemorySlice> allocate(const VkMemoryRequirements& needs, MemoryUse use, bool linear);
    void release(const MemorySlice& slice) noexcept;
    VkDeviceMemory memoryOf(const MemorySlice& slice, std::byte** mapped) const noexcept;
    Result<void> fillImage(GpuImage& image, const ImageCreate& info);
    Result<void> fillStructure(GpuBuffer& buffer, VkAccelerationStructureTypeKHR type, const char* name);
    Result<void> fillBuffer(GpuBuffer& buffer, VkBufferUsageFlags usage, MemoryUse use, const char* name);

    // With the mutex held.
    Result<MemorySlice> allocateOf(std::uint32_t type, const VkMemoryRequirements& needs, bool linear);
    Result<std::uint32_t> makeBlock(const VkMemoryRequirements& needs, std::uint32_t type, bool linear, bool own);
    Error overLimit(VkDeviceSize bytes, std::uint32_t type, bool linear) const;
    void freeEmptyBlocks() noexcept;
    void freeBlock(Block& block) noexcept;

    const DeviceTable& vk_;
    VkDeviceSize limit_;
    bool uploadIsFar_;
    std::vector<std::uint32_t> families_;
    mutable std::mutex mutex_;
    std::vector<Block> blocks_; ///< Slots stay where they are: slices name them by index.
    VkDeviceSize used_ = 0;
    VkDeviceSize held_ = 0;
};

VkImageAspectFlags aspectsOf(VkFormat format) noexcept;

} // namespace gnomon
