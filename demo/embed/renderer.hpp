// A deferred renderer with a forward pass for glass: two frames in flight, two ways to get shadows.
#pragma once

#include "shadows.hpp" // has integers, for what follows

#include "embed_shaders/glass_frag.h"
#include "embed_shaders/lighting_frag.h"
#include "embed_shaders/lighting_vert.h"
#include "embed_shaders/surface_frag.h"
#include "embed_shaders/surface_vert.h"

namespace embed {

constexpr uint32_t kInFlight = 2;
using Stage = vk::PipelineStageFlagBits2;

/// Where the picture goes: an image of the swapchain, or nowhere.
struct Target {
    vk::Image image;
    vk::Semaphore acquired, drawn;
};

class Renderer {
public:
    Renderer(const Gpu& gpu, const Scene& scene)
        : shadows(gpu, scene), picturePass(gpu.createPass({picture.format}, vk::ImageLayout::eTransferSrcOptimal)),
          gpu_(gpu), scene_(scene)
    {
        using Usage = vk::BufferUsageFlagBits;
        using Property = vk::MemoryPropertyFlagBits;
        const size_t positionBytes = scene.positions.size() * sizeof(glm::vec3), indexBytes = scene.indices.size() * 4;
        indicesAt_ = kPositionsAt + positionBytes;
        const auto usage = Usage::eUniformBuffer | Usage::eVertexBuffer | Usage::eIndexBuffer;
        buffer_ = {gpu.device, vk::BufferCreateInfo({}, indicesAt_ + indexBytes, usage)};
        bufferMemory_ = gpu.place(buffer_, Property::eHostVisible | Property::eHostCoherent);
        mapped_ = static_cast<std::byte*>(bufferMemory_.mapMemory(0, VK_WHOLE_SIZE));
        std::memcpy(mapped_ + kPositionsAt, scene.positions.data(), positionBytes);
        std::memcpy(mapped_ + indicesAt_, scene.indices.data(), indexBytes);

        using Type = vk::DescriptorType; // as in shaders.glsl
        constexpr auto data = Type::eUniformBuffer, read = Type::eCombinedImageSampler;
        const auto stages = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
        std::vector<vk::DescriptorSetLayoutBinding> bindings;
        for (const Type type : {data, read, read, read, read, data, Type::eSampledImage, Type::eSampler})
            bindings.emplace_back(uint32_t(bindings.size()), type, type == Type::eSampledImage ? kLights : 1, stages);
        constexpr auto pushed = vk::DescriptorSetLayoutCreateFlagBits::ePushDescriptorKHR;
        setLayout_ = {gpu.device, vk::DescriptorSetLayoutCreateInfo(pushed, bindings)};
        const vk::PushConstantRange colour(vk::ShaderStageFlagBits::eFragment, 0, sizeof(glm::vec4));
        layout_ = {gpu.device, vk::PipelineLayoutCreateInfo({}, *setLayout_, colour)};
        surfacePass_ = gpu.createPass({albedo_.format, normals_.format, depth_.format}, kReadable);
        const PipelineInfo table[] = {
            {.vertex = k_surface_vert, .fragment = k_surface_frag, .pass = *surfacePass_, .colours = 2, .depth = true},
            {.vertex = k_lighting_vert, .fragment = k_lighting_frag, .pass = *picturePass, .positions = false},
            {.vertex = k_surface_vert, .fragment = k_glass_frag, .pass = *picturePass, .blended = true}};
        for (size_t i = 0; i < pipelines_.size(); ++i)
            pipelines_[i] = gpu.createPipeline(*layout_, table[i]);
        for (Slot& slot : slots_) {
            slot.pool = {gpu.device, vk::CommandPoolCreateInfo({}, gpu.family)};
            slot.commands = vk::raii::CommandBuffers(gpu.device, {*slot.pool, {}, 2});
        }
        const vk::SemaphoreTypeCreateInfo type(vk::SemaphoreType::eTimeline, 0);
        timeline_ = {gpu.device, vk::SemaphoreCreateInfo({}, &type)};
    }
    ~Renderer() { gpu_.device.waitIdle(); }

    /// Makes the images anew if their size changes.
    void resize(vk::Extent2D size)
    {
        if (size == std::exchange(size_, size)) return;
        gpu_.device.waitIdle(); // gnomon keeps its own images until frames are completed
        for (Image* image : {&albedo_, &normals_, &depth_, &picture})
            gpu_.create(*image, size);
        const std::array surfaces{*albedo_.view, *normals_.view, *depth_.view};
        intoSurfaces_ = gpu_.createFramebuffer(*surfacePass_, surfaces, size);
        intoPicture_ = gpu_.createFramebuffer(*picturePass, *picture.view, size);
    }

