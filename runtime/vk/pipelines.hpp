#pragma once
// Pipelines by description: created on a background thread, executed once on a tiny target (that is when a software
// device compiles), only then ready.
#include <cstdint>
#include <initializer_list>
#include <span>

#include "gnomon/gnomon.h"

namespace gnomon {

struct PipelineId {
    std::uint32_t index = UINT32_MAX;
    explicit operator bool() const { return index != UINT32_MAX; }
    bool operator==(const PipelineId&) const = default;
};

/// What a shader finds at a binding of set 0.
enum class BindingKind : std::uint8_t {
    constants,    ///< uniform block, filled by PassContext::constants (dynamic offset)
    sampledImage, ///< combined image sampler; view type by `array`
    storageImage,
    storageBuffer,
    structure, ///< accelerationStructureEXT; needs DeviceTable::rayQuery()
};
enum class SamplerKind : std::uint8_t {
    nearest,          ///< clamp to edge
    nearestBorderFar, ///< clamp to a border of depth 1
};

struct BindingInfo {
    std::uint32_t binding = 0;
    BindingKind kind = BindingKind::constants;
    VkFormat format = VK_FORMAT_UNDEFINED; ///< Images: what will be bound, for the warm-up draws.
    bool array = false;                    ///< Images: viewed as a 2D array.
    SamplerKind sampler = SamplerKind::nearest;
    bool powerOfTwo = false; ///< Images: sides are powers of two (maps), or arbitrary (screen).
    bool stencil = false;    ///< Images: the stencil aspect of a depth-stencil format is read.
    bool operator==(const BindingInfo&) const = default;
};
constexpr BindingInfo constantsAt(std::uint32_t binding)
{
    return {.binding = binding};
}
constexpr BindingInfo bufferAt(std::uint32_t binding)
{
    return {.binding = binding, .kind = BindingKind::storageBuffer};
}
/// An image as large as the screen.
constexpr BindingInfo sampledAt(std::uint32_t binding, VkFormat format)
{
    return {.binding = binding, .kind = BindingKind::sampledImage, .format = format};
}
/// An image whose sides are powers of two.
constexpr BindingInfo mapAt(std::uint32_t binding, VkFormat format, SamplerKind sampler = SamplerKind::nearest)
{
    return {.binding = binding,
            .kind = BindingKind::sampledImage,
            .format = format,
            .sampler = sampler,
            .powerOfTwo = true};
}
/// One that a shader writes.
constexpr BindingInfo storedMapAt(std::uint32_t binding, VkFormat format)
{
    return {.binding = binding, .kind = BindingKind::storageImage, .format = format, .powerOfTwo = true};
}

/// SPIR-V of one stage, static storage. Up to four 32-bit specialization constants with ids 0..3.
struct ShaderInfo {
    std::span<const std::uint32_t> code;
    std::uint32_t specializationCount = 0;
    std::uint32_t specialization[4] = {};
};

struct StencilInfo {
    bool enable = false;
    VkStencilOpState front{}; ///< Masks and reference as given here, not dynamic.
    VkStencilOpState back{};
};
/// The same of front and back; what a test fails leaves the stencil as it is.
constexpr StencilInfo stencilTest(VkCompareOp compare, std::uint32_t reference = 0,
                                  VkStencilOp pass = VK_STENCIL_OP_KEEP, std::uint32_t writeMask = 0)
{
    const VkStencilOpState both{VK_STENCIL_OP_KEEP, pass, VK_STENCIL_OP_KEEP, compare, 0xff, writeMask, reference};
    return {.enable = true, .front = both, .back = both};
}

/// A graphics pipeline for dynamic rendering. Viewport and scissor are dynamic; cull mode, front face and depth bias
/// values too where `casters` is set (PassContext::drawCasters sets them).
struct GraphicsPipelineInfo {
    const char* name = "";
    ShaderInfo vertex;
    ShaderInfo fragment; ///< May be empty.
    std::span<const BindingInfo> bindings;
    std::uint32_t pushBytes = 0;    ///< Push constants, all stages; at most 128.
    std::uint32_t vertexStride = 0; ///< 0: no vertex buffer. 12: vec3 at location 0; 16: vec4 at location 0.
    bool casters = false;           ///< Dynamic culling and bias, as PassContext::drawCasters sets them.
    bool transforms = false;        ///< The vertex shader includes shared/casters.glsl.
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkCullModeFlags cullMode = VK_CULL_MODE_NONE;
    VkFrontFace frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    bool depthTest = false;
    bool depthWrite = false;
    VkCompareOp depthCompare = VK_COMPARE_OP_ALWAYS;
    bool depthClamp = false; ///< Needs the feature; eligibility is the algorithm's to check.
    StencilInfo stencil;
    VkColorComponentFlags colorMask = 0xf; ///< 0 writes no colour.
    bool blendScale = false;               ///< result = source + destination * source alpha
    VkFormat colorFormat = VK_FORMAT_UNDEFINED;
    VkFormat depthFormat = VK_FORMAT_UNDEFINED; ///< Depth and/or stencil attachment.
};

struct ComputePipelineInfo {
    const char* name = "";
    ShaderInfo compute;
    std::span<const BindingInfo> bindings;
    std::uint32_t pushBytes = 0;
};

/// Hands out pipelines; equal descriptions (by name and code) are one pipeline.
class PipelineLibrary {
public:
    virtual ~PipelineLibrary() = default;
    virtual PipelineId graphics(const GraphicsPipelineInfo& info) = 0;
    virtual PipelineId compute(const ComputePipelineInfo& info) = 0;

    PipelineId compute(const char* name, const ShaderInfo& shader, std::initializer_list<BindingInfo> bindings,
                       std::uint32_t pushBytes = 0)
    {
        return compute({name, shader, {bindings.begin(), bindings.size()}, pushBytes});
    }
};

} // namespace gnomon
