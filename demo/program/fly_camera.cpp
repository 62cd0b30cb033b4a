#include "demo/program/fly_camera.hpp"

#include <algorithm>
#include <cmath>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace gnomon::demo {
namespace {

constexpr double kMetresPerSecond = 4.0, kFastFactor = 4.0;
constexpr double kRadiansPerPixel = 0.004; // half a turn over 800 pixels

} // namespace

CameraState FlyCamera::update(Window& window, const CameraState& scripted, double seconds, bool keys, bool mouse)
{
    double dx = 0.0, dy = 0.0;
    bool looked = window.dragging(dx, dy);
    if (!mouse) {
        looked = false;
        dx = dy = 0.0;
    }
    glm::dvec3 move(0.0);
    const auto axis = [&](int plus, int minus) {
        return keys ? double(window.held(plus)) - double(window.held(minus)) : 0.0;
    };
    move.x = axis(GLFW_KEY_D, GLFW_KEY_A);
    move.y = axis(GLFW_KEY_E, GLFW_KEY_Q);
    move.z = axis(GLFW_KEY_W, GLFW_KEY_S);
    if (!flying_ && (looked || move != glm::dvec3(0.0))) takeOver(scripted);
    if (!flying_) return scripted;
    yaw_ -= dx * kRadiansPerPixel;
    pitch_ = std::clamp(pitch_ - dy * kRadiansPerPixel, -1.5, 1.5); // short of straight up and down
    const glm::dvec3 forward(-std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), -std::cos(yaw_) * std::cos(pitch_));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0)));
    const double step = seconds * kMetresPerSecond * (window.held(GLFW_KEY_LEFT_SHIFT) ? kFastFactor : 1.0);
    eye_ += step * (move.x * right + move.y * glm::dvec3(0.0, 1.0, 0.0) + move.z * forward);
    CameraState camera = scripted;
    camera.eye = eye_;
    camera.target = eye_ + forward;
    camera.up = glm::cross(right, forward);
    return camera;
}

void FlyCamera::takeOver(const CameraState& from)
{
    flying_ = true;
    eye_ = from.eye;
    const glm::dvec3 forward = from.forward();
    yaw_ = std::atan2(-forward.x, -forward.z);
    pitch_ = std::asin(std::clamp(forward.y, -1.0, 1.0));
}

} // namespace gnomon::demo
