#include "algorithms/hybrid/conservative_votes.hpp"

#include "algorithms/hybrid/block_answers.hpp"

namespace gnomon {

namespace {

using simd::kBlockSide;
using simd::kLanes;

constexpr simd::MapBytes kReasonCodes{.outside = gpu::REASON_OUTSIDE,
                                      .backfacing = gpu::REASON_BACKFACING,
                                      .lit = gpu::REASON_MAP_LIT,
                                      .dark = gpu::REASON_MAP_SHADOW,
                                      .unsure = gpu::REASON_MAP_LIT};

/// Everything the host pass needs; copied into the frame.
struct VoteJob {
    const CameraView* view;
    const LightView* light;
    const gpu::ConservativeConstants* constants;
    ConservativeCopies copies;
    HostVisibility buffers;
    Doubt doubt;
};

/// Starts of rays by the map's two layers.
struct Conserving {
    using Places = simd::LayerPlaces;
    const CameraView& view;
    const Doubt& doubt;
    std::span<const float> depth;
    const BlockReader& reader;
    const simd::ConservativeLookup& look;
    const simd::MapBytes& bytes;

    void place(std::uint32_t x, std::uint32_t y, Places& places) const { reader.place(x, y, look, places); }
    std::uint32_t answer(const Places& places, std::uint32_t x, std::uint32_t y, std::uint8_t (&answers)[kLanes]) const
    {
        const std::uint32_t wanting = reader.kernels().conserve(look, places, bytes, answers);
        const VkRect2D& pixels = doubt.where.pixels; // image coordinates
        const auto left = static_cast<std::uint32_t>(view.area.offset.x) + x;
        const auto top = static_cast<std::uint32_t>(view.area.offset.y) + y;
        const auto from = [](std::int32_t offset) { return static_cast<std::uint32_t>(offset); };
        if (left + kBlockSide <= from(pixels.offset.x) || left >= from(pixels.offset.x) + pixels.extent.width ||
            top + kBlockSide <= from(pixels.offset.y) || top >= from(pixels.offset.y) + pixels.extent.height)
            return wanting;
        return wanting | doubted(places, left, top, answers);
    }

private:
    std::uint32_t doubted(const Places& places, std::uint32_t left, std::uint32_t top,
                          const std::uint8_t (&answers)[kLanes]) const;
};

/// Lanes that ask, whose byte is not believed for where they lie.
std::uint32_t Conserving::doubted(const Places& places, std::uint32_t left, std::uint32_t top,
                                  const std::uint8_t (&answers)[kLanes]) const
{
    const VkRect2D& pixels = doubt.where.pixels;
    const Aabb& box = doubt.where.receivers;
    std::uint32_t lanes = 0;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        const std::uint32_t x = left + lane % kBlockSide, y = top + lane / kBlockSide;
        const bool within = x - static_cast<std::uint32_t>(pixels.offset.x) < pixels.extent.width &&
                            y - static_cast<std::uint32_t>(pixels.offset.y) < pixels.extent.height;
        if (!within || places.asked[lane] != simd::kRay || answers[lane] != doubt.byte) continue;
        const float w = gpu::linearDepth(view.constants, depth[std::size_t(y) * view.extent.width + x]);
        const glm::vec3 receiver =
            glm::vec3(view.constants.eyeWs) + w * gpu::viewRayWs(view.constants, glm::vec2(x, y) + 0.5f);
        if (glm::clamp(receiver, box.lower, box.upper) == receiver) lanes |= 1u << lane;
    }
    return lanes;
}

void answer(const VoteJob& job, const HostContext& host)
{
    const gpu::ConservativeConstants& constants = *job.constants;
    const BlockReader reader = blocksOf(*job.view, *job.light, job.buffers, host);
    simd::ConservativeLookup look{.map = job.copies.nearest.onHost(host, constants.hybrid.base),
                                  .texelsPerMetre = constants.texelsPerMetre,
                                  .depthPerMetre = constants.depthPerMetre,
                                  .depthSquare = constants.depthSquare,
                                  .thesis = constants.thesis,
                                  .covered = {}};
    const simd::MapLookup covered = job.copies.covered.onHost(host, constants.hybrid.base);
    std::copy(std::begin(covered.depth), std::end(covered.depth), look.covered);
    const bool reasons = constants.hybrid.reasons != 0;
    const BlockAsking asking{.view = *job.view,
                             .light = *job.light,
                             .host = host,
                             .reader = reader,
                             .bytes = reasons ? kReasonCodes : kVisibility,
                             .rayLit = reasons ? std::uint8_t{gpu::REASON_RT_LIT} : std::uint8_t{255},
                             .rayDark = reasons ? std::uint8_t{gpu::REASON_RT_SHADOW} : std::uint8_t{0}};
    const Conserving map{.view = *job.view,
                         .doubt = job.doubt,
                         .depth = host.read<float>(job.buffers.depth),
                         .reader = reader,
                         .look = look,
                         .bytes = asking.bytes};
    answerByBlocks(asking, map, host.write<std::uint8_t>(job.buffers.rows));
}

} // namespace

void declareConservativeVotes(PassBuilder& passes, const ShadowTask& task, const VoteNames& names,
                              const ConservativeCopies& copies, const gpu::ConservativeConstants& constants,
                              const Doubt& doubt)
{
    const VoteJob job{.view = task.view,
                      .light = task.light,
                      .constants = &constants,
                      .copies = copies,
                      .buffers = declareHostVisibility(passes, task, names.visibility),
                      .doubt = doubt};
    PassRef host = passes.host(names.pass);
    useHostVisibility(host, job.buffers);
    copies.nearest.uses(host);
    copies.covered.uses(host);
    host.run([job](HostContext& context) { answer(job, context); });
    declareVisibilityCopy(passes, task, job.buffers, names.copy);
}

} // namespace gnomon
