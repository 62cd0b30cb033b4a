#include "algorithms/maps/view_solid.hpp"

#include <algorithm>

#include <glm/vec2.hpp>

namespace gnomon {

Polygon::Polygon(const glm::dvec4& plane, glm::dvec3 centre, double radius)
{
    const glm::dvec3 normal(plane);
    const glm::dvec3 foot = centre - glm::dot(plane, glm::dvec4(centre, 1.0)) * normal;
    const glm::dvec3 aside = std::abs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = radius * glm::normalize(glm::cross(normal, aside)), v = glm::cross(normal, u);
    corners_[0] = foot - u - v;
    corners_[1] = foot + u - v;
    corners_[2] = foot + u + v;
    corners_[3] = foot - u + v;
}

// Sutherland and Hodgman 1974.
void Polygon::clip(const glm::dvec4& plane)
{
    std::array<glm::dvec3, kRoom> kept;
    std::size_t count = 0;
    const auto keep = [&](const glm::dvec3& corner) {
        if (count < kept.size()) kept[count++] = corner;
    };
    for (std::size_t i = 0; i < count_; ++i) {
        const glm::dvec3 &from = corners_[i], &to = corners_[(i + 1) % count_];
        const double a = glm::dot(plane, glm::dvec4(from, 1.0)), b = glm::dot(plane, glm::dvec4(to, 1.0));
        if (a >= 0.0) keep(from);
        if ((a >= 0.0) != (b >= 0.0)) keep(from + (a / (a - b)) * (to - from));
    }
    std::copy_n(kept.begin(), count, corners_.begin());
    count_ = count;
}

ViewSolid::ViewSolid(const CameraView& view, double density)
{
    const gpu::ViewConstants& constants = view.constants;
    const glm::dvec3 across = glm::cross(glm::dvec3(constants.rayDxWs), glm::dvec3(constants.rayDyWs));
    const glm::vec3 ray = gpu::viewRayWs(constants, {0.0f, 0.0f});
    const glm::dvec3 metre(gpu::atDistanceWs(constants, ray, 1.0f) - gpu::atDistanceWs(constants, ray, 0.0f));
    const glm::dvec3 ahead = across / glm::dot(across, metre);
    distance_ = {ahead, -glm::dot(ahead, glm::dvec3(view.eye))};
    const double size = static_cast<double>(constants.pixelSize) / density;
    pixel_ = gpu::isOrthographic(constants) ? glm::dvec4(0.0, 0.0, 0.0, size) : size * distance_;
    for (std::size_t i = 0; i < 4; ++i)
        sides_[i] = {glm::dvec3(view.frustum[i].normal), static_cast<double>(view.frustum[i].distance)};
    const float plane = gpu::viewDistance(constants, view.reversed() ? 1.0f : 0.0f);
    nearest_ = view.oblique ? 0.0 : static_cast<double>(plane);
}

std::span<const glm::dvec4> ViewSolid::planesOf(const Aabb& box, std::span<const glm::dvec4> ends,
                                                std::array<glm::dvec4, 18>& room) const
{
    std::size_t count = 0;
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        glm::dvec3 normal(0.0);
        normal[axis] = side % 2 ? -1.0 : 1.0;
        const float at = side % 2 ? box.upper[axis] : -box.lower[axis];
        room[count++] = {normal, static_cast<double>(at)};
    }
    for (const glm::dvec4& side : sides_)
        room[count++] = side;
    for (const glm::dvec4& end : ends)
        if (const double length = glm::length(glm::dvec3(end)); length > 0.0) room[count++] = end / length;
    return {room.data(), count};
}

} // namespace gnomon
