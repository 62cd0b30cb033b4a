#include "algorithms/registry.hpp"

#include <array>
#include <initializer_list>

#ifdef GNOMON_WITH_EMBREE
#include "algorithms/hybrid/coherence_sampling.hpp"
#include "algorithms/hybrid/conservative_map.hpp"
#include "algorithms/hybrid/contour_chain.hpp"
#include "algorithms/hybrid/eight_point_hybrid.hpp"
#include "algorithms/hybrid/pcf_hybrid.hpp"
#include "algorithms/hybrid/ray_traced.hpp"
#include "algorithms/hybrid/tile_shafts.hpp"
#endif
#include "algorithms/maps/cascades.hpp"
#include "algorithms/maps/shadow_map.hpp"
#include "algorithms/omni/cube_map.hpp"
#include "algorithms/omni/dual_paraboloid.hpp"
#include "algorithms/revectorized/rbsm.hpp"
#include "algorithms/volumes/mccool.hpp"
#if defined(GNOMON_WITH_EMBREE) && defined(GNOMON_WITH_OPENMESH)
#include "algorithms/hybrid/conservative_map_adjacency.hpp"
#include "algorithms/volumes/angular_spans.hpp"
#endif
#ifdef GNOMON_WITH_OPENMESH
#include "algorithms/volumes/all_edges_volume.hpp"
#include "algorithms/volumes/chan_durand.hpp"
#include "algorithms/volumes/octree_volume.hpp"
#include "algorithms/volumes/penumbra_wedges.hpp"
#include "algorithms/volumes/projected_planar.hpp"
#include "algorithms/volumes/stencil_volume.hpp"
#endif

namespace gnomon {

namespace {

constexpr std::array kAlgorithms = {
    &kShadowMap,
    &kCubeMap,
    &kDualParaboloid,
    &kRbsm,
    &kCascades,
#ifdef GNOMON_WITH_OPENMESH
    &kStencilVolume,
    &kChanDurand,
    &kOctreeVolume,
    &kAllEdgesVolume,
    &kProjectedPlanar,
    &kPenumbraWedges,
#endif
    &kMcCool,
#ifdef GNOMON_WITH_EMBREE
    &kPcfHybrid,
    &kContourChain,
    &kConservativeMap,
    &kRayTraced,
    &kTileShafts,
    &kEightPointHybrid,
    &kCoherenceSampling,
#endif
#if defined(GNOMON_WITH_EMBREE) && defined(GNOMON_WITH_OPENMESH)
    &kAngularSpans,
    &kConservativeMapAdjacency,
#endif
};

/// Known to rules, left out of this build.
constexpr std::initializer_list<const char*> kAbsentNames = {
#ifndef GNOMON_WITH_EMBREE
    "ray_traced",         "pcf_hybrid",
    "contour_chain",      "conservative_map",
    "tile_shafts",        "eight_point_hybrid",
    "coherence_sampling",
#endif
#ifndef GNOMON_WITH_OPENMESH
    "stencil_volume",     "chan_durand",
    "octree_volume",      "all_edges_volume",
    "projected_planar",   "penumbra_wedges",
#endif
#if !defined(GNOMON_WITH_EMBREE) || !defined(GNOMON_WITH_OPENMESH)
    "angular_spans",      "conservative_map_adjacency",
#endif
};
constexpr std::span<const char* const> kAbsent{kAbsentNames.begin(), kAbsentNames.size()};

} // namespace

std::span<const AlgorithmEntry* const> builtinAlgorithms()
{
    return kAlgorithms;
}

AlgorithmRegistry builtinRegistry()
{
    return {.entries = builtinAlgorithms(), .absent = kAbsent};
}

} // namespace gnomon
