// A deferred renderer with a forward pass for glass: two frames in flight, two ways to get shadows.
#pragma once

#include <tuple>

#include "shadows.hpp"

#include <imgui_impl_vulkan.h>

namespace embed {

constexpr uint32_t kInFlight = 2; // frames

class Renderer {
public:
    /// \param picture Drawn into where there is no window.
    Renderer(const Gpu& gpu, const Scene& scene, const Canvas& picture, Swapchain* window)
        : shadows(gpu, scene), gpu_(gpu), scene_(scene), picture_(picture), window_(window)
    {
        using Usage = vk::BufferUsageFlagBits;
        using Property = vk::MemoryPropertyFlagBits;
        const size_t cornerBytes = scene.corners.size() * sizeof(glm::vec3);
        pixelsAt_ = kCornersAt + cornerBytes;
        const auto usage = Usage::eUniformBuffer | Usage::eVertexBuffer | Usage::eTransferDst;
        const vk::DeviceSize pixelBytes = 4 * picture.size.width * picture.size.height;
        buffer_ = {gpu.device, vk::BufferCreateInfo({}, pixelsAt_ + pixelBytes, usage)};
        bufferMemory_ = gpu.place(buffer_, Property::eHostVisible | Property::eHostCoherent);
        mapped_ = static_cast<unsigned char*>(bufferMemory_.mapMemory(0, VK_WHOLE_SIZE));
        std::memcpy(mapped_ + kCornersAt, scene.corners.data(), cornerBytes);
    }
    ~Renderer() { gpu_.device.waitIdle(); }

    /// \param recorded gnomon records into our command buffer; else it submits to the queue.
    /// \param overlay Dear ImGui's, over the picture; or null.
    void draw(const Camera& camera, const Lights& lights, bool recorded, ImDrawData* overlay)
    {
        const Slot& slot = slots_[(frame_ + 1) % kInFlight];
        std::ignore = gpu_.device.waitForFences(*slot.done, true, UINT64_MAX); // throws where it fails
        const Canvas* target = window_ ? window_->acquire(*slot.free) : &picture_;
        if (!target) return;
        gpu_.device.resetFences(*slot.done);
        slot.pool.reset();
        if (surfaces_.size != target->size) surfaces_.resize(target->size); // the swapchain has waited for the device
        const glm::mat4 clipFromView = camera.clipFromView(float(target->size.width) / float(target->size.height));
        const glm::mat4 clipFromWorld = clipFromView * camera.viewFromWorld();

        const vk::raii::CommandBuffer &before = slot.commands[0], &after = slot.commands[1];
        before.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        surfaces_.begin(before);
        drawObjects(before, surface_, clipFromWorld, scene_.opaque);
        before.endRenderPass();
        before.end();
        gpu_.queue.submit(vk::SubmitInfo({}, {}, *before));

        after.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        const uint64_t completed = ++frame_ > kInFlight ? frame_ - kInFlight : 0;
        shadows.render(recorded ? *after : nullptr, camera, clipFromView, lights, surfaces_, frame_, completed);
        nameInputs(after, {glm::inverse(clipFromWorld), lights});
        target->begin(after);
        drawObjects(after, lighting_, glm::mat4(1), scene_.cover);
        drawObjects(after, glass_, clipFromWorld, scene_.glass);
        if (overlay) ImGui_ImplVulkan_RenderDrawData(overlay, *after);
        after.endRenderPass();
        if (!window_) {
            const vk::BufferImageCopy all(pixelsAt_, {}, {}, {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, {},
                                          vk::Extent3D(picture_.size, 1));
            after.copyImageToBuffer(*picture_.images[0].image, vk::ImageLayout::eTransferSrcOptimal, *buffer_, all);
        }
        after.end();
        if (window_)
            window_->show(*after, *slot.free, *slot.done);
        else
            gpu_.queue.submit(vk::SubmitInfo({}, {}, *after), *slot.done);
    }

    /// What the last frame without a window shows: four bytes a pixel.
    const unsigned char* pixels() const
    {
        gpu_.device.waitIdle();
        return mapped_ + pixelsAt_;
    }

    Shadows shadows;

private:
    struct ObjectData { // Object in shaders.glsl
        glm::mat4 clipFromWorld;
        glm::vec4 colour;
    };
    struct FrameData { // Frame there
        glm::mat4 worldFromClip;
        Lights lights;
    };
    struct Slot { // one of the frames in flight
        const vk::raii::Device& device;
        vk::raii::Fence done{device, vk::FenceCreateInfo(vk::FenceCreateFlagBits::eSignaled)};
        vk::raii::Semaphore free{device, vk::SemaphoreCreateInfo()};
        vk::raii::CommandPool pool{device, vk::CommandPoolCreateInfo()};
        vk::raii::CommandBuffers commands{device, {*pool, {}, 2}}; // the second after submitted shadows
    };
    using Type = vk::DescriptorType;
    static constexpr auto kStages = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
    static constexpr auto kPushed = vk::DescriptorSetLayoutCreateFlagBits::ePushDescriptorKHR;
    static constexpr vk::DescriptorSetLayoutBinding kBindings[] = { // as in shaders.glsl
        {0, Type::eUniformBuffer, 1, kStages},
        {1, Type::eSampledImage, kLights, kStages},
        {2, Type::eSampler, 1, kStages},
        {3, Type::eCombinedImageSampler, 3, kStages},
        {4, Type::eCombinedImageSampler, 1, kStages},
        {5, Type::eUniformBuffer, 1, kStages}};
    static constexpr vk::PushConstantRange kObject{kStages, 0, sizeof(ObjectData)};
    static constexpr vk::DeviceSize kConstantsAt = 2048, kCornersAt = 4096; // in the buffer, bytes, for any alignment

    void drawObjects(const vk::raii::CommandBuffer& commands, const vk::raii::Pipeline& by,
                     const glm::mat4& clipFromWorld, const std::vector<Object>& objects) const
    {
        commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *by);
        commands.bindVertexBuffers(0, *buffer_, kCornersAt);
        for (const Object& object : objects) {
            commands.pushConstants<ObjectData>(*layout_, kStages, 0, ObjectData{clipFromWorld, object.colour});
            commands.draw(object.count, 1, object.first, 0);
        }
    }

