#pragma once
// Sides of shadow maps by screen coverage: about a texel a pixel where the light's receivers are nearest to the eye,
// and no more texels than the pixels that it reaches can show.
#include <array>
#include <cstdint>
#include <span>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Texels per side, each twice the one before.
inline constexpr std::array<std::uint32_t, 6> kMapSides{128, 256, 512, 1024, 2048, 4096};
/// Where nothing is known of the receivers; of what is guessed of them the most.
inline constexpr std::uint32_t kUnmeasuredSide = 1024;

/// Place in kMapSides of one of them.
std::size_t rungOf(std::uint32_t side) noexcept;

/// What a map side follows from.
struct MapCoverage {
    double texelAtOne = 0.0; ///< LightFit::texelAtOne: the map's width at 1 m, or anywhere for a directional light.
    /// Metres from the light to the receiver over metres from the eye to it, of the receiver where that is most; of a
    /// directional light 1 over the latter.
    double nearness = 0.0;
    double pixelAngle = 0.0; ///< Width of a pixel at 1 m.
    double pixels = 0.0;     ///< That the light reaches.
    double maps = 1.0;       ///< Among which its texels are divided.
};

/// Width of a light's map at 1 m, or anywhere for a directional light, in metres.
double mapWidth(const LightView& light, const LightCasters& casters);
/// Among how many maps the texels of a light of the kind are divided: six faces, four cascades, or one.
double mapsOf(GnLightType type) noexcept;

/// The side that shows what the pixels can show, not rounded; 0: no receiver is visible.
double sideFor(const MapCoverage& coverage) noexcept;

/// The side of a light's maps from frame to frame. It grows at once, and shrinks when the wish has been small for a
/// while: a light at the border of two sides keeps the one it has.
class MapSide {
public:
    static constexpr double kGrow = 1.4, kShrink = 0.6; ///< Of the side, that a wish has to pass.
    static constexpr std::uint32_t kShrinkFrames = 30;  ///< In a row; half a second at 60 Hz.

    /// One frame. @param wish of sideFor(); 0 changes nothing @param again the newest wish counts alone: the first one,
    /// or that of a camera cut
    void follow(double wish, bool again) noexcept;

    std::uint32_t side() const noexcept { return side_; }     ///< In force.
    std::uint32_t wanted() const noexcept { return wanted_; } ///< By coverage.
    /// By coverage, and by memory.
    std::uint32_t affordable() const noexcept { return wanted_ < most_ ? wanted_ : most_; }
    void limit(std::uint32_t most) noexcept { most_ = most; } ///< What memory allows, until told otherwise.
    std::uint32_t most() const noexcept { return most_; }
    void take() noexcept { side_ = affordable(); } ///< It is in force from this frame on.

private:
    std::uint32_t side_ = kUnmeasuredSide, wanted_ = kUnmeasuredSide, most_ = kMapSides.back();
    std::uint32_t below_ = 0; ///< Frames in a row with a wish below kShrink.
};

/// One light's maps in a frame.
struct SideRequest {
    MapSide* side = nullptr;
    bool redraws = false;       ///< The maps are kept, and another side has them drawn once more.
    double bytesPerTexel = 0.0; ///< Device bytes over the square of the side; 0: no memory depends on it.
    bool drawn = true;          ///< The light's method has maps; false: it may change to one that has.
    double worth = 1.0;         ///< What a wrong pixel is held against: importance times pixels reached.

    double bytes(std::uint32_t at) const noexcept { return bytesPerTexel * at * at; }
};

/// Limits sides so that all maps together fit. What shows least a byte is halved first, again and again; where there is
/// room once more, one light a frame gets a step back. Below kMapSides.front() nothing goes: methods are refused then.
/// Maps that are not drawn are limited to their share of the room that is left, since all of them may be drawn in the
/// next frame; one light is offered all of it.
/// @param turn which of them that is, modulo their number; another one in every frame
void fitSides(std::span<const SideRequest> requests, double budgetBytes, std::uint64_t turn) noexcept;

/// Sides come into force: all at once where maps are drawn in this frame anyway, or memory wants them smaller; and one
/// a frame, the one that is farthest off, where a kept map is drawn once more for it.
void takeSides(std::span<const SideRequest> requests) noexcept;

} // namespace gnomon
