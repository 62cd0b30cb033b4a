// Runs of frames, and the exact answers that they are held against.
#ifndef GNOMON_TESTS_HOST_RUNS_HPP
#define GNOMON_TESTS_HOST_RUNS_HPP

#include <memory>
#include <string>
#include <vector>

#include "measure.hpp"

namespace stranger {

constexpr double kStepS = 1.0 / 30.0; // of the animation, whatever a frame takes

/// Renders frames from a moment on, waits, and gives the median of what their shadows took.
double runFrames(Renderer& renderer, double fromS, int frames);

/// Renders for a second of wall time, as a host does before its user has looked around, and 16 frames where a machine
/// is too slow for them.
void runFirstSecond(Renderer& renderer);

/// A renderer all of whose lights are pinned, warmed up. Null where the method is refused.
std::unique_ptr<Renderer> createPinned(const Device& device, const Options& options, const std::string& method);

/// What rays say at some moments, by the submitted entry point. Throws where there are no rays.
std::vector<Answer> traceReferences(const Device& device, VkExtent2D size);

/// Largest wrong share over these moments, in per cent. Each is looked at in its second frame: what was kept from the
/// first one, and should not have been, shows.
double wrongAtMoments(Renderer& renderer, const std::vector<Answer>& references);

} // namespace stranger
#endif
