// A deferred renderer with a forward pass for glass: dynamic rendering, two frames in flight, two ways to get shadows.
#pragma once

#include "embed_shaders/glass_frag.h"
#include "embed_shaders/lighting_frag.h"
#include "embed_shaders/lighting_vert.h"
#include "embed_shaders/surface_frag.h"
#include "embed_shaders/surface_vert.h"
#include "shadows.hpp"

namespace embed {

constexpr uint32_t kInFlight = 2;

/// Where the picture goes: an image of the swapchain, or nowhere.
struct Target {
    vk::Image image;
    vk::Semaphore acquired, drawn;
};

class Renderer {
public:
    Renderer(Gpu& gpu, const Scene& scene) : gpu_(gpu), scene_(scene), shadows(gpu, scene)
    {
        createBuffer();
        using Type = vk::DescriptorType;
        const auto all = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
        // As the shaders have them: FrameData; albedo, normals, depth, visibility; three of gnomon/sample_shadow.h.
        constexpr auto read = Type::eCombinedImageSampler;
        std::vector<vk::DescriptorSetLayoutBinding> bindings;
        for (const Type type :
             {Type::eUniformBuffer, read, read, read, read, Type::eUniformBuffer, Type::eSampledImage, Type::eSampler})
            bindings.emplace_back(uint32_t(bindings.size()), type, type == Type::eSampledImage ? kLights : 1, all);
        setLayout_ = {gpu.device, vk::DescriptorSetLayoutCreateInfo(
                                      vk::DescriptorSetLayoutCreateFlagBits::ePushDescriptorKHR, bindings)};
        const vk::PushConstantRange colour(vk::ShaderStageFlagBits::eFragment, 0, sizeof(glm::vec4));
        layout_ = {gpu.device, vk::PipelineLayoutCreateInfo({}, *setLayout_, colour)};
        surfaces_ = gpu.createPipeline(*layout_, k_surface_vert, k_surface_frag, {albedo_.format, normals_.format},
                                       depth_.format, true, false);
        lighting_ = gpu.createPipeline(*layout_, k_lighting_vert, k_lighting_frag, {picture.format}, {}, false, false);
        glass_ = gpu.createPipeline(*layout_, k_surface_vert, k_glass_frag, {picture.format}, {}, true, true);
        for (Slot& slot : slots_) {
            slot.pool = {gpu.device, vk::CommandPoolCreateInfo({}, gpu.family)};
            slot.commands = vk::raii::CommandBuffers(gpu.device, {*slot.pool, {}, 2});
        }
        const vk::SemaphoreTypeCreateInfo type(vk::SemaphoreType::eTimeline, 0);
        timeline_ = {gpu.device, vk::SemaphoreCreateInfo({}, &type)};
        sampler_ = {gpu.device, vk::SamplerCreateInfo()};
    }
    ~Renderer() { gpu_.device.waitIdle(); }

    void resize(vk::Extent2D size)
    {
        gpu_.device.waitIdle(); // so that the old images may go; gnomon keeps its own until frames are completed
        size_ = size;
        using Usage = vk::ImageUsageFlagBits;
        for (Image* image : {&albedo_, &normals_, &depth_, &picture}) {
            const auto drawn = image == &depth_ ? Usage::eDepthStencilAttachment : Usage::eColorAttachment;
            image->image = {gpu_.device,
                            vk::ImageCreateInfo({}, vk::ImageType::e2D, image->format, {size.width, size.height, 1}, 1,
                                                1, vk::SampleCountFlagBits::e1, vk::ImageTiling::eOptimal,
                                                Usage::eSampled | Usage::eTransferSrc | drawn)};
            image->memory = gpu_.place(image->image, vk::MemoryPropertyFlagBits::eDeviceLocal);
            image->view = {gpu_.device, vk::ImageViewCreateInfo({}, *image->image, vk::ImageViewType::e2D,
                                                                image->format, {}, wholeOf(image->format))};
        }
    }

