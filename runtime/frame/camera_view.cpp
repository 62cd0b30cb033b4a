#include "runtime/frame/camera_view.hpp"

#include <cmath>

namespace gnomon {

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
