#include "renderer.hpp"

#include <cmath>
#include <cstring>
#include <span>

#include "pipelines.hpp"

namespace stranger {
namespace {

constexpr VkImageUsageFlags kTargetUsage =
    VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
constexpr VkImageUsageFlags kDepthUsage =
    VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

Vec3 faceNormal(const Vec3& a, const Vec3& b, const Vec3& c)
{
    const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    Vec3 n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (float& x : n)
        x = length > 0.0f ? x / length : 0.0f;
    return n;
}

constexpr uint32_t kVisibilityBinding = 3; // shaders/lighting.frag

VkDescriptorSetLayout createSetLayout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings)
{
    const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                               .bindingCount = static_cast<uint32_t>(bindings.size()),
                                               .pBindings = bindings.data()};
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    STRANGER_CHECK(vkCreateDescriptorSetLayout(device.device, &info, nullptr, &layout));
    return layout;
}
} // namespace

Renderer::Renderer(const Device& device, const Options& options)
    : device_(device), options_(options), shadows_(device, options, makeMeshes())
{
    createGeometry();
    createImages();
    createSets();
    createSlots();
    surfacePipeline_ =
        createSurfacePipeline(device, pipelineLayout_, options.size, albedo_.format, normals_.format, depth_.format);
    lightingPipeline_ = createLightingPipeline(device, pipelineLayout_, options.size, picture_.format);
}

Renderer::~Renderer()
{
    const VkDevice device = device_.device;
    vkQueueWaitIdle(device_.queue);
    vkDestroyPipeline(device, surfacePipeline_, nullptr);
    vkDestroyPipeline(device, lightingPipeline_, nullptr);
    vkDestroySemaphore(device, timeline_, nullptr);
    vkDestroyQueryPool(device, queries_, nullptr);
    vkDestroyCommandPool(device, commandPool_, nullptr);
    vkDestroyPipelineLayout(device, pipelineLayout_, nullptr);
    vkDestroyDescriptorPool(device, setPool_, nullptr);
    for (VkDescriptorSetLayout layout : setLayouts_)
        vkDestroyDescriptorSetLayout(device, layout, nullptr);
    vkDestroySampler(device, sampler_, nullptr);
    for (Slot& slot : slots_)
        device_.destroy(slot.frameData);
    device_.destroy(vertices_);
    for (Image* pImage : {&albedo_, &normals_, &depth_, &picture_})
        device_.destroy(*pImage);
}

void Renderer::createGeometry()
{
    std::vector<Vertex> vertices;
    for (const Mesh& mesh : makeMeshes())
        for (size_t i = 0; i < mesh.indices.size(); i += 3) {
            const uint32_t* corners = &mesh.indices[i];
            const Vec3 normal =
                faceNormal(mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]);
            for (size_t corner = 0; corner < 3; ++corner) {
                Vertex vertex;
                std::memcpy(vertex.position, mesh.positions[corners[corner]].data(), sizeof vertex.position);
                std::memcpy(vertex.normal, normal.data(), sizeof vertex.normal);
                std::memcpy(vertex.colour, mesh.colour.data(), sizeof vertex.colour);
                vertices.push_back(vertex);
            }
        }
    vertexCount_ = static_cast<uint32_t>(vertices.size());
    vertices_ = device_.createBuffer(vertices.size() * sizeof(Vertex), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    std::memcpy(vertices_.mapped, vertices.data(), vertices.size() * sizeof(Vertex));
}

void Renderer::createImages()
{
    albedo_ = device_.createImage(VK_FORMAT_R8G8B8A8_UNORM, options_.size, kTargetUsage);
    normals_ = device_.createImage(VK_FORMAT_R16G16B16A16_SFLOAT, options_.size, kTargetUsage);
    depth_ = device_.createImage(VK_FORMAT_D32_SFLOAT, options_.size, kDepthUsage);
    picture_ = device_.createImage(VK_FORMAT_R8G8B8A8_UNORM, options_.size, kTargetUsage);
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    STRANGER_CHECK(vkCreateSampler(device_.device, &info, nullptr, &sampler_));
}