    /// \param recorded gnomon records into our command buffer; else it submits to the queue between two of ours.
    /// \param ui Draws over the picture, which is in COLOR_ATTACHMENT_OPTIMAL, and may copy it when it is drawn.
    template <typename Ui>
    void draw(const Camera& camera, const std::array<Light, kLights>& lights, bool recorded, Ui&& ui,
              const Target& target, const vk::raii::Buffer* copy)
    {
        Slot& slot = slots_[++frame_ % kInFlight];
        waitFor(slot.frame);
        const uint64_t completed = std::exchange(slot.frame, frame_);
        slot.pool.reset();
        const glm::mat3& axes = camera.worldFromView;
        const FrameData data{camera.clipFromWorld,
                             {camera.eye, camera.clipFromView[3][2]},
                             {axes[0], camera.clipFromView[0][0]},
                             {axes[1], camera.clipFromView[1][1]},
                             {axes[2], 0},
                             lights};
        std::memcpy(mapped_ + slot.at, &data, sizeof data);

        const vk::raii::CommandBuffer* commands = &begin(slot.commands[0]);
        pass(*commands, surfaces_, {&albedo_, &normals_}, &depth_, [&] {
            name(*commands, slot, nullptr);
            drawObjects(*commands, 0, glassAt());
        });
        if (!recorded) submit(*commands, {}, 0);
        shadows.render(recorded ? **commands : vk::CommandBuffer(), camera, lights, depth_, normals_, size_, frame_,
                       completed);
        const GnSampledShadows maps = shadows.view.sampledShadows().value();
        std::memcpy(mapped_ + slot.at + kPart, maps.pConstants, maps.constantsSize);
        if (!recorded) commands = &begin(slot.commands[1]);
        pass(*commands, lighting_, {&picture}, nullptr, [&] {
            name(*commands, slot, &maps);
            commands->draw(3, 1, 0, 0);
            commands->bindPipeline(vk::PipelineBindPoint::eGraphics, *glass_);
            drawObjects(*commands, glassAt(), scene_.objects.size());
        });
        ui(*commands);
        barrier(*commands, *picture.image, picture.format, kColour, kCopied);
        if (target.image) show(*commands, target.image);
        if (copy)
            commands->copyImageToBuffer(*picture.image, kCopied.layout, **copy,
                                        vk::BufferImageCopy(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, {},
                                                            {size_.width, size_.height, 1}));
        submit(*commands, target, frame_);
    }

    void waitFor(uint64_t frame) const
    {
        const vk::SemaphoreWaitInfo wait({}, *timeline_, frame);
        if (gpu_.device.waitSemaphores(wait, UINT64_MAX) != vk::Result::eSuccess) throw std::runtime_error("no end");
    }
    uint64_t frame() const { return frame_; }

    Image picture{vk::Format::eR8G8B8A8Unorm};

private:
    struct FrameData { // shaders/frame.glsl
        glm::mat4 clipFromWorld;
        glm::vec4 eye, right, up, back;
        std::array<Light, kLights> lights;
    };
    struct Slot { // one of the frames in flight
        uint64_t frame = 0;
        vk::raii::CommandPool pool = nullptr;
        std::vector<vk::raii::CommandBuffer> commands; // the second after submitted shadows
        vk::DeviceSize at = 0;                         // FrameData in the buffer, gnomon's constants kPart behind
    };
    static constexpr vk::DeviceSize kPart = 2048; // bytes, for any alignment

