#include "algorithms/hybrid/receiver_hulls.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace gnomon {

using lanes::Block;
using lanes::kBlockSide;

namespace {

using Holds = ReceiverHull::Holds;

constexpr std::uint32_t kCellBlocks = 4; // of the smallest squares

/// A hull along the axes of `joined` around four others.
void extendOver(const ReceiverHull* const (&parts)[4], ReceiverHull& joined)
{
    Hull& hull = joined.hull;
    double lower[3] = {1e300, 1e300, 1e300}, upper[3] = {-1e300, -1e300, -1e300};
    hull.largestOffset = 0.0;
    const glm::dvec3 start = hull.centre;
    for (const ReceiverHull* part : parts) {
        if (part->holds != Holds::whole) continue;
        for (int i = 0; i < 3; ++i) {
            const double along = glm::dot(hull.axis[i], part->hull.centre - start);
            const double radius = part->hull.radius(hull.axis[i]);
            lower[i] = std::min(lower[i], along - radius);
            upper[i] = std::max(upper[i], along + radius);
        }
        hull.largestOffset = std::max(hull.largestOffset, part->hull.largestOffset);
    }
    for (int i = 0; i < 3; ++i) {
        hull.centre += hull.axis[i] * (0.5 * (lower[i] + upper[i]));
        hull.half[i] = 0.5 * (upper[i] - lower[i]);
    }
}

Holds together(Holds a, Holds b)
{
    return a == Holds::beyond || a == b ? b : b == Holds::beyond ? a : Holds::partial;
}

} // namespace

HullPyramid::HullPyramid(VkExtent2D extent)
{
    const std::uint32_t rows = (extent.height + kLargest - 1) / kLargest;
    columns_ = (extent.width + kLargest - 1) / kLargest;
    first_[0] = 0;
    for (std::uint32_t level = 0; level < kLevels; ++level) {
        const std::uint32_t across = kLargest / (kSmallest << level);
        first_[level + 1] = first_[level] + std::size_t(columns_) * rows * across * across;
    }
}

std::size_t HullPyramid::index(std::uint32_t side, std::uint32_t x, std::uint32_t y) const
{
    const auto level = static_cast<std::uint32_t>(std::countr_zero(side / kSmallest));
    return first_[level] + std::size_t(y / side) * (columns_ * (kLargest / side)) + x / side;
}

HullMaker::HullMaker(const lanes::Kernels& kernels, const BlockReader& reader, const CameraView& view,
                     std::span<ReceiverHull> hulls)
    : kernels_(kernels), reader_(reader), extent_(view.area.extent), rowDirection_(view.constants.rayDxWs),
      pyramid_(extent_), hulls_(hulls)
{
}

/// One of the smallest squares, from its pixels.
void HullMaker::cell(std::uint32_t x, std::uint32_t y, ReceiverHull& square) const
{
    square.holds = Holds::beyond;
    if (x >= extent_.width || y >= extent_.height) return;
    Block blocks[kCellBlocks];
    std::uint32_t receivers = 0;
    bool finite = true;
    constexpr float infinity = std::numeric_limits<float>::infinity();
    square.normalSum = glm::vec3(0.0f);
    square.normalLower = glm::vec3(infinity);
    square.normalUpper = glm::vec3(-infinity);
    for (std::uint32_t i = 0; i < kCellBlocks; ++i) {
        Block& block = blocks[i];
        const std::uint32_t left = x + i % 2 * kBlockSide, top = y + i / 2 * kBlockSide;
        block.rays = 0;
        if (left >= extent_.width || top >= extent_.height) continue;
        reader_.readSurfaces(left, top, block);
        if (block.rays == 0) continue;
        receivers += block.rays;
        finite = finite && block.finite != 0;
        for (int axis = 0; axis < 3; ++axis) {
            square.normalSum[axis] += block.normalSum[axis];
            square.normalLower[axis] = std::min(square.normalLower[axis], block.normalLower[axis]);
            square.normalUpper[axis] = std::max(square.normalUpper[axis], block.normalUpper[axis]);
        }
    }
    // Squares that the area cuts are none either: normals of lanes beyond it would count.
    const bool whole = receivers == HullPyramid::kSmallest * HullPyramid::kSmallest && finite &&
                       hullOf(kernels_, blocks, kCellBlocks, rowDirection_, square.hull);
    square.holds = receivers == 0 ? Holds::sky : whole ? Holds::whole : Holds::partial;
}

/// A larger square, from its quarters.
void HullMaker::join(std::uint32_t side, std::uint32_t x, std::uint32_t y) const
{
    const std::uint32_t half = side / 2;
    const ReceiverHull* const quarters[4] = {
        &hulls_[pyramid_.index(half, x, y)], &hulls_[pyramid_.index(half, x + half, y)],
        &hulls_[pyramid_.index(half, x, y + half)], &hulls_[pyramid_.index(half, x + half, y + half)]};
    ReceiverHull& square = hulls_[pyramid_.index(side, x, y)];
    square.holds = Holds::beyond;
    for (const ReceiverHull* quarter : quarters)
        square.holds = together(square.holds, quarter->holds);
    if (square.holds != Holds::whole) return;
    const ReceiverHull* first = nullptr;
    for (const ReceiverHull* quarter : quarters) {
        if (quarter->holds != Holds::whole) continue;
        square.normalSum = first ? square.normalSum + quarter->normalSum : quarter->normalSum;
        square.normalLower = first ? glm::min(square.normalLower, quarter->normalLower) : quarter->normalLower;
        square.normalUpper = first ? glm::max(square.normalUpper, quarter->normalUpper) : quarter->normalUpper;
        first = first ? first : quarter;
    }
    square.hull.turn(square.normalSum, rowDirection_);
    square.hull.centre = first->hull.centre;
    extendOver(quarters, square);
}

