#include "runtime/frame/camera_view.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

/// A view from its matrices, in double: differences are taken of nearly equal rays.
class ViewRays {
public:
    ViewRays(const CameraView& view, const glm::dmat4& projection)
        : worldFromView_(glm::transpose(view.viewFromWorld)), area_(view.area), p_(projection),
          orthographic_(projection[2][3] == 0.0), z_(orthographic_ ? 0.0 : 1.0 / projection[2][3])
    {
    }

    /// Through a point of the image, pixels: the ray of linear depth (clip w) 1. Orthographic, where w is 1: from the
    /// eye to there at depth value 0.
    glm::dvec3 through(double px, double py) const { return worldFromView_ * inView(px, py); }
    /// From the one through (0, 0) to the one through this point.
    glm::dvec3 step(double px, double py) const { return worldFromView_ * (inView(px, py) - inView(0.0, 0.0)); }
    /// The way that linear depth grows.
    glm::dvec3 forward() const { return worldFromView_ * glm::dvec3(0.0, 0.0, z_); }
    /// Orthographic: from depth value 0 to 1.
    glm::dvec3 deeper() const
    {
        const double z = 1.0 / p_[2][2];
        return worldFromView_ * glm::dvec3(-p_[2][0] * z / p_[0][0], -p_[2][1] * z / p_[1][1], z);
    }

private:
    /// With p = the projection: w = p11 z, x_clip = p0 x + p8 z, so x = (x_ndc - p8 z) / p0 for z = 1 / p11.
    /// Orthographic: x_ndc = p0 x + p8 z + p12, depth = p10 z + p14.
    glm::dvec3 inView(double px, double py) const
    {
        const double xNdc = 2.0 * (px - area_.offset.x) / area_.extent.width - 1.0;
        const double yNdc = 2.0 * (py - area_.offset.y) / area_.extent.height - 1.0;
        const double z = orthographic_ ? -p_[3][2] / p_[2][2] : z_;
        return {(xNdc - p_[3][0] - p_[2][0] * z) / p_[0][0], (yNdc - p_[3][1] - p_[2][1] * z) / p_[1][1], z};
    }

    glm::dmat3 worldFromView_;
    VkRect2D area_;
    glm::dmat4 p_;
    bool orthographic_;
    double z_;
};

/// @param step of depth values
void setConstants(CameraView& view, const ViewRays& rays, double step)
{
    const glm::mat4& p = view.projection;
    glm::mat4 viewFromWorld(view.viewFromWorld);
    viewFromWorld[3] = glm::vec4(-(view.viewFromWorld * view.eye), 1.0f);
    gpu::ViewConstants& c = view.constants;
    c = {};
    c.offsetFactor = view.reversed() ? 1.0f : 3.0f;
    c.clipFromWorld = p * viewFromWorld;
    c.eyeWs = glm::vec4(view.eye, static_cast<float>(step) / c.offsetFactor);
    c.rayCornerWs = glm::vec4(rays.through(0.0, 0.0), 0.0f);
    c.rayDxWs = glm::vec4(rays.step(1.0, 0.0), 0.0f);
    c.rayDyWs = glm::vec4(rays.step(0.0, 1.0), 0.0f);
    c.depthScale = p[2][3] * p[3][2]; // w = p11 p14 / (p11 depth - p10)
    c.depthMul = p[2][3];
    c.depthAdd = -p[2][2];
    if (p[2][3] == 0.0f) { // orthographic: depth = p10 z + p14
        c.depthScale = c.depthAdd = 1.0f;
        const float ahead = (p[2][2] > 0.0f) != view.reversed() ? 1.0f : -1.0f;
        c.rayDepthWs = glm::vec4(rays.deeper(), ahead / p[2][2]);
        c.rayCornerWs.w = -ahead * p[3][2] / p[2][2];
    }
    c.skyDepth = view.reversed() ? 0.0f : 1.0f;
    c.pixelSize = glm::length(glm::vec3(c.rayDyWs));
}

