#include "algorithms/hybrid/conservative_map.hpp"

#include "algorithms/hybrid/conservative_layers.hpp"

namespace gnomon {

namespace {

constexpr UndecidedNames kNames = {.status = "conservative_map.status",
                                   .readback = "conservative_map.readback",
                                   .visibility = "conservative_map.visibility",
                                   .trace = "conservative_map.trace",
                                   .copy = "conservative_map.copy",
                                   .list = "conservative_map.list",
                                   .clear = "conservative_map.clear_list"};

class ConservativeMap final : public ConservativeMethod {
public:
    explicit ConservativeMap(const AlgorithmServices& services)
        : ConservativeMethod(services, "conservative_map.classify", kNames)
    {
    }

private:
    ImageId declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                           const ConservativeMaps& maps, bool thesis) const override
    {
        return maps.declareCovered(passes, task, view, thesis);
    }
};

} // namespace

constinit const AlgorithmEntry kConservativeMap{
    .name = "conservative_map",
    .source = "Hertel, Hormann and Westermann 2009; Morais 2015, 3.4.2",
    .traits = ConservativeMethod::kTraits,
    .roundTrips = 1,
    .settings = ConservativeMethod::kSettings,
    .memoryPerLight = ConservativeMethod::memory,
    .create = makeAlgorithm<ConservativeMap>,
    .approximates = ConservativeMethod::approximates,
    .memoryWithDeviceRays = ConservativeMethod::memoryWithDeviceRays,
};

} // namespace gnomon
