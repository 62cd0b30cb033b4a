#include "device/fixture.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "demo/host/pipelines.hpp"
#include "shaders/surface_frag.h"
#include "shaders/surface_vert.h"

namespace gnomon::test {
namespace {

using namespace demo;

constexpr uint32_t kSurfacePushBytes = 128; // surface.vert, surface.frag

VKAPI_ATTR VkResult VKAPI_CALL countedDeviceWaitIdle(VkDevice handle)
{
    ++vulkanCalls().deviceWaitIdle;
    return vkDeviceWaitIdle(handle);
}

VKAPI_ATTR VkResult VKAPI_CALL countedQueueWaitIdle(VkQueue queue)
{
    ++vulkanCalls().queueWaitIdle;
    return vkQueueWaitIdle(queue);
}

VKAPI_ATTR VkResult VKAPI_CALL countedQueueSubmit2(VkQueue queue, uint32_t count, const VkSubmitInfo2* submits,
                                                   VkFence fence)
{
    ++vulkanCalls().submits;
    return vkQueueSubmit2(queue, count, submits, fence);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL countedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    if (std::strcmp(name, "vkDeviceWaitIdle") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&countedDeviceWaitIdle);
    if (std::strcmp(name, "vkQueueWaitIdle") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&countedQueueWaitIdle);
    if (std::strcmp(name, "vkQueueSubmit2") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&countedQueueSubmit2);
    return vkGetDeviceProcAddr(handle, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL countedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&countedGetDeviceProcAddr);
    for (const char* counted : {"vkDeviceWaitIdle", "vkQueueWaitIdle", "vkQueueSubmit2"})
        if (std::strcmp(name, counted) == 0) return countedGetDeviceProcAddr(VK_NULL_HANDLE, name);
    return vkGetInstanceProcAddr(instance, name);
}

} // namespace

VulkanCalls& vulkanCalls()
{
    static VulkanCalls calls;
    return calls;
}

static bool validated = true;
static std::unique_ptr<Device> made;

void withoutValidation()
{
    validated = false;
}

Device& device()
{
    // gnomon_add_test(... UNVALIDATED), but in the row `full` of tests/matrix.sh
    const bool wanted = !std::getenv("GNOMON_TEST_UNVALIDATED") || std::getenv("GNOMON_TEST_FULL");
    if (!made) made = Device::create({.validation = validated && wanted});
    return *made;
}

void releaseDevice()
{
    made.reset();
}

DeviceTest::~DeviceTest()
{
    const std::vector<std::string> all = device().validation.messages();
    for (size_t i = before_; i < all.size() && i < before_ + 3; ++i)
        FAIL_CHECK("validation: " << all[i]);
    CHECK(device().validation.count() == before_);
}

// --- the scene as gnomon knows it ---

Host::Host(Scene wanted, const HostOptions& options)
    : scene(std::move(wanted)), geometry_(device(), scene), casterDrawer_(device(), geometry_),
      layout_(makePipelineLayout(device(), {}, kSurfacePushBytes,
                                 VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT)),
      pipeline_(makeGraphicsPipeline(device(), {.vertex = k_surface_vert,
                                                .fragment = k_surface_frag,
                                                .layout = layout_.get(),
                                                .readsPositions = true,
                                                .colour = options.target.normals,
                                                .depth = options.target.depth,
                                                .depthCompare = scene.depth.convention == DepthConvention::Standard
                                                                    ? VK_COMPARE_OP_LESS
                                                                    : VK_COMPARE_OP_GREATER,
                                                .samples = options.target.samples})),
      timeline_(makeTimeline(device())), readback_(device(), options.packed), extent_(options.extent),
      area_(options.area), target_(options.target), hidden_(scene.instances.size(), false), warmUp_(options.warmUp),
      warmAll_(options.warmAll)
{
    surfaces_.resize(options.viewCount);
    createSurfaces();
    slots_.resize(options.framesInFlight);
    for (Slot& slot : slots_) {
        const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                               .queueFamilyIndex = device().queueFamily};
        VkCommandPool pool = VK_NULL_HANDLE;
        vkCheck(vkCreateCommandPool(device().handle, &poolInfo, nullptr, &pool), "vkCreateCommandPool");
        slot.pool = {device().handle, pool};
        VkCommandBuffer buffers[2] = {};
        const VkCommandBufferAllocateInfo info{
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 2};
        vkCheck(vkAllocateCommandBuffers(device().handle, &info, buffers), "vkAllocateCommandBuffers");
        slot.before = buffers[0];
        slot.after = buffers[1];
    }
    createContext(options);
    if (options.mapSide > 0.0) fixMapSides(options.mapSide);
    createScene();
    views.resize(options.viewCount);
    for (GnView& view : views) {
        const GnViewCreateInfo info{.maxLights = options.maxLights,
                                    .pName = "test",
                                    .flags = options.packed ? GnViewCreateFlags{GN_VIEW_PACKED_BIT} : 0};
        require(gnCreateView(context, &info, &view));
    }
}

Host::~Host()
{
    wait(submission_);
    gnDestroyContext(context);
}

