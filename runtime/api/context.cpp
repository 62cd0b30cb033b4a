#include "runtime/api/context.hpp"

#include <algorithm>

#include "runtime/scene/bias.hpp"
#if GNOMON_WITH_YAML
#include "rules/yaml/shipped.hpp"
#endif

namespace gnomon {

namespace {

constexpr std::uint32_t kMaxFramesInFlight = 8;

std::vector<std::uint32_t> sharingFamilies(const GnContextCreateInfo& info)
{
    std::vector<std::uint32_t> families{info.queueFamilyIndex};
    for (std::uint32_t i = 0; i < info.visibilityQueueFamilyCount; ++i)
        if (std::find(families.begin(), families.end(), info.pVisibilityQueueFamilies[i]) == families.end())
            families.push_back(info.pVisibilityQueueFamilies[i]);
    return families;
}

VkDeviceSize defaultLimit(const DeviceTable& vk)
{
    VkDeviceSize largest = 0;
    for (std::uint32_t i = 0; i < vk.memory.memoryHeapCount; ++i)
        if (vk.memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            largest = std::max(largest, vk.heapBudget[i]);
    return largest / 2;
}

/// The distances by which shadows keep clear of what casts them allow for corners rounded to 1/256 pixel.
void remarkOnSubpixels(const DeviceTable& vk, const Messages& messages)
{
    constexpr std::uint32_t kBits = 8;
    const std::uint32_t bits = vk.properties.limits.subPixelPrecisionBits;
    if (bits >= kBits) return;
    messages.warn("SubPixelPrecision", "the device says it rasterises to 1/" + std::to_string(1u << bits) +
                                           " pixel; methods allow for 1/256, and are less exact than they say");
}

} // namespace

Context::Context(const GnContextCreateInfo& info)
    : messages_(info.pfnMessage, info.pUserData, info.pName),
      background_((info.flags & GN_CONTEXT_NO_BACKGROUND_BIT) == 0 && info.jobThreadCount != 1),
      timeEveryFrame_((info.flags & GN_CONTEXT_TIME_EVERY_FRAME_BIT) != 0)
{
}

Result<std::unique_ptr<Context>> Context::create(const GnContextCreateInfo& info)
{
    if (const GnContextCreateFlags other =
            info.flags & ~(GN_CONTEXT_TIME_EVERY_FRAME_BIT | GN_CONTEXT_NO_BACKGROUND_BIT | GN_CONTEXT_DEVICE_RAYS_BIT))
        return unknownFlags("GnContextCreateInfo::flags", other, "GnContextCreateFlagBits");
    if (info.framesInFlight > kMaxFramesInFlight)
        return Error{GN_ERROR_OUT_OF_RANGE, "FramesInFlight",
                     "framesInFlight is " + std::to_string(info.framesInFlight) + ", outside [1, 8]"};
    if ((info.pfnLockQueue == nullptr) != (info.pfnUnlockQueue == nullptr))
        return Error{GN_ERROR_NULL_ARGUMENT, "QueueLockHalf", "pfnLockQueue and pfnUnlockQueue go together"};
    if (info.visibilityQueueFamilyCount && !info.pVisibilityQueueFamilies)
        return Error{GN_ERROR_NULL_ARGUMENT, "QueueFamiliesMissing", "pVisibilityQueueFamilies is null"};
    std::unique_ptr<Context> context(new Context(info));
    if (Result<void> made = context->init(info); !made) return made.error();
    return context;
}

Result<void> Context::init(const GnContextCreateInfo& info)
{
    Result<std::unique_ptr<DeviceTable>> vk = loadDeviceTable(info);
    if (!vk) return vk.error();
    vk_ = std::move(*vk);
    for (std::uint32_t i = 0; i < info.visibilityQueueFamilyCount; ++i)
        if (info.pVisibilityQueueFamilies[i] >= vk_->queueFamilyCount)
            return Error{GN_ERROR_OUT_OF_RANGE, "QueueFamily",
                         "pVisibilityQueueFamilies[" + std::to_string(i) + "] is " +
                             std::to_string(info.pVisibilityQueueFamilies[i]) + "; the device has " +
                             std::to_string(vk_->queueFamilyCount) + " families"};
    remarkOnSubpixels(*vk_, messages_);
    pluginInterface_ = makePluginInterface(vk_->device, vk_->vkGetDeviceProcAddr);
    memory_ = std::make_unique<DeviceMemory>(*vk_, info.memoryLimit ? info.memoryLimit : defaultLimit(*vk_),
                                             sharingFamilies(info));
    jobs_ =
        std::make_unique<JobSystem>(info.pfnScheduleJob, info.pUserData, info.jobThreadCount, info.pfnThreadStarted);
#if GNOMON_WITH_EMBREE
    rays_ = std::make_unique<RayScene>();
#endif
    scene_ = std::make_unique<SceneRegistry>(*vk_, *memory_, *jobs_, rays_.get(), messages_, background_);
    samplers_ = std::make_unique<SamplerSet>(*vk_);
    if (Result<void> made = samplers_->create(); !made) return made;
    pipelines_ = std::make_unique<PipelineStore>(*vk_, *memory_, *samplers_);
    pipelines_->setWarmupSlopeBias(kOpenSlopeBias);
    if (info.pipelineCacheDataSize) beginPipelineCache(info);
    methods_ = std::make_unique<MethodTable>(*vk_, *pipelines_, *jobs_, messages_, background_);
    registry_ = builtinRegistry();
    if (Result<void> added = methods_->addBuiltins(registry_); !added) return added;
    pipelines_->setOwner(kRuntimeOwner);
    own_.describe(*pipelines_);
    images_.describe(*pipelines_);
    scene_->readBuffersBy(*pipelines_, kMeshOwner);
    selector_ = std::make_unique<Selector>(*methods_);
    plan_ = std::make_unique<FramePlan>(*methods_, vk_->software);
    loadShippedKnowledge();
    pool_ = std::make_unique<ResourcePool>(*memory_);
    graph_ = std::make_unique<PassGraph>(*pool_, arena_);
    if (vk_->rayQuery()) deviceRays_ = std::make_unique<DeviceRays>(*vk_, !background_);
    executor_ = std::make_unique<PassExecutor>(*vk_, *memory_, *pipelines_, *samplers_, *jobs_, *pool_, *graph_, info);
    return executor_->create(info.framesInFlight ? info.framesInFlight : 2);
}

void Context::beginPipelineCache(const GnContextCreateInfo& info)
{
    const std::string_view data(static_cast<const char*>(info.pPipelineCacheData), info.pipelineCacheDataSize);
    if (const Result<void> begun = pipelines_->beginCache(data); !begun)
        messages_.warn(begun.error().id, begun.error().text);
}

/// The one place that waits for all that is on the queue. @return false where the device may still use what is ours
bool Context::drain() noexcept
{
    if (executor_ && !std::exchange(drained_, true)) {
        finishUnderway();
        if (!lost_ || executor_->hung()) executor_->waitQueue();
    }
    if (methods_) methods_->finishBackground();
    if (scene_) scene_->finishBackground();
    return !executor_ || !executor_->hung();
}

void Context::abandon() noexcept
{
    try {
        messages_.warn("ContextAbandoned", "the device hangs; what it may still use is not destroyed");
    } catch (...) { // no memory for the words
    }
    jobs_.reset();
}

Context::~Context()
{
    drain();
    views_.forEach([&](View& view) {
        for (const std::unique_ptr<PooledImage>* image : {&view.visibility, &view.replaced})
            if (*image) memory_->destroy((*image)->gpu);
    });
    executor_.reset();
    graph_.reset();
    pool_.reset();
}

Result<void> Context::warmUp()
{
    return warmUp([](const Method&) { return true; });
}

Result<void> Context::warmUpMethod(const char* name)
{
    const Result<Method*> method = usableMethod(name);
    if (!method) return method.error();
    const auto wanted = [&](const Method& each) { return &each == *method || each.has(GN_TRAIT_FALLBACK_BIT); };
    if (Result<void> warm = warmUp(wanted); !warm) return warm;
    if (const Result<Method*> still = usableMethod(name); !still) return still.error();
    return {};
}

template <typename Wanted>
Result<void> Context::warmUp(Wanted&& wanted)
{
    finishUnderway();
    if (lost_) return Error{GN_ERROR_DEVICE_LOST, "DeviceLost", "the device is lost"};
    scene_->finishBackground();
    methods_->finishBackground();
    const bool own = own_.create(*pipelines_, messages_);
    jobs_->parallelFor(methods_->size(), 1, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        for (std::size_t i = begin; i < end; ++i)
            if (Method& method = (*methods_)[static_cast<std::uint32_t>(i)]; wanted(method))
                methods_->createNow(method);
    });
    return executor_->once([&](VkCommandBuffer cmd) -> Result<void> {
        if (own) {
            if (auto tried = pipelines_->recordWarmupDraws(cmd, kRuntimeOwner); !tried) return tried;
            own_.ready = true;
        }
        for (std::uint32_t i = 0; i < methods_->size(); ++i) {
            Method& method = (*methods_)[i];
            if (method.ready || method.unavailable || !wanted(method)) continue;
            if (methods_->failed(method)) continue;
            if (auto tried = pipelines_->recordWarmupDraws(cmd, i); !tried) return tried;
            method.ready = true;
        }
        return {};
    });
}

// --- views ---

Result<GnView> Context::createView(const GnViewCreateInfo& info)
{
    return views_.add(info, *vk_, *memory_, *pool_);
}

void Context::destroyView(GnView handle)
{
    View* const gone = views_.find(handle);
    if (!gone) return;
    finishUnderway();
    if (lost_) return;
    views_.makeRoomToTake(); // what may throw comes before what changes
    for (std::unique_ptr<PooledImage>* image : {&gone->visibility, &gone->replaced})
        if (*image) pool_->retire(std::exchange(*image, nullptr));
    std::erase_if(frame_.views, [&](const ViewFrame& viewFrame) { return viewFrame.view == gone; });
    const std::unique_ptr<View> view = views_.take(handle, newest_);
    for (auto& [id, memory] : view->lights)
        plan_->forget(memory);
}

Result<GnVisibility> Context::visibility(GnView handle)
{
    View* view = views_.find(handle);
    if (!view) return invalidHandle("view");
    if (!view->visibility)
        return Error{GN_ERROR_FRAME_ORDER, "NoFrameYet",
                     "view '" + view->name + "' has been in no frame yet, and was created without imageExtent"};
    const GpuImage& gpu = view->visibility->gpu;
    return GnVisibility{.image = gpu.image,
                        .imageView = gpu.view,
                        .extent = gpu.extent,
                        .layerCount = gpu.layers,
                        .revision = view->revision,
                        .format = gpu.format,
                        .lightsPerTexel = view->packed ? kPackedLights : 1};
}

// --- methods and rules ---

Result<Method*> Context::usableMethod(const char* name)
{
    Method* method = methods_->find(name);
    if (!method) return methods_->unknown(name);
    if (method->unavailable)
        return Error{GN_ERROR_FEATURE_MISSING, "MethodUnavailable",
                     "method '" + method->name + "': " + method->unavailable};
    return method;
}

Result<void> Context::setLightMethod(GnLight light, const char* name)
{
    const std::optional<SceneRegistry::LightInfo> info = scene_->lightInfo(light);
    if (!info) return invalidHandle("light");
    LightState& state = lights_[info->id];
    state.handle = light;
    if (!name) {
        state.pinned = UINT32_MAX;
        return {};
    }
    const Result<Method*> found = usableMethod(name);
    if (!found) return found.error();
    const Method* method = *found;
    if (!method->serves(info->type))
        return Error{GN_ERROR_UNKNOWN_METHOD, "MethodLightKind",
                     "method '" + method->name + "' does not serve the kind of light '" + std::string(info->name) +
                         "' is"};
    state.pinned = method->index;
    views_.forEach([&](View& view) { // asked for again, it is tried again
        if (const auto known = view.lights.find(info->id); known != view.lights.end())
            known->second.failures[method->index] = {};
    });
    return {};
}

template <typename Add>
Result<void> Context::admit(const char* name, GnTraits traits, Add&& add)
{
    if (Result<void> admitted = methods_->admits(name); !admitted) return admitted;
    Result<Selector::BoundRules> rules = selector_->boundWith(name, traits, registry_);
    if (!rules) return rules.error();
    if (Result<std::uint32_t> added = add(); !added) return added.error();
    selector_->adopt(std::move(*rules));
    teachShared();
    return {};
}

Result<void> Context::addMethod(const char* name, const char* algorithm)
{
    if (!name || !algorithm) return Error{GN_ERROR_NULL_ARGUMENT, "NameMissing", "pName and pAlgorithm are required"};
    const Result<const AlgorithmEntry*> entry = methods_->algorithm(algorithm);
    if (!entry) return entry.error();
    return admit(name, (*entry)->traits, [&] { return methods_->add(name, **entry); });
}

Result<void> Context::registerAlgorithm(const GnAlgorithmInfo& info)
{
    if (Result<void> ok = checkAlgorithmInfo(info); !ok) return ok;
    pluginAlgorithms_.reserve(pluginAlgorithms_.size() + 1);
    auto plugin = std::make_unique<PluginAlgorithm>(info);
    const AlgorithmEntry& entry = plugin->entry();
    if (auto admitted = admit(entry.name, entry.traits, [&] { return methods_->addEntry(entry); }); !admitted)
        return admitted;
    plugin->own();
    pluginAlgorithms_.push_back(std::move(plugin));
    return {};
}

Result<GnResult> Context::loadPlugin(GnContext self, const char* path)
{
    if (!path) return Error{GN_ERROR_NULL_ARGUMENT, "PathMissing", "pPath is null"};
    Result<std::unique_ptr<SharedObject>> object = SharedObject::open(path);
    if (!object) return object.error();
    plugins_.push_back(std::move(*object)); // stays even if it fails: it may have registered something
    const GnResult result = plugins_.back()->pluginMain()(self, &pluginInterface_);
    if (result >= 0) return result;
    return Error{result, "PluginMain",
                 "plug-in '" + std::string(path) + "': gnPluginMain returned " + gnResultName(result)};
}

Result<void> Context::setMethodSetting(const char* method, const char* setting, double value)
{
    if (!method || !setting) return Error{GN_ERROR_NULL_ARGUMENT, "NameMissing", "pMethod and pSetting are required"};
    return methods_->set(method, setting, value, newest_);
}

std::uint32_t Context::methods(const StructArray<GnMethodInfo>& out)
{
    for (std::uint32_t i = 0; i < std::min(methods_->size(), out.size()); ++i) {
        const Method& method = (*methods_)[i];
        out.put(i, {.pName = method.name.c_str(),
                    .pAlgorithm = method.entry->name,
                    .pSource = method.entry->source,
                    .traits = method.entry->traits,
                    .roundTrips = method.entry->roundTrips,
                    .ready = method.ready ? VK_TRUE : VK_FALSE,
                    .pUnavailable = method.unavailable,
                    .settingCount = static_cast<std::uint32_t>(method.settingInfos.size()),
                    .pSettings = method.settingInfos.data()});
    }
    return methods_->size();
}

Result<void> Context::loadRules(std::string_view text, std::string_view fileName)
{
    std::vector<rules::Diagnostic> findings;
    Result<void> loaded = selector_->loadRules(text, fileName, registry_, findings);
    sendFindings(findings);
    return loaded;
}

Result<void> Context::setPreset(std::string_view name)
{
    std::vector<rules::Diagnostic> findings;
    Result<void> set = selector_->setPreset(name, registry_, findings);
    sendFindings(findings);
    return set;
}

void Context::sendFindings(std::span<const rules::Diagnostic> findings)
{
    for (const rules::Diagnostic& finding : findings) {
        const bool error = finding.severity == rules::Severity::Error;
        messages_.send(error ? GN_SEVERITY_ERROR : GN_SEVERITY_WARNING, error ? GN_ERROR_RULES : GN_SUCCESS,
                       error ? "RuleError" : "RuleWarning", rules::toText(finding));
    }
}

Result<void> Context::loadShippedRules(std::string_view name)
{
#if GNOMON_WITH_YAML
    if (const std::string_view text = rules::shippedRuleBase(name); !text.empty()) return loadRules(text, name);
    std::string known;
    for (const rules::ShippedRuleBase& base : rules::shippedRuleBases())
        known += (known.empty() ? "" : ", ") + std::string(base.name);
    return Error{GN_ERROR_OUT_OF_RANGE, "RulesUnknown",
                 "no rule base '" + std::string(name) + "' comes with the library, but " + known};
#else
    return loadRules({}, name);
#endif
}

Result<GnLightMap> Context::lightMap(GnLight light)
{
    const std::optional<SceneRegistry::LightInfo> info = scene_->lightInfo(light);
    if (!info) return invalidHandle("light");
    ShadowAlgorithm::Map map{};
    for (const DeclaredMap& declared : frame_.maps) {
        if (declared.lightId != info->id || declared.beside) continue;
        if (!map.image)
            map = declared.map;
        else if (map.image.index == declared.map.image.index)
            map.validLayers |= declared.map.validLayers; // which another view needs
    }
    if (!map.image)
        return Error{GN_ERROR_UNKNOWN_METHOD, "NoLightMap",
                     "the method of light '" + std::string(info->name) + "' keeps no map"};
    const GpuImage& gpu = graph_->image(map.image).gpu;
    GnLightMap out{.image = gpu.image,
                   .imageView = gpu.view,
                   .format = gpu.format,
                   .extent = gpu.extent,
                   .layerCount = gpu.layers,
                   .validLayers = map.validLayers,
                   .clipFromWorld = {},
                   .origin = {origin_.at()[0], origin_.at()[1], origin_.at()[2]}};
    for (std::uint32_t i = 0; i < 6; ++i)
        for (int k = 0; k < 16; ++k)
            out.clipFromWorld[i][k] = map.clipFromWorld[i][k / 4][k % 4];
    return out;
}

} // namespace gnomon
