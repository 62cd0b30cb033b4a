#include "demo/program/window_split.hpp"

#include <cmath>
#include <utility>

namespace gnomon::demo {
namespace {

SessionOptions truthOptions(const Session& session, const RunOptions& options)
{
    return {.size = session.renderer.extent(), .framesInFlight = options.framesInFlight, .plugins = options.plugins};
}

uint32_t columnAt(double divider, const Image& picture)
{
    return static_cast<uint32_t>(std::lround(divider * picture.extent.width));
}

} // namespace

SplitView::SplitView(Session& session, const RunOptions& options)
    : session_(session), truth_(session.device, session.scene, truthOptions(session, options))
{
    std::vector<std::string> refused; // by lights that stay with the fallback
    expect(truth_.shadows.pinAll("ray_traced", &refused));
    expect(refused.empty() ? truth_.shadows.warmUp("ray_traced") : truth_.shadows.warmUp());
}

void SplitView::draw(double time, const CameraState& camera, VkExtent2D extent)
{
    wrongPercent_.reset();
    if (std::exchange(readsTruth_, false)) {
        session_.renderer.waitForFrame(); // whose sets and images the truth may change
        const ErrorView::Counts counts = errors_->counts();
        if (counts.counted > 0) wrongPercent_ = 100.0 * double(counts.wrong) / double(counts.counted);
    }
    const VkExtent2D before = truth_.renderer.extent();
    if (before.width != extent.width || before.height != extent.height) {
        session_.renderer.waitForFrame(); // which may still copy from the picture that goes
        truth_.renderer.resize(extent);
    }
    truth_.renderer.draw({.time = time, .cameras = {&camera, 1}, .shadows = &truth_.shadows});
}

// Its picture was drawn by an earlier submission that ends with a barrier towards copies, and the next frame's begins
// with one behind all earlier commands of the queue: nothing else orders them.
void SplitView::show(VkCommandBuffer cmd, const Image& picture, double divider) const
{
    const Image& truth = truth_.renderer.colour();
    const uint32_t left = columnAt(divider, picture);
    if (left >= picture.extent.width) return;
    constexpr Access copied{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                            VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    constexpr Access written{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    const VkImageMemoryBarrier2 before[] = {imageBarrier(picture.get(), VK_IMAGE_ASPECT_COLOR_BIT, copied, written)};
    cmdBarrier(cmd, before);
    const VkOffset3D corner{static_cast<int32_t>(left), 0, 0};
    const VkImageCopy region{.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .srcOffset = corner,
                             .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .dstOffset = corner,
                             .extent = {picture.extent.width - left, picture.extent.height, 1}};
    vkCmdCopyImage(cmd, truth.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, picture.get(), written.layout, 1, &region);
    const VkImageMemoryBarrier2 after[] = {imageBarrier(picture.get(), VK_IMAGE_ASPECT_COLOR_BIT, written, copied)};
    cmdBarrier(cmd, after);
}

void SplitView::prepareErrors()
{
    if (!errors_) errors_.emplace(session_.device, session_.renderer);
}

void SplitView::showErrors(VkCommandBuffer cmd, double divider)
{
    const Image& picture = session_.renderer.colour();
    const uint32_t left = columnAt(divider, picture);
    if (left >= picture.extent.width) return;
    errors_->record(cmd, session_.renderer, truth_.renderer, left);
    readsTruth_ = true;
}

} // namespace gnomon::demo