void Host::createContext(const HostOptions& options)
{
    GnContextCreateInfo info = device().contextInfo();
    info.flags |= options.flags;
    info.pfnGetInstanceProcAddr = &countedGetInstanceProcAddr;
    info.framesInFlight = options.framesInFlight;
    info.pfnMessage = &onMessage;
    info.pUserData = this;
    if (options.context) options.context(info);
    REQUIRE(gnCreateContext(&info, &context) == GN_SUCCESS);
}

void Host::createScene()
{
    for (const Mesh& mesh : scene.meshes) {
        const GnMeshCreateInfo info{.pName = mesh.name.c_str(),
                                    .pPositions = &mesh.positions[0].x,
                                    .positionCount = static_cast<uint32_t>(mesh.positions.size()),
                                    .positionStride = sizeof(glm::vec3),
                                    .indexCount = static_cast<uint32_t>(mesh.indices.size()),
                                    .pIndices = mesh.indices.data()};
        require(gnCreateMesh(context, &info, &meshes.emplace_back()));
    }
    hostDrawn_.resize(scene.instances.size());
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const MeshRange& range = geometry_.meshes[instance.mesh];
        hostDrawn_[i] = {&casterDrawer_, &scene.meshes[instance.mesh], range, instance.alphaTested,
                         instanceAt(instance, 0.0)};
        GnInstanceCreateInfo info{};
        if (instance.isStatic) info.flags |= GN_INSTANCE_STATIC_BIT;
        if (instance.alphaTested) info.flags |= GN_INSTANCE_ALPHA_TESTED_BIT;
        if (instance.hostDrawn) info.flags |= GN_INSTANCE_HOST_DRAWN_BIT;
        info.pName = instance.name.c_str();
        info.mesh = meshes[instance.mesh];
        info.transform = toGnTransform(hostDrawn_[i].transform);
        info.casterMask = instance.casterMask;
        std::copy_n(&range.lower.x, 3, info.boundsMin);
        std::copy_n(&range.upper.x, 3, info.boundsMax);
        info.pfnDrawCasters = instance.hostDrawn ? &CasterDrawer::draw : nullptr;
        info.pfnOpacity = instance.alphaTested ? &CasterDrawer::opacity : nullptr;
        info.pUserData = &hostDrawn_[i];
        require(gnCreateInstance(context, &info, &instances.emplace_back()));
        lastTransforms_.push_back(info.transform);
    }
    for (const Light& light : scene.lights) {
        lastLights_.push_back(lightAt(light, 0.0));
        const GnLightInfo info = toGnLight(light, lastLights_.back());
        require(gnCreateLight(context, &info, &lights.emplace_back()));
    }
}

void Host::update(const SceneState& state)
{
    for (size_t i = 0; i < state.instances.size(); ++i) {
        const GnTransform transform = toGnTransform(state.instances[i]);
        const bool same = std::ranges::equal(transform.basis, lastTransforms_[i].basis) &&
                          std::ranges::equal(transform.translation, lastTransforms_[i].translation);
        if (same) continue;
        require(gnSetInstanceTransform(context, instances[i], &transform));
        lastTransforms_[i] = transform;
        hostDrawn_[i].transform = state.instances[i];
    }
    for (size_t i = 0; i < state.lights.size(); ++i) {
        const LightState& now = state.lights[i];
        if (now.position == lastLights_[i].position && now.direction == lastLights_[i].direction) continue;
        const GnLightInfo info = toGnLight(scene.lights[i], now);
        require(gnUpdateLight(context, lights[i], &info));
        lastLights_[i] = now;
    }
}

// --- frames ---

void Host::pin(size_t light, const char* method)
{
    require(gnSetLightMethod(context, lights[light], method));
    if (!method) {
        pinned_.erase(lights[light]);
        return;
    }
    pinned_.insert(lights[light]);
    if (warmUp_ && warm_.insert(method).second) require(gnWarmUpMethod(context, method));
}

void Host::warm(const char* method)
{
    warmsByName_ = true;
    if (warmUp_ && warm_.insert(method).second) require(gnWarmUpMethod(context, method));
}

void Host::renewLights()
{
    pinned_.clear();
    for (size_t i = 0; i < lights.size(); ++i) {
        gnDestroyLight(context, lights[i]);
        const GnLightInfo info = toGnLight(scene.lights[i], lastLights_[i]);
        require(gnCreateLight(context, &info, &lights[i]));
    }
}

void Host::beginAnew(const Scene& from, const char* method)
{
    if (&from != &scene) scene = from;
    renewLights();
    pinAll(method);
}

/// A frame with lights that no method is pinned to may ask for any.
void Host::warmUpFor(const std::vector<GnLight>& lit)
{
    if (!warmUp_ || warmForRules_ || warmsByName_) return;
    warmForRules_ = lit.empty() || !std::ranges::all_of(lit, [&](GnLight light) { return pinned_.contains(light); });
    if (!warmForRules_) return;
    if (warmAll_) return require(gnWarmUp(context));
    for (const char* method : {"shadow_map", "cube_map", "stencil_volume", "octree_volume", "ray_traced"})
        if (gnWarmUpMethod(context, method) == GN_SUCCESS) warm_.insert(method);
}

