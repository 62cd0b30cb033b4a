#include "exactness/thrown.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <glm/geometric.hpp>

#include "demo/program/ambiguity.hpp"

namespace gnomon::exact {

glm::dvec3 Dice::direction()
{
    for (;;) {
        const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
        const glm::dvec3 v(x, y, z);
        const double length = glm::length(v);
        if (length > 0.1 && length < 1.0) return v / length;
    }
}

Thrown::Thrown(Scene from, VkExtent2D extent, Lights lights)
    : scene_(std::move(from)), lights_(lights),
      session_(test::device(), scene_, {.scene = {}, .size = extent, .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT})
{
    for (demo::Light& light : scene_.lights) {
        if (lights_ == Lights::asTheyAre) break;
        light.isStatic = false;
        light.keys.clear();
        light.orbit = {};
    }
    first_ = scene_.lights;
}

demo::CameraState Thrown::camera(Dice& dice) const
{
    demo::CameraState state = session_.camera(dice.between(0.0, 8.0));
    const double distance = glm::length(state.target - state.eye);
    state.eye += dice.direction() * distance * dice.between(0.0, 0.5);
    state.eye.y = std::max(state.eye.y, 0.05);
    state.target += dice.direction() * distance * 0.3;
    const glm::dvec3 ahead = glm::normalize(state.target - state.eye);
    state.up = glm::normalize(glm::cross(glm::cross(ahead, glm::normalize(dice.direction())), ahead));
    return state;
}

void Thrown::throwLights(Dice& dice, std::vector<demo::Light>& lights) const
{
    for (demo::Light& light : lights) {
        light.position += dice.direction() * dice.between(0.0, 2.0);
        light.direction = glm::normalize(light.direction + dice.direction() * dice.between(0.0, 0.9));
    }
}

void Thrown::keepPresent(std::size_t most, Throw& frame)
{
    scene_.lights = frame.lights;
    std::vector<uint32_t> present = demo::stateAt(scene_, frame.time).present;
    if (present.size() <= most) return;
    std::rotate(present.begin(), present.begin() + static_cast<std::ptrdiff_t>(turn_ % present.size()), present.end());
    turn_ += most;
    for (std::size_t i = most; i < present.size(); ++i)
        frame.lights[present[i]].disappear = frame.time;
}

Throw Thrown::next(Dice& dice, std::size_t most)
{
    Throw frame;
    frame.lights = first_;
    if (lights_ == Lights::thrown) throwLights(dice, frame.lights);
    frame.eye = camera(dice);
    frame.time = dice.between(0.0, 8.0);
    keepPresent(most, frame);
    return frame;
}

Pictures Thrown::draw(const char* method, const Throw& frame)
{
    if (warm_.insert(method).second) REQUIRE(gnWarmUpMethod(session_.shadows.context(), method) >= 0);
    scene_.lights = frame.lights;
    const std::vector<uint32_t> present = demo::stateAt(scene_, frame.time).present;
    for (uint32_t i = 0; i < scene_.lights.size(); ++i)
        demo::expect(session_.shadows.pin(i, method));
    const auto served = [&] {
        return std::ranges::all_of(present, [&](uint32_t light) { return servedByPin(session_, light, method); });
    };
    // Memory that the method before has left is given back within a few frames.
    for (uint32_t tries = 0; tries == 0 || (tries < 8 && !served()); ++tries)
        session_.renderer.draw({.time = frame.time, .cameras = {&frame.eye, 1}, .shadows = &session_.shadows});
    REQUIRE_MESSAGE(served(), method, " in ", scene_.name);
    return session_.renderer.readVisibility();
}

std::uint64_t Thrown::rays() const
{
    GnFrameStats stats{};
    REQUIRE(gnGetFrameStats(session_.shadows.context(), &stats) == GN_SUCCESS);
    return stats.rays;
}

std::size_t Thrown::passes(const std::string& part) const
{
    const GnContext context = session_.shadows.context();
    uint32_t count = 0;
    REQUIRE(gnGetFramePasses(context, &count, nullptr) == GN_SUCCESS);
    std::vector<GnPassTiming> all(count);
    REQUIRE(gnGetFramePasses(context, &count, all.data()) == GN_SUCCESS);
    return static_cast<std::size_t>(std::ranges::count_if(all, [&](const GnPassTiming& pass) {
        return std::string_view(pass.pName).find(part) != std::string_view::npos;
    }));
}

std::string inWords(const Apart& apart)
{
    return std::to_string(apart.pixels) + " of " + std::to_string(apart.all) + " pixels differ, " +
           std::to_string(apart.clear) + " of them clear; " + std::to_string(apart.dark) + " dark";
}

void compareWith(Thrown& thrown, const Throw& frame, const Pictures& truth, const Pictures& shown, Apart& apart)
{
    const demo::SceneState state = demo::stateAt(thrown.scene(), frame.time);
    REQUIRE(truth.size() == shown.size());
    REQUIRE(truth.size() == state.present.size());
    for (std::size_t layer = 0; layer < truth.size(); ++layer) {
        std::vector<uint8_t> differing(truth[layer].texels.size());
        std::size_t count = 0;
        for (std::size_t i = 0; i < differing.size(); ++i) {
            differing[i] = truth[layer].texels[i] != shown[layer].texels[i];
            count += differing[i];
            apart.dark += truth[layer].texels[i] == 0;
        }
        apart.all += differing.size();
        apart.pixels += count;
        if (count == 0) continue;
        demo::Renderer& renderer = thrown.session().renderer;
        const demo::FrameSurfaces surfaces{renderer.readDepth(), renderer.readNormals()};
        const uint32_t light = state.present[layer];
        const std::vector<uint8_t> ambiguous =
            demo::ambiguousPixels(thrown.scene(), state, renderer.camera(), surfaces, thrown.scene().lights[light],
                                  state.lights[light], differing);
        for (std::size_t i = 0; i < differing.size(); ++i)
            apart.clear += differing[i] == 1 && ambiguous[i] == 0;
    }
}

} // namespace gnomon::exact