    /// All that the CPU writes: data of each slot, positions, indices.
    void createBuffer()
    {
        using Usage = vk::BufferUsageFlagBits;
        for (uint32_t i = 0; i < kInFlight; ++i)
            slots_[i].at = 2 * kPart * i;
        positionsAt_ = 2 * kPart * kInFlight;
        indicesAt_ = positionsAt_ + scene_.positions.size() * 12;
        buffer_ = {gpu_.device,
                   vk::BufferCreateInfo({}, indicesAt_ + scene_.indices.size() * 4,
                                        Usage::eUniformBuffer | Usage::eVertexBuffer | Usage::eIndexBuffer)};
        using Property = vk::MemoryPropertyFlagBits;
        bufferMemory_ = gpu_.place(buffer_, Property::eHostVisible | Property::eHostCoherent);
        mapped_ = static_cast<std::byte*>(bufferMemory_.mapMemory(0, VK_WHOLE_SIZE));
        std::memcpy(mapped_ + positionsAt_, scene_.positions.data(), scene_.positions.size() * 12);
        std::memcpy(mapped_ + indicesAt_, scene_.indices.data(), scene_.indices.size() * 4);
    }

    size_t glassAt() const { return scene_.objects.size() - 1; }
    void drawObjects(const vk::raii::CommandBuffer& commands, size_t first, size_t end) const
    {
        commands.bindVertexBuffers(0, *buffer_, positionsAt_);
        commands.bindIndexBuffer(*buffer_, indicesAt_, vk::IndexType::eUint32);
        for (size_t i = first; i < end; ++i) {
            const Object& object = scene_.objects[i];
            commands.pushConstants<glm::vec4>(*layout_, vk::ShaderStageFlagBits::eFragment, 0, object.colour);
            commands.drawIndexed(object.indexCount, 1, object.firstIndex, int32_t(object.firstVertex), 0);
        }
    }

    /// Draws into images that are cleared to 0 (reversed: infinitely far). With depth they are made readable.
    template <typename Draw>
    void pass(const vk::raii::CommandBuffer& commands, const vk::raii::Pipeline& pipeline,
              std::initializer_list<const Image*> colours, const Image* depth, Draw&& draw) const
    {
        std::vector<vk::RenderingAttachmentInfo> attachments;
        const auto open = [&](const Image& image, const Use& use) {
            const Use before{depth ? kRead.stages : kCopied.stages, {}, vk::ImageLayout::eUndefined};
            barrier(commands, *image.image, image.format, before, use);
            attachments.emplace_back(*image.view, use.layout).loadOp = vk::AttachmentLoadOp::eClear;
        };
        for (const Image* image : colours)
            open(*image, kColour);
        if (depth) open(*depth, kDepth);
        commands.beginRendering(vk::RenderingInfo({}, {{}, size_}, 1, 0, uint32_t(colours.size()), attachments.data(),
                                                  depth ? &attachments.back() : nullptr));
        commands.setViewport(0, vk::Viewport(0, 0, float(size_.width), float(size_.height), 0, 1));
        commands.setScissor(0, vk::Rect2D({}, size_));
        commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline);
        draw();
        commands.endRendering();
        if (!depth) return;
        for (const Image* image : colours)
            barrier(commands, *image->image, image->format, kColour, kRead);
        barrier(commands, *depth->image, depth->format, kDepth, kRead);
    }

    /// Tells the shaders what they read. Descriptors that are pushed are those of the frame; an engine that keeps sets
    /// writes them again when GnVisibility::revision or GnSampledShadows::revision has grown.
    /// \param maps Null: there is nothing yet but FrameData.
    void name(const vk::raii::CommandBuffer& commands, const Slot& slot, const GnSampledShadows* maps) const
    {
        using Type = vk::DescriptorType;
        constexpr auto readable = vk::ImageLayout::eShaderReadOnlyOptimal;
        const vk::DescriptorBufferInfo data(*buffer_, slot.at, sizeof(FrameData)),
            constants(*buffer_, slot.at + kPart, kLights * GN_SAMPLED_LIGHT_SIZE);
        std::vector<vk::WriteDescriptorSet> writes{{{}, 0, 0, 1, Type::eUniformBuffer, nullptr, &data}};
        std::array<vk::DescriptorImageInfo, 4 + kLights + 1> images;
        if (maps) {
            const vk::ImageView visibility = shadows.view.visibility()->imageView;
            for (uint32_t i = 0; const vk::ImageView view : {*albedo_.view, *normals_.view, *depth_.view, visibility})
                images[i++] = {*sampler_, view, readable};
            for (uint32_t i = 0; i < kLights; ++i)
                images[4 + i] = {{}, maps->pMaps[i], readable};
            images.back() = vk::DescriptorImageInfo(maps->sampler);
            for (uint32_t i = 0; i < 4; ++i)
                writes.push_back({{}, 1 + i, 0, 1, Type::eCombinedImageSampler, &images[i]});
            writes.push_back({{}, 5, 0, 1, Type::eUniformBuffer, nullptr, &constants});
            writes.push_back({{}, 6, 0, kLights, Type::eSampledImage, &images[4]});
            writes.push_back({{}, 7, 0, 1, Type::eSampler, &images.back()});
        }
        commands.pushDescriptorSetKHR(vk::PipelineBindPoint::eGraphics, *layout_, 0, writes);
    }

