#include "demo/host/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/gtc/packing.hpp>

#include "demo/host/light_tiles.hpp"
#include "demo/host/pipelines.hpp"
#include "shaders/demo/frame.h"
#include "shaders/demo_lighting_frag.h"
#include "shaders/demo_lighting_vert.h"
#include "shaders/demo_prepass_frag.h"
#include "shaders/demo_prepass_vert.h"

namespace gnomon::demo {
namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr VkFormat kNormalFormat = VK_FORMAT_R16G16B16A16_SFLOAT;

Image makeSingle(const Device& device, VkFormat format, VkExtent2D extent, VkImageUsageFlags usage)
{
    return makeImage(device, {.format = format, .extent = extent, .usage = usage});
}

gpu::DemoInstance instanceData(const Instance& instance, const MeshRange& mesh, const Transform& transform,
                               const glm::dvec3& eye)
{
    gpu::DemoInstance out{};
    const glm::dmat3& m = transform.linear;
    const glm::dvec3 translation = transform.translation - eye;
    const double side = transform.mirrors() ? -1.0 : 1.0; // normals stay on the front
    const glm::dvec3 cofactorColumns[3] = {side * glm::cross(m[1], m[2]), side * glm::cross(m[2], m[0]),
                                           side * glm::cross(m[0], m[1])};
    for (int row = 0; row < 3; ++row) {
        out.worldFromObject[row] = glm::vec4(m[0][row], m[1][row], m[2][row], translation[row]);
        out.cofactors[row] = glm::vec4(cofactorColumns[0][row], cofactorColumns[1][row], cofactorColumns[2][row], 0.0);
    }
    out.albedo = glm::vec4(instance.albedo, 1.0f);
    out.firstTriangle = mesh.firstTriangle;
    return out;
}

gpu::DemoLight lightData(const Light& light, const LightState& state, const glm::dvec3& eye)
{
    gpu::DemoLight out{};
    out.positionEye = glm::vec4(glm::vec3(state.position - eye), 0.0f);
    out.direction = glm::vec4(glm::vec3(state.direction), std::cos(light.outerAngle));
    out.colour = glm::vec4(light.colour * light.intensity, light.range);
    // A cone without a soft rim would divide by zero in smoothstep.
    out.cosInner = std::max(std::cos(light.innerAngle), std::cos(light.outerAngle) + 1e-4f);
    out.type = static_cast<uint32_t>(light.kind);
    return out;
}
static_assert(static_cast<uint32_t>(LightKind::Spot) == gpu::LIGHT_SPOT &&
              static_cast<uint32_t>(LightKind::Point) == gpu::LIGHT_POINT);

} // namespace

Renderer::Renderer(const Device& device, const Scene& scene, const SceneGeometry& geometry,
                   const RendererOptions& options)
    : device_(device), scene_(scene), geometry_(geometry), options_(options), extent_(options.extent),
      sampler_(makeNearestSampler(device)), timeline_(makeTimeline(device)), readback_(device)
{
    if (scene.instances.size() > gpu::MAX_DEMO_INSTANCES)
        throw HostError("scene '" + scene.name + "' has more than " + std::to_string(gpu::MAX_DEMO_INSTANCES) +
                        " instances");
    if (options.maxLights > gpu::MAX_DEMO_LIGHTS) throw HostError("the demo's lighting pass takes at most 256 lights");
    views_.resize(options.viewCount);
    slots_.resize(options.framesInFlight);
    for (Slot& slot : slots_) {
        const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                               .queueFamilyIndex = device.queueFamily};
        VkCommandPool pool = VK_NULL_HANDLE;
        vkCheck(vkCreateCommandPool(device.handle, &poolInfo, nullptr, &pool), "vkCreateCommandPool");
        slot.pool = {device.handle, pool};
        VkCommandBuffer buffers[2] = {};
        const VkCommandBufferAllocateInfo info{
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 2};
        vkCheck(vkAllocateCommandBuffers(device.handle, &info, buffers), "vkAllocateCommandBuffers");
        slot.before = buffers[0];
        slot.after = buffers[1];
    }
    createSets();
    createPipelines();
    createImages();
}

Renderer::~Renderer()
{
    if (submitted_ != frame_) { // a frame was given up half-way: only the device knows when its first half ends
        vkDeviceWaitIdle(device_.handle);
        return;
    }
    try {
        waitForFrame();
    } catch (const HostError&) { // device lost: nothing runs any more
    }
}

