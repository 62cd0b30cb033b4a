#pragma once
// Text as HTML: escaping, numbers, and charts as inline SVG. The page is well-formed XML, so that a strict reader finds
// what a forgiving browser would not.
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "demo/io/image.hpp"

namespace gnomon::demo {

/// For text and for attributes in double quotes. Control characters, which XML has no place for, become spaces.
std::string escaped(std::string_view text);
std::string fixed(double value, int decimals); ///< "-" where it is no number.
std::string percent(double part, double whole);
std::string base64(std::string_view bytes);

struct Axis {
    double low = 0.0, high = 1.0; ///< low < high; of a logarithmic one, low > 0.
    std::string title;
    bool logarithmic = false;
    bool numbered = true; ///< Has ticks.
};

using Points = std::vector<std::pair<double, double>>;

/// One chart with axes. What is drawn lies over what was drawn before.
class SvgChart {
public:
    SvgChart(double width, double height, Axis x, Axis y);

    void line(const Points& points, const Rgb8& colour, double width = 1.2); ///< NaN breaks it.
    void dot(double x, double y, const Rgb8& colour, std::string_view tip);
    void box(double x0, double x1, double y0, double y1, const Rgb8& colour, std::string_view tip);
    void text(double x, double y, std::string_view words); ///< Beside a place, or above or below other texts there.
    void rowName(double y, std::string_view words);        ///< Left of the y axis, in place of a number.
    /// Says `tip` wherever the pointer is between two places of the x axis. Last of all, over everything.
    void tip(double x0, double x1, std::string_view words);

    std::string svg() const;
    double height() const { return height_; }
    double width() const { return width_; }
    const std::string& body() const { return body_; } ///< Without the <svg> around it.

private:
    double placeX(double x) const;
    double placeY(double y) const;
    void axes();

    struct Text {
        double left = 0.0, right = 0.0, low = 0.0; ///< Pixels.
    };

    double width_, height_;
    Axis x_, y_;
    std::string body_;
    std::vector<Text> texts_;
};

/// Round numbers between the ends of the axis: some five, or the powers of ten and their double and fivefold.
std::vector<double> ticks(const Axis& axis);

using Legend = std::vector<std::pair<std::string, Rgb8>>;

/// A chart with what stands above it.
struct Drawing {
    std::string title;
    SvgChart chart;
    Legend entries; ///< A coloured patch with a word for each.
};

/// An SVG file, in rows of so many drawings, with a note below.
std::string svgPicture(std::span<const Drawing> drawings, size_t columns = 1, std::string_view note = {});

/// As HTML.
std::string legend(std::span<const Legend::value_type> entries);

} // namespace gnomon::demo