    /// Tells the shaders what they read. Descriptors that are pushed are those of the frame; an engine that keeps sets
    /// writes them again when GnVisibility::revision or GnSampledShadows::revision has grown.
    void nameInputs(const vk::raii::CommandBuffer& commands, const FrameData& data) const
    {
        const GnSampledShadows maps = shadows.view.sampledShadows().value();
        const vk::DescriptorBufferInfo constants(*buffer_, kConstantsAt, maps.constantsSize),
            frame(*buffer_, 0, sizeof data);
        const auto* bytes = static_cast<const std::byte*>(maps.pConstants);
        commands.updateBuffer<std::byte>(*buffer_, kConstantsAt, {uint32_t(maps.constantsSize), bytes});
        commands.updateBuffer<FrameData>(*buffer_, 0, data);
        std::vector<vk::DescriptorImageInfo> images;
        const auto add = [&](vk::ImageView view) {
            images.emplace_back(maps.sampler, view, vk::ImageLayout::eShaderReadOnlyOptimal);
        };
        std::for_each_n(maps.pMaps, kLights, add);
        for (const Image& surface : surfaces_.images)
            add(*surface.view);
        add(shadows.view.visibility()->imageView);
        const vk::WriteDescriptorSet writes[] = {{{}, 0, 0, 1, Type::eUniformBuffer, nullptr, &constants},
                                                 {{}, 1, 0, kLights, Type::eSampledImage, &images[0]},
                                                 {{}, 2, 0, 1, Type::eSampler, &images[0]},
                                                 {{}, 3, 0, 3, Type::eCombinedImageSampler, &images[kLights]},
                                                 {{}, 4, 0, 1, Type::eCombinedImageSampler, &images[kLights + 3]},
                                                 {{}, 5, 0, 1, Type::eUniformBuffer, nullptr, &frame}};
        commands.pushDescriptorSetKHR(vk::PipelineBindPoint::eGraphics, *layout_, 0, writes);
    }

    const Gpu& gpu_;
    const Scene& scene_;
    const Canvas& picture_;
    Swapchain* window_;
    uint64_t frame_ = 0;
    vk::raii::DeviceMemory bufferMemory_ = nullptr;
    vk::raii::Buffer buffer_ = nullptr; // data of the frame, corners of the scene, pixels of the picture
    unsigned char* mapped_ = nullptr;
    vk::DeviceSize pixelsAt_ = 0;
    Canvas surfaces_{gpu_,
                     {vk::Format::eR8G8B8A8Unorm, vk::Format::eR16G16B16A16Sfloat, kDepthFormat},
                     vk::ImageLayout::eShaderReadOnlyOptimal};
    vk::raii::DescriptorSetLayout setLayout_{gpu_.device, vk::DescriptorSetLayoutCreateInfo(kPushed, kBindings)};
    vk::raii::PipelineLayout layout_{gpu_.device, vk::PipelineLayoutCreateInfo({}, *setLayout_, kObject)};
    vk::raii::Pipeline surface_ = surfaces_.createPipeline(*layout_, k_surface_frag, false);
    vk::raii::Pipeline lighting_ = picture_.createPipeline(*layout_, k_lighting_frag, false);
    vk::raii::Pipeline glass_ = picture_.createPipeline(*layout_, k_glass_frag, true);
    std::array<Slot, kInFlight> slots_{Slot{gpu_.device}, Slot{gpu_.device}};
};

} // namespace embed
