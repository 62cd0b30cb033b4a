// The colours that pictures and plots give to methods.
#include <cmath>
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
