#include "demo/program/error_count.hpp"

#include <algorithm>
#include <cstdlib>

#include "demo/program/receivers.hpp"

namespace gnomon::demo {
namespace {

constexpr uint8_t kHalf = 128; // 8-bit visibility of at least 0.5

} // namespace

bool isLit(uint8_t visibility)
{
    return visibility >= kHalf;
}

bool isWrong(uint8_t visibility, uint8_t truth)
{
    return isLit(visibility) != isLit(truth);
}

ErrorCount& ErrorCount::operator+=(const ErrorCount& other)
{
    counted += other.counted;
    falseLit += other.falseLit;
    falseShadow += other.falseShadow;
    grazing += other.grazing;
    ambiguous += other.ambiguous;
    wrongClear += other.wrongClear;
    absoluteSum += other.absoluteSum;
    return *this;
}

std::vector<uint8_t> countedPixels(const Scene& scene, const CameraMatrices& camera, const FrameSurfaces& surfaces,
                                   const Light& light, const LightState& state)
{
    const uint32_t width = surfaces.depth.width, height = surfaces.depth.height;
    const gpu::ViewConstants view = viewConstants(scene, camera, {width, height});
    const gpu::LightConstants constants = lightConstants(light, state, camera.eye);
    std::vector<uint8_t> out(size_t(width) * height, 0);
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const float depth = *surfaces.depth.at(x, y);
            if (depth == view.skyDepth) continue;
            const glm::vec3 ray = gpu::viewRayWs(view, glm::vec2(float(x) + 0.5f, float(y) + 0.5f));
            const glm::vec3 receiver = ray * gpu::linearDepth(view, depth);
            const float* n = surfaces.normals.at(x, y);
            const float facing = glm::dot(glm::vec3(n[0], n[1], n[2]), gpu::towardsLightWs(constants, receiver));
            if (facing > 0.0f && gpu::lightReaches(constants, receiver))
                out[size_t(y) * width + x] = facing < gpu::GRAZING ? 2 : 1;
        }
    }
    return out;
}

ErrorCount compare(const Image8& visibility, const Image8& truth, const std::vector<uint8_t>& counted,
                   const std::vector<uint8_t>& ambiguous)
{
    ErrorCount out;
    for (size_t i = 0; i < counted.size(); ++i) {
        out.grazing += counted[i] == 2;
        if (counted[i] != 1) continue;
        const uint8_t v = visibility.texels[i], t = truth.texels[i];
        ++out.counted;
        const bool unclear = !ambiguous.empty() && ambiguous[i];
        out.ambiguous += unclear;
        out.wrongClear += isWrong(v, t) && !unclear;
        out.falseLit += isWrong(v, t) && isLit(v);
        out.falseShadow += isWrong(v, t) && !isLit(v);
        out.absoluteSum += std::abs(int(v) - int(t)) / 255.0;
    }
    return out;
}

Rect worstWindow(const Image8& visibility, const Image8& truth, const std::vector<uint8_t>& counted, uint32_t width,
                 uint32_t height, uint64_t& wrongInside)
{
    const uint32_t w = visibility.width, h = visibility.height;
    width = std::min(width, w);
    height = std::min(height, h);
    // Summed-area table with a border of zeros, so that a window is four look-ups.
    std::vector<uint32_t> sums(size_t(w + 1) * (h + 1), 0);
    const auto at = [&](uint32_t x, uint32_t y) -> uint32_t& { return sums[size_t(y) * (w + 1) + x]; };
    for (uint32_t y = 0; y < h; ++y)
        for (uint32_t x = 0; x < w; ++x) {
            const size_t i = size_t(y) * w + x;
            const uint32_t wrong = counted[i] == 1 && isWrong(visibility.texels[i], truth.texels[i]);
            at(x + 1, y + 1) = at(x, y + 1) + at(x + 1, y) - at(x, y) + wrong;
        }
    Rect best{static_cast<int32_t>((w - width) / 2), static_cast<int32_t>((h - height) / 2), width, height};
    wrongInside = 0;
    for (uint32_t y = 0; y + height <= h; ++y)
        for (uint32_t x = 0; x + width <= w; ++x) {
            const uint32_t inside = at(x + width, y + height) - at(x, y + height) - at(x + width, y) + at(x, y);
            if (inside > wrongInside) {
                wrongInside = inside;
                best.x = static_cast<int32_t>(x);
                best.y = static_cast<int32_t>(y);
            }
        }
    return best;
}

} // namespace gnomon::demo
