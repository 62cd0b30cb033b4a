#pragma once
// The full-screen pass that turns a map into visibility, for every map that is compared on the receiver's plane.
#include <array>
#include <span>

#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/map_lookup.hpp"

namespace gnomon {

/// What every look-up in a map reads, as map_receiver.glsl has it: 0 constants, 2 depth, 3 normals, 4 the map.
std::array<BindingInfo, 4> lookupBindings(bool layers);

/// The images behind bindings 2 to 4.
struct LookupImages {
    LookupImages(const ShadowTask& task, ImageId map);
    void uses(PassRef& pass) const;

    ImageId depth, normals, map; ///< A shader variant without normals never reads them, but needs an image: depth.
    bool hasNormals;
};

/// The full-screen pass that asks a map: it writes the task's layer of visibility where the light reaches pixels, and
/// what is not asked is lit.
class LookupPass {
public:
    LookupPass(PassBuilder& passes, const ShadowTask& task, const char* name, const LookupImages& look);
    /// Writes another image of the view's extent. @param otherwise what the pixels have that the light does not reach
    LookupPass(PassBuilder& passes, const ShadowTask& task, const char* name, const LookupImages& look, ImageId target,
               VkClearValue otherwise);

    PassRef uses; ///< For what the shader uses beside the look's images.

    /// Ends the declaration. @param bind (PassContext&): binds the pipeline; copied bytewise
    template <typename Bind>
    void record(const Bind& bind)
    {
        uses.record([bind, pixels = pixels_](PassContext& gpu) {
            if (!gpu.clipTo(pixels)) return;
            bind(gpu);
            gpu.drawFullscreen();
        });
    }

private:
    void writes(const CameraView& view, ImageId target, const Part& part);

    VkRect2D pixels_; ///< Where the light reaches.
};

/// What a resolve shader of a family is called, where its code is and what it is given.
struct MapResolveInfo {
    const char* name = "";                    ///< Pass and pipelines.
    std::span<const std::uint32_t> fragment;  ///< Specialization: 0 has normals, 1 filtered, 2 point light.
    std::span<const std::uint32_t> cube = {}; ///< For point lights, whose map is a 2D array; empty: there are none.
    bool layers = false;                      ///< The map of `fragment` is a 2D array.
    bool filters = true;                      ///< The shader looks at 1.
    /// Buffers and images beside lookupBindings(), kMostMore; static storage. Maps have layers where the map has.
    std::span<const BindingInfo> more = {};
    SamplerKind sampler = SamplerKind::nearestBorderFar; ///< Of the map.
    VkFormat format = VK_FORMAT_R8_UNORM;                ///< Of what it writes.
};

/// How a map is looked up.
struct Lookup {
    static constexpr std::size_t kMostMore = 3;
    struct Input {
        ImageId image; ///< Null: the buffer.
        BufferId buffer;
    };

    bool filtered = false;
    std::array<Input, kMostMore> more{}; ///< For MapResolveInfo::more, in its order.
    ImageId target{};                    ///< Null: the task's layer of visibility.
    VkClearValue otherwise{};            ///< What pixels of the target have that the light does not reach.
};

class MapResolve {
public:
    MapResolve(const AlgorithmServices& services, const MapResolveInfo& info);

    /// @param constants those of mapConstants(), or a block that begins with them
    template <typename Constants>
    void declare(PassBuilder& passes, const ShadowTask& task, ImageId map, const Constants& constants,
                 const Lookup& lookup) const
    {
        const LookupImages look(task, map);
        const Constants* block = passes.arena().make(constants);
        LookupPass pass = passOf(passes, task, look, lookup);
        pass.record([=, pipeline = pipelineOf(*task.light, look, lookup.filtered), inputs = lookup.more, more = more_,
                     sampler = sampler_](PassContext& gpu) {
            std::array<Bound, 4 + Lookup::kMostMore> bound = {gpu.constants(0, *block), gpu.sampled(2, look.depth),
                                                              gpu.sampled(3, look.normals),
                                                              gpu.sampled(4, look.map, sampler)};
            for (std::size_t i = 0; i < more.size(); ++i)
                bound[4 + i] = {.binding = more[i].binding,
                                .kind = more[i].kind,
                                .image = inputs[i].image,
                                .buffer = inputs[i].buffer};
            gpu.bind(pipeline, std::span(bound).first(4 + more.size()));
        });
    }
    void declare(PassBuilder& passes, const ShadowTask& task, ImageId map, const gpu::MapConstants& constants) const
    {
        declare(passes, task, map, constants, {.filtered = constants.map.filterSide > 1.0f});
    }

private:
    LookupPass passOf(PassBuilder& passes, const ShadowTask& task, const LookupImages& look,
                      const Lookup& lookup) const;
    PipelineId pipelineOf(const LightView& light, const LookupImages& look, bool filtered) const
    {
        return pipelines_[hasCube_ && light.type == GN_LIGHT_TYPE_POINT][look.hasNormals][filtered];
    }

    const char* name_;
    std::span<const BindingInfo> more_;
    SamplerKind sampler_;
    bool hasCube_;
    PipelineId pipelines_[2][2][2]; ///< [point light][has normals][filtered]
};

/// Odd side of the filter's box from the setting `filter`: an even one counts as the next odd one.
std::uint32_t filterSide(double setting);

/// Settings of maps with kernels of all shapes (shaders/shared/kernels.glsl).
inline constexpr SettingSpec kKernelSideSetting = {
    "filter", "Texels per side of the kernel: 1 (the nearest texel), or odd up to 15.", 1, gpu::MAX_KERNEL_SIDE, 1};
inline constexpr SettingSpec kKernelSetting = {
    "kernel", "0: box of bilinear taps, 1: box of nearest texels, 2: tent, 3: 32 taps of a turned disc.", 0, 3, 0};

/// Texels around what a map has to cover, so that kernels of that side stay inside.
constexpr std::uint32_t kernelBorder(std::uint32_t side)
{
    return side <= gpu::MAX_FILTER_SIDE ? kMapBorderTexels : (side + 1) / 2;
}

} // namespace gnomon
