#include "demo/theses/thesis_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "demo/program/measure.hpp"
#include "demo/program/receivers.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

constexpr double kLargestMap = 8192.0; // of every method that has a map

Scene squareScene(const ViewScene& view)
{
    Scene scene = valueOf(loadScene(std::string("views/") + view.file));
    if (scene.lights.size() != 1) throw HostError("views/" + std::string(view.file) + " must have one light");
    return scene;
}

} // namespace

const char* nameOf(Look look) noexcept
{
    return look == Look::side ? "side" : look == Look::with ? "with" : "against";
}

double percentOf(uint64_t part, uint64_t whole)
{
    return whole > 0 ? 100.0 * double(part) / double(whole) : 0.0;
}

ThesisView::ThesisView(Device& device, const ViewScene& view, uint32_t side)
    : scene_(squareScene(view)), view_(view),
      session_(device, scene_, {.scene = {}, .size = {side, side}, .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT})
{
    look(Look::side);
}

void ThesisView::look(Look look)
{
    time_ = frameTime(scene_, view_.frames[static_cast<size_t>(look)]);
    const auto [found, isNew] = looks_.try_emplace(look);
    seen_ = &found->second;
    if (!isNew) return;
    seen_->truth = draw(kTruthMethod, {});
    seen_->camera = session_.renderer.camera();
    seen_->surfaces = {session_.renderer.readDepth(), session_.renderer.readNormals()};
    seen_->counted =
        countedPixels(scene_, seen_->camera, seen_->surfaces, scene_.lights[0], session_.renderer.state().lights[0]);
}

Image8 ThesisView::draw(const std::string& method, const std::vector<SettingChoice>& settings)
{
    for (const SettingChoice& setting : settings)
        expect(session_.shadows.set(method, setting.name, setting.value));
    expect(session_.shadows.pinAll(method));
    expect(session_.shadows.warmUp(method));
    const CameraState camera = session_.camera(time_);
    const auto served = [&] {
        GnDecision decision{};
        gnGetDecision(session_.shadows.context(), session_.shadows.view(0), session_.shadows.light(0), &decision);
        return decision.reason == GN_REASON_PINNED && decision.pMethod == method;
    };
    constexpr int patience = 64; // frames: memory that the method before has left is given back within some
    for (int i = 0; i == 0 || !served(); ++i) {
        if (i == patience) throw HostError(session_.shadows.whyNot(0, method));
        session_.renderer.draw({.time = time_, .cameras = {&camera, 1}, .shadows = &session_.shadows});
    }
    return std::move(session_.renderer.readVisibility().front());
}

double ThesisView::shareOfMap(const Seen& seen, MapFit fit) const
{
    GnLightMap map{};
    if (gnGetLightMap(session_.shadows.context(), session_.shadows.light(0), &map) < 0)
        throw HostError(std::string("gnGetLightMap: ") + gnGetLastError(session_.shadows.context()));
    const glm::dmat4 clipFromWorld(glm::make_mat4(map.clipFromWorld[0]));
    const glm::dvec3 eye = seen.camera.eye - glm::dvec3(map.origin[0], map.origin[1], map.origin[2]);
    const ImageF& depth = seen.surfaces.depth;
    const gpu::ViewConstants view = viewConstants(scene_, seen.camera, {depth.width, depth.height});
    glm::dvec2 lower(1e30), upper(-1e30);
    for (uint32_t y = 0; y < depth.height; ++y)
        for (uint32_t x = 0; x < depth.width; ++x) {
            const float value = *depth.at(x, y);
            if (value == view.skyDepth) continue;
            const glm::vec3 ray = gpu::viewRayWs(view, glm::vec2(float(x) + 0.5f, float(y) + 0.5f));
            const glm::dvec3 receiver = eye + glm::dvec3(ray * gpu::linearDepth(view, value));
            const glm::dvec2 clip(clipFromWorld * glm::dvec4(receiver, 1.0)); // directional: w is 1
            lower = glm::min(lower, clip);
            upper = glm::max(upper, clip);
        }
    // Metres: clip coordinates a metre are the lengths of the matrix's rows.
    const glm::dmat4 rows = glm::transpose(clipFromWorld);
    const glm::dvec2 perMetre(glm::length(glm::dvec3(rows[0])), glm::length(glm::dvec3(rows[1])));
    const glm::dvec2 ours = 2.0 / perMetre, fitted = (upper - lower) / perMetre;
    const double area = fit == MapFit::tight ? fitted.x * fitted.y : std::pow(std::max(fitted.x, fitted.y), 2.0);
    return std::sqrt(area / (ours.x * ours.y));
}

uint32_t ThesisView::sideAsFitted(uint32_t side, MapFit fit)
{
    double& share = seen_->shares[size_t(fit)];
    if (share == 0.0) {
        draw("shadow_map", {{"resolution", double(side)}, {"filter", 1.0}});
        share = shareOfMap(*seen_, fit);
    }
    return static_cast<uint32_t>(std::lround(std::min(double(side) / share, kLargestMap)));
}

} // namespace gnomon::demo
