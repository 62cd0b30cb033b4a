#include "demo/program/pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "demo/io/number.hpp"
#include "demo/io/text.hpp"
#include "runtime/registry.hpp"

namespace gnomon::demo {
namespace {

constexpr Rgb8 kInk{16, 16, 16};

/// Lightness and chroma in Oklab (Ottosson 2020). The darkest still carries dark ink at a contrast of 4.4 to 1.
struct Tier {
    float lightness, chroma;
};
constexpr std::array<Tier, 3> kTiers = {{{0.74f, 0.15f}, {0.60f, 0.17f}, {0.87f, 0.14f}}};

// Hues of one tier are a golden section of a turn apart, so that they spread evenly however many there are. The tiers
// are shifted against each other: of the first 21 colours no two are closer than 0.07 in Oklab.
constexpr float kGoldenTurn = 0.618034f;
constexpr float kTierTurn = 0.4f;

Rgb8 fromOklab(float lightness, float a, float b)
{
    const auto cube = [](float x) { return x * x * x; };
    const float l = cube(lightness + 0.3963377774f * a + 0.2158037573f * b);
    const float m = cube(lightness - 0.1055613458f * a - 0.0638541728f * b);
    const float s = cube(lightness - 0.0894841775f * a - 1.2914855480f * b);
    return {encodeSrgb(4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s),
            encodeSrgb(-1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s),
            encodeSrgb(-0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s)};
}

/// Where a method stands in the registry. Others, of plug-ins or added under a name, get places behind by their
/// letters.
size_t placeOf(std::string_view method) noexcept
{
    const auto algorithms = builtinRegistry().algorithms;
    for (size_t place = 0; place < algorithms.size(); ++place)
        if (method == algorithms[place].entry->name) return place;
    uint32_t hash = 2166136261u; // FNV-1a
    for (const char c : method)
        hash = (hash ^ static_cast<uint8_t>(c)) * 16777619u;
    return algorithms.size() + hash % 1024u;
}

/// Letters of some 12 pixels in a picture 640 wide, and in proportion.
uint32_t captionScale(const Image8& picture)
{
    return std::max(1u, picture.width / 640u);
}

} // namespace

Rgb8 seriesColour(size_t place) noexcept
{
    const size_t tier = place % kTiers.size();
    const float turns = kGoldenTurn * static_cast<float>(place / kTiers.size()) + kTierTurn * static_cast<float>(tier);
    const float angle = 2.0f * std::numbers::pi_v<float> * (turns - std::floor(turns));
    const auto [lightness, chroma] = kTiers[tier];
    return fromOklab(lightness, chroma * std::cos(angle), chroma * std::sin(angle));
}

Rgb8 methodColour(std::string_view method) noexcept
{
    return seriesColour(placeOf(method));
}

bool projectToPixel(const CameraMatrices& camera, VkExtent2D extent, const glm::dvec3& world, int32_t& x, int32_t& y)
{
    const glm::dvec4 clip = glm::dmat4(camera.clipFromEye) * glm::dvec4(world - camera.eye, 1.0);
    if (clip.w <= 0.0) return false;
    const double px = (clip.x / clip.w * 0.5 + 0.5) * extent.width, py = (clip.y / clip.w * 0.5 + 0.5) * extent.height;
    if (px < 0.0 || py < 0.0 || px >= extent.width || py >= extent.height) return false;
    x = static_cast<int32_t>(px);
    y = static_cast<int32_t>(py);
    return true;
}

void MethodCounts::take(const std::vector<FrameLog::LightLine>& lines)
{
    for (auto& [method, count] : lights_)
        count = 0;
    for (const FrameLog::LightLine& line : lines)
        if (line.method != kNoMethod) ++lights_[line.method];
}

Image8 captioned(const Image8& picture, const Scene& scene, const SceneState& state, const CameraMatrices& camera,
                 const std::vector<FrameLog::LightLine>& lines, std::string_view title)
{
    const uint32_t scale = captionScale(picture);
    const auto lineHeight = static_cast<int32_t>(measureText("X", scale).height + 3 * kLabelMargin * scale);
    int32_t y = static_cast<int32_t>(4 * scale);
    const auto x = y;
    const bool fits = int64_t(lines.size() + 1) * lineHeight + y <= int64_t(picture.height);
    Image8 out = picture;
    for (size_t i = 0; i < state.present.size() && i < lines.size(); ++i) {
        const Light& light = scene.lights[state.present[i]];
        int32_t px = 0, py = 0;
        if (light.kind != LightKind::Directional &&
            projectToPixel(camera, {picture.width, picture.height}, state.lights[state.present[i]].position, px, py))
            drawLabel(out, px, py, fits ? std::string_view(light.name) : " ", kInk, methodColour(lines[i].method),
                      scale);
    }
    drawLabel(out, x, y, title, {255, 255, 255}, kInk, scale);
    if (!fits) {
        MethodCounts counts;
        counts.take(lines);
        return withLegend(out, counts);
    }
    for (const FrameLog::LightLine& line : lines) {
        y += lineHeight;
        std::string text = line.light + ": " + line.method + "  ";
        appendFixed(text, double(line.suitability), 2);
        drawLabel(out, x, y, text, kInk, methodColour(line.method), scale);
    }
    return out;
}

glm::vec3 lightTint(const Rgb8& colour, const Light& light) noexcept
{
    const auto brightness = [](const glm::vec3& c) { return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f)); };
    const auto linear = [](uint8_t c) { return std::pow((float(c) / 255.0f + 0.055f) / 1.055f, 2.4f); };
    const glm::vec3 shade(linear(colour.r), linear(colour.g), linear(colour.b)), grey(brightness(shade));
    // Of light colours a grey wall would show little: their chroma counts twice.
    const glm::vec3 tint = glm::max(grey + 2.0f * (shade - grey), 0.0f);
    return tint * (brightness(light.colour * light.intensity) / brightness(tint));
}

void tintByMethod(const Scene& scene, const SceneState& state, const std::vector<FrameLog::LightLine>& lines,
                  std::vector<glm::vec3>& tints)
{
    if (tints.empty())
        for (const Light& light : scene.lights)
            tints.push_back(light.colour * light.intensity);
    for (size_t i = 0; i < state.present.size() && i < lines.size(); ++i)
        tints[state.present[i]] = lightTint(methodColour(lines[i].method), scene.lights[state.present[i]]);
}

Image8 withLegend(const Image8& picture, const MethodCounts& counts)
{
    const uint32_t scale = captionScale(picture);
    const auto gap = static_cast<int32_t>(2 * kLabelMargin * scale);
    const auto plate = [scale](uint32_t letters) { return int32_t(letters + 2 * kLabelMargin * scale); };
    struct Entry {
        std::string text;
        Rgb8 colour;
        int32_t x, row;
    };
    std::vector<Entry> entries;
    int32_t x = gap, row = 0;
    for (const auto& [method, count] : counts.lights()) {
        std::string text = method + "  " + std::to_string(count);
        const int32_t width = plate(measureText(text, scale).width);
        if (x > gap && x + width + gap > int32_t(picture.width)) {
            x = gap;
            ++row;
        }
        entries.push_back({std::move(text), methodColour(method), x, row});
        x += width + gap;
    }
    Image8 out = picture;
    const int32_t rowHeight = plate(measureText("X", scale).height) + gap;
    for (const Entry& entry : entries)
        drawLabel(out, entry.x, int32_t(picture.height) - (row - entry.row + 1) * rowHeight, entry.text, kInk,
                  entry.colour, scale);
    return out;
}

} // namespace gnomon::demo
