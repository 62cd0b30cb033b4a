#pragma once
// What every run of a comparison draws, and the truth that its errors are counted against.
#include <array>
#include <map>

#include "demo/compare/fixed_choice.hpp"
#include "demo/compare/near_far.hpp"
#include "demo/compare/path.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

/// By frame of the path.
using Truths = std::map<uint32_t, FrameTruth>;

struct Stage {
    Device& device;
    const Scene& scene;
    VkExtent2D size{};
    ComparePath path;
    bool recorded = false; ///< gnCmdRenderShadows, else gnSubmitShadows.
    RuleText rules;        ///< For maps that follow screen coverage: without rules no receivers are measured.
};

/// Draws a frame of the path and waits for it. \param budgetMs 0: the host gives none
void drawFrame(Session& session, const Stage& stage, uint32_t frame, float budgetMs = 0.0f, GnFrameFlags flags = 0);

/// Frames in which errors are counted, evenly over the path.
std::vector<uint32_t> truthFrames(const ComparePath& path);

/// Draws each of these frames by ray_traced, submitted. Throws HostError where the build or the device has no such
/// method.
Truths measureTruths(Session& session, const Stage& stage, const std::vector<uint32_t>& frames);

/// Errors of the newest frame of a session, by LightKind. Lights may be fewer than the truth's.
std::array<NearFar, kLightKinds> countErrors(Session& session, const FrameTruth& truth);

} // namespace gnomon::demo
