#include "measure.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <stdexcept>

#include <lodepng.h>

namespace stranger {
namespace {

/// A normal half float, or zero: what unit vectors are made of.
float floatFromHalf(uint16_t half)
{
    const uint32_t exponent = half >> 10 & 31u;
    if (exponent == 0) return 0.0f;
    return std::bit_cast<float>((half & 0x8000u) << 16 | (exponent + 112u) << 23 | (half & 0x3FFu) << 13);
}

Vec3 positionOf(const Answer& answer, size_t pixel)
{
    const FrameData& data = answer.data;
    const auto clipAt = [](size_t i, uint32_t count) {
        return 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(count) - 1.0f;
    };
    const float ahead = data.near / answer.depth[pixel];
    const float x = ahead * clipAt(pixel % answer.size.width, answer.size.width) / data.clipPerViewX;
    const float y = ahead * clipAt(pixel / answer.size.width, answer.size.height) / data.clipPerViewY;
    Vec3 position;
    for (size_t axis = 0; axis < 3; ++axis)
        position[axis] =
            data.eye[axis] + x * data.viewRight[axis] + y * data.viewUp[axis] - ahead * data.viewBack[axis];
    return position;
}

bool shinesOn(const Answer& answer, size_t pixel, const Vec3& position, size_t lamp)
{
    constexpr float kGrazing = 0.03f;
    float squared = 0.0f, along = 0.0f;
    for (size_t axis = 0; axis < 3; ++axis) {
        const float toLamp = answer.data.lamps[lamp].position[axis] - position[axis];
        squared += toLamp * toLamp;
        along += toLamp * floatFromHalf(answer.normals[4 * pixel + axis]);
    }
    const float away = std::sqrt(squared);
    return along > kGrazing * away && away < answer.data.lamps[lamp].range;
}
} // namespace

Summary summarise(std::vector<double> values)
{
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return {sum / static_cast<double>(values.size()), values[values.size() / 2], values.back()};
}

double wrongPercent(const Answer& answer, const Answer& reference)
{
    const size_t pixels = reference.depth.size();
    size_t shone = 0, wrong = 0;
    for (size_t pixel = 0; pixel < pixels; ++pixel) {
        if (reference.depth[pixel] == 0.0f) continue;
        const Vec3 position = positionOf(reference, pixel);
        for (size_t lamp = 0; lamp < kLampCount; ++lamp) {
            if (!shinesOn(reference, pixel, position, lamp)) continue;
            const size_t at = lamp * pixels + pixel;
            ++shone;
            wrong += std::abs(answer.visibility[at] - reference.visibility[at]) > 127;
        }
    }
    return shone ? 100.0 * static_cast<double>(wrong) / static_cast<double>(shone) : 0.0;
}

std::string listChoices(const std::array<Choice, kLampCount>& choices)
{
    std::map<std::string, int> counts;
    for (const Choice& choice : choices)
        ++counts[std::string(choice.pMethod ? choice.pMethod : "none") + " (" + reasonText(choice.reason) + ")"];
    std::string text;
    for (const auto& [what, count] : counts)
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " x " + what;
    return text;
}

void writePicture(const Answer& answer, const std::string& path)
{
    if (const unsigned error = lodepng::encode(path, answer.pixels, answer.size.width, answer.size.height))
        throw std::runtime_error(path + ": " + lodepng_error_text(error));
}
} // namespace stranger
