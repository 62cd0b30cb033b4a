#pragma once
// The depth map of a directional or spot light whose texels are not of one size, and its look-up.
#include <cstdint>

#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/trapezoid.hpp"

namespace gnomon {

/// What a warped map is of: the plain fit, and the part of it that the view sees.
struct WarpSource {
    const LightFit* plain;
    SeenPart part;
};

struct WarpSettings {
    std::uint32_t resolution;
    double filter;
    bool minimal;    ///< The smallest rectangle around what is seen is asked too.
    double contact;  ///< kContactSetting
    double most = 1; ///< Up to how many times the warp's strength is asked: a power of two.
};

class WarpedMap {
public:
    /// @param resolveName of the pass that turns the map into visibility
    WarpedMap(const AlgorithmServices& services, const char* resolveName, const ViewMapNames& names);

    WarpSource source(PassBuilder& passes, const ShadowTask& task, std::uint32_t resolution) const;
    /// Draws the map where light, casters or view have moved, and looks every receiver up. The map is that of `warp`,
    /// of the same with less strength, or the plain one: fitWarped().
    void declare(PassBuilder& passes, const ShadowTask& task, const WarpSource& source, const Warp& warp,
                 const WarpSettings& settings);
    const ShadowAlgorithm::Map* lightMap() const { return &map_; }

private:
    DepthMapPipelines casters_;
    MapResolve resolve_;
    ContactShadows contact_;
    ViewMapNames names_;
    ShadowAlgorithm::Map map_;
};

/// Adds how receivers are found in a map of such a fit: addProjection(), and what a directional light's needs beside.
void addWarpedProjection(gpu::MapConstants& constants, const LightFit& fit, const ShadowTask& task);

} // namespace gnomon
