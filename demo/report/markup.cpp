#include "demo/report/markup.hpp"

#include <algorithm>
#include <cmath>

#include "demo/io/number.hpp"
#include "demo/program/gnuplot.hpp"

namespace gnomon::demo {

namespace {

constexpr double kLeft = 58.0, kRight = 12.0, kTop = 10.0, kBottom = 40.0; // room for axes, pixels

std::string attribute(std::string_view name, double value)
{
    std::string out(" ");
    out += name;
    return out + "=\"" + fixed(value, 1) + "\"";
}

std::string titled(std::string_view tip)
{
    return "<title>" + escaped(tip) + "</title>";
}

} // namespace

std::string escaped(std::string_view text)
{
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
    }
    return out;
}

std::string fixed(double value, int decimals)
{
    if (!std::isfinite(value)) return "-";
    std::string text;
    appendFixed(text, value, decimals);
    return text;
}

std::string percent(double part, double whole)
{
    return whole > 0.0 ? fixed(100.0 * part / whole, 1) + " %" : "-";
}

std::string base64(std::string_view bytes)
{
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t three = 0;
        const size_t have = std::min<size_t>(3, bytes.size() - i);
        for (size_t k = 0; k < 3; ++k)
            three = three << 8 | (k < have ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            out += k <= have ? letters[three >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

std::vector<double> ticks(const Axis& axis)
{
    std::vector<double> out;
    constexpr double kSteps[] = {1.0, 2.0, 5.0};
    if (!axis.numbered) return out;
    if (axis.logarithmic) {
        const bool wide = axis.high / axis.low > 1e3;
        for (int power = int(std::floor(std::log10(axis.low))); power <= int(std::ceil(std::log10(axis.high))); ++power)
            for (const double step : kSteps) {
                const double tick = step * std::pow(10.0, power);
                if (tick >= axis.low && tick <= axis.high && (!wide || step == 1.0)) out.push_back(tick);
            }
        return out;
    }
    const double rough = (axis.high - axis.low) / 5.0;
    const double ten = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10.0 * ten;
    for (const double s : kSteps)
        if (s * ten >= rough) {
            step = s * ten;
            break;
        }
    for (double tick = std::ceil(axis.low / step) * step; tick <= axis.high + 1e-9 * step; tick += step)
        out.push_back(tick);
    return out;
}

SvgChart::SvgChart(double width, double height, Axis x, Axis y)
    : width_(width), height_(height), x_(std::move(x)), y_(std::move(y))
{
    for (Axis* axis : {&x_, &y_}) // of one value
        if (!(axis->high > axis->low)) axis->high = axis->low + std::max(1.0, std::abs(axis->low));
    axes();
}

namespace {

double share(const Axis& axis, double value)
{
    if (axis.logarithmic) return std::log(std::max(value, axis.low) / axis.low) / std::log(axis.high / axis.low);
    return (value - axis.low) / (axis.high - axis.low);
}

std::string tickText(double tick)
{
    std::string text;
    appendDigits(text, tick, 4);
    return text;
}

} // namespace

double SvgChart::placeX(double x) const
{
    return kLeft + (width_ - kLeft - kRight) * std::clamp(share(x_, x), 0.0, 1.0);
}

double SvgChart::placeY(double y) const
{
    return height_ - kBottom - (height_ - kTop - kBottom) * std::clamp(share(y_, y), 0.0, 1.0);
}

void SvgChart::axes()
{
    const double bottom = height_ - kBottom;
    for (const double tick : ticks(y_)) {
        const double y = placeY(tick);
        body_ += "<path class=\"grid\" d=\"M" + fixed(kLeft, 1) + " " + fixed(y, 1) + "H" + fixed(width_ - kRight, 1) +
                 "\"/><text class=\"tick\" text-anchor=\"end\"" + attribute("x", kLeft - 6) + attribute("y", y + 4) +
                 ">" + tickText(tick) + "</text>";
    }
    for (const double tick : ticks(x_)) {
        const double x = placeX(tick);
        body_ += "<path class=\"grid\" d=\"M" + fixed(x, 1) + " " + fixed(kTop, 1) + "V" + fixed(bottom, 1) +
                 "\"/><text class=\"tick\" text-anchor=\"middle\"" + attribute("x", x) + attribute("y", bottom + 15) +
                 ">" + tickText(tick) + "</text>";
    }
    body_ += "<text class=\"axis\" text-anchor=\"middle\"" + attribute("x", (kLeft + width_ - kRight) / 2) +
             attribute("y", height_ - 8) + ">" + escaped(x_.title) +
             "</text><text class=\"axis\" text-anchor=\"middle\" transform=\"translate(14 " +
             fixed((kTop + bottom) / 2, 1) + ") rotate(-90)\">" + escaped(y_.title) + "</text>";
}

void SvgChart::line(const Points& points, const Rgb8& colour, double width)
{
    std::string path;
    bool open = false;
    for (const auto& [x, y] : points) {
        if (!std::isfinite(x) || !std::isfinite(y)) {
            open = false;
            continue;
        }
        path += open ? 'L' : 'M';
        path += fixed(placeX(x), 1) + " " + fixed(placeY(y), 1);
        open = true;
    }
    if (path.empty()) return;
    body_ += "<path fill=\"none\" stroke=\"" + hexOf(colour) + "\"" + attribute("stroke-width", width) + " d=\"" +
             path + "\"/>";
}

void SvgChart::dot(double x, double y, const Rgb8& colour, std::string_view tip)
{
    body_ += "<circle r=\"5\" stroke=\"#222\" fill=\"" + hexOf(colour) + "\"" + attribute("cx", placeX(x)) +
             attribute("cy", placeY(y)) + ">" + titled(tip) + "</circle>";
}

void SvgChart::box(double x0, double x1, double y0, double y1, const Rgb8& colour, std::string_view tip)
{
    const double left = placeX(x0), top = placeY(y1);
    body_ += "<rect fill=\"" + hexOf(colour) + "\"" + attribute("x", left) + attribute("y", top) +
             attribute("width", std::max(placeX(x1) - left, 0.3)) + attribute("height", placeY(y0) - top) + ">" +
             titled(tip) + "</rect>";
}

void SvgChart::text(double x, double y, std::string_view words)
{
    constexpr double kLetter = 6.2, kLine = 10.0; // pixels, on average
    Text text{.left = placeX(x) + 8.0, .low = placeY(y) + 4.0};
    text.right = text.left + kLetter * static_cast<double>(words.size());
    const auto meets = [&text](const Text& other) {
        return text.left < other.right && other.left < text.right && std::abs(text.low - other.low) < kLine;
    };
    for (int i = 1; i <= 8 && std::any_of(texts_.begin(), texts_.end(), meets); ++i) // one line down, one up, two down
        text.low += (i % 2 != 0 ? i : -i) * kLine;
    texts_.push_back(text);
    body_ += "<text class=\"tick\"" + attribute("x", text.left) + attribute("y", text.low) + ">" + escaped(words) +
             "</text>";
}

void SvgChart::rowName(double y, std::string_view words)
{
    body_ += "<text class=\"row\" text-anchor=\"end\"" + attribute("x", kLeft - 4) + attribute("y", placeY(y) + 3) +
             ">" + escaped(words) + "</text>";
}

void SvgChart::tip(double x0, double x1, std::string_view words)
{
    const double left = placeX(x0);
    body_ += "<rect class=\"tip\"" + attribute("x", left) + attribute("y", kTop) +
             attribute("width", std::max(placeX(x1) - left, 0.5)) + attribute("height", height_ - kTop - kBottom) +
             ">" + titled(words) + "</rect>";
}

std::string SvgChart::svg() const
{
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + fixed(width_, 0) + " " + fixed(height_, 0) +
           "\">" + body_ + "</svg>\n";
}

namespace {

constexpr double kTitle = 30.0;                        // pixels, the line of a title
constexpr double kPatch = 11.0, kEntryHeight = 16.0;   // of a legend's entry
constexpr double kEntryLetter = 7.2, kEntryGap = 14.0; // on average, at 12 pixels

/// In as many rows as it takes, beside `width`. \param height becomes theirs
std::string svgLegend(const Legend& entries, double width, double& height)
{
    std::string out;
    double x = kLeft, y = 0.0;
    for (const auto& [name, colour] : entries) {
        const double room = kPatch + 5.0 + kEntryLetter * static_cast<double>(name.size());
        if (x > kLeft && x + room > width - kRight) x = kLeft, y += kEntryHeight;
        out += "<rect" + attribute("x", x) + attribute("y", y) + attribute("width", kPatch) +
               attribute("height", kPatch) + " fill=\"" + hexOf(colour) + "\"/><text class=\"axis\"" +
               attribute("x", x + kPatch + 5.0) + attribute("y", y + 10.0) + ">" + escaped(name) + "</text>";
        x += room + kEntryGap;
    }
    height = entries.empty() ? 0.0 : y + kEntryHeight;
    return out;
}

std::string moved(double x, double y, const std::string& body)
{
    return "<g transform=\"translate(" + fixed(x, 0) + " " + fixed(y, 0) + ")\">" + body + "</g>\n";
}

} // namespace

std::string svgPicture(std::span<const Drawing> drawings, size_t columns, std::string_view note)
{
    std::string body;
    double width = 0.0, top = 0.0, bottom = 0.0, left = 0.0;
    for (size_t i = 0; i < drawings.size(); ++i) {
        const auto& [title, chart, entries] = drawings[i];
        if (i % columns == 0) top = bottom, left = 0.0;
        double legendHeight = 0.0;
        const std::string patches = svgLegend(entries, chart.width(), legendHeight);
        body += "<text class=\"title\"" + attribute("x", left + kLeft) + attribute("y", top + 20.0) + ">" +
                escaped(title) + "</text>" + moved(left, top + kTitle, patches) +
                moved(left, top + kTitle + legendHeight, chart.body());
        left += chart.width();
        width = std::max(width, left);
        bottom = std::max(bottom, top + kTitle + legendHeight + chart.height());
    }
    if (!note.empty()) {
        body += "<text class=\"axis\"" + attribute("x", kLeft) + attribute("y", bottom + 12.0) + ">" + escaped(note) +
                "</text>\n";
        bottom += kTitle;
    }
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + fixed(width, 0) + " " + fixed(bottom, 0) +
           "\" font-family=\"sans-serif\"><style>.grid{stroke:#e3e6ea;fill:none}.tick{font-size:11px;fill:#59636e}"
           ".axis{font-size:12px;fill:#1c2128}.title{font-size:14px;font-weight:bold;fill:#1c2128}"
           "rect{shape-rendering:crispEdges}</style>"
           "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
           body + "</svg>\n";
}

std::string legend(std::span<const Legend::value_type> entries)
{
    std::string out = "<p class=\"legend\">";
    for (const auto& [name, colour] : entries)
        out += "<span><i style=\"background:" + hexOf(colour) + "\"></i>" + escaped(name) + "</span> ";
    return out + "</p>\n";
}

} // namespace gnomon::demo
