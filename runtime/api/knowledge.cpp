// What is known of times from outside: a knowledge base that somebody measured, and timings for who measures one.
#include <array>

#include "runtime/api/context.hpp"
#include "runtime/cost/knowledge_base.hpp"

namespace gnomon {

namespace {

std::string_view kindOf(const DeviceTable& vk)
{
    if (vk.software) return "software";
    return vk.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ? "integrated" : "discrete";
}

} // namespace

Result<void> Context::loadKnowledge(std::string_view text, std::string_view fileName)
{
    const std::string file(fileName);
    cost::KnowledgeResult parsed = cost::parseKnowledge(text);
    if (!parsed.base) return Error{GN_ERROR_KNOWLEDGE, "KnowledgeRefused", file + ": " + parsed.error};
    takeKnowledge(std::move(*parsed.base), file);
    return {};
}

void Context::loadShippedKnowledge()
{
    takeKnowledge(cost::shippedKnowledge(), "shipped knowledge");
}

void Context::takeKnowledge(cost::KnowledgeBase base, const std::string& source)
{
    const std::string device = vk_->properties.deviceName;
    const FramePlan::Taught taught = plan_->teach(std::move(base), {device, kindOf(*vk_)});
    teachShared();
    if (taught.methods == 0)
        messages_.warn("KnowledgeEmpty",
                       source + ": no row of an algorithm of this build; predictions stay as they were");
    else if (!taught.same)
        messages_.info("KnowledgeForeign", source + ": measured on " + taught.device + ", not on " + device +
                                               "; the factor between them is learned from the first timed frames");
}

/// What the knowledge base in force says that lights share, to all methods there are.
void Context::teachShared() noexcept
{
    const cost::DeviceKnowledge* known = plan_->knowledge();
    if (!known || known->kind != kindOf(*vk_)) return;    // milliseconds of another kind of device say nothing here
    std::array<std::string_view, kMaxMethods> algorithms; // no memory is asked for: methods have just been added
    for (std::uint32_t m = 0; m < methods_->size(); ++m)
        algorithms[m] = (*methods_)[m].entry->name;
    history_.shared.teach(known->parts, {algorithms.data(), methods_->size()});
}

Result<const TimedLight*> Context::timedLight(GnView viewHandle, GnLight light)
{
    const View* view = views_.find(viewHandle);
    if (!view) return invalidHandle("view");
    const std::optional<SceneRegistry::LightInfo> info = scene_->lightInfo(light);
    if (!info) return invalidHandle("light");
    const auto memory = view->lights.find(info->id);
    return memory == view->lights.end() ? nullptr : plan_->timed(memory->second);
}

Result<GnLightTiming> Context::lightTiming(GnView view, GnLight light)
{
    const Result<const TimedLight*> timed = timedLight(view, light);
    if (!timed) return timed.error();
    if (!*timed) return GnLightTiming{};
    const auto& timing = (*timed)->timing;
    return GnLightTiming{.updated = timing.updated ? VK_TRUE : VK_FALSE,
                         .frame = timing.frame,
                         .pMethod = (*methods_)[(*timed)->method].name.c_str(),
                         .updateGpuMs = timing.updateGpuMs,
                         .updateCpuMs = timing.updateCpuMs,
                         .resolveGpuMs = timing.resolveGpuMs,
                         .resolveCpuMs = timing.resolveCpuMs};
}

Result<GnLightWorkload> Context::lightWorkload(GnView view, GnLight light)
{
    const Result<const TimedLight*> timed = timedLight(view, light);
    if (!timed) return timed.error();
    if (!*timed) return GnLightWorkload{};
    const cost::Workload& workload = (*timed)->workload;
    return GnLightWorkload{.type = workload.directional ? GN_LIGHT_TYPE_DIRECTIONAL
                                   : workload.point     ? GN_LIGHT_TYPE_POINT
                                                        : GN_LIGHT_TYPE_SPOT,
                           .still = workload.still ? VK_TRUE : VK_FALSE,
                           .frame = (*timed)->timing.frame,
                           .pixels = workload.pixels,
                           .casterTriangles = workload.casterTriangles,
                           .drawnTriangles = workload.drawnTriangles,
                           .casters = workload.casters,
                           .mapTexels = workload.mapTexels,
                           .sharing = workload.sharing,
                           .drawnPixels = workload.drawnPixels,
                           .viewPixels = workload.viewPixels,
                           .shadowPixels = workload.shadowPixels,
                           .treeLevels = workload.treeLevels,
                           .mapFilled = workload.mapFilled,
                           .mapTouched = workload.mapTouched,
                           .softPixels = workload.softPixels};
}

} // namespace gnomon