void Renderer::createSets()
{
    constexpr VkShaderStageFlags stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    const VkDescriptorSetLayoutBinding frameBindings[] = {{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, stages, nullptr},
                                                          {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, stages, nullptr},
                                                          {2, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, stages, nullptr}};
    frameLayout_ = makeSetLayout(device_, frameBindings);
    const VkDescriptorSetLayoutBinding imageBindings[] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
        {1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
        {2, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr}};
    imageLayout_ = makeSetLayout(device_, imageBindings);

    const uint32_t sets = options_.viewCount * options_.framesInFlight;
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3 * sets},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3 * sets}};
    const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                              .maxSets = 2 * sets,
                                              .poolSizeCount = 2,
                                              .pPoolSizes = sizes};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorPool(device_.handle, &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
    descriptors_ = {device_.handle, pool};

    const size_t instanceBytes = std::max<size_t>(scene_.instances.size(), 1) * sizeof(gpu::DemoInstance);
    for (View& view : views_) {
        for (uint32_t i = 0; i < options_.framesInFlight; ++i) {
            SlotOfView slot;
            slot.view = makeBuffer(device_, sizeof(gpu::DemoView), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
            slot.instances = makeBuffer(device_, instanceBytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
            const VkDescriptorSetLayout layouts[] = {frameLayout_.get(), imageLayout_.get()};
            VkDescriptorSet allocated[2] = {};
            const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                                   .descriptorPool = pool,
                                                   .descriptorSetCount = 2,
                                                   .pSetLayouts = layouts};
            vkCheck(vkAllocateDescriptorSets(device_.handle, &info, allocated), "vkAllocateDescriptorSets");
            slot.frameSet = allocated[0];
            slot.imageSet = allocated[1];
            const VkDescriptorBufferInfo buffers[] = {{slot.view.get(), 0, VK_WHOLE_SIZE},
                                                      {slot.instances.get(), 0, VK_WHOLE_SIZE},
                                                      {geometry_.normals.get(), 0, VK_WHOLE_SIZE}};
            const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                             .dstSet = slot.frameSet,
                                             .descriptorCount = 3,
                                             .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                             .pBufferInfo = buffers};
            vkUpdateDescriptorSets(device_.handle, 1, &write, 0, nullptr);
            view.slots.push_back(std::move(slot));
        }
    }
}

void Renderer::createPipelines()
{
    const VkDescriptorSetLayout layouts[] = {frameLayout_.get(), imageLayout_.get()};
    prepassLayout_ = makePipelineLayout(device_, std::span(layouts).first(1), 0, 0);
    lightingLayout_ = makePipelineLayout(device_, layouts, 0, 0);
    const bool standard = scene_.depth.convention == DepthConvention::Standard;
    for (uint32_t i = 0; i < prepass_.size(); ++i)
        prepass_[i] = makeGraphicsPipeline(
            device_, {.vertex = k_demo_prepass_vert,
                      .fragment = k_demo_prepass_frag,
                      .layout = prepassLayout_.get(),
                      .readsPositions = true,
                      .colour = kNormalFormat,
                      .depth = kDepthFormat,
                      .depthCompare = standard ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_GREATER,
                      .cull = i & 1u ? VkCullModeFlags(VK_CULL_MODE_NONE) : VkCullModeFlags(VK_CULL_MODE_BACK_BIT),
                      .dynamicFrontFace = true,
                      .constant0 = (i & 2u) != 0});
    lighting_ = makeGraphicsPipeline(device_, {.vertex = k_demo_lighting_vert,
                                               .fragment = k_demo_lighting_frag,
                                               .layout = lightingLayout_.get(),
                                               .colour = kColourFormat});
}

