// Two depth layers that cannot be wrong: triangles grown by half a texel and shrunk by half a texel. What lies before
// all grown ones is lit, what lies behind a shrunk one is dark, and the rest is traced on the CPU. Source:    E.
// Hertel, K. Hormann, R. Westermann, "A hybrid GPU rendering pipeline for alias-free hard shadows", Eurographics
//            2009, areas papers; F. Morais 2015, 3.4.2 and 4 (CRSM).
// Reads:     casters' triangles, receiver depth and normals (also read back).     Writes: visibility.
// Strong at: exact, whatever the map's resolution; large triangles, little of the picture in shadow.
// Weak at:   every edge between triangles tears the shadow: inside it, finely divided casters leave all pixels to the
// rays.
#include "algorithms/entries.hpp"

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
