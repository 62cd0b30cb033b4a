#include <algorithm>
#include <cstring>

#include "runtime/vk/pipeline_create.hpp"

namespace gnomon {
namespace {

bool same(const ShaderInfo& a, const ShaderInfo& b) noexcept
{
    return a.code.data() == b.code.data() && a.code.size() == b.code.size() &&
           a.specializationCount == b.specializationCount &&
           std::equal(a.specialization, a.specialization + a.specializationCount, b.specialization);
}

bool same(const VkStencilOpState& a, const VkStencilOpState& b) noexcept
{
    return a.failOp == b.failOp && a.passOp == b.passOp && a.depthFailOp == b.depthFailOp &&
           a.compareOp == b.compareOp && a.compareMask == b.compareMask && a.writeMask == b.writeMask &&
           a.reference == b.reference;
}

bool same(const StencilInfo& a, const StencilInfo& b) noexcept
{
    return a.enable == b.enable && (!a.enable || (same(a.front, b.front) && same(a.back, b.back)));
}

bool sameState(const GraphicsPipelineInfo& a, const GraphicsPipelineInfo& b) noexcept
{
    return a.pushBytes == b.pushBytes && a.vertexStride == b.vertexStride && a.casters == b.casters &&
           a.transforms == b.transforms && a.topology == b.topology && a.cullMode == b.cullMode &&
           a.frontFace == b.frontFace && a.depthTest == b.depthTest && a.depthWrite == b.depthWrite &&
           a.depthCompare == b.depthCompare && a.depthClamp == b.depthClamp && same(a.stencil, b.stencil) &&
           a.colorMask == b.colorMask && a.blendScale == b.blendScale && a.colorFormat == b.colorFormat &&
           a.depthFormat == b.depthFormat;
}

std::vector<BindingInfo> sorted(std::span<const BindingInfo> bindings)
{
    std::vector<BindingInfo> result(bindings.begin(), bindings.end());
    std::sort(result.begin(), result.end(),
              [](const BindingInfo& a, const BindingInfo& b) { return a.binding < b.binding; });
    return result;
}

} // namespace

PipelineDescription::PipelineDescription(const GraphicsPipelineInfo& info)
    : graphics(info), bindings(info.bindings.begin(), info.bindings.end())
{
    bindings = sorted(bindings);
    graphics.bindings = {}; // the caller's; `bindings` is ours
}

PipelineDescription::PipelineDescription(const ComputePipelineInfo& info)
    : isCompute(true), compute(info), bindings(sorted(info.bindings))
{
    compute.bindings = {};
}

bool PipelineDescription::operator==(const PipelineDescription& other) const noexcept
{
    if (isCompute != other.isCompute || std::strcmp(name(), other.name()) != 0) return false;
    if (bindings != other.bindings) return false;
    if (isCompute) return same(compute.compute, other.compute.compute) && compute.pushBytes == other.compute.pushBytes;
    return same(graphics.vertex, other.graphics.vertex) && same(graphics.fragment, other.graphics.fragment) &&
           sameState(graphics, other.graphics);
}

} // namespace gnomon
