#include "algorithms/shared/screen_blur.hpp"

#include <algorithm>
#include <array>

#include "shaders/shared_fullscreen_vert.h"
#include "shaders/shared_screen_blur_frag.h"

namespace gnomon {

namespace {

constexpr VkFormat kOnceFormat = VK_FORMAT_R16_SFLOAT;

} // namespace

ScreenBlur::ScreenBlur(const AlgorithmServices& services, const char* rows, const char* columns)
    : rows_(rows), columns_(columns)
{
    std::array<BindingInfo, 5> bindings{};
    std::ranges::copy(lookupBindings(false), bindings.begin());
    bindings[3] = sampledAt(4, kSeenFormat);
    bindings[4] = sampledAt(5, kOnceFormat);
    for (const bool normals : {false, true})
        for (const bool last : {false, true})
            pipelines_[normals][last] =
                services.pipelines->graphics({.name = last ? columns : rows,
                                              .vertex = {.code = k_shared_fullscreen_vert},
                                              .fragment = {k_shared_screen_blur_frag, 2, {normals, last}},
                                              .bindings = bindings,
                                              .colorFormat = last ? VK_FORMAT_R8_UNORM : kOnceFormat});
}

ImageId ScreenBlur::declareSeen(PassBuilder& passes, const ShadowTask& task)
{
    return passes.transient(ImageInfo{.name = "screen_blur.seen", .format = kSeenFormat, .extent = task.view->extent});
}

void ScreenBlur::declare(PassBuilder& passes, const ShadowTask& task, ImageId seen,
                         const gpu::ScreenPenumbraConstants& constants) const
{
    const ImageId once =
        passes.transient(ImageInfo{.name = "screen_blur.once", .format = kOnceFormat, .extent = task.view->extent});
    const LookupImages look(task, seen);
    const auto bindings = [=, this, block = &constants](LookupPass& pass, bool last) {
        const ImageId source = last ? once : seen;
        pass.record([=, pipeline = pipelines_[look.hasNormals][last]](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, *block), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                                gpu.sampled(4, seen), gpu.sampled(5, source)});
        });
    };
    LookupPass rows(passes, task, rows_, look, once, kNotAsked);
    bindings(rows, false);
    LookupPass columns(passes, task, columns_, look);
    columns.uses.samples(once);
    bindings(columns, true);
}

VkDeviceSize ScreenBlur::memory(VkExtent2D extent)
{
    return storedImageSize(extent, 8) + storedImageSize(extent, 2);
}

} // namespace gnomon