void Renderer::createSets()
{
    const VkDescriptorType uniform = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                           sampled = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    const VkShaderStageFlags fragment = VK_SHADER_STAGE_FRAGMENT_BIT;
    const VkDescriptorSetLayoutBinding frameBindings[] = {
        {0, uniform, 1, fragment | VK_SHADER_STAGE_VERTEX_BIT, nullptr}};
    const VkDescriptorSetLayoutBinding imageBindings[] = {{0, sampled, 1, fragment, nullptr},
                                                          {1, sampled, 1, fragment, nullptr},
                                                          {2, sampled, 1, fragment, nullptr},
                                                          {kVisibilityBinding, sampled, 1, fragment, nullptr}};
    setLayouts_[0] = createSetLayout(device_, frameBindings);
    setLayouts_[1] = createSetLayout(device_, imageBindings);
    const VkPipelineLayoutCreateInfo pipelineInfo{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = 2, .pSetLayouts = setLayouts_.data()};
    STRANGER_CHECK(vkCreatePipelineLayout(device_.device, &pipelineInfo, nullptr, &pipelineLayout_));
    const uint32_t slots = Shadows::kFramesInFlight;
    const VkDescriptorPoolSize sizes[] = {{uniform, slots}, {sampled, 4 * slots}};
    const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                              .maxSets = 2 * slots,
                                              .poolSizeCount = 2,
                                              .pPoolSizes = sizes};
    STRANGER_CHECK(vkCreateDescriptorPool(device_.device, &poolInfo, nullptr, &setPool_));
    const VkDescriptorSetAllocateInfo setInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = setPool_,
                                              .descriptorSetCount = 2,
                                              .pSetLayouts = setLayouts_.data()};
    for (Slot& slot : slots_) {
        STRANGER_CHECK(vkAllocateDescriptorSets(device_.device, &setInfo, slot.sets.data()));
        slot.frameData = device_.createBuffer(sizeof(FrameData), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
        const VkDescriptorBufferInfo frameData{slot.frameData.buffer, 0, sizeof(FrameData)};
        const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                         .dstSet = slot.sets[0],
                                         .descriptorCount = 1,
                                         .descriptorType = uniform,
                                         .pBufferInfo = &frameData};
        vkUpdateDescriptorSets(device_.device, 1, &write, 0, nullptr);
        writeImage(slot.sets[1], 0, albedo_.view);
        writeImage(slot.sets[1], 1, normals_.view);
        writeImage(slot.sets[1], 2, depth_.view);
    }
}

void Renderer::writeImage(VkDescriptorSet set, uint32_t binding, VkImageView view) const
{
    const VkDescriptorImageInfo image{sampler_, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set,
                                     .dstBinding = binding,
                                     .descriptorCount = 1,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                     .pImageInfo = &image};
    vkUpdateDescriptorSets(device_.device, 1, &write, 0, nullptr);
}

void Renderer::createSlots()
{
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    STRANGER_CHECK(vkCreateCommandPool(device_.device, &poolInfo, nullptr, &commandPool_));
    const VkCommandBufferAllocateInfo commandInfo{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = commandPool_, .commandBufferCount = 2};
    for (Slot& slot : slots_)
        STRANGER_CHECK(vkAllocateCommandBuffers(device_.device, &commandInfo, slot.commands.data()));
    const VkQueryPoolCreateInfo queryInfo{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                          .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                          .queryCount = 2 * Shadows::kFramesInFlight};
    STRANGER_CHECK(vkCreateQueryPool(device_.device, &queryInfo, nullptr, &queries_));
    const VkSemaphoreTypeCreateInfo typeInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                             .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo semaphoreInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &typeInfo};
    STRANGER_CHECK(vkCreateSemaphore(device_.device, &semaphoreInfo, nullptr, &timeline_));
}

void Renderer::nameVisibility(Slot& slot) const
{
    const GnVisibility visibility = shadows_.visibility();
    if (slot.revision == visibility.revision) return;
    slot.revision = visibility.revision;
    writeImage(slot.sets[1], kVisibilityBinding, visibility.imageView);
}
} // namespace stranger
