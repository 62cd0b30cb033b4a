// What is known of times from outside: a knowledge base that somebody measured, and timings for who measures one.
#include <array>

#include "runtime/api/context.hpp"
#include "runtime/cost/knowledge_base.hpp"

namespace gnomon {

Result<void> Context::loadKnowledge(std::string_view text, std::string_view fileName)
{
    const std::string file(fileName);
    cost::KnowledgeResult parsed = cost::parseKnowledge(text);
    if (!parsed.base) return Error{GN_ERROR_KNOWLEDGE, "KnowledgeRefused", file + ": " + parsed.error};
    for (const std::string& finding : parsed.base->findings)
        messages_.warn("KnowledgeRow", file + ": " + finding);
    if (parsed.base->rows.empty() && parsed.base->rejected > 0)
        return Error{GN_ERROR_KNOWLEDGE, "KnowledgeRefused",
                     file + ": none of its " + std::to_string(parsed.base->rejected) + " rows can be used"};
    const std::string device = vk_->properties.deviceName;
    const cost::Learned learned = plan_->teach(std::move(*parsed.base), device);
    teachShared();
    if (learned.rows == 0)
        messages_.warn("KnowledgeEmpty",
                       file + ": no row of an algorithm of this build; predictions stay as they were");
    else if (!learned.sameDevice)
        messages_.info("KnowledgeForeign", file + ": measured on " + learned.device + ", not on " + device +
                                               "; the factor between them is learned from the first timed frames");
    return {};
}

/// What the knowledge base in force says that lights share, to all methods there are.
void Context::teachShared() noexcept
{
    std::array<std::string_view, kMaxMethods> algorithms; // no memory is asked for: methods have just been added
    for (std::uint32_t m = 0; m < methods_->size(); ++m)
        algorithms[m] = (*methods_)[m].entry->name;
    history_.shared.teach(plan_->knowledge().parts, vk_->properties.deviceName, {algorithms.data(), methods_->size()});
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
                           .mapTouched = workload.mapTouched};
}

} // namespace gnomon
