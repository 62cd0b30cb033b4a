#include "demo/program/aliasing.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

namespace gnomon::demo {

std::vector<glm::dmat4> layersOf(const GnLightMap& map, const glm::dvec3& eye)
{
    std::vector<glm::dmat4> layers;
    const glm::dvec3 move = eye - glm::dvec3(map.origin[0], map.origin[1], map.origin[2]);
    for (uint32_t i = 0; i < std::min(map.layerCount, 6u); ++i) {
        const glm::dmat4 clipFromWorld(glm::make_mat4(map.clipFromWorld[i]));
        if ((map.validLayers >> i & 1) == 0 || glm::transpose(clipFromWorld)[3] == glm::dvec4(0.0)) continue;
        glm::dmat4 about(1.0);
        about[3] = glm::dvec4(move, 1.0);
        layers.push_back(clipFromWorld * about);
    }
    return layers;
}

namespace {

/// The one that is looked up: of a cube's faces the one that the receiver lies deepest in, else the first that holds
/// it.
const glm::dmat4* layerAt(std::span<const glm::dmat4> layers, LightKind kind, const glm::dvec3& at)
{
    const glm::dmat4* best = nullptr;
    double deepest = 0.0;
    for (const glm::dmat4& layer : layers) {
        const glm::dvec4 clip = layer * glm::dvec4(at, 1.0);
        if (!(clip.w > deepest) || std::fabs(clip.x) > clip.w || std::fabs(clip.y) > clip.w) continue;
        best = &layer;
        if (kind != LightKind::Point) return best;
        deepest = clip.w;
    }
    return best;
}

} // namespace

glm::dmat4 samplesFromClip(double width, double height)
{
    glm::dmat4 matrix(1.0);
    matrix[0][0] = 0.5 * width;
    matrix[1][1] = 0.5 * height;
    matrix[3] = glm::dvec4(0.5 * width, 0.5 * height, 0.0, 1.0);
    return matrix;
}

// Neither sample coordinate changes along the beam, so that their gradients are across it.
glm::dvec3 beamAt(const glm::dmat4& samplesFromWorld, const glm::dvec3& at)
{
    const glm::dmat4 rows = glm::transpose(samplesFromWorld);
    const glm::dvec4 sample = samplesFromWorld * glm::dvec4(at, 1.0);
    const glm::dvec3 x = (glm::dvec3(rows[0]) - sample.x / sample.w * glm::dvec3(rows[3])) / sample.w;
    const glm::dvec3 y = (glm::dvec3(rows[1]) - sample.y / sample.w * glm::dvec3(rows[3])) / sample.w;
    return glm::cross(x, y);
}

double aliasingOf(const glm::dvec3& texels, const glm::dvec3& pixels, const glm::dvec3& normal)
{
    const double texelWidth = 1.0 / std::sqrt(glm::length(texels)), pixelWidth = 1.0 / std::sqrt(glm::length(pixels));
    const double texelCosine = std::fabs(glm::dot(normal, glm::normalize(texels)));
    const double pixelCosine = std::fabs(glm::dot(normal, glm::normalize(pixels)));
    return texelWidth / pixelWidth * std::sqrt(pixelCosine / texelCosine);
}

std::optional<ImageF> measureAliasing(const GnLightMap& map, LightKind kind, const CameraMatrices& camera,
                                      const FrameSurfaces& surfaces, const std::vector<uint8_t>& counted)
{
    const std::vector<glm::dmat4> layers = layersOf(map, camera.eye);
    if (layers.empty()) return std::nullopt;
    const uint32_t width = surfaces.depth.width, height = surfaces.depth.height;
    const glm::dmat4 texelsFromClip = samplesFromClip(map.extent.width, map.extent.height);
    const glm::dmat4 pixelsFromEye = samplesFromClip(width, height) * glm::dmat4(camera.clipFromEye);
    ImageF result(width, height, 1);
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            if (counted[size_t(y) * width + x] != 1) continue;
            const double linear =
                double(camera.depthScale) / (double(*surfaces.depth.at(x, y)) + double(camera.depthAdd));
            const glm::dvec3 at = linear * (glm::dvec3(camera.rayCorner) + (x + 0.5) * glm::dvec3(camera.rayDx) +
                                            (y + 0.5) * glm::dvec3(camera.rayDy));
            const glm::dmat4* const layer = layerAt(layers, kind, at);
            if (!layer) continue;
            const float* n = surfaces.normals.at(x, y);
            *result.at(x, y) = static_cast<float>(aliasingOf(beamAt(texelsFromClip * *layer, at),
                                                             beamAt(pixelsFromEye, at), glm::dvec3(n[0], n[1], n[2])));
        }
    }
    return result;
}

Image8 pictureOf(const ImageF& aliasing)
{
    Image8 picture(aliasing.width, aliasing.height, 3);
    for (size_t i = 0; i < aliasing.texels.size(); ++i) {
        const float m = aliasing.texels[i];
        if (!(m > 0.0f)) continue;
        const float factor = std::clamp(std::log2(m) / 3.0f, -1.0f, 1.0f);
        const auto other = static_cast<uint8_t>(std::lround(255.0f * (1.0f - std::fabs(factor))));
        uint8_t* rgb = &picture.texels[3 * i];
        rgb[0] = factor >= 0.0f ? 255 : other;
        rgb[1] = other;
        rgb[2] = factor <= 0.0f ? 255 : other;
    }
    return picture;
}

} // namespace gnomon::demo
