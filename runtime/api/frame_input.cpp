// What the host says of a camera: checked, then turned into what shaders and rays use.
#include <cmath>

#include "runtime/api/context.hpp"
#include "runtime/base/number_text.hpp"
#include "runtime/store/scene_input.hpp"

namespace gnomon {

namespace {

Error wrong(GnResult result, const char* id, const char* viewName, const std::string& what)
{
    return {result, id, "view '" + std::string(viewName) + "': " + what};
}

std::string sizeText(VkExtent2D extent)
{
    return std::to_string(extent.width) + "x" + std::to_string(extent.height);
}

template <typename T>
Result<void> checkFinite(std::span<const T> values, const char* name, const char* viewName)
{
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue; // no words for what is right: this runs every frame
        const std::string where = std::string(name) + "[" + std::to_string(i) + "]";
        if (std::isnan(values[i])) return wrong(GN_ERROR_NOT_A_NUMBER, "CameraNaN", viewName, where + " is NaN");
        return wrong(GN_ERROR_INFINITE, "CameraInfinite", viewName, where + " is infinite");
    }
    return {};
}

Result<void> checkProjection(const GnViewFrame& frame, const char* viewName)
{
    const float* p = frame.projection;
    // Clip w is +-view z, rays leave from the eye, nothing is skewed; the frustum may be off centre (8, 9).
    for (const int i : {0, 1, 2, 3, 4, 5, 6, 7, 11, 12, 13, 14, 15}) {
        const bool zero = i != 0 && i != 5 && i != 11 && i != 14;
        if (zero ? p[i] == 0.0f : i == 11 ? std::abs(p[i]) == 1.0f : p[i] != 0.0f) continue;
        return wrong(GN_ERROR_OUT_OF_RANGE, "ProjectionNotPerspective", viewName,
                     "projection is not a perspective matrix: projection[" + std::to_string(i) + "] is " +
                         shortestText(double{p[i]}) + ", not " +
                         (zero      ? "0"
                          : i == 11 ? "1 or -1"
                                    : "different from 0"));
    }
    if (frame.depthConvention < GN_DEPTH_REVERSED_INFINITE || frame.depthConvention > GN_DEPTH_STANDARD)
        return wrong(GN_ERROR_OUT_OF_RANGE, "DepthConvention", viewName,
                     "depthConvention is " + std::to_string(frame.depthConvention) + ", not a GnDepthConvention");
    // Which depth belongs to the near plane follows from the matrix; the convention must agree.
    const bool infinite = p[10] == 0.0f;
    const bool reversed = p[14] > 0.0f; // depth = p10 / p11 + p14 / w
    const bool saysReversed = frame.depthConvention != GN_DEPTH_STANDARD;
    if (reversed != saysReversed || (frame.depthConvention == GN_DEPTH_REVERSED_INFINITE && !infinite))
        return wrong(GN_ERROR_OUT_OF_RANGE, "DepthConvention", viewName,
                     "depthConvention " + std::to_string(frame.depthConvention) + " does not fit the projection (" +
                         (reversed ? "reversed" : "standard") + (infinite ? ", infinite far)" : ", finite far)"));
    return {};
}

Result<void> checkRotation(const GnViewFrame& frame, const char* viewName)
{
    const float* r = frame.viewFromWorld;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) {
            const float d = r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
            if (std::abs(d - (i == j ? 1.0f : 0.0f)) > 1e-3f)
                return wrong(GN_ERROR_OUT_OF_RANGE, "CameraNotRotation", viewName,
                             "viewFromWorld is not a rotation: rows " + std::to_string(i) + " and " +
                                 std::to_string(j) + " have dot product " + shortestText(double{d}));
        }
    return {};
}

