#include <algorithm>

#include "runtime/select/frame_plan.hpp"

// What part of the truth a method keeps: what the knowledge base says of it, and how hard the light makes it.
namespace gnomon {

namespace {

/// Pixels across a texel of a plain map of 1024, on average over a light's receivers, for which the knowledge's wrong
/// percents hold. Lights of eight shipped scenes with sides by coverage, texels of 0.1 to 30 pixels: the median of what
/// each implies is 0.58 for one map and 0.37 for six faces, and errors grow as the width to the power of 1.1 and 0.7.
constexpr double kUsualTexelPixels = 0.45;

/// Reach::outlines for which the knowledge's wrong percents hold, and the least share of it that counts. Of 211 pairs
/// of a light and shadow_map, cube_map or dual_paraboloid at 1024 texels, in 14 scenes at 640x360, the wrong pixels of
/// all together are 1.02, 1.00 and 1.01 times what these two expect; one pair differs by 1.7 octaves (root mean
/// square).
constexpr double kUsualOutlines = 0.03, kLeastOutlines = 0.25;

// Likewise of ShadowOutlines, and what may lie between its rays. Of 150 pairs of a light and shadow_map, cube_map or
// dual_paraboloid at 1024 texels, in 14 scenes at 640x360, the wrong pixels are 1.11, 0.77 and 0.82 times what is
// expected, and one pair differs by 0.96, 1.18 and 1.21 octaves (gnomon calibrate --errors). Reach::outlines
// leaves 1.5, 1.8 and 1.6 of these.
constexpr double kUsualTraced = 0.009, kUntraced = 0.001;

} // namespace

float qualityOf(const Method& method, const cost::KnowledgeBase& knowledge)
{
    const double typical = double{method.entry->typicalWrongPercent};
    return static_cast<float>(
        cost::measuresOf(knowledge, nullptr, method.entry->name, typical).quality(method.mapSide(kUnmeasuredSide)));
}

FramePlan::Coarseness FramePlan::coarsenessOf(const LightMemory& memory, std::uint32_t height) const
{
    Coarseness light;
    float texels = memory.texelPixels;
    if (memory.traced.known()) {
        light.outlines = (double{memory.traced.density()} + kUntraced) / kUsualTraced;
        if (memory.traced.texelPixels() > 0.0f) texels = memory.traced.texelPixels();
    } else if (memory.measured) {
        light.outlines = std::max(double{memory.outlines.get()} / kUsualOutlines, kLeastOutlines);
    }
    if (texels > 0.0f) light.texels = double{texels} / kUsualTexelPixels;
    if (memory.measured && memory.workload.softPixels > 0.0)
        light.hardEdges = penumbraPercent(double{memory.penumbraPixels.get()}, height);
    return light;
}

/// Share of the truth that a method keeps with maps of a plain side.
float FramePlan::quality(std::uint32_t method, std::uint32_t side, const Coarseness& light) const
{
    double wrong = double{wrong_[rungOf(side) * methods_.size() + method]};
    if (methods_[method].coarsens()) wrong *= light.texels;
    if (!methods_[method].isExact()) wrong *= light.outlines;
    if (!methods_[method].isSoft()) wrong += light.hardEdges;
    return static_cast<float>(1.0 / (1.0 + wrong));
}

/// Of a method whose maps follow coverage, the smallest that keeps so much of the truth; 0: none does, or it has none.
std::uint32_t FramePlan::leastSide(std::uint32_t method, float least, const Coarseness& light) const
{
    if (method >= methods_.size() || !methods_[method].followsCoverage() || methods_[method].isExact()) return 0;
    const auto keeps = [&](std::uint32_t side) { return quality(method, side, light) >= least; };
    const auto found = std::find_if(kMapSides.begin(), kMapSides.end(), keeps);
    return found == kMapSides.end() ? 0 : *found;
}

} // namespace gnomon
