// Whole tiles of receivers against whole casters: a tile whose shaft to the light meets nothing is lit, one that lies
// in the shadow of a single triangle is dark, and what neither proves is split, at last into single pixels and rays.
// Source:    gnomon's own; shafts: E. Haines, J. Wallace, "Shaft culling for efficient ray-cast radiosity", 1991.
// Reads:     receiver depth and normals (read back), caster triangles and their trees.     Writes: visibility.
// Strong at: the picture of ray_traced with a fraction of its rays, whatever moves: no map, nothing kept.
// Weak at:   finely tessellated casters in shadow of themselves; one GPU-CPU-GPU round trip; no host-drawn casters.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>
#include <type_traits>

#include "algorithms/hybrid/block_rays.hpp"
#include "algorithms/hybrid/host_blocks.hpp"
#include "algorithms/hybrid/receiver_pyramid.hpp"
#include "algorithms/hybrid/tile_search.hpp"
#include "algorithms/hybrid/undecided.hpp"

namespace gnomon {

namespace {

using simd::Block;
using simd::kBlockSide;
using simd::kLanes;

enum Setting { kTile, kReasons };

constexpr std::uint32_t kLargestTile = 64;
constexpr SettingSpec kSettings[] = {
    {"tile", "Side of the largest tile, pixels; rounded down to a power of two.", kBlockSide, kLargestTile, 32},
    kReasonsSetting,
};

/// Everything the host pass needs; copied into the frame.
struct ShaftJob {
    const CameraView* view;
    const LightView* light;
    const LightCasters* casters;
    HostVisibility buffers;
    BufferId hulls;     ///< Null where none are made.
    std::uint32_t tile; ///< Pixels a side, a power of two.
    bool reasons;
};

/// The byte in visibility for each reason.
struct Bytes {
    std::uint8_t of[gpu::REASON_COUNT];

    explicit Bytes(bool reasons)
    {
        for (std::uint32_t i = 0; i < gpu::REASON_COUNT; ++i) {
            const bool lit = i == gpu::REASON_OUTSIDE || i == gpu::REASON_TILE_LIT || i == gpu::REASON_RT_LIT;
            of[i] = reasons ? static_cast<std::uint8_t>(i) : lit ? 255 : 0;
        }
    }
};

/// Column (or, shifted by one, row) of a block from its number in Z order.
std::uint32_t everyOtherBit(std::uint32_t z)
{
    std::uint32_t result = 0;
    for (std::uint32_t bit = 0; bit < 4; ++bit)
        result |= (z >> bit) & (1u << bit);
    return result;
}
static_assert(kLargestTile / kBlockSide <= 1u << 4);
constexpr std::uint32_t kBlocks = (kLargestTile / kBlockSide) * (kLargestTile / kBlockSide);

/// One thread's share of the tiles.
class TileRows final : public TileAnswers {
public:
    TileRows(const ShaftJob& job, const HostContext& host, const BlockReader& reader, const ShaftScene& scene)
        : job_(job), reader_(reader), bytes_(job.reasons), squares_(*job.view, *job.light),
          pyramid_(job.view->area.extent),
          hulls_(job.hulls ? host.read<ReceiverSquare>(job.hulls) : std::span<const ReceiverSquare>()),
          search_(scene, *host.arena),
          blocks_(host.arena->array<Block>(std::size_t(job.tile / kBlockSide) * (job.tile / kBlockSide))),
          stride_((job.view->area.extent.width + job.tile - 1) / job.tile * job.tile),
          rows_(host.arena->array<std::uint8_t>(std::size_t(job.tile) * stride_)),
          asked_(askedPixels(*job.view, *job.light, job.tile)), rays_({.host = host,
                                                                       .reader = reader,
                                                                       .light = *job.light,
                                                                       .lit = bytes_.of[gpu::REASON_RT_LIT],
                                                                       .dark = bytes_.of[gpu::REASON_RT_SHADOW]},
                                                                      rows_, stride_)
    {
        fillOutside();
        for (std::uint32_t i = 0; i < blocks_.size(); ++i)
            corner_[i] = static_cast<std::uint32_t>(everyOtherBit(i >> 1) * kBlockSide * stride_ +
                                                    everyOtherBit(i) * kBlockSide);
    }

