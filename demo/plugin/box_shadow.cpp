// A shadow algorithm of one's own as a plug-in: whatever a caster's bounding box hides from the light is dark.
//
// It is as wrong as it is short; `gnomon bench --plugin` says by how much. Yours begins at visibility(), which answers
// for one pixel on the CPU. A pass on the GPU is a GN_PASS_RASTER or GN_PASS_COMPUTE with pfnRecord, which records any
// Vulkan commands; `gnomon/algorithm.h` explains kinds of passes, what they touch, and what is kept between frames.
#include <gnomon/algorithm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace {

using Vec = std::array<double, 3>; // metres from the frame's origin

Vec operator+(const Vec& a, const Vec& b)
{
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vec operator-(const Vec& a, const Vec& b)
{
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec operator*(const Vec& a, double s)
{
    return {a[0] * s, a[1] * s, a[2] * s};
}
double dot(const Vec& a, const Vec& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <typename Number>
Vec vec(const Number* v)
{
    return {v[0], v[1], v[2]};
}

struct Box {
    Vec low, high;
};

const GnPluginInterface* gn = nullptr;
std::vector<Box> boxes; // of all tasks of a frame: declared one after the other, before any pass runs
uint64_t boxesOfFrame = 0;

/// What a pass needs of its task, whose pointers end with the declaration.
struct Work {
    GnImageRef depth, visibility;
    GnBufferRef depths, shades;
    VkRect2D area;
    VkExtent2D extent;
    GnDepthConvention convention;
    GnLightType type;
    float clipFromWorld[16], position[3], direction[3], range, cosCone;
    uint32_t layer, firstBox, boxCount;
};
static_assert(sizeof(Work) <= 256); // as GnPassInfo::userDataSize

/// Where three planes meet: x, y and z of the pixel, each as row - value * w of the matrix.
Vec worldPoint(const Work& work, double x, double y, double z)
{
    const float* m = work.clipFromWorld;
    Vec n[3];
    double d[3];
    const double values[3] = {x, y, z};
    for (int row = 0; row < 3; ++row) {
        for (int i = 0; i < 3; ++i)
            n[row][i] = double(m[4 * i + row]) - values[row] * double(m[4 * i + 3]);
        d[row] = values[row] * double(m[15]) - double(m[12 + row]);
    }
    const Vec sum = cross(n[1], n[2]) * d[0] + cross(n[2], n[0]) * d[1] + cross(n[0], n[1]) * d[2];
    return sum * (1.0 / dot(n[0], cross(n[1], n[2])));
}

/// Whether the way from the point, `way` long, meets the box. A box around the point is its own caster's: no shadow.
bool hides(const Box& box, const Vec& point, const Vec& way)
{
    double from = 0.0, to = 1.0;
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
        constexpr double kSkin = 1e-3; // metres
        inside = inside && point[i] > box.low[i] - kSkin && point[i] < box.high[i] + kSkin;
        const double a = (box.low[i] - point[i]) / way[i], b = (box.high[i] - point[i]) / way[i];
        from = std::max(from, std::min(a, b)); // without a way along the axis: infinities, or NaN, which loses
        to = std::min(to, std::max(a, b));
    }
    return !inside && from < to;
}

/// Your idea goes here. 1: lit, 0: dark. \param point on the surface that the pixel shows
double visibility(const Work& work, const Vec& point)
{
    const Vec light = vec(work.position), travels = vec(work.direction);
    constexpr double kFar = 1e4; // metres; a directional light's way
    const Vec way = work.type == GN_LIGHT_TYPE_DIRECTIONAL ? travels * -kFar : light - point;
    const double distance = std::sqrt(dot(way, way));
    if (work.type != GN_LIGHT_TYPE_DIRECTIONAL && distance > double(work.range)) return 1.0; // no light to lose
    if (work.type == GN_LIGHT_TYPE_SPOT && -dot(way, travels) < double(work.cosCone) * distance) return 1.0;
    for (uint32_t i = 0; i < work.boxCount; ++i)
        if (hides(boxes[work.firstBox + i], point, way)) return 0.0;
    return 1.0;
}

template <typename Function>
Function vulkan(const char* name)
{
    return reinterpret_cast<Function>(gn->pfnGetDeviceProcAddr(gn->device, name));
}

VkBufferImageCopy copyOf(const Work& work, VkImageAspectFlags aspect, uint32_t layer)
{
    VkBufferImageCopy copy{};
    copy.imageSubresource = {aspect, 0, layer, 1};
    copy.imageOffset = {work.area.offset.x, work.area.offset.y, 0};
    copy.imageExtent = {work.area.extent.width, work.area.extent.height, 1};
    return copy;
}

void GN_CALL readDepth(GnPassContext context, VkCommandBuffer commands, const VkRect2D*, void* data)
{
    const Work& work = *static_cast<const Work*>(data);
    const VkBufferImageCopy copy = copyOf(work, VK_IMAGE_ASPECT_DEPTH_BIT, 0);
    vulkan<PFN_vkCmdCopyImageToBuffer>("vkCmdCopyImageToBuffer")(commands, gn->pfnVkImage(context, work.depth),
                                                                 VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                                                 gn->pfnVkBuffer(context, work.depths), 1, &copy);
}

void GN_CALL shade(GnPassContext context, void* data)
{
    const Work& work = *static_cast<const Work*>(data);
    const auto* depths = static_cast<const float*>(gn->pfnMapped(context, work.depths));
    auto* shades = static_cast<uint8_t*>(gn->pfnMapped(context, work.shades));
    const float nothing = work.convention == GN_DEPTH_STANDARD ? 1.0f : 0.0f; // the sky's depth
    for (uint32_t i = 0; i < work.area.extent.width * work.area.extent.height; ++i) {
        const double x = work.area.offset.x + i % work.area.extent.width + 0.5;
        const double y = work.area.offset.y + i / work.area.extent.width + 0.5;
        const Vec point =
            worldPoint(work, 2 * x / work.extent.width - 1, 2 * y / work.extent.height - 1, double(depths[i]));
        shades[i] = depths[i] == nothing ? 255 : static_cast<uint8_t>(255.0 * visibility(work, point) + 0.5);
    }
}

void GN_CALL writeVisibility(GnPassContext context, VkCommandBuffer commands, const VkRect2D*, void* data)
{
    const Work& work = *static_cast<const Work*>(data);
    const VkBufferImageCopy copy = copyOf(work, VK_IMAGE_ASPECT_COLOR_BIT, work.layer);
    vulkan<PFN_vkCmdCopyBufferToImage>("vkCmdCopyBufferToImage")(commands, gn->pfnVkBuffer(context, work.shades),
                                                                 gn->pfnVkImage(context, work.visibility),
                                                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
}

uint32_t keepBoxes(const GnShadowTask& task, double scale)
{
    if (boxesOfFrame != task.frame) boxes.clear();
    boxesOfFrame = task.frame;
    const auto first = static_cast<uint32_t>(boxes.size());
    for (uint32_t i = 0; i < task.casterCount; ++i) {
        const Vec low = vec(task.pCasters[i].boundsMin), high = vec(task.pCasters[i].boundsMax);
        const Vec inset = (high - low) * (0.5 - 0.5 * scale);
        boxes.push_back({low + inset, high - inset});
    }
    return first;
}

GnAccess access(GnAccessKind kind, GnImageRef image, GnBufferRef buffer, uint32_t layer = 0)
{
    GnAccess out{};
    out.kind = kind;
    out.image = image;
    out.buffer = buffer;
    out.baseLayer = layer;
    return out;
}

void declarePass(GnPassBuilder builder, const char* name, GnPassKind kind, const Work& work,
                 const GnAccess (&touched)[2], PFN_gnRecord record, PFN_gnRun run)
{
    GnPassInfo pass{};
    pass.pName = name;
    pass.kind = kind;
    pass.scope = GN_SCOPE_TASK;
    pass.accessCount = 2;
    pass.pAccesses = touched;
    pass.pfnRecord = record;
    pass.pfnRun = run;
    pass.userDataSize = sizeof work;
    pass.pUserData = &work;
    gn->pfnPass(builder, &pass); // a failure is a message, and another method serves the light
}

GnBufferRef bufferFor(GnPassBuilder builder, const char* name, GnBufferPlace place, VkDeviceSize size)
{
    GnBufferInfo info{};
    info.pName = name;
    info.scope = GN_SCOPE_TASK;
    info.size = size;
    info.place = place;
    return gn->pfnBuffer(builder, &info);
}

void GN_CALL declare(void*, GnPassBuilder builder, const GnShadowTask* task)
{
    const VkDeviceSize pixels = VkDeviceSize{task->area.extent.width} * task->area.extent.height;
    Work work{};
    work.depth = task->depth;
    work.visibility = task->visibility;
    work.layer = task->layer;
    work.depths = bufferFor(builder, "box_shadow.depths", GN_BUFFER_READBACK, pixels * sizeof(float));
    work.shades = bufferFor(builder, "box_shadow.shades", GN_BUFFER_UPLOAD, pixels);
    work.area = task->area;
    work.extent = task->extent;
    work.convention = task->depthConvention;
    work.type = task->lightType;
    std::copy_n(task->clipFromWorld, 16, work.clipFromWorld);
    std::copy_n(task->lightPosition, 3, work.position);
    std::copy_n(task->lightDirection, 3, work.direction);
    work.range = task->lightRange;
    work.cosCone = std::cos(task->coneAngle);
    work.firstBox = keepBoxes(*task, task->pSettings[0]);
    work.boxCount = task->casterCount;
    declarePass(builder, "box_shadow.depth", GN_PASS_TRANSFER, work,
                {access(GN_ACCESS_COPY_SOURCE, work.depth, 0), access(GN_ACCESS_WRITE, 0, work.depths)}, readDepth,
                nullptr);
    declarePass(builder, "box_shadow.shade", GN_PASS_HOST, work,
                {access(GN_ACCESS_READ, 0, work.depths), access(GN_ACCESS_WRITE, 0, work.shades)}, nullptr, shade);
    declarePass(builder, "box_shadow.write", GN_PASS_TRANSFER, work,
                {access(GN_ACCESS_READ, 0, work.shades), access(GN_ACCESS_WRITE, work.visibility, 0, work.layer)},
                writeVisibility, nullptr);
}

} // namespace

const uint32_t gnPluginVersion = GN_PLUGIN_VERSION;

GnResult GN_CALL gnPluginMain(GnContext context, const GnPluginInterface* pInterface)
{
    GnSettingInfo scale{};
    scale.pName = "scale";
    scale.pDescription = "Size of the boxes, as a share of the casters' bounds.";
    scale.minimum = 0.1;
    scale.maximum = 1.0;
    scale.value = 1.0;
    GnAlgorithmInfo info{};
    info.pName = "box_shadow";
    info.pSource = "demo/plugin of gnomon";
    info.traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT;
    info.roundTrips = 1; // depth goes to the CPU, visibility comes back
    info.settingCount = 1;
    info.pSettings = &scale;
    info.pfnDeclare = &declare;
    gn = pInterface;
    return gn->pfnRegisterAlgorithm(context, &info);
}
