#pragma once
// Pictures of frames: the lit image, and the same with every light's method written into it.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "demo/host/renderer.hpp"
#include "demo/program/frame_log.hpp"

namespace gnomon::demo {

/// Of pixels that are lit by mistake, and dark by mistake.
inline constexpr Rgb8 kFalseLit{255, 40, 40}, kFalseShadow{60, 120, 255};

/// The colours of a series of any length. Neighbours differ in hue and in lightness.
Rgb8 seriesColour(size_t place) noexcept;

/// One colour per method, the same in every picture: by its place in the registry, or else by the letters of its name.
Rgb8 methodColour(std::string_view method) noexcept;

/// How many lights each method serves. A method that has served stays, at 0: legends of a film do not jump.
class MethodCounts {
public:
    /// In place of the counts before. Lights that no method serves are not counted.
    void take(const std::vector<FrameLog::LightLine>& lines);
    const std::map<std::string, uint32_t>& lights() const noexcept { return lights_; }

private:
    std::map<std::string, uint32_t> lights_;
};

/// A caption per light in its method's colour at the top left, and its name where it stands, if on the screen. Where
/// the picture has no room for so many lines, a legend and marks.
Image8 captioned(const Image8& picture, const Scene& scene, const SceneState& state, const CameraMatrices& camera,
                 const std::vector<FrameLog::LightLine>& lines, std::string_view title);

/// A colour as light, as bright as that of the light.
glm::vec3 lightTint(const Rgb8& colour, const Light& light) noexcept;

/// Colours of the lights, one per light of the scene, by the methods in a frame's lines: FrameRequest::lightColours.
/// Lights that are not there keep what `tints` has; empty, it starts with the scene's.
void tintByMethod(const Scene& scene, const SceneState& state, const std::vector<FrameLog::LightLine>& lines,
                  std::vector<glm::vec3>& tints);

/// The methods with how many lights each serves, in their colours along the bottom, in as many rows as it takes.
Image8 withLegend(const Image8& picture, const MethodCounts& counts);

/// Pixel of a world position; false when it is behind the eye or off the screen.
bool projectToPixel(const CameraMatrices& camera, VkExtent2D extent, const glm::dvec3& world, int32_t& x, int32_t& y);

} // namespace gnomon::demo