Result<void> checkImages(const GnViewFrame& frame, const char* viewName, const DeviceTable& vk)
{
    if (!frame.depthImage || !frame.depthView)
        return wrong(GN_ERROR_NULL_ARGUMENT, "DepthMissing", viewName, "depthImage and depthView are required");
    if (frame.depthFormat != VK_FORMAT_D32_SFLOAT && frame.depthFormat != VK_FORMAT_D32_SFLOAT_S8_UINT)
        return wrong(GN_ERROR_OUT_OF_RANGE, "DepthFormat", viewName,
                     "depthFormat " + std::to_string(frame.depthFormat) +
                         " is neither D32_SFLOAT nor D32_SFLOAT_S8_UINT");
    if ((frame.normalImage != VK_NULL_HANDLE) != (frame.normalView != VK_NULL_HANDLE))
        return wrong(GN_ERROR_NULL_ARGUMENT, "NormalsHalf", viewName, "normalImage and normalView go together");
    if (frame.normalImage && frame.normalFormat != VK_FORMAT_R16G16B16A16_SFLOAT &&
        frame.normalFormat != VK_FORMAT_R32G32B32A32_SFLOAT)
        return wrong(GN_ERROR_OUT_OF_RANGE, "NormalFormat", viewName,
                     "normalFormat " + std::to_string(frame.normalFormat) +
                         " is neither R16G16B16A16_SFLOAT nor R32G32B32A32_SFLOAT");
    const VkExtent2D extent = frame.imageExtent;
    if (extent.width == 0 || extent.height == 0)
        return wrong(GN_ERROR_EMPTY, "ViewEmpty", viewName, "imageExtent is " + sizeText(extent));
    const std::uint32_t limit = vk.properties.limits.maxImageDimension2D;
    if (extent.width > limit || extent.height > limit)
        return wrong(GN_ERROR_OUT_OF_RANGE, "ViewTooLarge", viewName,
                     "imageExtent " + sizeText(extent) + " is above the device's " + std::to_string(limit));
    const VkRect2D area = frame.renderArea;
    const bool inside = area.offset.x >= 0 && area.offset.y >= 0 &&
                        std::uint64_t(area.offset.x) + area.extent.width <= extent.width &&
                        std::uint64_t(area.offset.y) + area.extent.height <= extent.height;
    if (!inside || (area.extent.width == 0) != (area.extent.height == 0))
        return wrong(GN_ERROR_OUT_OF_RANGE, "RenderArea", viewName,
                     "renderArea, " + sizeText(area.extent) + " at " + std::to_string(area.offset.x) + ", " +
                         std::to_string(area.offset.y) +
                         (inside ? ", is empty" : ", does not lie inside imageExtent, " + sizeText(extent)));
    return {};
}

} // namespace

Result<void> checkViewFrame(const GnViewFrame& frame, const char* viewName, std::uint32_t maxLights,
                            const DeviceTable& vk)
{
    if (auto r = checkFinite<double>(frame.eye, "eye", viewName); !r) return r;
    for (int i = 0; i < 3; ++i)
        if (std::abs(frame.eye[i]) > kLargestMagnitude)
            return wrong(GN_ERROR_OUT_OF_RANGE, "CameraTooFar", viewName,
                         "eye[" + std::to_string(i) + "] is " + shortestText(frame.eye[i]) +
                             ", beyond 1e18 m of the world's zero");
    if (auto r = checkFinite<float>(frame.viewFromWorld, "viewFromWorld", viewName); !r) return r;
    if (auto r = checkFinite<float>(frame.projection, "projection", viewName); !r) return r;
    if (auto r = checkRotation(frame, viewName); !r) return r;
    if (auto r = checkProjection(frame, viewName); !r) return r;
    if (auto r = checkImages(frame, viewName, vk); !r) return r;
    if (frame.lightCount > maxLights)
        return wrong(GN_ERROR_TOO_MANY, "TooManyLights", viewName,
                     std::to_string(frame.lightCount) + " lights, the view holds " + std::to_string(maxLights));
    if (frame.lightCount && !frame.pLights)
        return wrong(GN_ERROR_NULL_ARGUMENT, "LightsMissing", viewName, "pLights is null");
    return {};
}

namespace {

/// Rays of linear depth (clip w) 1, in world space. With p = projection: w = p11 z, x_clip = p0 x + p8 z, so
/// x = (x_ndc - p8 z) / p0 for z = 1 / p11. In double: differences are taken of nearly equal ones.
class ViewRays {
public:
    ViewRays(const CameraView& view, const float* projection)
        : worldFromView_(glm::transpose(view.viewFromWorld)), area_(view.area), p_(projection), z_(1.0 / projection[11])
    {
    }

    /// Through a point of the image, pixels.
    glm::vec3 through(double px, double py) const { return toWorld(inView(px, py)); }
    /// From the one through (0, 0) to the one through this point.
    glm::vec3 step(double px, double py) const { return toWorld(inView(px, py) - inView(0.0, 0.0)); }
    /// The way that linear depth grows.
    glm::vec3 forward() const { return toWorld({0.0, 0.0, z_}); }

private:
    glm::dvec3 inView(double px, double py) const
    {
        const double xNdc = 2.0 * (px - area_.offset.x) / area_.extent.width - 1.0;
        const double yNdc = 2.0 * (py - area_.offset.y) / area_.extent.height - 1.0;
        return {(xNdc - p_[8] * z_) / p_[0], (yNdc - p_[9] * z_) / p_[5], z_};
    }
    glm::vec3 toWorld(const glm::dvec3& v) const { return glm::vec3(worldFromView_ * v); }