    void answer(std::uint32_t tileRow, std::span<std::uint8_t> visibility);

private:
    void dark(std::uint32_t firstBlock, std::uint32_t count) override;
    void lanes(std::uint32_t block, simd::LaneStates states) override;
    bool knownHull(std::uint32_t firstBlock, std::uint32_t count, Hull& hull) override;
    void wanted(std::uint32_t firstBlock, std::uint32_t count) override;
    void tile(std::uint32_t left, std::uint32_t top);
    void fillTile(std::uint8_t byte);
    void fillOutside() { std::fill(rows_.begin(), rows_.end(), bytes_.of[gpu::REASON_OUTSIDE]); }
    void read();
    std::size_t rowAt(std::uint32_t block) const { return corner_[block] + left_; } ///< Of the block's first pixel.

    const ShaftJob& job_;
    const BlockReader& reader_;
    const Bytes bytes_;
    const SquareAnswers squares_;
    const ReceiverPyramid pyramid_;
    const std::span<const ReceiverSquare> hulls_;
    TileSearch search_;
    std::span<Block> blocks_;
    std::size_t stride_; ///< Of rows_: whole tiles.
    std::span<std::uint8_t> rows_;
    AskedPixels asked_;
    std::uint32_t corner_[kBlocks];      ///< Of the blocks of a tile, in rows_.
    std::uint32_t left_ = 0, top_ = 0;   ///< Of the tile at work, in the area.
    bool allAsk_ = false;                ///< All pixels of that tile; its blocks are read when they are wanted.
    std::uint64_t read_[kBlocks / 64]{}; ///< Bits of the blocks that were.
    BlockRays rays_;                     ///< Answered in rows_.
};

/// Reads a tile and writes what needs no search; the others are lit until more is known.
void TileRows::read()
{
    const VkExtent2D extent = job_.view->area.extent;
    const std::uint32_t left = left_, top = top_;
    const std::uint8_t before[3] = {bytes_.of[gpu::REASON_OUTSIDE], bytes_.of[gpu::REASON_BACKFACING],
                                    bytes_.of[gpu::REASON_TILE_LIT]};
    for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
        const std::uint32_t x = left + everyOtherBit(i) * kBlockSide, y = top + everyOtherBit(i >> 1) * kBlockSide;
        // Z order jumps from row to row, where no processor looks ahead by itself.
        const std::uint32_t next = i + 4;
        reader_.prefetch(left + everyOtherBit(next) * kBlockSide, top + everyOtherBit(next >> 1) * kBlockSide);
        Block& block = blocks_[i];
        block.rays = 0;
        if (x >= extent.width || y >= extent.height) continue;
        reader_.readSummed(x, y, block);
        std::uint8_t bytes[kLanes];
        std::memset(bytes, before[simd::kRay], kLanes);
        if (block.rays != kLanes)
            for (std::uint32_t lane = 0; lane < kLanes; ++lane)
                bytes[lane] = before[block.asked[lane]];
        for (std::uint32_t row = 0; row < kBlockSide; ++row)
            std::memcpy(&rows_[rowAt(i) + row * stride_], bytes + row * kBlockSide, kBlockSide);
    }
}

bool TileRows::knownHull(std::uint32_t firstBlock, std::uint32_t count, Hull& hull)
{
    const std::uint32_t side = kBlockSide << std::countr_zero(count) / 2;
    if (!allAsk_ || side < ReceiverPyramid::kSmallest) return false;
    const std::uint32_t x = left_ + everyOtherBit(firstBlock) * kBlockSide;
    const std::uint32_t y = top_ + everyOtherBit(firstBlock >> 1) * kBlockSide;
    const ReceiverSquare& square = hulls_[pyramid_.index(side, x, y)];
    if (square.holds != ReceiverSquare::Holds::whole) return false; // beyond the area: nobody asks
    hull = squares_.hull(square);
    return true;
}

void TileRows::wanted(std::uint32_t firstBlock, std::uint32_t count)
{
    if (!allAsk_) return;
    const VkExtent2D extent = job_.view->area.extent;
    for (std::uint32_t i = firstBlock; i < firstBlock + count; ++i) {
        if ((read_[i / 64] >> i % 64 & 1) != 0) continue;
        read_[i / 64] |= std::uint64_t{1} << i % 64;
        const std::uint32_t x = left_ + everyOtherBit(i) * kBlockSide, y = top_ + everyOtherBit(i >> 1) * kBlockSide;
        const std::uint32_t next = i + 4; // as in read()
        reader_.prefetch(left_ + everyOtherBit(next) * kBlockSide, top_ + everyOtherBit(next >> 1) * kBlockSide);
        blocks_[i].rays = 0;
        if (x < extent.width && y < extent.height) reader_.read(x, y, blocks_[i]);
    }
}

void TileRows::fillTile(std::uint8_t byte)
{
    for (std::uint32_t y = 0; y < job_.tile; ++y)
        std::memset(&rows_[y * stride_ + left_], byte, job_.tile);
}

void TileRows::tile(std::uint32_t left, std::uint32_t top)
{
    using Answer = SquareAnswers::Answer;
    left_ = left;
    top_ = top;
    const bool known = !hulls_.empty() && job_.tile >= ReceiverPyramid::kSmallest;
    const Answer answer = known ? squares_.of(hulls_[pyramid_.index(job_.tile, left, top)]) : Answer::mixed;
    allAsk_ = answer == Answer::rays;
    if (answer == Answer::mixed) {
        read();
    } else {
        fillTile(bytes_.of[answer == Answer::lit    ? gpu::REASON_OUTSIDE
                           : answer == Answer::dark ? gpu::REASON_BACKFACING
                                                    : gpu::REASON_TILE_LIT]);
        if (!allAsk_) return;
        std::fill(std::begin(read_), std::end(read_), 0);
    }
    search_.run(blocks_, *this);
}

void TileRows::dark(std::uint32_t firstBlock, std::uint32_t count)
{
    const std::uint8_t byte = bytes_.of[gpu::REASON_TILE_SHADOW];
    if (allAsk_) {
        for (std::uint32_t i = firstBlock; i < firstBlock + count; ++i)
            for (std::uint32_t row = 0; row < kBlockSide; ++row)
                std::memset(&rows_[rowAt(i) + row * stride_], byte, kBlockSide);
        return;
    }
    for (std::uint32_t i = firstBlock; i < firstBlock + count; ++i) {
        const Block& block = blocks_[i];
        for (std::uint32_t row = 0; row < kBlockSide && block.rays != 0; ++row) {
            std::uint8_t* first = &rows_[rowAt(i) + row * stride_];
            for (std::uint32_t x = 0; x < kBlockSide; ++x)
                if (block.rays == kLanes || block.asked[row * kBlockSide + x] == simd::kRay) first[x] = byte;
        }
    }
}

void TileRows::lanes(std::uint32_t block, simd::LaneStates states)
{
    const std::size_t first = rowAt(block);
    const Block& from = blocks_[block];
    std::uint32_t asking = 0;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane)
        asking |= from.asked[lane] == simd::kRay ? 1u << lane : 0u;
    for (std::uint32_t inside = states.inside & asking; inside != 0; inside &= inside - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(inside));
        rows_[first + lane / kBlockSide * stride_ + lane % kBlockSide] = bytes_.of[gpu::REASON_TILE_SHADOW];
    }
    rays_.ask(from, states.unsure & asking, first);
}

