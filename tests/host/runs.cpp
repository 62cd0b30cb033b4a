#include "runs.hpp"

#include <algorithm>
#include <stdexcept>

namespace stranger {
namespace {

constexpr double kMomentsS[] = {0.7, 2.9, 5.3}; // lamps stand elsewhere each time
} // namespace

double runFrames(Renderer& renderer, double fromS, int frames)
{
    const size_t first = renderer.reports().size();
    for (int i = 0; i < frames; ++i)
        renderer.renderFrame(fromS + i * kStepS);
    renderer.finish();
    std::vector<double> times;
    for (size_t i = first; i < renderer.reports().size(); ++i)
        times.push_back(renderer.reports()[i].shadowMs);
    return summarise(times).median;
}

void runFirstSecond(Renderer& renderer)
{
    constexpr int kAtOnce = 4;
    constexpr size_t kFrames = 16; // two timed ones, at one in eight
    double elapsedMs = 0.0;
    while (elapsedMs < 1000.0 || renderer.reports().size() < kFrames) {
        const size_t first = renderer.reports().size();
        runFrames(renderer, static_cast<double>(first) * kStepS, kAtOnce);
        for (size_t i = first; i < renderer.reports().size(); ++i)
            elapsedMs += renderer.reports()[i].wallMs;
    }
}

std::unique_ptr<Renderer> createPinned(const Device& device, const Options& options, const std::string& method)
{
    auto renderer = std::make_unique<Renderer>(device, options);
    if (!renderer->shadows().pin(method.c_str())) return nullptr;
    renderer->shadows().warmUp(method.c_str());
    return renderer;
}

std::vector<Answer> traceReferences(const Device& device, VkExtent2D size)
{
    const auto renderer = createPinned(device, {.size = size}, "ray_traced");
    if (!renderer) throw std::runtime_error("ray_traced, the reference, cannot serve");
    std::vector<Answer> references;
    for (double moment : kMomentsS) {
        runFrames(*renderer, moment - kStepS, 2);
        references.push_back(renderer->read());
    }
    return references;
}

double wrongAtMoments(Renderer& renderer, const std::vector<Answer>& references)
{
    double wrong = 0.0;
    for (size_t i = 0; i < references.size(); ++i) {
        runFrames(renderer, kMomentsS[i] - kStepS, 2);
        wrong = std::max(wrong, wrongPercent(renderer.read(), references[i]));
    }
    return wrong;
}
} // namespace stranger
