#pragma once
// Agrawala's coherence-based sampling on one tile of receivers: each one's picture of the light is predicted from its
// neighbours', and only cells that may have changed are traced.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/cell_grid.hpp"
#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/shared/receivers.hpp"

namespace gnomon {

/// The light and its cells; the same for all tiles.
struct CellLight {
    CellGrid grid;
    float radius;    ///< discRadius().
    float pixelSize; ///< Width of a pixel at linear depth 1, metres.
    std::uint32_t mask;
};

/// Memory for a tile; one a thread.
class CoherenceTile {
public:
    static constexpr std::uint32_t kSide = 32; ///< Pixels; the first of them traces all of its cells.

    CoherenceTile(const CellLight& light, const HostContext& host) : light_(light), host_(host) {}

    /// Shares of the light that the pixels see, as bytes. @param visibility row by row, `stride` apart, of the tile's
    /// width x height pixels; left, top: in image coordinates.
    void answer(const Receivers& receivers, std::uint32_t left, std::uint32_t top, std::uint32_t width,
                std::uint32_t height, std::span<std::uint8_t> visibility, std::size_t stride);

private:
    enum Side : std::uint8_t { kLeft = 1, kRight = 2, kAbove = 4, kBelow = 8, kAround = 15 };
    struct Pixel {
        ShadowRay centre;
        Receiver surface;
        LightDisc disc;
        CellPicture cells;
        bool asks;
        std::uint8_t beside; ///< Bits of Side: neighbours that ask and lie on the same surface.
    };
    static constexpr std::uint32_t kPixels = kSide * kSide, kCells = CellGrid::kMaxSide * CellGrid::kMaxSide;
    static constexpr std::size_t kBatch = kSide * kCells; ///< Rays: as many as a diagonal can ask.
    /// Pixels that follow their borders together, and what they ask next.
    struct Following {
        Pixel* pixel;
        CellMask doubted, asked;
    };

    void read(const Receivers& receivers, std::uint32_t left, std::uint32_t top, std::span<std::uint8_t> visibility,
              std::size_t stride);
    void findAlike();
    bool alike(const Pixel& pixel, const Pixel& other) const;
    void ask(const Pixel& pixel, CellMask cells, std::uint32_t tag);
    void askRims(std::uint32_t left, std::uint32_t top);
    CellMask predict(Pixel& pixel) const;
    CellMask review(const Pixel& pixel) const;
    template <typename Doubt>
    void sweep(std::uint32_t diagonal, Doubt doubt);
    void follow(std::span<Following> pixels);
    std::span<Following> askNext(std::span<Following> pixels);
    Pixel& at(std::uint32_t x, std::uint32_t y) { return pixels_[y * kSide + x]; }

    const CellLight& light_;
    const HostContext& host_;
    std::uint32_t width_ = 0, height_ = 0;
    Pixel pixels_[kPixels];
    Following following_[kSide];
    RayBatch<kBatch> batch_;
};

} // namespace gnomon
