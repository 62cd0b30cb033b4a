#include "algorithms/hybrid/map_votes.hpp"

#include "algorithms/hybrid/block_answers.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon {

namespace {

/// Receivers by the four texels around them.
struct Voting {
    using Places = lanes::MapPlaces;
    const BlockReader& reader;
    const lanes::MapLook& map;
    const lanes::MapBytes& bytes;

    void place(std::uint32_t x, std::uint32_t y, Places& places) const { reader.place(x, y, map, places); }
    std::uint32_t answer(const Places& places, std::uint32_t, std::uint32_t,
                         std::uint8_t (&answers)[lanes::kLanes]) const
    {
        return reader.kernels().vote(map, places, bytes, answers);
    }
};

/// And by their own texel alone.
struct Nearest : Voting {
    std::uint32_t answer(const Places& places, std::uint32_t, std::uint32_t,
                         std::uint8_t (&answers)[lanes::kLanes]) const
    {
        reader.kernels().nearest(map, places, bytes, answers);
        return 0;
    }
};

constexpr lanes::MapBytes kReasonCodes{.outside = gpu::REASON_OUTSIDE,
                                       .backfacing = gpu::REASON_BACKFACING,
                                       .lit = gpu::REASON_TC_LIT,
                                       .dark = gpu::REASON_TC_SHADOW,
                                       .unsure = gpu::REASON_TC_LIT};

BlockReader readerOf(const MapQuestion& question, const HostContext& host)
{
    return BlockReader(widestKernels(), *question.view, *question.light, host.read<float>(question.depth),
                       host.read<std::byte>(question.normals));
}

template <typename Map>
void answer(const MapQuestion& question, const lanes::MapBytes& told, bool reasons, const HostContext& host,
            std::span<std::uint8_t> bytes)
{
    const BlockReader reader = readerOf(question, host);
    const lanes::MapLook map = question.map.onHost(host, *question.constants);
    const BlockAsking asking{.view = *question.view,
                             .light = *question.light,
                             .host = host,
                             .reader = reader,
                             .bytes = told,
                             .rayLit = reasons ? std::uint8_t{gpu::REASON_RT_LIT} : std::uint8_t{255},
                             .rayDark = reasons ? std::uint8_t{gpu::REASON_RT_SHADOW} : std::uint8_t{0}};
    answerByBlocks(asking, Map{reader, map, asking.bytes}, bytes);
}

} // namespace

void MapQuestion::uses(PassRef& host) const
{
    host.reads(depth).reads(normals);
    map.uses(host);
}

void declareMapVotes(PassBuilder& passes, const ShadowTask& task, const VoteNames& names, const HostMapCopy& map,
                     const gpu::MapConstants& constants, bool reasons)
{
    const HostVisibility buffers = declareHostVisibility(passes, task, names.visibility);
    const MapQuestion question{.view = task.view,
                               .light = task.light,
                               .constants = &constants,
                               .map = map,
                               .depth = buffers.depth,
                               .normals = buffers.normals};
    PassRef host = passes.host(names.pass);
    question.uses(host);
    host.writes(buffers.rows);
    host.run([question, reasons, rows = buffers.rows](HostContext& context) {
        votedPixels(question, reasons, context, context.write<std::uint8_t>(rows));
    });
    declareVisibilityCopy(passes, task, buffers, names.copy);
}

void votedPixels(const MapQuestion& question, bool reasons, const HostContext& host, std::span<std::uint8_t> bytes)
{
    answer<Voting>(question, reasons ? kReasonCodes : kVisibility, reasons, host, bytes);
}

void nearestPixels(const MapQuestion& question, const lanes::MapBytes& told, const HostContext& host,
                   std::span<std::uint8_t> bytes)
{
    answer<Nearest>(question, told, false, host, bytes);
}

} // namespace gnomon
