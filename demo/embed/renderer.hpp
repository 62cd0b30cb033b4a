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
        createBuffers();
        using Type = vk::DescriptorType;
        using Stage = vk::ShaderStageFlagBits;
        const vk::DescriptorSetLayoutBinding data(0, Type::eUniformBuffer, 1, Stage::eVertex | Stage::eFragment);
        std::vector<vk::DescriptorSetLayoutBinding> images; // albedo, normals, depth, visibility of either view
        for (uint32_t i = 0; i < 5; ++i)
            images.emplace_back(i, Type::eCombinedImageSampler, 1, Stage::eFragment);
        setLayouts_.emplace_back(gpu.device, vk::DescriptorSetLayoutCreateInfo({}, data));
        setLayouts_.emplace_back(gpu.device, vk::DescriptorSetLayoutCreateInfo({}, images));
        const std::array setLayouts{*setLayouts_[0], *setLayouts_[1]};
        const vk::PushConstantRange colour(Stage::eFragment, 0, sizeof(glm::vec4));
        layout_ = {gpu.device, vk::PipelineLayoutCreateInfo({}, setLayouts, colour)};
        surfaces_ = gpu.createPipeline(*layout_, k_surface_vert, k_surface_frag, {albedo_.format, normals_.format},
                                       depth_.format, true, false);
        depthAlone_ = gpu.createPipeline(*layout_, k_surface_vert, {}, {}, depth_.format, true, false);
        lighting_ = gpu.createPipeline(*layout_, k_lighting_vert, k_lighting_frag, {picture.format}, {}, false, false);
        glass_ = gpu.createPipeline(*layout_, k_surface_vert, k_glass_frag, {picture.format}, {}, true, true);

        const std::array sizes{vk::DescriptorPoolSize(Type::eUniformBuffer, kInFlight),
                               vk::DescriptorPoolSize(Type::eCombinedImageSampler, 5 * kInFlight)};
        setPool_ = {gpu.device, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                             2 * kInFlight, sizes)};
        for (uint32_t i = 0; i < kInFlight; ++i) {
            slots_[i].sets = vk::raii::DescriptorSets(gpu.device, {*setPool_, setLayouts});
            slots_[i].pool = {gpu.device, vk::CommandPoolCreateInfo({}, gpu.family)};
            slots_[i].commands = vk::raii::CommandBuffers(gpu.device, {*slots_[i].pool, {}, 2});
            const vk::DescriptorBufferInfo buffer(*buffers_[i], 0, sizeof(FrameData));
            const vk::WriteDescriptorSet write(*slots_[i].sets[0], 0, 0, Type::eUniformBuffer, {}, buffer);
            gpu.device.updateDescriptorSets(write, {});
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
        const auto read = Usage::eSampled | Usage::eTransferSrc;
        const std::array images{&albedo_, &normals_, &depth_, &front_, &picture};
        std::vector<vk::raii::Image*> placed;
        for (Image* image : images) {
            const bool depth = image->format == vk::Format::eD32Sfloat;
            image->image = {
                gpu_.device,
                vk::ImageCreateInfo({}, vk::ImageType::e2D, image->format, {size.width, size.height, 1}, 1, 1,
                                    vk::SampleCountFlagBits::e1, vk::ImageTiling::eOptimal,
                                    read | (depth ? Usage::eDepthStencilAttachment : Usage::eColorAttachment))};
            placed.push_back(&image->image);
        }
        std::vector<vk::DeviceSize> places;
        imageMemory_ = gpu_.place<vk::raii::Image>(placed, vk::MemoryPropertyFlagBits::eDeviceLocal, places);
        for (Image* image : images)
            image->view = {gpu_.device, vk::ImageViewCreateInfo({}, *image->image, vk::ImageViewType::e2D,
                                                                image->format, {}, wholeOf(image->format))};
        for (const Slot& slot : slots_)
            for (uint32_t i = 0; i < 3; ++i)
                writeImage(slot, i, *images[i]->view);
    }

    /// \param recorded gnomon records into our command buffer; else it submits to the queue between two of ours.
    /// \param ui Draws over the picture, which is in COLOR_ATTACHMENT_OPTIMAL.
    template <typename Ui>
    void draw(const Camera& camera, const std::array<Light, 3>& lights, bool recorded, Ui&& ui, const Target& target)
    {
        Slot& slot = slots_[++frame_ % kInFlight];
        waitFor(slot.frame);
        const uint64_t completed = std::exchange(slot.frame, frame_);
        slot.pool.reset();
        const glm::mat3& axes = camera.worldFromView;
        *slot.data = {camera.clipFromWorld,
                      {camera.eye, camera.clipFromView[3][2]},
                      {axes[0], camera.clipFromView[0][0]},
                      {axes[1], camera.clipFromView[1][1]},
                      {axes[2], 0},
                      lights};

        const vk::raii::CommandBuffer* commands = &begin(slot.commands[0]);
        pass(*commands, {*slot.sets[0]}, surfaces_, {&albedo_, &normals_}, &depth_,
             [&] { drawObjects(*commands, 0, glassAt()); });
        pass(*commands, {*slot.sets[0]}, depthAlone_, {}, &front_,
             [&] { drawObjects(*commands, 0, scene_.objects.size()); });
        if (!recorded) submit(*commands, {}, 0);
        shadows.render(recorded ? **commands : vk::CommandBuffer(), camera, lights, normals_, {&depth_, &front_}, size_,
                       frame_, completed);
        nameVisibility(slot);
        if (!recorded) commands = &begin(slot.commands[1]);
        pass(*commands, {*slot.sets[0], *slot.sets[1]}, lighting_, {&picture}, nullptr, [&] {
            commands->draw(3, 1, 0, 0);
            commands->bindPipeline(vk::PipelineBindPoint::eGraphics, *glass_);
            drawObjects(*commands, glassAt(), scene_.objects.size());
        });
        barrier(*commands, *picture.image, picture.format, vk::ImageLayout::eShaderReadOnlyOptimal,
                vk::ImageLayout::eColorAttachmentOptimal);
        ui(*commands);
        barrier(*commands, *picture.image, picture.format, vk::ImageLayout::eColorAttachmentOptimal,
                vk::ImageLayout::eTransferSrcOptimal);
        if (target.image) show(*commands, target.image);
        submit(*commands, target, frame_);
    }

    void waitFor(uint64_t frame) const
    {
        const vk::SemaphoreWaitInfo wait({}, *timeline_, frame);
        if (gpu_.device.waitSemaphores(wait, UINT64_MAX) != vk::Result::eSuccess) throw std::runtime_error("no end");
    }

    Image picture{vk::Format::eR8G8B8A8Unorm};

