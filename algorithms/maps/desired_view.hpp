#pragma once
// A light's depth map cropped to the receivers in view, on the GPU: "desired view" (Navratil 2015, 4.2.5).
#include <cstdint>

#include "algorithms/shared/map_resolve.hpp"
#include "shaders/maps/desired_view.h"

namespace gnomon {

/// The map of a directional or spot light, drawn in every frame into the rectangle of the light's plain map that
/// receivers of the task's view lie in, and looked up. A caster of a receiver lies on the receiver's ray, so it is in
/// the rectangle too. Casters that the host draws cannot be cropped.
class DesiredViewMap {
public:
    explicit DesiredViewMap(const AlgorithmServices& services);

    static bool serves(const ShadowTask& task);

    /// Writes the task's layer of visibility.
    /// @param constants with the projection of `fit`
    void declare(PassBuilder& passes, const ShadowTask& task, const LightFit& fit, const gpu::MapConstants& constants,
                 std::uint32_t borderTexels) const;

private:
    DepthMapPipelines casters_;
    PipelineId seen_[2]; ///< [has normals]
    PipelineId crop_;
    MapResolve resolve_;
};

} // namespace gnomon
