#include "runtime/cost/method_measures.hpp"

namespace gnomon::cost {

namespace {

constexpr double kReferenceSide = 1024.0;
constexpr double kPriorSamples = 4.0; // measurements that the author's figure is worth

} // namespace

double MethodMeasures::wrongAt(double side) const noexcept
{
    return wrongPercent * (side > 0.0 ? kReferenceSide / side : 1.0);
}

MethodMeasures measuresOf(const KnowledgeBase& base, const DeviceKnowledge* device, std::string_view algorithm,
                          double typicalWrongPercent) noexcept
{
    double sum = kPriorSamples * typicalWrongPercent, samples = kPriorSamples;
    for (const DeviceKnowledge& each : base.devices)
        if (const AlgorithmCost* known = each.find(algorithm)) {
            sum += known->wrongSamples * known->wrongPercent;
            samples += known->wrongSamples;
        }
    const AlgorithmCost* here = device ? device->find(algorithm) : nullptr;
    return {.wrongPercent = sum / samples, .firstFrameMs = here ? here->firstFrameMs : 0.0};
}

} // namespace gnomon::cost
