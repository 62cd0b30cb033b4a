#pragma once
// The tables of Macedo's thesis, measured with our methods on scenes that stand in for his.

#include <array>
#include <compare>
#include <functional>
#include <map>
#include <string>

#include "demo/program/session.hpp"

namespace gnomon::demo::macedo {

/// What a row of his tables stands for.
enum class Row : uint8_t {
    map,
    conservative,
    lines,
    volume,
    moments,
    pcf,
    distances,
    rpcf,
    uniform,
    adaptive,
    revectorized,
    pcss,
    softDistances,
    softLines,
    screenLines,
    tables
};
const char* nameOf(Row row) noexcept;

/// His scenes are not to be had. Simple bodies, a grid of bars, fine detail, trees.
enum class Scenery : uint8_t { figure, lattice, fine, trees };
const char* nameOf(Scenery scenery) noexcept;

enum class Picture : uint8_t { p480, p720, p1080, p2160 };
inline constexpr std::array<VkExtent2D, 4> kPictures = {{{854, 480}, {1280, 720}, {1920, 1080}, {3840, 2160}}};

/// One number of a table.
struct Cell {
    Scenery scenery = Scenery::figure;
    Picture picture = Picture::p720;
    Row row = Row::map;
    uint32_t map = 1024;
    uint32_t kernel = 0; ///< Texels a side; 0: the row's own.

    auto operator<=>(const Cell&) const = default;
};

struct Measured {
    bool served = false;                 ///< The method has such a map and kernel, and memory for it.
    double frameMs = 0.0;                ///< Median, the picture without shadows included.
    double points = 0.0;                 ///< adaptive, revectorized: of 289.
    std::map<std::string, double> steps; ///< distances, revectorized, tables: ms of the passes of a name.
};
using Times = std::map<Cell, Measured>;

struct Options {
    double share = 1.0;  ///< Of the sides of his pictures and maps, in (0, 1].
    uint32_t frames = 6; ///< That count for a number.
    std::function<void(const Cell&, const Measured&)> measured;
};
/// @param cells those wanted; each is measured once
Times measure(Device& device, Times cells, const Options& options);

} // namespace gnomon::demo::macedo
