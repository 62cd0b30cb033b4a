#pragma once
// The under-estimated layer by sheets: a texel that no silhouette touches is covered by whatever face lies over its
// centre and the faces that go on from there. And the thesis's form, in which triangles keep the edges that they share
// with neighbours.
#include "algorithms/hybrid/conservative_layers.hpp"

namespace gnomon {

class ConservativeSheets {
public:
    explicit ConservativeSheets(const AlgorithmServices& services);

    /// Declares what is missing of the under-estimated layer: of triangles by themselves, and of sheets.
    ImageId declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                           const ConservativeMaps& maps) const;
    /// The same as the thesis has it: one, one, two or four triangles for 0 to 3 kept edges.
    ImageId declareThesis(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                          const ConservativeMaps& maps) const;

    /// Device bytes beyond the layer itself.
    static VkDeviceSize memory(std::uint32_t resolution);

    /// Pipelines of the passes that find sheets.
    struct Pipelines {
        PipelineId slope, centre, sheets;
    };

private:
    Pipelines pipelines_;
};

} // namespace gnomon
