#pragma once
// Agrawala's coherence-based sampling on one tile of receivers: each one's picture of the light is predicted from its
// neighbours', and only cells that may have changed are traced.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/cell_grid.hpp"
#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/hybrid/receivers.hpp"

namespace gnomon {

/// The light and its cells; the same for all tiles.
struct CellLight {
    CellGrid grid;
    float radius;     ///< discRadius().
    float pixelSize;  ///< Width of a pixel at linear depth 1, metres.
    std::uint32_t mask;
};

/// Memory for a tile; one a thread.
class CoherenceTile {
public:
    static constexpr std::uint32_t kSide = 16; ///< Pixels; the first of them traces all of its cells.

    CoherenceTile(const CellLight& light, const HostContext& host) : light_(light), host_(host) {}

    /// Shares of the light that the pixels see, as bytes. @param visibility row by row, `stride` apart, of the tile's
    /// width x height pixels; left, top: in image coordinates.
    void answer(const Receivers& receivers, std::uint32_t left, std::uint32_t top, std::uint32_t width,
                std::uint32_t height, std::span<std::uint8_t> visibility, std::size_t stride);

private:
    struct Pixel {
        ShadowRay centre;
        Receiver surface;
        LightDisc disc;
        CellMask seen, known;
        bool asks;
    };
    static constexpr std::uint32_t kPixels = kSide * kSide;

    void read(const Receivers& receivers, std::uint32_t left, std::uint32_t top, std::span<std::uint8_t> visibility,
              std::size_t stride);
    void askRims(std::uint32_t left, std::uint32_t top);
    void predict(std::uint32_t x, std::uint32_t y);
    void review(std::uint32_t x, std::uint32_t y);
    CellMask ask(const Pixel& pixel, CellMask cells);
    const Pixel* alike(const Pixel& pixel, std::int32_t x, std::int32_t y) const;
    Pixel& at(std::uint32_t x, std::uint32_t y) { return pixels_[y * kSide + x]; }

    const CellLight& light_;
    const HostContext& host_;
    std::uint32_t width_ = 0, height_ = 0;
    std::uint64_t rays_ = 0; ///< Of the tile at work that were asked pixel by pixel.
    Pixel pixels_[kPixels];
};

} // namespace gnomon
