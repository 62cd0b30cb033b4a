#include "demo/compare/near_far.hpp"

#include <glm/geometric.hpp>

namespace gnomon::demo {

WrongShare& WrongShare::operator+=(const WrongShare& other)
{
    counted += other.counted;
    wrong += other.wrong;
    return *this;
}

NearFar& NearFar::operator+=(const NearFar& other)
{
    near += other.near;
    far += other.far;
    return *this;
}

std::vector<bool> nearPixels(const CameraMatrices& camera, const ImageF& depth)
{
    std::vector<bool> out(size_t(depth.width) * depth.height, false);
    for (uint32_t y = 0; y < depth.height; ++y) {
        for (uint32_t x = 0; x < depth.width; ++x) {
            const float stored = *depth.at(x, y);
            if (stored == camera.skyDepth) continue;
            const glm::vec3 ray =
                camera.rayCorner + (float(x) + 0.5f) * camera.rayDx + (float(y) + 0.5f) * camera.rayDy;
            const float linear = camera.depthScale / (stored + camera.depthAdd);
            out[size_t(y) * depth.width + x] = linear * glm::length(ray) < kNearMetres;
        }
    }
    return out;
}

LightTruth truthOf(const Image8& visibility, const std::vector<uint8_t>& counted)
{
    LightTruth truth{.counted = std::vector<bool>(counted.size()), .lit = std::vector<bool>(counted.size())};
    for (size_t i = 0; i < counted.size(); ++i) {
        truth.counted[i] = counted[i] == 1;
        truth.lit[i] = isLit(visibility.texels[i]);
    }
    return truth;
}

NearFar countWrong(const Image8& visibility, const LightTruth& truth, const std::vector<bool>& near)
{
    NearFar out;
    for (size_t i = 0; i < truth.counted.size(); ++i) {
        if (!truth.counted[i]) continue;
        WrongShare& share = near[i] ? out.near : out.far;
        ++share.counted;
        share.wrong += isLit(visibility.texels[i]) != truth.lit[i];
    }
    return out;
}

} // namespace gnomon::demo
