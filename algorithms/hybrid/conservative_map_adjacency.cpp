// conservative_map whose shrunken layer knows which triangles go together: shadows tear at silhouettes only.
// Source:    F. Morais, "Rasterization + Ray Tracing: Rendering of Hard Shadows", Universidade do Minho 2015, 4
// (CRSMA).
//            Differs: its kept edges claim texels that are not covered, so by default a texel counts as covered by the
//            sheet over its centre unless a silhouette edge touches it.
// Reads:     casters' triangles and topology, receiver depth and normals (also read back).     Writes: visibility.
// Strong at: exact, with a part of the rays of conservative_map: the inside of shadows is known.
// Weak at:   silhouettes close together leave no texel untouched; three more passes over the casters when they move.
#include "algorithms/entries.hpp"

#include <bit>

#include "algorithms/hybrid/conservative_sheets.hpp"
#include "algorithms/hybrid/sheet_edges.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon {

namespace {

constexpr UndecidedNames kNames = {.status = "conservative_map_adjacency.status",
                                   .readback = "conservative_map_adjacency.readback",
                                   .visibility = "conservative_map_adjacency.visibility",
                                   .trace = "conservative_map_adjacency.trace",
                                   .copy = "conservative_map_adjacency.copy",
                                   .list = "conservative_map_adjacency.list",
                                   .clear = "conservative_map_adjacency.clear_list"};

class ConservativeMapAdjacency final : public ConservativeMethod {
public:
    explicit ConservativeMapAdjacency(const AlgorithmServices& services)
        : ConservativeMethod(services, "conservative_map_adjacency.classify", kNames),
          most_(services.vk->properties.limits.maxStorageBufferRange), sheets_(services)
    {
    }
    const char* refuses(const ShadowTask& task) const override
    {
        for (const Caster* caster : task.casters->all) {
            if (!caster->mesh || !caster->mesh->topology) continue;
            // Buffers grow to a power of two, and are bound up to it.
            const std::uint64_t words = sheetListWords(caster->mesh->topology->edges.size());
            if (std::bit_ceil(words * sizeof(std::uint32_t)) > most_)
                return "a caster has more edges than a storage buffer";
        }
        return ConservativeMethod::refuses(task);
    }

private:
    ImageId declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                           const ConservativeMaps& maps, bool thesis) const override
    {
        return thesis ? sheets_.declareThesis(passes, task, view, maps)
                      : sheets_.declareCovered(passes, task, view, maps);
    }

    std::uint64_t most_; ///< Bytes of a storage buffer.
    ConservativeSheets sheets_;
};

} // namespace

constinit const AlgorithmEntry kConservativeMapAdjacency{
    .name = "conservative_map_adjacency",
    .source = "Morais 2015, 4",
    .traits = ConservativeMethod::kTraits | GN_TRAIT_TOPOLOGY_BIT,
    .roundTrips = 1,
    .settings = ConservativeMethod::kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return ConservativeMethod::memory(settings, extent, type) +
                   ConservativeSheets::memory(static_cast<std::uint32_t>(settings[ConservativeMethod::kResolution]));
        },
    .create = makeAlgorithm<ConservativeMapAdjacency>,
    .approximates = ConservativeMethod::approximates,
    .memoryWithDeviceRays =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return ConservativeMethod::memoryWithDeviceRays(settings, extent, type) +
                   ConservativeSheets::memory(static_cast<std::uint32_t>(settings[ConservativeMethod::kResolution]));
        },
};

} // namespace gnomon