    glm::dmat3 worldFromView_;
    VkRect2D area_;
    const float* p_;
    double z_;
};

/// From the corner rays; the near plane from depth 1 (reversed) or 0.
void setFrustum(CameraView& view, const ViewRays& rays)
{
    const gpu::ViewConstants& c = view.constants;
    const auto left = static_cast<double>(view.area.offset.x), top = static_cast<double>(view.area.offset.y);
    const double right = left + view.area.extent.width, bottom = top + view.area.extent.height;
    const std::array<glm::vec3, 4> corners = {rays.through(left, top), rays.through(right, top),
                                              rays.through(right, bottom), rays.through(left, bottom)};
    const glm::vec3 forward = rays.forward();
    const float nearDepth = view.reversed() ? 1.0f : 0.0f, farDepth = 1.0f - nearDepth;
    const float nearW = gpu::linearDepth(c, nearDepth);
    for (std::size_t i = 0; i < 4; ++i) {
        view.nearCorners[i] = view.eye + corners[i] * nearW;
        glm::vec3 normal = glm::normalize(glm::cross(corners[i], corners[(i + 1) % 4]));
        if (glm::dot(normal, corners[(i + 2) % 4]) < 0.0f) normal = -normal; // whichever way the view is handed
        view.frustum[i] = {normal, -glm::dot(normal, view.eye)};
    }
    view.frustum[4] = {forward, -glm::dot(forward, view.eye) - nearW};
    view.frustum[5] = {glm::vec3(0.0f), 1.0f};
    if (view.convention == GN_DEPTH_REVERSED_INFINITE || c.depthMul * farDepth + c.depthAdd == 0.0f) return;
    const float farW = gpu::linearDepth(c, farDepth);
    view.frustum[5] = {-forward, glm::dot(forward, view.eye) + farW};
}

} // namespace

CameraView makeCameraView(const GnViewFrame& frame, const std::array<double, 3>& origin, std::uint32_t id,
                          std::span<const Caster> casters)
{
    CameraView view;
    view.id = id;
    view.cut = frame.cameraCut != VK_FALSE;
    view.convention = frame.depthConvention;
    view.depthFormat = frame.depthFormat;
    view.normalFormat = frame.normalImage ? frame.normalFormat : VK_FORMAT_UNDEFINED;
    view.extent = frame.imageExtent;
    view.area = frame.renderArea.extent.width ? frame.renderArea : VkRect2D{{0, 0}, frame.imageExtent};
    for (int i = 0; i < 3; ++i) {
        view.origin[i] = origin[i];
        view.eye[i] = static_cast<float>(frame.eye[i] - origin[i]);
    }
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            view.viewFromWorld[column][row] = frame.viewFromWorld[3 * row + column];
    const float* p = frame.projection;
    for (int i = 0; i < 16; ++i)
        view.projection[i / 4][i % 4] = p[i];

    glm::mat4 viewFromWorld(view.viewFromWorld);
    viewFromWorld[3] = glm::vec4(-(view.viewFromWorld * view.eye), 1.0f);
    const ViewRays rays(view, p);
    gpu::ViewConstants& c = view.constants;
    c = {};
    c.clipFromWorld = view.projection * viewFromWorld;
    c.eyeWs = glm::vec4(view.eye, 0.0f);
    c.rayCornerWs = glm::vec4(rays.through(0.0, 0.0), 0.0f);
    c.rayDxWs = glm::vec4(rays.step(1.0, 0.0), 0.0f);
    c.rayDyWs = glm::vec4(rays.step(0.0, 1.0), 0.0f);
    c.depthScale = p[11] * p[14]; // w = p11 p14 / (p11 depth - p10)
    c.depthMul = p[11];
    c.depthAdd = -p[10];
    c.skyDepth = view.reversed() ? 0.0f : 1.0f;
    c.offsetFactor = view.reversed() ? 1.0f : 3.0f;
    c.pixelSize = glm::length(glm::vec3(c.rayDyWs));
    c.hasNormals = frame.normalImage != VK_NULL_HANDLE;
    c.corners = cornersOf(casters, view.eye);
    setFrustum(view, rays);
    return view;
}

} // namespace gnomon
