// The colours that pictures and plots give to methods.
#include <cmath>
#include <map>
#include <string>

#include <doctest/doctest.h>

#include "demo/program/pictures.hpp"
#include "runtime/registry.hpp"

using namespace gnomon::demo;

namespace {

double distance(Rgb8 a, Rgb8 b)
{
    return std::hypot(double(a.r) - b.r, double(a.g) - b.g, double(a.b) - b.b);
}

/// Relative luminance (WCAG 2.1).
double luminance(Rgb8 colour)
{
    const auto linear = [](uint8_t byte) {
        const double value = byte / 255.0;
        return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * linear(colour.r) + 0.7152 * linear(colour.g) + 0.0722 * linear(colour.b);
}

} // namespace

TEST_CASE("any number of methods get colours of their own, neighbours clearly different ones")
{
    constexpr size_t count = 64;
    const double ink = luminance({16, 16, 16}); // that captions are written in
    for (size_t i = 0; i < count; ++i) {
        CAPTURE(i);
        const Rgb8 colour = seriesColour(i);
        CHECK((luminance(colour) + 0.05) / (ink + 0.05) > 4.0);
        CHECK(distance(colour, seriesColour(i + 1)) > 60.0);
        for (size_t other = 0; other < i; ++other)
            CHECK(seriesColour(other) != colour);
    }
}

TEST_CASE("built-in methods are told apart, and a name that is none has a colour of its own too")
{
    const auto algorithms = gnomon::builtinRegistry().algorithms;
    for (size_t i = 0; i < algorithms.size(); ++i)
        for (size_t other = 0; other < i; ++other) {
            const std::string name = algorithms[i].entry->name, otherName = algorithms[other].entry->name;
            CHECK_MESSAGE(distance(methodColour(name), methodColour(otherName)) > 10.0, name, " and ", otherName);
        }
    CHECK(methodColour("some plug-in") == methodColour("some plug-in"));
    CHECK(methodColour("some plug-in") != methodColour("another plug-in"));
}

TEST_CASE("a light in its method's colour is as bright as before, and a legend counts lights by method")
{
    Light light;
    light.colour = {1.0f, 0.4f, 0.2f};
    light.intensity = 3.0f;
    const auto brightness = [](const glm::vec3& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; };
    const glm::vec3 tint = lightTint(methodColour("shadow_map"), light),
                    other = lightTint(methodColour("ray_traced"), light);
    CHECK(brightness(tint) == doctest::Approx(3.0 * brightness(light.colour)));
    CHECK(brightness(other) == doctest::Approx(brightness(tint)));
    CHECK(std::abs(tint.r / tint.g - other.r / other.g) > 0.1f);

    const Image8 picture(320, 90, 3);
    MethodCounts methods;
    methods.take({{"a", "shadow_map", 1.0f, false}, {"b", "ray_traced", 1.0f, false}, {"c", "none", 0.0f, false}});
    CHECK(methods.lights() == std::map<std::string, uint32_t>{{"ray_traced", 1}, {"shadow_map", 1}});
    const Image8 legend = withLegend(picture, methods);
    const auto counts = [&](uint32_t top, uint32_t bottom, std::string_view method) {
        const Rgb8 colour = methodColour(method);
        size_t found = 0;
        for (uint32_t i = top * 320; i < bottom * 320; ++i)
            found += legend.texels[3 * i] == colour.r && legend.texels[3 * i + 1] == colour.g &&
                     legend.texels[3 * i + 2] == colour.b;
        return found;
    };
    for (const std::string_view method : {"shadow_map", "ray_traced"}) {
        CHECK(counts(0, 66, method) == 0);
        CHECK(counts(66, 90, method) > 300);
    }
    CHECK(counts(0, 90, "cube_map") == 0);
    methods.take({{"a", "shadow_map", 1.0f, false}, {"b", "shadow_map", 1.0f, false}});
    CHECK(methods.lights() == std::map<std::string, uint32_t>{{"ray_traced", 0}, {"shadow_map", 2}});
}

TEST_CASE("a legend that is wider than the picture takes more rows, and all of it is seen")
{
    std::vector<FrameLog::LightLine> lines;
    const auto algorithms = gnomon::builtinRegistry().algorithms;
    for (size_t i = 0; i < 8; ++i)
        lines.push_back({"light", algorithms[i].entry->name, 1.0f, false});
    MethodCounts methods;
    methods.take(lines);
    const Image8 legend = withLegend(Image8(320, 180, 3), methods);
    for (const FrameLog::LightLine& line : lines) {
        CAPTURE(line.method);
        const Rgb8 colour = methodColour(line.method);
        size_t found = 0;
        for (size_t i = 0; i < legend.texels.size(); i += 3)
            found += Rgb8{legend.texels[i], legend.texels[i + 1], legend.texels[i + 2]} == colour;
        CHECK(found > 300); // a plate of its own
    }
}
