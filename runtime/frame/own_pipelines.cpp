#include "runtime/frame/own_pipelines.hpp"

#include "runtime/frame/frame.hpp"
#include "shaders/runtime_fade_mix_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

constexpr BindingInfo kMixBindings[] = {
    {.binding = 0, .kind = BindingKind::sampledImage, .format = VK_FORMAT_R8_UNORM, .array = true}};

} // namespace

void OwnPipelines::describe(PipelineLibrary& library)
{
    grid = DepthGrid::pipeline(library);
    mix = library.graphics({.name = "view.fade",
                            .vertex = {.code = k_shared_fullscreen_vert},
                            .fragment = {.code = k_runtime_fade_mix_frag},
                            .bindings = kMixBindings,
                            .pushBytes = sizeof(float),
                            .colorFormat = VK_FORMAT_R8_UNORM});
}

bool OwnPipelines::create(PipelineStore& store, const Messages& messages)
{
    if (ready || failed) return false;
    while (store.createNext(kRuntimeOwner)) {
    }
    const std::string failure = store.failure(kRuntimeOwner);
    if (!failure.empty()) fail(failure, messages);
    return failure.empty();
}

void OwnPipelines::fail(const std::string& why, const Messages& messages)
{
    failed = true;
    messages.warn("RuntimePipelines", "distances to receivers are not measured, and nothing fades: " + why);
}

} // namespace gnomon
