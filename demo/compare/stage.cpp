#include "demo/compare/stage.hpp"

#include "demo/program/measure.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kTruthFrames = 12;

} // namespace

void drawFrame(Session& session, const Stage& stage, uint32_t frame, float budgetMs, GnFrameFlags flags)
{
    const double time = stage.path.time(frame);
    const CameraState camera = cameraAt(stage.scene, time);
    session.renderer.draw({.time = time,
                           .cameras = {&camera, 1},
                           .shadows = &session.shadows,
                           .recorded = stage.recorded,
                           .budgetMs = budgetMs,
                           .flags = flags,
                           .cameraCut = stage.path.cut(frame)});
    session.renderer.waitForFrame();
}

std::vector<uint32_t> truthFrames(const ComparePath& path)
{
    const uint32_t step = std::max(1u, path.frames / kTruthFrames);
    std::vector<uint32_t> frames;
    for (uint32_t frame = step / 2; frame < path.frames; frame += step)
        frames.push_back(frame);
    return frames;
}

Truths measureTruths(Session& session, const Stage& stage, const std::vector<uint32_t>& frames)
{
    std::vector<std::string> refused;
    const Status pinned = session.shadows.pinAll(kTruthMethod, &refused);
    if (!pinned) throw HostError("errors are counted against ray_traced: " + pinned.error());
    if (!refused.empty()) throw HostError("errors are counted against ray_traced: " + refused.front());
    Truths truths;
    for (const uint32_t frame : frames) {
        settle(session, kTruthMethod, stage.path.time(frame), false);
        const FrameSurfaces surfaces{session.renderer.readDepth(), session.renderer.readNormals()};
        const std::vector<Image8> visibility = session.renderer.readVisibility();
        const SceneState& state = session.renderer.state();
        FrameTruth& truth = truths[frame];
        truth.near = nearPixels(session.renderer.camera(), surfaces.depth);
        for (size_t layer = 0; layer < state.present.size(); ++layer) {
            const uint32_t light = state.present[layer];
            const std::vector<uint8_t> counted = countedPixels(stage.scene, session.renderer.camera(), surfaces,
                                                               stage.scene.lights[light], state.lights[light]);
            truth.lights.emplace(stage.scene.lights[light].name, truthOf(visibility[layer], counted));
        }
    }
    return truths;
}

std::array<NearFar, kLightKinds> countErrors(Session& session, const FrameTruth& truth)
{
    std::array<NearFar, kLightKinds> errors;
    const std::vector<Image8> visibility = session.renderer.readVisibility();
    const std::vector<uint32_t>& present = session.renderer.state().present;
    for (size_t layer = 0; layer < present.size(); ++layer) {
        const Light& light = session.scene.lights[present[layer]];
        errors[size_t(light.kind)] += countWrong(visibility[layer], truth.lights.at(light.name), truth.near);
    }
    return errors;
}

} // namespace gnomon::demo
