#pragma once
// Drawing casters into a layer of a conservative map (shaders/hybrid/conservative.h).
#include <cstdint>
#include <span>

#include <glm/mat4x4.hpp>

#include "algorithms/shared/map_cells.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "shaders/hybrid/conservative_lookup.h"

namespace gnomon {

/// What a layer of a map holds; the numbers of conservative_varyings.glsl.
enum class ConservativeLayer : std::uint32_t {
    nearest, ///< Every texel touched, with the smallest depth in it.
    covered, ///< Every texel covered, with the largest depth in it.
    slope,   ///< Every texel touched, with the slope as a depth; 0: faces or edges seen edge-on.
    thesisNearest,
    thesisCovered,
    centre, ///< Every texel whose centre is on a face, with the depth there.
};

/// By how much the thesis's form moves edges (Morais 2015, eq. 19): values of the setting `lambda`.
enum class ThesisOffset : std::uint32_t {
    tight,        ///< The texel's extent along the edge's normal: what the guaranteed form has.
    halfDiagonal, ///< Eq. 19 read in normalised coordinates.
    diagonal,     ///< Read in coordinates of the map.
};
inline constexpr SettingSpec kLambdaSetting = {
    "lambda", "Mode 1 moves edges by: 0 a texel's extent along their normal, 1 half its diagonal, 2 its diagonal.", 0,
    2, 1};

/// A map as casters and receivers meet in it.
struct ConservativeProjection {
    glm::dmat4 texelFromZero{1.0}; ///< x and y in texels times w, as gpu::MapLookup has them.
    glm::dvec3 zeroWs{0.0};
    glm::mat4 clipFromZero{1.0f}; ///< MapProjection's.
    float side = 0.0f;
    float depthConstant = 0.0f, depthScale = -1.0f; ///< As in MapProjection.
    bool perspective = false;
    float lightCoordinate = 0.0f; ///< Largest coordinate of the light; 0 without a place.
    ThesisOffset offset = ThesisOffset::halfDiagonal;
};
ConservativeProjection conservativeProjection(const LightFit& fit, const LightView& light, std::uint32_t resolution);

/// Fills what a receiver's rounding does in the map: its own, and, many times as large, that of a ray's start on the
/// way into the space of the most skewed of the light's casters.
void addRounding(gpu::ConservativeConstants& constants, const ConservativeProjection& projection,
                 std::span<const Caster* const> casters);

/// One caster's constants. @param backOnly of the faces, those turned away from the light.
gpu::ConservativePush conservativePush(const ConservativeProjection& projection, const Caster& caster, bool backOnly);

/// Whether of a caster only the faces turned away from the light are occluders: no light reaches a receiver outside a
/// closed solid through it without leaving it by one. Holes that rays may find in its faces (alpha) open it.
bool backFacesOnly(const Caster& caster);

/// Bits of the edges that the thesis keeps, per caster drawn; null buffer: none.
struct KeptEdges {
    const Caster* caster;
    BufferId bits;
};

/// Pipelines of one layer, for all methods.
PipelineId makeConservativePipeline(const AlgorithmServices& services, const char* name, ConservativeLayer layer);

/// Records casters; what KeptMap::update takes. Copied bytewise.
class ConservativeCasters {
public:
    ConservativeCasters(PipelineId pipeline, ConservativeLayer layer, const ConservativeProjection* projection)
        : pipeline_(pipeline), layer_(layer), projection_(projection)
    {
    }
    void keep(std::span<const KeptEdges> kept) { kept_ = kept; }
    void uses(PassRef& pass) const;
    void operator()(PassContext& gpu, std::span<const Caster* const> casters, bool statics) const;
    /// KeptMap::update(): triangles are grown by less than a cell.
    Cells cells(std::span<const Caster* const> casters) const;
    /// Edges as triangles of two corners: an indirect command and three vertices of the caster's mesh an edge.
    void drawEdges(PassContext& gpu, const Caster& caster, BufferId edges) const;

private:
    bool thesis() const
    {
        return layer_ == ConservativeLayer::thesisNearest || layer_ == ConservativeLayer::thesisCovered;
    }
    BufferId keptOf(const Caster& caster) const;

    PipelineId pipeline_;
    ConservativeLayer layer_;
    const ConservativeProjection* projection_; ///< In the frame's memory.
    std::span<const KeptEdges> kept_;
};

} // namespace gnomon
