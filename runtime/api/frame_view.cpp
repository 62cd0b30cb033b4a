// What a frame makes of a view: its camera, its images, and the visibility image that it leaves.
#include <algorithm>
#include <utility>

#include "runtime/api/context.hpp"

namespace gnomon {

Result<void> Context::prepareView(View& view, const GnViewFrame& frame, std::span<const Caster> casters)
{
    const VkExtent2D extent = frame.imageExtent;
    const bool resized = !view.visibility || view.visibility->gpu.extent.width != extent.width ||
                         view.visibility->gpu.extent.height != extent.height;
    if (resized) {
        auto made = pool_->ownedImage({.format = VK_FORMAT_R8_UNORM,
                                       .extent = extent,
                                       .layers = view.maxLights,
                                       .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                                VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                       .name = "view.visibility",
                                       .concurrent = true});
        if (!made) { // another attempt may need the place of the old one, which frames before this may still read
            if (view.visibility) pool_->retire(std::move(view.visibility), frame_ - 1);
            return made.error();
        }
        view.replaced = std::move(view.visibility);
        view.visibility = std::move(*made);
        view.resized = true;
        view.replacedMadeIn = std::exchange(view.madeIn, frame_);
        ++view.revision;
        view.grid->invalidate();
    }
    present().pixels += double(extent.width) * double(extent.height);
    view.camera = makeCameraView(frame, origin_, view.id, casters);
    if (frame.cameraCut) {
        view.grid->invalidate();
        for (auto& [id, memory] : view.lights) {
            memory.measured = false;
            memory.share.reset();
            memory.treeLevels.reset();
        }
    }
    view.decisions.clear();
    ViewFrame& out = *std::find_if(viewFrames_.begin(), viewFrames_.end(),
                                   [&](const ViewFrame& candidate) { return candidate.view == &view; });
    out.depthImage = pool_->import(frame.depthImage, frame.depthView, frame.depthFormat, extent);
    out.depth = graph_->addImage(*out.depthImage, "host.depth");
    imports_.push_back(out.depthImage);
    if (frame.normalImage) {
        out.normalImage = pool_->import(frame.normalImage, frame.normalView, frame.normalFormat, extent);
        out.normals = graph_->addImage(*out.normalImage, "host.normals");
        imports_.push_back(out.normalImage);
    }
    pool_->touch(*view.visibility);
    view.visibility->kept.lastUsed = pool_->frame();
    out.visibility = graph_->addImage(*view.visibility, "view.visibility");
    visibilities_.push_back(view.visibility.get());
    return {};
}

/// The newest frame stands, and with it the visibility images that it made.
void Context::keepVisibility()
{
    for (const ViewFrame& viewFrame : viewFrames_) {
        View& view = *viewFrame.view;
        if (view.replaced) pool_->retire(std::move(view.replaced), frame_ - 1); // the last that wrote it
        view.resized = false;
    }
}

/// The newest frame does not: what hosts find is what they found before, unless another attempt may need its place.
void Context::restoreVisibility(bool memoryShort)
{
    for (const ViewFrame& viewFrame : viewFrames_) {
        View& view = *viewFrame.view;
        if (!std::exchange(view.resized, false)) continue;
        pool_->retire(std::move(view.visibility), 0); // nobody has ever read it
        if (view.replaced && memoryShort) pool_->retire(std::move(view.replaced), frame_ - 1);
        view.visibility = std::move(view.replaced);
        view.madeIn = view.replacedMadeIn;
        ++view.revision;
    }
}

} // namespace gnomon