void HullMaker::row(std::uint32_t top) const
{
    constexpr std::uint32_t smallest = HullPyramid::kSmallest, largest = HullPyramid::kLargest;
    const std::uint32_t width = (extent_.width + largest - 1) / largest * largest;
    for (std::uint32_t y = top; y < top + largest; y += smallest)
        for (std::uint32_t x = 0; x < width; x += smallest) {
            // Two squares ahead: eight rows at once are more than processors follow by themselves.
            reader_.prefetch(x + 2 * smallest, y);
            reader_.prefetch(x + 2 * smallest, y + kBlockSide);
            cell(x, y, hulls_[pyramid_.index(smallest, x, y)]);
        }
    for (std::uint32_t side = 2 * smallest; side <= largest; side *= 2)
        for (std::uint32_t y = top; y < top + largest; y += side)
            for (std::uint32_t x = 0; x < width; x += side)
                join(side, x, y);
}

SquareAnswers::SquareAnswers(const CameraView& view, const LightView& light)
    : light_(light), position_(light.position()), axis_(light.direction()), range_(light.constants.range),
      cosine_(-1.0), sine_(0.0), offset_(0.0), cone_(light.type == GN_LIGHT_TYPE_SPOT)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        axis_ = -axis_;
        return;
    }
    // receiverOffset() (shaders/shared/receiver.h)
    offset_ = double(view.constants.offsetFactor) * double(lightLargest(view, light)) / 2097152.0;
    if (!cone_) return;
    cosine_ = light.constants.directionWs.w;
    sine_ = std::sqrt(std::max(1.0 - cosine_ * cosine_, 0.0));
}

SquareAnswers::Answer SquareAnswers::of(const ReceiverHull& square) const
{
    if (square.holds == Holds::beyond || square.holds == Holds::sky) return Answer::lit;
    if (square.holds == Holds::partial) return Answer::mixed;
    const Hull& hull = square.hull;
    const glm::dvec3 extent = hull.extent() + hull.largestOffset;
    // Ways to the light: single ones for directional lights, a box of them for the others.
    glm::dvec3 towards = axis_, spread(0.0);
    // Single precision squares what it compares: 1e-5 is far more than it loses, and a hundredth of a pixel.
    constexpr double kRounding = 1e-5;
    if (light_.type != GN_LIGHT_TYPE_DIRECTIONAL) {
        towards = position_ - hull.centre;
        spread = extent + kRounding * (glm::abs(position_) + glm::abs(hull.centre));
        const double radius = glm::length(spread), distance = glm::length(towards);
        if (distance - radius > range_ * (1.0 + kRounding)) return Answer::lit;
        if (!(distance + radius < range_ * (1.0 - kRounding))) return Answer::mixed;
        if (cone_) {
            // distance * sin(angle to the axis - half angle) changes by no more than a point moves.
            const double along = -glm::dot(towards, axis_);
            const double across = std::sqrt(std::max(distance * distance - along * along, 0.0));
            const double outside = cosine_ * across - sine_ * along, unsure = radius + 1e-3 * distance;
            if (outside > unsure) return Answer::lit;
            if (!(outside < -unsure)) return Answer::mixed;
        }
    }
    double least = 0.0, most = 0.0, size = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double n[2] = {square.normalLower[i], square.normalUpper[i]};
        const double to[2] = {towards[i] - spread[i], towards[i] + spread[i]};
        const double products[4] = {n[0] * to[0], n[0] * to[1], n[1] * to[0], n[1] * to[1]};
        least += *std::min_element(products, products + 4);
        most += *std::max_element(products, products + 4);
        size += std::max(std::abs(n[0]), std::abs(n[1])) * std::max(std::abs(to[0]), std::abs(to[1]));
    }
    if (least > kRounding * size) return Answer::rays;
    return most < -kRounding * size ? Answer::dark : Answer::mixed;
}

Hull SquareAnswers::hull(const ReceiverHull& square) const
{
    Hull hull = square.hull;
    if (light_.type == GN_LIGHT_TYPE_DIRECTIONAL) return hull; // the same numbers
    // Rays start farther along each pixel's normal, and their coordinates are rounded anew: 2^-23 of them, twice.
    const glm::dvec3 largest = hull.largest();
    const double wider = offset_ + 1e-5 * hull.largestOffset + 0x1p-22 * (largest.x + largest.y + largest.z);
    for (double& half : hull.half)
        half += wider;
    hull.largestOffset += wider;
    return hull;
}

} // namespace gnomon
