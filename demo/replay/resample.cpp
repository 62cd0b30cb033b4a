#include "demo/replay/resample.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/cost/exponent.hpp"

namespace gnomon::demo {

namespace {

float between(float a, float b, double share)
{
    // A fact that nobody knows (NaN) is known when it is.
    return std::isfinite(a) && std::isfinite(b) ? static_cast<float>(a + (double{b} - a) * share) : a;
}

float betweenOctaves(float a, float b, double share)
{
    if (!(a > 0.0f) || !(b > 0.0f)) return a;
    const double from = cost::log2Exactly(a), to = cost::log2Exactly(b);
    return static_cast<float>(cost::exp2Exactly(from + (to - from) * share));
}

/// One light from a recorded frame towards the next one.
class LightPath {
public:
    LightPath(const Trace& recorded, uint32_t frame, uint32_t slot)
        : recorded_(recorded), from_(recorded.cell(frame, slot)), to_(from_)
    {
        if (frame + 1 >= recorded.frames || recorded.cuts[frame + 1]) return;
        const size_t next = recorded.cell(frame + 1, slot);
        const TraceLight &here = recorded.lightStates[from_], &there = recorded.lightStates[next];
        if (here.present && there.present && !there.fresh) to_ = next;
    }

    void at(double share, Trace& out, size_t cell) const
    {
        const TraceLight& there = recorded_.lightStates[to_];
        TraceLight& light = out.lightStates[cell];
        light = recorded_.lightStates[from_];
        light.fresh = light.fresh && share == 0.0;
        light.importance = between(light.importance, there.importance, share);
        light.pixels = betweenOctaves(light.pixels, there.pixels, share);
        light.casterTriangles = betweenOctaves(light.casterTriangles, there.casterTriangles, share);
        light.drawnTriangles = betweenOctaves(light.drawnTriangles, there.drawnTriangles, share);
        light.casters = betweenOctaves(light.casters, there.casters, share);
        light.drawnPixels = betweenOctaves(light.drawnPixels, there.drawnPixels, share);
        light.shadowPixels = betweenOctaves(light.shadowPixels, there.shadowPixels, share);
        light.treeLevels = betweenOctaves(light.treeLevels, there.treeLevels, share);
        const size_t facts = recorded_.facts.size(), methods = recorded_.methods.size();
        for (size_t f = 0; f < facts; ++f)
            out.factValues[cell * facts + f] =
                between(recorded_.factValues[from_ * facts + f], recorded_.factValues[to_ * facts + f], share);
        for (size_t m = 0; m < methods; ++m)
            out.measures[cell * methods + m] =
                measure(recorded_.measures[from_ * methods + m], recorded_.measures[to_ * methods + m], share);
    }

private:
    static TraceMethod measure(TraceMethod a, const TraceMethod& b, double share)
    {
        a.updateGpuMs = betweenOctaves(a.updateGpuMs, b.updateGpuMs, share);
        a.updateCpuMs = betweenOctaves(a.updateCpuMs, b.updateCpuMs, share);
        a.resolveGpuMs = betweenOctaves(a.resolveGpuMs, b.resolveGpuMs, share);
        a.resolveCpuMs = betweenOctaves(a.resolveCpuMs, b.resolveCpuMs, share);
        a.error = between(a.error, b.error, share);
        a.spread = between(a.spread, b.spread, share);
        a.quality = between(a.quality, b.quality, share);
        if (a.suitability >= 0 && b.suitability >= 0)
            a.suitability = static_cast<int16_t>(std::lround(a.suitability + (b.suitability - a.suitability) * share));
        return a;
    }

    const Trace& recorded_;
    size_t from_, to_; ///< Cells; the same where nothing goes over.
};

} // namespace

Trace resample(const Trace& recorded, double framesPerSecond)
{
    const double wanted = std::round(double{recorded.frameSeconds} * framesPerSecond);
    // No more frames than a trace may have.
    const double most = std::floor(double{kTraceMostFrames} / std::max(1u, recorded.frames));
    const auto steps = static_cast<uint32_t>(std::max(1.0, std::min(wanted, most)));
    if (steps == 1) return recorded;
    Trace out = recorded;
    out.frames = recorded.frames * steps;
    out.frameSeconds = recorded.frameSeconds / static_cast<float>(steps);
    out.allocate();
    for (uint32_t frame = 0; frame < recorded.frames; ++frame) {
        for (uint32_t step = 0; step < steps; ++step) {
            out.budgetsMs[frame * steps + step] = recorded.budgetsMs[frame];
            out.cuts[frame * steps + step] = recorded.cuts[frame] && step == 0;
        }
        for (uint32_t slot = 0; slot < recorded.lights; ++slot) {
            const LightPath path(recorded, frame, slot);
            for (uint32_t step = 0; step < steps; ++step)
                path.at(static_cast<double>(step) / static_cast<double>(steps), out,
                        out.cell(frame * steps + step, slot));
        }
    }
    return out;
}

} // namespace gnomon::demo