void TileRows::answer(std::uint32_t tileRow, std::span<std::uint8_t> visibility)
{
    const VkExtent2D extent = job_.view->area.extent;
    const std::uint32_t top = tileRow * job_.tile;
    if (asked_.holdsRow(top)) {
        for (std::uint32_t left = asked_.left; left < asked_.right; left += job_.tile)
            tile(left, top);
        rays_.flush();
    } else {
        fillOutside();
    }
    // Upload memory may be write-combined: whole rows at a time.
    for (std::uint32_t y = 0; y < std::min(job_.tile, extent.height - top); ++y)
        std::memcpy(&visibility[std::size_t(top + y) * extent.width], &rows_[y * stride_], extent.width);
}

void answer(const ShaftJob& job, const HostContext& host)
{
    const CameraView& view = *job.view;
    const BlockReader reader = blocksOf(view, *job.light, job.buffers, host);
    const ShaftScene scene(widestKernels(), *job.light, job.casters->all, glm::vec3(view.constants.rayDxWs),
                           *host.arena);
    const std::span<std::uint8_t> visibility = host.write<std::uint8_t>(job.buffers.rows);
    const std::uint32_t tileRows = (view.area.extent.height + job.tile - 1) / job.tile;
    const std::span<TileRows*> rows = host.arena->array<TileRows*>(host.jobs->threadCount());
    std::fill(rows.begin(), rows.end(), nullptr);
    static_assert(std::is_trivially_destructible_v<TileRows>);
    host.jobs->parallelFor(tileRows, 1, [&](std::size_t begin, std::size_t end, std::uint32_t thread) {
        if (!rows[thread])
            rows[thread] =
                new (host.arena->allocate(sizeof(TileRows), alignof(TileRows))) TileRows(job, host, reader, scene);
        for (std::size_t row = begin; row < end; ++row)
            rows[thread]->answer(static_cast<std::uint32_t>(row), visibility);
    });
}