    static const vk::raii::CommandBuffer& begin(const vk::raii::CommandBuffer& commands)
    {
        commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        return commands;
    }
    void show(const vk::raii::CommandBuffer& commands, vk::Image image) const
    {
        const Use taken{kCopied.stages, {}, vk::ImageLayout::eUndefined};
        const Use written{kCopied.stages, Access2::eTransferWrite, vk::ImageLayout::eTransferDstOptimal};
        const vk::ImageSubresourceLayers colour(vk::ImageAspectFlagBits::eColor, 0, 0, 1);
        const std::array corners{vk::Offset3D(), vk::Offset3D(int32_t(size_.width), int32_t(size_.height), 1)};
        barrier(commands, image, picture.format, taken, written);
        commands.blitImage(*picture.image, kCopied.layout, image, written.layout,
                           vk::ImageBlit(colour, corners, colour, corners), vk::Filter::eNearest);
        barrier(commands, image, picture.format, written, {kCopied.stages, {}, vk::ImageLayout::ePresentSrcKHR});
    }
    /// \param frame The last of a frame says so to the timeline.
    void submit(const vk::raii::CommandBuffer& commands, const Target& target, uint64_t frame) const
    {
        commands.end();
        const vk::CommandBufferSubmitInfo buffer(*commands);
        const vk::SemaphoreSubmitInfo wait(target.acquired, 0, Stage2::eTransfer);
        const std::array signals{vk::SemaphoreSubmitInfo(*timeline_, frame, Stage2::eAllCommands),
                                 vk::SemaphoreSubmitInfo(target.drawn, 0, Stage2::eTransfer)};
        const uint32_t shown = target.image ? 1 : 0;
        gpu_.queue.submit2(vk::SubmitInfo2({}, shown, &wait, 1, &buffer, frame ? 1 + shown : 0, signals.data()));
    }

    Gpu& gpu_;
    const Scene& scene_;

public:
    Shadows shadows;

private:
    vk::Extent2D size_;
    uint64_t frame_ = 0;
    vk::raii::DeviceMemory bufferMemory_ = nullptr;
    vk::raii::Buffer buffer_ = nullptr;
    std::byte* mapped_ = nullptr;
    vk::DeviceSize positionsAt_ = 0, indicesAt_ = 0;
    Image albedo_{vk::Format::eR8G8B8A8Unorm}, normals_{vk::Format::eR16G16B16A16Sfloat};
    Image depth_{vk::Format::eD32Sfloat};
    vk::raii::Sampler sampler_ = nullptr;
    vk::raii::DescriptorSetLayout setLayout_ = nullptr;
    vk::raii::PipelineLayout layout_ = nullptr;
    vk::raii::Pipeline surfaces_ = nullptr, lighting_ = nullptr, glass_ = nullptr;
    vk::raii::Semaphore timeline_ = nullptr;
    std::array<Slot, kInFlight> slots_;
};

} // namespace embed