void Renderer::createImages()
{
    constexpr VkImageUsageFlags read = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    for (View& view : views_) {
        view.images.depth =
            makeSingle(device_, kDepthFormat, extent_, read | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
        view.images.normals = makeSingle(device_, kNormalFormat, extent_, read | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
        view.images.colour = makeSingle(device_, kColourFormat, extent_,
                                        read | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
        view.visibility = VK_NULL_HANDLE;
    }
    ones_ = makeImage(device_, {.format = VK_FORMAT_R8_UNORM,
                                .extent = extent_,
                                .layers = options_.maxLights,
                                .arrayView = true,
                                .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    onesCleared_ = false;
}

void Renderer::resize(VkExtent2D extent)
{
    if (extent.width == extent_.width && extent.height == extent_.height) return;
    Retired old{.frame = frame_, .images = {}, .ones = std::move(ones_)};
    for (View& view : views_)
        old.images.push_back(std::move(view.images));
    retired_.push_back(std::move(old));
    extent_ = extent;
    createImages();
}

void Renderer::retire()
{
    const uint64_t done = completed();
    while (!retired_.empty() && retired_.front().frame <= done)
        retired_.pop_front();
    while (!gnomonFrames_.empty() && gnomonFrames_.front().first <= done) {
        gnomonCompleted_ = gnomonFrames_.front().second;
        gnomonFrames_.pop_front();
    }
}

uint64_t Renderer::completed() const
{
    uint64_t value = 0;
    vkCheck(vkGetSemaphoreCounterValue(device_.handle, timeline_.get(), &value), "vkGetSemaphoreCounterValue");
    return value;
}

void Renderer::waitForFrame(uint64_t frame)
{
    waitTimeline(device_, timeline_.get(), frame);
}

void Renderer::writeFrameData(uint32_t index, const FrameRequest& request)
{
    View& view = views_[index];
    SlotOfView& slot = view.slots[frame_ % options_.framesInFlight];
    view.camera = cameraMatrices(scene_, request.cameras[index], extent_);
    const CameraMatrices& camera = view.camera;

    gpu::DemoView data{};
    data.clipFromEye = camera.clipFromEye;
    data.rayCorner = glm::vec4(camera.rayCorner, 0.0f);
    data.rayDx = glm::vec4(camera.rayDx, 0.0f);
    data.rayDy = glm::vec4(camera.rayDy, 0.0f);
    const VkExtent2D tile = lightTileSize(extent_);
    data.extent = glm::vec4(extent_.width, extent_.height, tile.width, tile.height);
    data.depthScale = camera.depthScale;
    data.depthAdd = camera.depthAdd;
    data.skyDepth = camera.skyDepth;
    data.ambient = scene_.ambient;
    data.sky = glm::vec4(scene_.sky, 0.0f);
    for (size_t i = 0; i < state_.present.size(); ++i) {
        const uint32_t light = state_.present[i];
        data.lights[i] = lightData(scene_.lights[light], state_.lights[light], camera.eye);
        if (!request.lightColours.empty())
            data.lights[i].colour = glm::vec4(request.lightColours[light], data.lights[i].colour.w);
    }
    markLightTiles(camera, extent_, std::span(data.lights).first(state_.present.size()), data.tileLights);
    std::memcpy(slot.view.mapped, &data, sizeof data);

    const std::span<gpu::DemoInstance> instances = slot.instances.as<gpu::DemoInstance>();
    for (size_t i = 0; i < scene_.instances.size(); ++i)
        instances[i] = instanceData(scene_.instances[i], geometry_.meshes[scene_.instances[i].mesh],
                                    state_.instances[i], camera.eye);
}

ImageF Renderer::readDepth(uint32_t view)
{
    waitForFrame();
    const Image& depth = views_[view].images.depth;
    const std::vector<std::byte> bytes = readback_.image(depth, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 4);
    ImageF out(depth.extent.width, depth.extent.height, 1);
    std::memcpy(out.texels.data(), bytes.data(), bytes.size());
    return out;
}

ImageF Renderer::readNormals(uint32_t view)
{
    waitForFrame();
    const Image& normals = views_[view].images.normals;
    const std::vector<std::byte> bytes = readback_.image(normals, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 8);
    ImageF out(normals.extent.width, normals.extent.height, 3);
    for (size_t pixel = 0; pixel < bytes.size() / 8; ++pixel) {
        uint64_t packed = 0;
        std::memcpy(&packed, &bytes[pixel * 8], 8);
        const glm::vec4 normal = glm::unpackHalf4x16(packed);
        for (int i = 0; i < 3; ++i)
            out.texels[pixel * 3 + i] = normal[i];
    }
    return out;
}

Image8 Renderer::readColour(uint32_t view)
{
    waitForFrame();
    const Image& colour = views_[view].images.colour;
    const std::vector<std::byte> bytes = readback_.image(colour, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, 4);
    Image8 out(colour.extent.width, colour.extent.height, 3);
    for (size_t pixel = 0; pixel < bytes.size() / 4; ++pixel)
        for (size_t i = 0; i < 3; ++i)
            out.texels[pixel * 3 + i] = static_cast<uint8_t>(bytes[pixel * 4 + i]);
    return out;
}

std::vector<Image8> Renderer::readVisibility(uint32_t view)
{
    waitForFrame();
    return readback_.visibility(views_[view].visibility, extent_, views_[view].layers);
}

} // namespace gnomon::demo
