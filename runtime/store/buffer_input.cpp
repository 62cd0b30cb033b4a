#include "runtime/store/buffer_input.hpp"

#include <algorithm>

#include "runtime/base/struct_size.hpp"

namespace gnomon {
namespace {

Error outOfRange(Subject what, const char* id, const std::string& text)
{
    return {GN_ERROR_OUT_OF_RANGE, id, what.text() + ": " + text};
}

Error unsupported(Subject what, const char* id, const std::string& text)
{
    return {GN_ERROR_UNSUPPORTED, id, what.text() + ": " + text};
}

std::uint32_t bytesOf(VkFormat format)
{
    if (format == VK_FORMAT_R32G32B32_SFLOAT) return 12;
    return format == VK_FORMAT_R16G16B16A16_SFLOAT || format == VK_FORMAT_R16G16B16A16_SNORM ? 8 : 0;
}

struct RangeIds {
    const char *null, *offset, *tooSmall, *tooLarge;
};
constexpr RangeIds kMeshRange{"MeshBufferNull", "MeshBufferOffset", "MeshBufferTooSmall", "MeshTooLarge"};
constexpr RangeIds kTransformRange{"TransformBufferNull", "TransformBufferOffset", "TransformBufferTooSmall",
                                   "TransformsTooLarge"};

/// What is needed of it. @param part "positions", "indices" or "transforms" @param need bytes from the offset on
Result<VkDescriptorBufferInfo> readRange(Subject what, const char* part, const VkDescriptorBufferInfo& range,
                                         std::uint64_t unit, std::uint64_t need, const MeshLimits& limits,
                                         const RangeIds& ids = kMeshRange)
{
    const std::string name = part;
    if (!range.buffer) return Error{GN_ERROR_NULL_ARGUMENT, ids.null, what.text() + ": " + name + ".buffer is null"};
    if (range.offset % unit != 0)
        return outOfRange(what, ids.offset,
                          name + ".offset is " + std::to_string(range.offset) + ", not a multiple of " +
                              std::to_string(unit));
    if (range.range == VK_WHOLE_SIZE || range.range < need)
        return outOfRange(what, ids.tooSmall,
                          name + ".range is " +
                              (range.range == VK_WHOLE_SIZE ? "VK_WHOLE_SIZE" : std::to_string(range.range)) + "; " +
                              std::to_string(need) + " bytes are needed");
    constexpr std::uint64_t kMostAlignment = 256; // Vulkan's limit of minStorageBufferOffsetAlignment
    if (need + kMostAlignment <= limits.bufferBytes) return VkDescriptorBufferInfo{range.buffer, range.offset, need};
    return Error{GN_ERROR_TOO_MANY, ids.tooLarge,
                 what.text() + ": " + name + " are " + std::to_string(need) + " bytes long; the device reads " +
                     std::to_string(limits.bufferBytes)};
}

Result<void> readScale(Subject what, const GnMeshBuffers& buffers, BufferMeshLayout& layout)
{
    static constexpr const char* kScale[] = {"positionScale[0]", "positionScale[1]", "positionScale[2]"};
    static constexpr const char* kBias[] = {"positionBias[0]", "positionBias[1]", "positionBias[2]"};
    for (int i = 0; i < 3; ++i) {
        if (Result<void> check = checkNumber(what, buffers.positionScale[i], kScale[i]); !check) return check;
        if (Result<void> check = checkNumber(what, buffers.positionBias[i], kBias[i]); !check) return check;
    }
    const bool none = std::all_of(std::begin(buffers.positionScale), std::end(buffers.positionScale),
                                  [](float scale) { return scale == 0.0f; });
    for (int i = 0; i < 3; ++i) {
        layout.scale[i] = none ? 1.0f : buffers.positionScale[i];
        layout.bias[i] = buffers.positionBias[i];
    }
    return {};
}

Result<void> readPositionLayout(Subject what, const GnMeshCreateInfo& info, const GnMeshBuffers& buffers,
                                BufferMeshLayout& layout)
{
    const std::uint32_t bytes = bytesOf(buffers.positionFormat);
    if (bytes == 0)
        return unsupported(what, "MeshPositionFormat",
                           "positionFormat " + std::to_string(buffers.positionFormat) +
                               " is none of R32G32B32_SFLOAT, R16G16B16A16_SFLOAT and R16G16B16A16_SNORM");
    layout.format = buffers.positionFormat;
    layout.stride = info.positionStride ? info.positionStride : bytes;
    layout.positionCount = info.positionCount;
    if (layout.stride < bytes || layout.stride % 4 != 0)
        return outOfRange(what, "MeshPositionStride",
                          "positionStride " + std::to_string(layout.stride) + " is not a multiple of 4, at least " +
                              std::to_string(bytes));
    return readScale(what, buffers, layout);
}

Result<VkDescriptorBufferInfo> readIndexLayout(Subject what, const GnMeshCreateInfo& info, const GnMeshBuffers& buffers,
                                               const MeshLimits& limits, BufferMeshLayout& layout)
{
    const Result<std::uint32_t> count = readIndexCount(what, info, buffers.indices.buffer != VK_NULL_HANDLE);
    if (!count) return count.error();
    layout.indexCount = *count;
    if (!buffers.indices.buffer) {
        if (*count <= layout.positionCount) return VkDescriptorBufferInfo{};
        return outOfRange(what, "MeshIndexOutOfRange",
                          "indexCount is " + std::to_string(*count) + " without indices, past the " +
                              std::to_string(layout.positionCount) + " vertices");
    }
    if (buffers.indexType != VK_INDEX_TYPE_UINT16 && buffers.indexType != VK_INDEX_TYPE_UINT32)
        return unsupported(what, "MeshIndexType",
                           "indexType " + std::to_string(buffers.indexType) + " is neither UINT16 nor UINT32");
    layout.indexBytes = buffers.indexType == VK_INDEX_TYPE_UINT16 ? 2 : 4;
    layout.vertexOffset = buffers.vertexOffset;
    // The shader reads words of four bytes.
    const std::uint64_t before = buffers.indices.offset % 4;
    const std::uint64_t need = (before + std::uint64_t{*count} * layout.indexBytes + 3) / 4 * 4 - before;
    return readRange(what, "indices", buffers.indices, layout.indexBytes, need, limits);
}

} // namespace

Result<VkDescriptorBufferInfo> readPositionRange(Subject what, const BufferMeshLayout& layout,
                                                 const VkDescriptorBufferInfo& positions, const MeshLimits& limits)
{
    const std::uint64_t need = std::uint64_t{layout.positionCount - 1} * layout.stride + bytesOf(layout.format);
    return readRange(what, "positions", positions, 4, need, limits);
}

Result<TransformArray> readTransformArray(Subject what, const GnTransformBuffer& transforms, std::uint32_t count,
                                          const MeshLimits& limits)
{
    constexpr std::uint32_t kBytes = 48;
    static constexpr const char* kOrigin[] = {"origin[0]", "origin[1]", "origin[2]"};
    TransformArray out{.stride = transforms.stride ? transforms.stride : kBytes,
                       .mirrored = transforms.mirrored != VK_FALSE};
    if (out.stride < kBytes || out.stride % 4 != 0)
        return outOfRange(what, "TransformStride",
                          "stride " + std::to_string(out.stride) + " is not a multiple of 4, at least 48");
    if (!transforms.pBounds)
        return Error{GN_ERROR_NULL_ARGUMENT, "TransformBoundsNull", what.text() + ": pBounds is null"};
    for (int i = 0; i < 3; ++i) {
        if (Result<void> check = checkNumber(what, transforms.origin[i], kOrigin[i]); !check) return check.error();
        out.origin[i] = transforms.origin[i];
    }
    const std::uint64_t need = std::uint64_t{count - 1} * out.stride + kBytes;
    const Result<VkDescriptorBufferInfo> range =
        readRange(what, "transforms", transforms.transforms, 4, need, limits, kTransformRange);
    if (!range) return range.error();
    out.range = *range;
    return out;
}

Result<Aabb> readPlacedBounds(Subject what, const GnTransformBuffer& transforms, std::uint32_t element)
{
    const float* six = transforms.pBounds + std::size_t{6} * element;
    Result<Aabb> bounds = readBounds(what, {six[0], six[1], six[2]}, {six[3], six[4], six[5]});
    if (bounds) return bounds;
    Error error = bounds.error();
    error.text = "pBounds of element " + std::to_string(element) + ": " + error.text;
    return error;
}

Result<BufferMeshInput> readMeshInBuffers(const GnMeshCreateInfo& info, const MeshLimits& limits)
{
    const Subject what{"mesh", info.pName};
    const Result<GnMeshBuffers> buffers = readStruct<GnMeshBuffers>(info.pBuffers, "pBuffers");
    if (!buffers) return buffers.error();
    if (info.pPositions || info.pIndices)
        return outOfRange(what, "MeshTwice",
                          std::string(info.pPositions ? "pPositions" : "pIndices") + " and pBuffers are both given");
    if (const GnMeshFlags other = info.flags & ~GnMeshFlags{GN_MESH_NO_CPU_COPY_BIT | GN_MESH_CLOSED_BIT})
        return outOfRange(what, "OutOfRange",
                          "flags has " + std::to_string(other) + ", which is none of GnMeshFlagBits");

    BufferMeshInput out;
    out.name = info.pName ? info.pName : "";
    const std::uint64_t bytes = std::max(std::uint64_t{12} * info.positionCount, std::uint64_t{4} * info.indexCount);
    if (Result<void> fits = checkMeshSize(what, info.positionCount, bytes, limits); !fits) return fits.error();
    if (Result<void> ok = readPositionLayout(what, info, *buffers, out.layout); !ok) return ok.error();
    const Result<VkDescriptorBufferInfo> indices = readIndexLayout(what, info, *buffers, limits, out.layout);
    if (!indices) return indices.error();
    const Result<VkDescriptorBufferInfo> positions = readPositionRange(what, out.layout, buffers->positions, limits);
    if (!positions) return positions.error();
    const Result<bool> turned = readFrontFace(what, info.frontFace);
    if (!turned) return turned.error();
    const Result<Aabb> bounds = readBounds(what, buffers->boundsMin, buffers->boundsMax);
    if (!bounds) return bounds.error();
    out.layout.turned = *turned;
    out.layout.closed = (info.flags & GN_MESH_CLOSED_BIT) != 0;
    out.layout.noCpuCopy = (info.flags & GN_MESH_NO_CPU_COPY_BIT) != 0;
    out.bounds = *bounds;
    out.positions = *positions;
    out.indices = *indices;
    return out;
}

} // namespace gnomon