/// The buffer of hulls and the pass that fills it, in host memory; null without normals.
BufferId declareReceiverSquares(PassBuilder& passes, const ShadowTask& task, BufferId depth, BufferId normals)
{
    if (!normals) return {};
    const CameraView* view = task.view;
    const ReceiverPyramid pyramid(view->area.extent);
    const BufferId hulls = passes.transient(BufferInfo{.name = "view.receiver_pyramid",
                                                       .scope = Scope::view,
                                                       .size = pyramid.count() * sizeof(ReceiverSquare),
                                                       .place = BufferPlace::readback});
    PassRef host = passes.host("view.receiver_pyramid", Scope::view);
    host.reads(depth).reads(normals).writes(hulls).run([=](HostContext& context) {
        const SquareMaker maker(widestKernels(), *view, context.read<float>(depth), context.read<std::byte>(normals),
                                context.write<ReceiverSquare>(hulls));
        const std::uint32_t rows =
            (view->area.extent.height + ReceiverPyramid::kLargest - 1) / ReceiverPyramid::kLargest;
        context.jobs->parallelFor(rows, 1, [&](std::size_t begin, std::size_t end, std::uint32_t) {
            for (std::size_t row = begin; row < end; ++row)
                maker.row(static_cast<std::uint32_t>(row) * ReceiverPyramid::kLargest);
        });
    });
    return hulls;
}

class TileShafts final : public ShadowAlgorithm {
public:
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        ShaftJob job{.view = task.view,
                     .light = task.light,
                     .casters = task.casters,
                     .buffers = declareHostVisibility(passes, task, "tile_shafts.visibility"),
                     .hulls = {},
                     .tile = std::bit_floor(static_cast<std::uint32_t>(task.settings[kTile])),
                     .reasons = task.settings[kReasons] != 0.0};
        job.hulls = declareReceiverSquares(passes, task, job.buffers.depth, job.buffers.normals);
        PassRef host = passes.host("tile_shafts.search");
        useHostVisibility(host, job.buffers);
        if (job.hulls) host.reads(job.hulls);
        host.run([job](HostContext& context) { answer(job, context); });
        declareVisibilityCopy(passes, task, job.buffers, "tile_shafts.copy");
    }
};

} // namespace

constinit const AlgorithmEntry kTileShafts{
    .name = "tile_shafts",
    .source = "gnomon; Haines and Wallace 1991",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent,
                         GnLightType) { return hostVisibilityMemory(extent); },
    .create = makeAlgorithm<TileShafts>,
};

} // namespace gnomon