private:
    struct FrameData { // shaders/frame.glsl
        glm::mat4 clipFromWorld;
        glm::vec4 eye, right, up, back;
        std::array<Light, 3> lights;
    };
    struct Slot { // one of the frames in flight
        uint64_t frame = 0;
        std::vector<vk::raii::DescriptorSet> sets; // the second for lighting: written while the first is bound
        vk::raii::CommandPool pool = nullptr;
        std::vector<vk::raii::CommandBuffer> commands; // the second after submitted shadows
        std::array<uint64_t, 2> revisions{};           // of the visibility that the set names
        FrameData* data = nullptr;
    };

    void createBuffers()
    {
        using Usage = vk::BufferUsageFlagBits;
        const auto& [positions, indices, objects] = scene_;
        for (uint32_t i = 0; i < kInFlight; ++i)
            buffers_.emplace_back(gpu_.device, vk::BufferCreateInfo({}, sizeof(FrameData), Usage::eUniformBuffer));
        buffers_.emplace_back(gpu_.device, vk::BufferCreateInfo({}, positions.size() * 12, Usage::eVertexBuffer));
        buffers_.emplace_back(gpu_.device, vk::BufferCreateInfo({}, indices.size() * 4, Usage::eIndexBuffer));
        std::vector<vk::raii::Buffer*> placed;
        for (vk::raii::Buffer& buffer : buffers_)
            placed.push_back(&buffer);
        std::vector<vk::DeviceSize> places;
        using Property = vk::MemoryPropertyFlagBits;
        bufferMemory_ = gpu_.place<vk::raii::Buffer>(placed, Property::eHostVisible | Property::eHostCoherent, places);
        auto* mapped = static_cast<std::byte*>(bufferMemory_.mapMemory(0, VK_WHOLE_SIZE));
        for (uint32_t i = 0; i < kInFlight; ++i)
            slots_[i].data = reinterpret_cast<FrameData*>(mapped + places[i]);
        std::memcpy(mapped + places[kInFlight], positions.data(), positions.size() * 12);
        std::memcpy(mapped + places[kInFlight + 1], indices.data(), indices.size() * 4);
    }

    size_t glassAt() const { return scene_.objects.size() - 1; }
    void drawObjects(const vk::raii::CommandBuffer& commands, size_t first, size_t end) const
    {
        commands.bindVertexBuffers(0, *buffers_[kInFlight], {0});
        commands.bindIndexBuffer(*buffers_[kInFlight + 1], 0, vk::IndexType::eUint32);
        for (size_t i = first; i < end; ++i) {
            const Object& object = scene_.objects[i];
            commands.pushConstants<glm::vec4>(*layout_, vk::ShaderStageFlagBits::eFragment, 0, object.colour);
            commands.drawIndexed(object.indexCount, 1, object.firstIndex, int32_t(object.firstVertex), 0);
        }
    }

    /// Draws into images that are cleared to 0 (reversed: infinitely far), and makes them readable.
    template <typename Draw>
    void pass(const vk::raii::CommandBuffer& commands, std::initializer_list<vk::DescriptorSet> sets,
              const vk::raii::Pipeline& pipeline, std::initializer_list<const Image*> colours, const Image* depth,
              Draw&& draw) const
    {
        std::vector<const Image*> images(colours);
        if (depth) images.push_back(depth);
        std::vector<vk::RenderingAttachmentInfo> attachments;
        for (const Image* image : images) {
            barrier(commands, *image->image, image->format, vk::ImageLayout::eUndefined,
                    vk::ImageLayout::eAttachmentOptimal);
            attachments.emplace_back(*image->view, vk::ImageLayout::eAttachmentOptimal).loadOp =
                vk::AttachmentLoadOp::eClear;
        }
        commands.beginRendering(vk::RenderingInfo({}, {{}, size_}, 1, 0, uint32_t(colours.size()), attachments.data(),
                                                  depth ? &attachments.back() : nullptr));
        commands.setViewport(0, vk::Viewport(0, 0, float(size_.width), float(size_.height), 0, 1));
        commands.setScissor(0, vk::Rect2D({}, size_));
        commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline);
        commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout_, 0, sets, nullptr);
        draw();
        commands.endRendering();
        for (const Image* image : images)
            barrier(commands, *image->image, image->format, vk::ImageLayout::eAttachmentOptimal,
                    vk::ImageLayout::eShaderReadOnlyOptimal);
    }

    /// The sets name gnomon's images; when these have changed, a set is written before its next use.
    void nameVisibility(Slot& slot) const
    {
        for (uint32_t view = 0; view < 2; ++view) {
            const GnVisibility now = shadows.views[view].visibility().value();
            if (std::exchange(slot.revisions[view], now.revision) != now.revision)
                writeImage(slot, 3 + view, now.imageView);
        }
    }
    void writeImage(const Slot& slot, uint32_t binding, vk::ImageView view) const
    {
        const vk::DescriptorImageInfo image(*sampler_, view, vk::ImageLayout::eShaderReadOnlyOptimal);
        const vk::WriteDescriptorSet write(*slot.sets[1], binding, 0, vk::DescriptorType::eCombinedImageSampler, image);
        gpu_.device.updateDescriptorSets(write, {});
    }

    static const vk::raii::CommandBuffer& begin(const vk::raii::CommandBuffer& commands)
    {
        commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        return commands;
    }
    void show(const vk::raii::CommandBuffer& commands, vk::Image image) const
    {
        using Layout = vk::ImageLayout;
        const vk::ImageSubresourceLayers colour(vk::ImageAspectFlagBits::eColor, 0, 0, 1);
        const std::array corners{vk::Offset3D(), vk::Offset3D(int32_t(size_.width), int32_t(size_.height), 1)};
        barrier(commands, image, picture.format, Layout::eUndefined, Layout::eTransferDstOptimal);
        commands.blitImage(*picture.image, Layout::eTransferSrcOptimal, image, Layout::eTransferDstOptimal,
                           vk::ImageBlit(colour, corners, colour, corners), vk::Filter::eNearest);
        barrier(commands, image, picture.format, Layout::eTransferDstOptimal, Layout::ePresentSrcKHR);
    }
    /// \param frame The last of a frame says so to the timeline.
    void submit(const vk::raii::CommandBuffer& commands, const Target& target, uint64_t frame) const
    {
        commands.end();
        constexpr auto all = vk::PipelineStageFlagBits2::eAllCommands;
        const vk::CommandBufferSubmitInfo buffer(*commands);
        const vk::SemaphoreSubmitInfo wait(target.acquired, 0, all);
        const std::array signals{vk::SemaphoreSubmitInfo(*timeline_, frame, all),
                                 vk::SemaphoreSubmitInfo(target.drawn, 0, all)};
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
    vk::raii::DeviceMemory bufferMemory_ = nullptr, imageMemory_ = nullptr;
    std::vector<vk::raii::Buffer> buffers_; // FrameData of each slot, positions, indices
    Image albedo_{vk::Format::eR8G8B8A8Unorm}, normals_{vk::Format::eR16G16B16A16Sfloat};
    Image depth_{vk::Format::eD32Sfloat}, front_{vk::Format::eD32Sfloat}; // without and with the glass
    vk::raii::Sampler sampler_ = nullptr;
    std::vector<vk::raii::DescriptorSetLayout> setLayouts_;
    vk::raii::PipelineLayout layout_ = nullptr;
    vk::raii::Pipeline surfaces_ = nullptr, depthAlone_ = nullptr, lighting_ = nullptr, glass_ = nullptr;
    vk::raii::DescriptorPool setPool_ = nullptr;
    vk::raii::Semaphore timeline_ = nullptr;
    std::array<Slot, kInFlight> slots_;
};

} // namespace embed
