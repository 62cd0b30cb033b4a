#include "runtime/cost/workload.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::cost {

namespace {

constexpr double kMillion = 1e6, kThousand = 1e3;
constexpr double kOneFace = 1.0 / 6.0; // of a cube, the least that an update draws

double sizeOf(double size)
{
    return std::isfinite(size) && size > 0.0 ? size : 0.0;
}

} // namespace

Terms termsOf(const Workload& w, Pass pass) noexcept
{
    const double instances = sizeOf(w.casters) / kThousand, texels = sizeOf(w.mapTexels) / kMillion;
    if (pass == Pass::update) {
        const double drawn = w.drawnTriangles > 0.0 ? w.drawnTriangles : w.casterTriangles;
        return {1.0, sizeOf(drawn) / kMillion, instances, texels * std::clamp(w.mapTouched, kOneFace, 1.0),
                texels * sizeOf(w.mapFilled)};
    }
    const double reached = sizeOf(w.pixels) / kMillion;
    const double view = w.viewPixels > 0.0 ? sizeOf(w.viewPixels) / kMillion : reached;
    const double drawn = w.drawnPixels > 0.0 ? sizeOf(w.drawnPixels) / kMillion : reached;
    const double met = w.treeLevels > 0.0 && view > 0.0 ? std::min(reached / view, 1.0) : 1.0;
    return {1.0,
            met * sizeOf(w.casterTriangles) / kMillion,
            met * instances,
            texels,
            0.0,
            view,
            drawn,
            reached,
            reached * sizeOf(w.treeLevels),
            sizeOf(w.shadowPixels) / kMillion,
            sizeOf(w.softPixels) / kMillion};
}

} // namespace gnomon::cost