/// The side planes through the corners of the near plane.
void setFrustum(CameraView& view, const ViewRays& rays)
{
    const gpu::ViewConstants& c = view.constants;
    const auto left = static_cast<double>(view.area.offset.x), top = static_cast<double>(view.area.offset.y);
    const double right = left + view.area.extent.width, bottom = top + view.area.extent.height;
    const std::array<glm::vec3, 4> corners = {rays.through(left, top), rays.through(right, top),
                                              rays.through(right, bottom), rays.through(left, bottom)};
    const bool orthographic = gpu::isOrthographic(c);
    const glm::vec3 axis =
        orthographic ? view.ahead() * glm::transpose(view.viewFromWorld)[2] : glm::vec3(rays.forward());
    const float nearDepth = view.reversed() ? 1.0f : 0.0f, farDepth = 1.0f - nearDepth;
    const float nearW = gpu::viewDistance(c, nearDepth);
    for (std::size_t i = 0; i < 4; ++i) {
        view.nearCorners[i] = view.eye + gpu::atDistanceWs(c, corners[i], nearW);
        glm::vec3 normal =
            glm::normalize(orthographic ? glm::cross(corners[(i + 1) % 4] - corners[i], gpu::lookingWs(c, axis))
                                        : glm::cross(corners[i], corners[(i + 1) % 4]));
        const glm::vec3 across = corners[(i + 2) % 4] - (orthographic ? corners[i] : glm::vec3(0.0f));
        if (glm::dot(normal, across) < 0.0f) normal = -normal; // whichever way the view is handed
        view.frustum[i] = {normal, -glm::dot(normal, orthographic ? view.nearCorners[i] : view.eye)};
    }
    view.frustum[4] = {axis, -glm::dot(axis, view.eye) - nearW};
    view.frustum[5] = {glm::vec3(0.0f), 1.0f};
    if (view.convention == GN_DEPTH_REVERSED_INFINITE || c.depthMul * farDepth + c.depthAdd == 0.0f) return;
    view.frustum[5] = {-axis, glm::dot(axis, view.eye) + gpu::viewDistance(c, farDepth)};
}

/// Of standardSampleLocations (Vulkan 1.3, "Multisampling"), sixteenths of a pixel: for 2, 4 and 8 samples.
constexpr std::uint8_t kSamplePlaces[3][8][2] = {
    {{12, 12}, {4, 4}},
    {{6, 2}, {14, 6}, {2, 10}, {10, 14}},
    {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}},
};

glm::dvec2 sampleAt(std::uint32_t samples, std::uint32_t sample)
{
    const std::uint8_t(&place)[2] = kSamplePlaces[samples == 2 ? 0 : samples == 4 ? 1 : 2][sample];
    return glm::dvec2(place[0], place[1]) / 16.0;
}

/// What is drawn where a sample lies, at the pixel's centre.
void lookThroughSample(glm::dmat4& projection, const CameraView& view, const glm::dvec2& place)
{
    const glm::dvec2 shift = 2.0 * (place - 0.5) / glm::dvec2(view.area.extent.width, view.area.extent.height);
    for (int column = 0; column < 4; ++column) {
        projection[column][0] -= shift.x * projection[column][3];
        projection[column][1] -= shift.y * projection[column][3];
    }
}

// Near plane of a copy of depth values that were drawn with one across the view, metres. Reversed depth is as exact
// whatever it is; a power of two keeps the digits.
constexpr double kObliqueNear = 0x1p-20;