    /// \param recorded gnomon records into our command buffer; else it submits to the queue.
    /// \param overlay Draws over the picture.
    template <typename Overlay>
    void draw(const Camera& camera, const Lights& lights, bool recorded, const Target& target, Overlay&& overlay)
    {
        Slot& slot = slots_[++frame_ % kInFlight];
        waitFor(slot.frame);
        const uint64_t completed = std::exchange(slot.frame, frame_);
        slot.pool.reset();
        const vk::DeviceSize at = 2 * kPart * (frame_ % kInFlight); // in the buffer, gnomon's constants kPart behind
        const glm::mat4& clipFromWorld = camera.clipFromWorld;
        const FrameData data{clipFromWorld, glm::inverse(clipFromWorld), glm::vec4(camera.eye, 1.0f), lights};
        std::memcpy(mapped_ + at, &data, sizeof data);

        const vk::raii::CommandBuffer &before = slot.commands[0], &after = slot.commands[1];
        before.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        beginPass(before, *surfacePass_, *intoSurfaces_, 3);
        name(before, at, nullptr);
        drawObjects(before, pipelines_[0], 0, glassAt());
        before.endRenderPass();
        submit(before, {}, 0);
        after.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        shadows.render(recorded ? *after : nullptr, camera, lights, depth_, normals_, size_, frame_, completed);
        const GnSampledShadows maps = shadows.view.sampledShadows().value();
        std::memcpy(mapped_ + at + kPart, maps.pConstants, maps.constantsSize);
        beginPass(after, *picturePass, *intoPicture_, 1);
        name(after, at, &maps);
        after.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipelines_[1]);
        after.draw(3, 1, 0, 0);
        drawObjects(after, pipelines_[2], glassAt(), scene_.objects.size());
        overlay(after);
        after.endRenderPass();
        if (target.image) show(after, target.image);
        submit(after, target, frame_);
    }
    void waitFor(uint64_t frame) const
    {
        const vk::SemaphoreWaitInfo wait({}, *timeline_, frame);
        if (gpu_.device.waitSemaphores(wait, UINT64_MAX) != vk::Result::eSuccess) throw std::runtime_error("no end");
    }

    Shadows shadows;
    Image picture{vk::Format::eR8G8B8A8Unorm};
    vk::raii::RenderPass picturePass;

private:
    struct FrameData { // Frame in shaders.glsl
        glm::mat4 clipFromWorld, worldFromClip;
        glm::vec4 eye;
        Lights lights;
    };
    struct Slot { // one of the frames in flight
        uint64_t frame = 0;
        vk::raii::CommandPool pool = nullptr;
        std::vector<vk::raii::CommandBuffer> commands; // the second after submitted shadows
    };
    static constexpr vk::DeviceSize kPart = 2048; // bytes, for any alignment
    static constexpr vk::DeviceSize kPositionsAt = 2 * kPart * kInFlight;
    static constexpr auto kReadable = vk::ImageLayout::eShaderReadOnlyOptimal;

