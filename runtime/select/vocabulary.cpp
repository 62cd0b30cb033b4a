#include "runtime/select/vocabulary.hpp"

#include "runtime/select/facts.hpp"

namespace gnomon {

namespace {

std::vector<std::string> traitWords(GnTraits traits)
{
    static constexpr struct {
        GnTraitBits bit;
        const char* word;
    } kWords[] = {
        {GN_TRAIT_DIRECTIONAL_BIT, "directional"},
        {GN_TRAIT_SPOT_BIT, "spot"},
        {GN_TRAIT_POINT_BIT, "point"},
        {GN_TRAIT_HARD_BIT, "hard"},
        {GN_TRAIT_FIXED_PENUMBRA_BIT, "fixedPenumbra"},
        {GN_TRAIT_SOFT_PENUMBRA_BIT, "softPenumbra"},
        {GN_TRAIT_EXACT_BIT, "exact"},
        {GN_TRAIT_CPU_GEOMETRY_BIT, "cpuGeometry"},
        {GN_TRAIT_RAYS_BIT, "rays"},
        {GN_TRAIT_PLANAR_BIT, "planar"},
        {GN_TRAIT_DEVICE_RAYS_BIT, "deviceRays"},
        {GN_TRAIT_GPU_POSITIONS_BIT, "gpuPositions"},
        {GN_TRAIT_FLAT_SOURCE_BIT, "flatSource"},
        {GN_TRAIT_GPU_TRANSFORMS_BIT, "gpuTransforms"},
    };
    std::vector<std::string> words;
    for (const auto& entry : kWords)
        if (traits & entry.bit) words.emplace_back(entry.word);
    return words;
}

} // namespace

RuleVocabulary::RuleVocabulary(const AlgorithmRegistry& registry) : traits(traitWords(~GnTraits{0}))
{
    for (const FactName& fact : kFactNames)
        facts.push_back({fact.name, fact.unit});
    for (const AbsentAlgorithm& algorithm : registry.absent)
        absent.push_back({algorithm.name, {}});
}

void RuleVocabulary::addMethod(std::string name, GnTraits methodTraits)
{
    outputs.push_back({std::move(name), traitWords(methodTraits)});
}

} // namespace gnomon