/// A near plane across the view: depth values are m + s / w, m linear on the image. Copied (DepthSource) they become
/// kObliqueNear / w, as of a view without that plane.
void straighten(glm::dmat4& projection, CameraView& view)
{
    const glm::dmat4& p = projection;
    const double perX = p[0][2] / p[0][0], perY = p[1][2] / p[1][1]; // of m, by x_ndc and y_ndc
    const double middle = (p[2][2] - perX * p[2][0] - perY * p[2][1]) / p[2][3];
    const double scale = kObliqueNear / p[3][2];
    const glm::dvec2 pixel = 2.0 / glm::dvec2(view.area.extent.width, view.area.extent.height);
    const glm::dvec2 first(-1.0 - pixel.x * view.area.offset.x, -1.0 - pixel.y * view.area.offset.y);
    view.source.straight =
        glm::vec4(glm::dvec4(middle + perX * first.x + perY * first.y, perX * pixel.x, perY * pixel.y, scale));
    view.source.skyDepth = view.reversed() ? 0.0f : 1.0f;
    view.oblique = true;
    view.convention = GN_DEPTH_REVERSED_INFINITE;
    projection[0][2] = projection[1][2] = projection[2][2] = 0.0;
    projection[3][2] = kObliqueNear;
}

/// What the values of a format of integers are apart; 0 for floats.
double stepOf(VkFormat format)
{
    return format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_D16_UNORM_S8_UINT             ? 1.0 / 65535.0
           : format == VK_FORMAT_X8_D24_UNORM_PACK32 || format == VK_FORMAT_D24_UNORM_S8_UINT ? 1.0 / 16777215.0
                                                                                              : 0.0;
}

void readTarget(CameraView& view, const GnViewFrame& frame)
{
    view.depthFormat = frame.depthFormat;
    view.normalFormat = judgedByNormals(frame) ? frame.normalFormat : VK_FORMAT_UNDEFINED;
    view.extent = frame.imageExtent;
    view.area = frame.renderArea.extent.width ? frame.renderArea : VkRect2D{{0, 0}, frame.imageExtent};
    view.source = {.samples = std::max(frame.imageSamples, 1u),
                   .sample = frame.imageSample,
                   .layered = frame.imageLayers != 0,
                   .layer = frame.imageLayer,
                   .encoding = frame.normalEncoding};
    const float* const scale = frame.motionScale;
    view.motionScale = {scale[0] != 0.0f ? scale[0] : 1.0f, scale[1] != 0.0f ? scale[1] : 1.0f, scale[2]};
}

} // namespace

bool judgedByNormals(const GnViewFrame& frame)
{
    return frame.normalImage != VK_NULL_HANDLE && frame.shadingNormals == VK_FALSE;
}

CameraView makeCameraView(const GnViewFrame& frame, const std::array<double, 3>& origin, std::uint32_t id,
                          std::span<const Caster> casters)
{
    CameraView view;
    view.id = id;
    view.cut = frame.cameraCut != VK_FALSE;
    view.convention = frame.depthConvention;
    readTarget(view, frame);
    for (int i = 0; i < 3; ++i) {
        view.origin[i] = origin[i];
        view.eye[i] = static_cast<float>(frame.eye[i] - origin[i]);
    }
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            view.viewFromWorld[column][row] = frame.viewFromWorld[3 * row + column];
    glm::dmat4 projection(0.0);
    for (int i = 0; i < 16; ++i)
        projection[i / 4][i % 4] = static_cast<double>(frame.projection[i]);
    if (view.source.samples > 1) lookThroughSample(projection, view, sampleAt(view.source.samples, view.source.sample));
    const double depthScale = projection[3][2];
    double step = stepOf(frame.depthFormat);
    if (projection[0][2] != 0.0 || projection[1][2] != 0.0) {
        straighten(projection, view);
        // Values near 1 are interpolated with some units in the last place, of floats or of integers.
        step = kObliqueNear / std::abs(depthScale) * (0x1p-22 + step);
    }
    view.projection = glm::mat4(projection);
    setConstants(view, ViewRays(view, projection), step);
    view.constants.hasNormals = judgedByNormals(frame);
    view.constants.corners = cornersOf(casters, view.eye);
    setFrustum(view, ViewRays(view, projection));
    return view;
}

} // namespace gnomon