    void beginPass(const vk::raii::CommandBuffer& commands, vk::RenderPass pass, vk::Framebuffer into,
                   uint32_t images) const
    {
        const std::vector<vk::ClearValue> zeros(images);
        commands.beginRenderPass({pass, into, {{}, size_}, zeros}, vk::SubpassContents::eInline);
        commands.setViewport(0, vk::Viewport(0, 0, float(size_.width), float(size_.height), 0, 1));
        commands.setScissor(0, vk::Rect2D({}, size_));
    }
    size_t glassAt() const { return scene_.objects.size() - 1; }
    void drawObjects(const vk::raii::CommandBuffer& commands, const vk::raii::Pipeline& by, size_t i, size_t end) const
    {
        commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *by);
        commands.bindVertexBuffers(0, *buffer_, kPositionsAt);
        commands.bindIndexBuffer(*buffer_, indicesAt_, vk::IndexType::eUint32);
        for (; i < end; ++i) {
            const Object& object = scene_.objects[i];
            commands.pushConstants<glm::vec4>(*layout_, vk::ShaderStageFlagBits::eFragment, 0, object.colour);
            commands.drawIndexed(object.indexCount, 1, object.firstIndex, int32_t(object.firstVertex), 0);
        }
    }

    /// Tells the shaders what they read. Descriptors that are pushed are those of the frame; an engine that keeps sets
    /// writes them again when GnVisibility::revision or GnSampledShadows::revision has grown.
    /// \param maps Null: there is nothing yet but FrameData.
    void name(const vk::raii::CommandBuffer& commands, vk::DeviceSize at, const GnSampledShadows* maps) const
    {
        using Type = vk::DescriptorType;
        const vk::DescriptorBufferInfo data(*buffer_, at, sizeof(FrameData)),
            constants(*buffer_, at + kPart, kLights * GN_SAMPLED_LIGHT_SIZE);
        std::vector<vk::WriteDescriptorSet> writes{{{}, 0, 0, 1, Type::eUniformBuffer, nullptr, &data}};
        std::vector<vk::DescriptorImageInfo> images;
        if (maps) {
            const vk::ImageView visibility = shadows.view.visibility()->imageView;
            for (const vk::ImageView view : {*albedo_.view, *normals_.view, *depth_.view, visibility})
                images.emplace_back(maps->sampler, view, kReadable);
            for (uint32_t i = 0; i < kLights; ++i)
                images.emplace_back(maps->sampler, maps->pMaps[i], kReadable);
            for (uint32_t i = 0; i < 4; ++i)
                writes.push_back({{}, 1 + i, 0, 1, Type::eCombinedImageSampler, &images[i]});
            writes.push_back({{}, 5, 0, 1, Type::eUniformBuffer, nullptr, &constants});
            writes.push_back({{}, 6, 0, kLights, Type::eSampledImage, &images[4]});
            writes.push_back({{}, 7, 0, 1, Type::eSampler, &images[0]});
        }
        commands.pushDescriptorSetKHR(vk::PipelineBindPoint::eGraphics, *layout_, 0, writes);
    }
    void show(const vk::raii::CommandBuffer& commands, vk::Image image) const
    {
        using Layout = vk::ImageLayout;
        const auto become = [&](Layout from, vk::AccessFlags2 written, Layout to, vk::AccessFlags2 access) {
            const vk::ImageMemoryBarrier2 one(Stage::eTransfer, written, Stage::eTransfer, access, from, to, 0, 0,
                                              image, {vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1});
            commands.pipelineBarrier2(vk::DependencyInfo({}, {}, {}, one));
        };
        const vk::ImageSubresourceLayers colour(vk::ImageAspectFlagBits::eColor, 0, 0, 1);
        const std::array corners{vk::Offset3D(), vk::Offset3D(int32_t(size_.width), int32_t(size_.height), 1)};
        become(Layout::eUndefined, {}, Layout::eTransferDstOptimal, vk::AccessFlagBits2::eTransferWrite);
        commands.blitImage(*picture.image, Layout::eTransferSrcOptimal, image, Layout::eTransferDstOptimal,
                           vk::ImageBlit(colour, corners, colour, corners), vk::Filter::eNearest);
        become(Layout::eTransferDstOptimal, vk::AccessFlagBits2::eTransferWrite, Layout::ePresentSrcKHR, {});
    }
    /// \param frame The last of a frame says so to the timeline.
    void submit(const vk::raii::CommandBuffer& commands, const Target& target, uint64_t frame) const
    {
        commands.end();
        const vk::CommandBufferSubmitInfo buffer(*commands);
        const vk::SemaphoreSubmitInfo wait(target.acquired, 0, Stage::eTransfer);
        const std::array signals{vk::SemaphoreSubmitInfo(*timeline_, frame, Stage::eAllCommands),
                                 vk::SemaphoreSubmitInfo(target.drawn, 0, Stage::eTransfer)};
        const uint32_t shown = target.image ? 1 : 0;
        gpu_.queue.submit2(vk::SubmitInfo2({}, shown, &wait, 1, &buffer, frame ? 1 + shown : 0, signals.data()));
    }

    const Gpu& gpu_;
    const Scene& scene_;
    vk::Extent2D size_;
    uint64_t frame_ = 0;
    vk::raii::DeviceMemory bufferMemory_ = nullptr;
    vk::raii::Buffer buffer_ = nullptr; // all that the CPU writes: data of each slot, positions, indices
    std::byte* mapped_ = nullptr;
    vk::DeviceSize indicesAt_ = 0;
    Image albedo_{vk::Format::eR8G8B8A8Unorm}, normals_{vk::Format::eR16G16B16A16Sfloat}, depth_{kDepthFormat};
    vk::raii::DescriptorSetLayout setLayout_ = nullptr;
    vk::raii::PipelineLayout layout_ = nullptr;
    vk::raii::RenderPass surfacePass_ = nullptr;
    std::array<vk::raii::Pipeline, 3> pipelines_{nullptr, nullptr, nullptr}; // surfaces, lighting, glass
    vk::raii::Framebuffer intoSurfaces_ = nullptr, intoPicture_ = nullptr;
    vk::raii::Semaphore timeline_ = nullptr;
    std::array<Slot, kInFlight> slots_;
};

} // namespace embed
