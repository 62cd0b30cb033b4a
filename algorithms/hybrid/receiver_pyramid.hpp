#pragma once
// Squares of 8 to 64 pixels of what a view shows: made once a view, whatever the lights, and asked by each what it is
// to all of a square, and for the hull of where its rays start there.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/shaft.hpp"
#include "algorithms/hybrid/tile_blocks.hpp"

namespace gnomon {

/// The receivers of a square of pixels.
struct ReceiverSquare {
    enum class Holds : std::uint8_t {
        beyond, ///< No pixel of the view's area.
        sky,    ///< No receiver.
        whole,  ///< A receiver in every pixel.
        partial ///< Anything else: depths that are no numbers or not ahead, squares that the area cuts.
    };
    simd::DepthPlane plane;             ///< Of whole squares, as what follows.
    glm::vec3 normalLower, normalUpper; ///< Bounds, as stored.
    std::uint16_t left, top;            ///< First pixel in the area.
    std::uint8_t width, height;         ///< As far as the area reaches, pixels.
    Holds holds = Holds::beyond;
};

/// Squares side by side, level by level: each level's are twice as wide as the one's before.
class ReceiverPyramid {
public:
    static constexpr std::uint32_t kSmallest = 8, kLargest = 64; ///< Sides, pixels.
    static constexpr std::uint32_t kLevels = 4;

    explicit ReceiverPyramid(VkExtent2D extent); ///< Of the view's area.
    std::size_t count() const { return first_[kLevels]; }
    /// Index of the square of `side` pixels, a power of two, that holds pixel (x, y) of the area.
    std::size_t index(std::uint32_t side, std::uint32_t x, std::uint32_t y) const;

private:
    std::uint32_t columns_; ///< Of the largest squares.
    std::size_t first_[kLevels + 1];
};

/// Fills the squares in rows of the largest ones.
class SquareMaker {
public:
    /// @param depth @param normals as for BlockReader; normals must be there
    SquareMaker(const simd::Kernels& kernels, const CameraView& view, std::span<const float> depth,
                std::span<const std::byte> normals, std::span<ReceiverSquare> squares);
    void row(std::uint32_t top) const; ///< @param top first pixel row in the area

private:
    simd::SquareTexels texels(std::uint32_t x, std::uint32_t y) const;
    void prefetch(std::uint32_t x, std::uint32_t y) const;
    void smallest(std::uint32_t x, std::uint32_t y) const;
    void join(std::uint32_t side, std::uint32_t x, std::uint32_t y) const;

    const simd::Kernels& kernels_;
    const gpu::ViewConstants& view_;
    VkRect2D area_;
    std::size_t width_; ///< Of the image.
    std::span<const float> depth_;
    std::span<const std::byte> normals_;
    bool halfNormals_;
    ReceiverPyramid pyramid_;
    std::span<ReceiverSquare> squares_;
};

/// One light and the squares of a view.
class SquareAnswers {
public:
    enum class Answer : std::uint8_t {
        lit,   ///< Nothing there that the light reaches.
        dark,  ///< All of it is reached and faces away.
        rays,  ///< All of it is reached and faces the light.
        mixed, ///< Anything else.
    };
    SquareAnswers(const CameraView& view, const LightView& light);
    Answer of(const ReceiverSquare& square) const;
    Hull hull(const ReceiverSquare& square) const; ///< Where the rays to this light start; of whole squares.

private:
    struct Prism;
    Prism prismOf(const ReceiverSquare& square) const;

    const CameraView& view_;
    const LightView& light_;
    glm::dvec3 position_, axis_; ///< The light's; directional: axis_ is the direction towards it.
    double range_, cosine_, sine_;
    double offset_; ///< What the light's place and far corners of triangles add to offsets, at most.
    bool cone_;
};

} // namespace gnomon
