#include "runtime/select/map_side.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "runtime/scene/light_fit.hpp"

namespace gnomon {

namespace {

// Texels of all of a light's maps for a pixel that it reaches. Most of a map lies where no pixel shows it, and texels
// of slanted receivers are long: with 4, a light that reaches all of 1280x720 gets the sides that fixed ones had by
// default, 1024 for six faces or four cascades.
constexpr double kTexelsPerPixel = 4.0;

/// The smallest side that such a wish does not grow beyond.
std::uint32_t sideOfWish(double wish) noexcept
{
    for (const std::uint32_t side : kMapSides)
        if (wish <= MapSide::kGrow * side) return side;
    return kMapSides.back();
}

// A light gets its step back where that leaves so much of the memory free: else the next light would take it again.
constexpr double kRoomKept = 0.1;

/// Doublings that a light's side is off.
int stepsOff(const MapSide& side) noexcept
{
    return std::abs(std::countr_zero(side.affordable()) - std::countr_zero(side.side()));
}

/// What halving this side loses a byte that it frees: wrong pixels grow with the width of a texel.
double lossPerByte(const SideRequest& request, std::uint32_t side) noexcept
{
    const double wrong = request.worth * request.side->wanted() / side;
    return wrong / (0.75 * request.bytes(side));
}

/// The request that is best by `better(loss per byte)`, of those that `side(request)` gives a side to halve, or 0.
template <typename Side, typename Better>
const SideRequest* bestOf(std::span<const SideRequest> requests, const Side& side, const Better& better) noexcept
{
    const SideRequest* best = nullptr;
    double bestLoss = 0.0;
    for (const SideRequest& request : requests) {
        const std::uint32_t at = side(request);
        if (at == 0) continue;
        const double loss = lossPerByte(request, at);
        if (best && !better(loss, bestLoss)) continue;
        best = &request;
        bestLoss = loss;
    }
    return best;
}

/// Halves sides of drawn maps until they fit. @return their bytes
double halveSides(std::span<const SideRequest> requests, double sum, double budgetBytes) noexcept
{
    const auto halvable = [](const SideRequest& request) {
        const std::uint32_t at = request.side->affordable();
        return request.drawn && request.bytesPerTexel > 0.0 && at > kMapSides.front() ? at : 0;
    };
    while (sum > budgetBytes) {
        const SideRequest* least = bestOf(requests, halvable, std::less<>());
        if (!least) break;
        const std::uint32_t at = least->side->affordable();
        least->side->limit(at / 2);
        sum -= least->bytes(at) - least->bytes(at / 2);
    }
    return sum;
}

/// The largest side whose maps take so many bytes at most.
std::uint32_t sideWithin(const SideRequest& request, double bytes) noexcept
{
    std::uint32_t side = kMapSides.front();
    while (side < kMapSides.back() && request.bytes(2 * side) <= bytes)
        side *= 2;
    return side;
}

} // namespace

std::size_t rungOf(std::uint32_t side) noexcept
{
    return static_cast<std::size_t>(std::countr_zero(side) - std::countr_zero(kMapSides.front()));
}

double mapWidth(const LightView& light, const LightCasters& casters)
{
    if (light.type == GN_LIGHT_TYPE_POINT) return 2.0; // each face spans 90 degrees
    const Aabb bounds = sceneBounds(casters);
    const bool spot = light.type == GN_LIGHT_TYPE_SPOT;
    return double{(spot ? fitSpot(light, bounds) : fitDirectional(light, bounds)).texelAtOne};
}

double mapsOf(GnLightType type) noexcept
{
    return type == GN_LIGHT_TYPE_POINT ? 6.0 : type == GN_LIGHT_TYPE_DIRECTIONAL ? 4.0 : 1.0;
}

double sideFor(const MapCoverage& coverage) noexcept
{
    if (!(coverage.nearness > 0.0 && coverage.pixelAngle > 0.0)) return 0.0;
    const double perPixel = coverage.texelAtOne * coverage.nearness / coverage.pixelAngle;
    return std::min(perPixel, std::sqrt(kTexelsPerPixel * coverage.pixels / coverage.maps));
}

void MapSide::follow(double wish, bool again) noexcept
{
    if (!(wish > 0.0)) return;
    below_ = wish < kShrink * wanted_ ? below_ + 1 : 0;
    if (!again && wish <= kGrow * wanted_ && below_ < kShrinkFrames) return;
    wanted_ = sideOfWish(wish);
    below_ = 0;
}

void fitSides(std::span<const SideRequest> requests, double budgetBytes, std::uint64_t turn) noexcept
{
    double sum = 0.0;
    for (const SideRequest& request : requests)
        if (request.drawn) sum += request.bytes(request.side->affordable());
    const double usable = (1.0 - kRoomKept) * budgetBytes;
    if (sum > budgetBytes) {
        sum = halveSides(requests, sum, budgetBytes);
    } else {
        const auto returnable = [&](const SideRequest& request) {
            const std::uint32_t at = request.side->affordable();
            const double more = request.bytes(2 * at) - request.bytes(at);
            return request.drawn && at < request.side->wanted() && sum + more <= usable ? 2 * at : 0;
        };
        if (const SideRequest* most = bestOf(requests, returnable, std::greater<>()))
            most->side->limit(2 * most->side->affordable());
    }
    const auto isApart = [](const SideRequest& each) { return !each.drawn; };
    auto others = static_cast<std::uint64_t>(std::count_if(requests.begin(), requests.end(), isApart));
    const auto offer = [&](const SideRequest& request, double shares) {
        request.side->limit(sideWithin(request, std::max(usable - sum, 0.0) / shares));
        sum += request.bytes(request.side->affordable());
        --others;
    };
    const SideRequest* whole = nullptr; // is offered all of the room
    for (std::uint64_t before = others > 0 ? turn % others + 1 : 0; const SideRequest& request : requests)
        if (isApart(request) && --before == 0) whole = &request;
    if (whole) offer(*whole, 1.0);
    for (const SideRequest& request : requests)
        if (isApart(request) && &request != whole) offer(request, static_cast<double>(others));
}

void takeSides(std::span<const SideRequest> requests) noexcept
{
    MapSide* farthest = nullptr;
    for (const SideRequest& request : requests) {
        MapSide& side = *request.side;
        const bool forMemory = side.affordable() < side.wanted() && side.affordable() < side.side();
        if (!request.redraws || forMemory)
            side.take();
        else if (stepsOff(side) > (farthest ? stepsOff(*farthest) : 0))
            farthest = &side;
    }
    if (farthest) farthest->take();
}

} // namespace gnomon
