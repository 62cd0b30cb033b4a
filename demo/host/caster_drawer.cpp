#include "demo/host/caster_drawer.hpp"

#include "demo/host/pipelines.hpp"
#include "shaders/demo/alpha.h"
#include "shaders/demo_host_caster_frag.h"
#include "shaders/demo_host_caster_vert.h"

namespace gnomon::demo {

CasterDrawer::CasterDrawer(const Device& device, const SceneGeometry& geometry)
    : device_(device), geometry_(geometry),
      layout_(makePipelineLayout(device, {}, sizeof(glm::mat4), VK_SHADER_STAGE_VERTEX_BIT))
{
}

void GN_CALL CasterDrawer::draw(VkCommandBuffer cmd, const GnCasterProjection* projection, void* user)
{
    const auto& caster = *static_cast<const HostDrawnCaster*>(user);
    CasterDrawer& self = *caster.drawer;
    const glm::dvec3 origin(projection->origin[0], projection->origin[1], projection->origin[2]);
    glm::dmat4 worldFromObject(caster.transform.linear);
    worldFromObject[3] = glm::dvec4(caster.transform.translation - origin, 1.0);
    glm::mat4 clipFromWorld;
    for (int i = 0; i < 16; ++i)
        clipFromWorld[i / 4][i % 4] = projection->clipFromWorld[i];
    const glm::mat4 clipFromObject = clipFromWorld * glm::mat4(worldFromObject);

    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, self.pipeline(projection->depthFormat, caster.alphaTested));
    vkCmdPushConstants(cmd, self.layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof clipFromObject, &clipFromObject);
    const VkBuffer positions = self.geometry_.positions.get();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(cmd, 0, 1, &positions, &offset);
    vkCmdBindIndexBuffer(cmd, self.geometry_.indices.get(), 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(cmd, caster.range.indexCount, 1, caster.range.firstIndex, caster.range.vertexOffset, 0);
}

float GN_CALL CasterDrawer::opacity(uint32_t triangle, float u, float v, void* user)
{
    const Mesh& mesh = *static_cast<const HostDrawnCaster*>(user)->mesh;
    const uint32_t* corner = &mesh.indices[size_t(triangle) * 3];
    const glm::vec3 position =
        (1.0f - u - v) * mesh.positions[corner[0]] + u * mesh.positions[corner[1]] + v * mesh.positions[corner[2]];
    return gpu::alphaOpacity(position);
}

VkPipeline CasterDrawer::pipeline(VkFormat depthFormat, bool alphaTested)
{
    UniquePipeline& made = pipelines_[{depthFormat, alphaTested}];
    if (!made.get())
        made = makeGraphicsPipeline(device_, {.vertex = k_demo_host_caster_vert,
                                              .fragment = k_demo_host_caster_frag,
                                              .layout = layout_.get(),
                                              .readsPositions = true,
                                              .depth = depthFormat,
                                              .dynamicDepthBias = true,
                                              .constant0 = alphaTested});
    return made.get();
}

} // namespace gnomon::demo
