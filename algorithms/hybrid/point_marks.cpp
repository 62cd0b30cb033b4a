#include "algorithms/hybrid/point_marks.hpp"

#include "shaders/hybrid_points_frag.h"
#include "shaders/hybrid_points_vert.h"

namespace gnomon {

namespace {

struct PointsPush {
    glm::vec4 area;
    float value;
};

} // namespace

PointMarks::PointMarks(const AlgorithmServices& services, const char* name) : name_(name)
{
    const BindingInfo bindings[] = {{.binding = 5, .kind = BindingKind::storageBuffer}};
    GraphicsPipelineInfo pipeline;
    pipeline.name = name;
    pipeline.vertex.code = k_hybrid_points_vert;
    pipeline.fragment.code = k_hybrid_points_frag;
    pipeline.bindings = bindings;
    pipeline.pushBytes = sizeof(PointsPush);
    pipeline.topology = VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    points_ = services.pipelines->graphics(pipeline);
}

void PointMarks::declare(PassBuilder& passes, const ShadowTask& task, BufferId pixels,
                         std::span<const MarkRange> ranges) const
{
    const VkRect2D& drawn = task.view->area;
    const glm::vec4 area(drawn.offset.x, drawn.offset.y, drawn.extent.width, drawn.extent.height);
    passes.raster(name_)
        .reads(pixels)
        .writes(task.visibility, {.layer = task.layer, .blend = true})
        .area({drawn.offset.x, drawn.offset.y, drawn.extent.width, drawn.extent.height})
        .record([=, pipeline = points_](PassContext& gpu) {
            bool bound = false;
            for (const MarkRange& range : ranges) {
                if (range.count == 0) continue;
                if (!bound) gpu.bind(pipeline, {gpu.storage(5, pixels)});
                bound = true;
                gpu.push(PointsPush{.area = area, .value = range.value});
                gpu.vk->vkCmdDraw(gpu.cmd, range.count, 1, range.first, 0);
            }
        });
}

} // namespace gnomon