void Host::wait(uint64_t submission)
{
    if (submission > 0) waitTimeline(device(), timeline_.get(), submission);
    waited_ = std::max(waited_, submission);
    // The layer forgets what was submitted when a queue is waited for, not a semaphore; until then every submission is
    // compared with all before it.
    if (submission == submission_) vkQueueWaitIdle(device().queue);
}

/// Only what was waited for counts as done, though the device may be further: what a frame finds completed, and so how
/// many copies of a buffer it needs, does not depend on the machine's speed.
void Host::retire()
{
    while (!retired_.empty() && retired_.front().submission <= waited_)
        retired_.pop_front();
    while (!unfinished_.empty() && unfinished_.front().first <= waited_) {
        completed_ = unfinished_.front().second;
        unfinished_.pop_front();
    }
}

Host::Slot& Host::takeSlot()
{
    ++submission_;
    if (submission_ > slots_.size()) wait(submission_ - slots_.size());
    retire();
    Slot& slot = slots_[submission_ % slots_.size()];
    vkCheck(vkResetCommandPool(device().handle, slot.pool.get(), 0), "vkResetCommandPool");
    return slot;
}

void Host::submit(VkCommandBuffer cmd, bool last)
{
    vkCheck(vkEndCommandBuffer(cmd), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo command{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = timeline_.get(),
                                       .value = submission_,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &command,
                             .signalSemaphoreInfoCount = last ? 1u : 0u,
                             .pSignalSemaphoreInfos = &signal};
    vkCheck(vkQueueSubmit2(device().queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
}

namespace {

/// What was recorded is not submitted: after a failure it names what is gone.
bool withdrawn(const FrameOptions& options, GnResult result)
{
    return options.drop || (options.call == Call::record && result < 0);
}

} // namespace

GnResult Host::draw(const FrameOptions& options)
{
    Slot& slot = takeSlot();
    const SceneState state = stateAt(scene, options.time);
    update(state);
    const std::vector<CameraState> cameras =
        options.cameras ? *options.cameras : std::vector(views.size(), cameraAt(scene, options.time));
    std::vector<GnLight> present;
    for (const uint32_t i : state.present)
        present.push_back(lights[i]);
    const std::vector<GnLight>& lit = options.lights ? *options.lights : present;
    warmUpFor(lit);

    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    vkCheck(vkBeginCommandBuffer(slot.before, &begin), "vkBeginCommandBuffer");
    std::vector<GnViewFrame> frames;
    for (uint32_t view = 0; view < views.size(); ++view) {
        CameraMatrices camera = cameraMatrices(scene, cameras[view], area_.extent.width != 0 ? area_.extent : extent_);
        if (options.lens) options.lens(camera);
        drawSurface(slot.before, view, camera, state, options);
        frames.push_back(viewFrame(view, camera, lit));
    }
    GnFrameInfo info{};
    info.frame = frame_ + 1;
    info.completedFrame = completed_;
    info.viewCount = static_cast<uint32_t>(frames.size());
    info.pViews = frames.data();
    if (options.adjust) options.adjust(info, frames);

    GnResult result = GN_SUCCESS;
    if (options.call == Call::record) {
        if (options.around) options.around(slot.before, true);
        result = gnCmdRenderShadows(context, slot.before, &info);
        if (options.around) options.around(slot.before, false);
        if (withdrawn(options, result)) vkCheck(vkEndCommandBuffer(slot.before), "vkEndCommandBuffer");
        if (options.drop && result >= 0) result = gnDropFrame(context, info.frame);
    }
    if (!withdrawn(options, result)) submit(slot.before, false);
    const size_t before = options.counter ? options.counter() : 0;
    if (options.call == Call::submit) result = gnSubmitShadows(context, &info);
    if (options.counter) counted = options.counter() - before;
    if (options.call == Call::begin) result = gnBeginShadows(context, &info);
    if (result >= 0) {
        frame_ = info.frame;
        layers_ = static_cast<uint32_t>(lit.size());
        unfinished_.emplace_back(submission_, frame_);
    }
    vkCheck(vkBeginCommandBuffer(slot.after, &begin), "vkBeginCommandBuffer");
    if (options.call != Call::begin || result < 0) submit(slot.after, true);
    return result;
}

GnResult Host::finish(uint64_t timeoutNs)
{
    const GnResult result = gnFinishShadows(context, timeoutNs);
    if (result != GN_TIMEOUT) submit(slots_[submission_ % slots_.size()].after, true);
    if (result < 0 && !unfinished_.empty() && unfinished_.back().second == frame_) {
        unfinished_.pop_back();
        --frame_;
    }
    return result;
}

void Host::draw(uint32_t frames, const FrameOptions& options)
{
    for (uint32_t i = 0; i < frames; ++i)
        require(draw(options));
}

std::vector<Image8> Host::pictures(uint32_t view)
{
    wait(submission_);
    GnVisibility visibility{};
    require(gnGetVisibility(context, views[view], &visibility));
    return readback_.visibility(visibility.imageView, visibility.extent, layers_);
}

} // namespace gnomon::test
