#include "runtime/frame/views.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "runtime/base/make_room.hpp"
#include "runtime/frame/camera_view.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/select/frame_plan.hpp"

namespace gnomon {

namespace {

// What no frame of the last ten seconds (at 60 Hz) asked for is forgotten.
constexpr std::uint64_t kForgetFrames = 600;

template <typename Handle>
std::uint64_t bits(Handle handle)
{
    return (std::uint64_t)handle; // a pointer or a 64-bit number, as the platform has it
}

bool sameSize(VkExtent2D a, VkExtent2D b)
{
    return a.width == b.width && a.height == b.height;
}

Result<std::unique_ptr<PooledImage>> makeVisibility(const View& view, VkExtent2D extent, ResourcePool& pool)
{
    const std::uint32_t packed = (view.maxLights + kPackedLights - 1) / kPackedLights;
    return pool.ownedImage({.format = view.packed ? VK_FORMAT_R8G8B8A8_UNORM : VK_FORMAT_R8_UNORM,
                            .extent = extent,
                            .layers = view.packed ? packed : view.maxLights,
                            .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                     VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                            .name = "view.visibility",
                            .concurrent = true});
}

/// Visibility of the frame's size; the one before is kept, since the frame may yet be withdrawn.
Result<void> resizeVisibility(View& view, VkExtent2D extent, ResourcePool& pool, std::uint64_t frame)
{
    auto made = makeVisibility(view, extent, pool);
    if (!made) { // another attempt may need the place of the old one, which frames before this may still read
        if (view.visibility) pool.retire(std::move(view.visibility), frame - 1);
        return made.error();
    }
    view.replaced = std::move(view.visibility);
    view.visibility = std::move(*made);
    view.resized = true;
    view.replacedMadeIn = std::exchange(view.madeIn, frame);
    ++view.revision;
    view.grid->invalidate();
    return {};
}

/// Visibility before the first frame, of the size that the host expects.
Result<void> beginVisibility(View& view, VkExtent2D extent, ResourcePool& pool)
{
    auto made = makeVisibility(view, extent, pool);
    if (!made) return made.error();
    view.visibility = std::move(*made);
    view.revision = 1;
    return {};
}

/// Whether two frames of a view look from one place in one direction at one scale. Projections may differ: those of
/// hosts that jitter do in every frame, by less than a pixel.
bool samePose(const CameraView& a, const CameraView& b)
{
    return std::equal(std::begin(a.origin), std::end(a.origin), std::begin(b.origin)) && a.eye == b.eye &&
           a.viewFromWorld == b.viewFromWorld && a.constants.pixelSize == b.constants.pixelSize;
}

/// What methods do not read as the host has it.
Result<void> copyImages(ViewFrame& out, const ViewParts& parts)
{
    CameraView& camera = out.view->camera;
    if (copiesDepth(camera)) {
        const Result<ImageId> copy = parts.images.copyDepth(parts.graph, camera, out.depth);
        if (!copy) return copy.error();
        out.depth = *copy;
    }
    if (out.normals && copiesNormals(camera)) {
        const Result<ImageId> copy = parts.images.copyNormals(parts.graph, camera, out.normals);
        if (!copy) return copy.error();
        out.normals = *copy;
        camera.normalFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
    }
    return {};
}

} // namespace

Result<GnView> Views::add(const GnViewCreateInfo& info, const DeviceTable& vk, DeviceMemory& memory, ResourcePool& pool)
{
    const std::uint32_t maxLights = info.maxLights ? info.maxLights : 16;
    const std::uint32_t limit = std::min(256u, vk.properties.limits.maxImageArrayLayers);
    if (maxLights > limit)
        return Error{GN_ERROR_TOO_MANY, "MaxLights",
                     "maxLights is " + std::to_string(maxLights) + ", above " + std::to_string(limit)};
    if (const GnViewCreateFlags other = info.flags & ~GnViewCreateFlags{GN_VIEW_PACKED_BIT})
        return unknownFlags("GnViewCreateInfo::flags", other, "GnViewCreateFlagBits");
    auto view = std::make_unique<View>();
    view->id = nextId_++;
    view->name = info.pName ? info.pName : "view " + std::to_string(view->id);
    view->maxLights = maxLights;
    view->packed = (info.flags & GN_VIEW_PACKED_BIT) != 0;
    view->grid = std::make_unique<DepthGrid>(memory);
    View* raw = view.get();
    const std::uint64_t handle = views_.insert(std::move(view));
    if (!handle) return Error{GN_ERROR_TOO_MANY, "TooManyViews", "no more views"};
    raw->handle = (GnView)handle;
    if (info.imageExtent.width == 0 && info.imageExtent.height == 0) return raw->handle;
    Result<void> made = Error{};
    try {
        made = beginVisibility(*raw, info.imageExtent, pool);
    } catch (...) {
        views_.take(handle);
        throw;
    }
    if (made) return raw->handle;
    views_.take(handle);
    return made.error();
}

View* Views::find(GnView handle)
{
    auto* slot = views_.find(bits(handle));
    return slot ? slot->get() : nullptr;
}

void Views::makeRoomToTake()
{
    makeRoom(retiredGrids_);
}

std::unique_ptr<View> Views::take(GnView handle, std::uint64_t frame) noexcept
{
    std::unique_ptr<View> view = views_.take(bits(handle));
    if (view) retiredGrids_.push_back({frame, std::move(view->grid)});
    return view;
}

void Views::release(std::uint64_t completedFrame)
{
    std::erase_if(retiredGrids_, [&](const RetiredGrid& old) { return old.frame <= completedFrame; });
}

void forgetOldLights(Views& views, LightStates& lights, const SceneRegistry& scene, FramePlan& plan,
                     std::uint64_t frame)
{
    if (frame % kForgetFrames != 0) return;
    std::erase_if(lights, [&](const auto& entry) {
        if (entry.second.lastFrame + kForgetFrames >= frame) return false;
        return entry.second.pinned == UINT32_MAX || !scene.validLight(entry.second.handle); // a pin outlasts a pause
    });
    views.forEach([&](View& view) {
        for (auto it = view.lights.begin(); it != view.lights.end();) {
            if (it->second.lastFrame + kForgetFrames >= frame) {
                ++it;
                continue;
            }
            plan.forget(it->second);
            it = view.lights.erase(it);
        }
    });
}

Result<void> openView(Frame& frame, std::uint32_t index, const GnViewFrame& given, const ViewParts& parts)
{
    ViewFrame& out = frame.views[index];
    View& view = *out.view;
    const VkExtent2D extent = given.imageExtent;
    if (!view.visibility || !sameSize(view.visibility->gpu.extent, extent))
        if (Result<void> made = resizeVisibility(view, extent, parts.pool, frame.number); !made) return made;
    const CameraView before = view.camera;
    view.camera = makeCameraView(given, parts.origin, view.id, parts.casters);
    if (!samePose(view.camera, before)) view.movedIn = frame.number;
    if (given.cameraCut) {
        view.grid->invalidate();
        for (auto& [id, memory] : view.lights) {
            memory.measured = false;
            memory.wishedSide = 0.0;
            memory.share.reset();
            memory.treeLevels.reset();
            memory.penumbraPixels.reset();
        }
    }
    view.decisions.clear();
    const auto import = [&](VkImage image, VkImageView imageView, VkFormat format, const char* name) {
        PooledImage* const imported = parts.pool.import(image, imageView, format, extent);
        frame.imports.push_back(imported);
        return parts.graph.addImage(*imported, name);
    };
    out.depth = import(given.depthImage, given.depthView, given.depthFormat, "host.depth");
    if (judgedByNormals(given))
        out.normals = import(given.normalImage, given.normalView, given.normalFormat, "host.normals");
    if (given.motionImage) out.motion = import(given.motionImage, given.motionView, given.motionFormat, "host.motion");
    if (given.lightCount != 0) // else nobody reads them
        if (Result<void> copied = copyImages(out, parts); !copied) return copied;
    parts.pool.touch(*view.visibility);
    view.visibility->kept.lastUsed = parts.pool.frame();
    out.visibility = parts.graph.addImage(*view.visibility, "view.visibility");
    frame.visibilities.push_back(view.visibility.get());
    out.lights = given.lightCount;
    if (!view.packed || given.lightCount == 0) return {};
    const Result<ImageId> layers = parts.images.layersFor(parts.graph, view.camera, given.lightCount);
    if (!layers) return layers.error();
    out.packed = std::exchange(out.visibility, *layers);
    return {};
}

void keepVisibility(std::span<const ViewFrame> views, ResourcePool& pool, std::uint64_t newest)
{
    for (const ViewFrame& viewFrame : views) {
        View& view = *viewFrame.view;
        if (view.replaced) pool.retire(std::move(view.replaced), newest - 1); // the last that wrote it
        view.resized = false;
    }
}

void restoreVisibility(std::span<const ViewFrame> views, ResourcePool& pool, std::uint64_t newest, bool memoryShort)
{
    for (const ViewFrame& viewFrame : views) {
        View& view = *viewFrame.view;
        if (!std::exchange(view.resized, false)) continue;
        pool.retire(std::move(view.visibility), 0); // nobody has ever read it
        if (view.replaced && memoryShort) pool.retire(std::move(view.replaced), newest - 1);
        view.visibility = std::move(view.replaced);
        view.madeIn = view.replacedMadeIn;
        ++view.revision;
    }
}

void loseVisibility(View& view, ResourcePool& pool, std::uint64_t frame)
{
    if (view.madeIn != frame || !view.visibility) return;
    pool.retire(std::move(view.visibility), 0); // nobody has ever read it
    ++view.revision;
}

} // namespace gnomon
