#include "frame_data.hpp"

#include <cmath>
#include <cstring>

namespace stranger {
namespace {

float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void normalise(float v[3])
{
    const float length = std::sqrt(dot(v, v));
    for (int i = 0; i < 3; ++i)
        v[i] /= length;
}

void cross(const float a[3], const float b[3], float result[3])
{
    for (int i = 0; i < 3; ++i)
        result[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}
} // namespace

void fillProjection(const FrameData& data, float projection[16])
{
    std::memset(projection, 0, 16 * sizeof(float));
    projection[0] = data.clipPerViewX;
    projection[5] = data.clipPerViewY;
    projection[11] = -1.0f;
    projection[14] = data.near;
}

FrameData frameDataAt(double seconds, float aspect)
{
    FrameData data{};
    const float sway = 0.3f * static_cast<float>(std::sin(0.5 * seconds));
    const float target[3] = {0.0f, 1.3f, 0.0f}, up[3] = {0.0f, 1.0f, 0.0f};
    const float eye[3] = {9.5f * std::sin(0.6f + sway), 4.0f, 9.5f * std::cos(0.6f + sway)};
    std::memcpy(data.eye, eye, sizeof eye);
    data.near = 0.1f;
    data.clipPerViewY = -1.7320508f; // 60 degrees high
    data.clipPerViewX = 1.7320508f / aspect;
    for (int i = 0; i < 3; ++i)
        data.viewBack[i] = eye[i] - target[i];
    normalise(data.viewBack);
    cross(up, data.viewBack, data.viewRight);
    normalise(data.viewRight);
    cross(data.viewBack, data.viewRight, data.viewUp);

    const float* rows[3] = {data.viewRight, data.viewUp, data.viewBack};
    float projection[16], viewFromWorld[16] = {};
    fillProjection(data, projection);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            viewFromWorld[4 * column + row] = rows[row][column];
        viewFromWorld[12 + row] = -dot(rows[row], eye);
    }
    viewFromWorld[15] = 1.0f;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            for (int k = 0; k < 4; ++k)
                data.clipFromWorld[4 * column + row] += projection[4 * k + row] * viewFromWorld[4 * column + k];

    const auto lamps = lampsAt(seconds);
    for (size_t i = 0; i < lamps.size(); ++i) {
        std::memcpy(data.lamps[i].position, lamps[i].position.data(), sizeof data.lamps[i].position);
        std::memcpy(data.lamps[i].colour, lamps[i].colour.data(), sizeof(Vec3));
        data.lamps[i].range = lamps[i].range;
    }
    return data;
}
} // namespace stranger
