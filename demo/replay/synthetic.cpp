#include "demo/replay/synthetic.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "demo/io/number.hpp"
#include "demo/replay/budget.hpp"
#include "runtime/cost/exponent.hpp"

namespace gnomon::demo {

namespace {

/// splitmix64: the standard library's distributions differ between builds.
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    double between(double low, double high)
    {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return low + (high - low) * (static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53);
    }

private:
    uint64_t state_;
};

/// An invented method: milliseconds per unit of work, and how its error behaves.
struct Kind {
    const char* name;
    float texels;
    double perTriangles, perTexels, perPixels; ///< ms for 1e5 triangles, 1e6 texels, 1e6 pixels.
    double nearError, farError;                ///< Share of wrong pixels.
};
constexpr std::array<Kind, 8> kKinds = {{
    {"map_512", 262144.0f, 0.10, 0.2, 0.8, 0.060, 0.010},
    {"map_1024", 1048576.0f, 0.10, 0.2, 0.8, 0.035, 0.005},
    {"map_2048", 4194304.0f, 0.10, 0.2, 0.9, 0.020, 0.003},
    {"filtered_map", 1048576.0f, 0.12, 0.4, 1.6, 0.030, 0.003},
    {"volume", 0.0f, 0.70, 0.0, 2.6, 0.000, 0.000},
    {"hybrid", 1048576.0f, 0.10, 0.2, 2.0, 0.002, 0.001},
    {"hybrid_fine", 4194304.0f, 0.11, 0.2, 1.7, 0.001, 0.001},
    {"traced", 0.0f, 0.05, 0.0, 9.0, 0.000, 0.000},
}};

/// What drifts of a light. Positions are phases, so that every quantity stays in its range and moves smoothly.
struct Drift {
    double phase[3], speed[3];
    double importance;
    uint32_t bornAt = 0, diesAt = UINT32_MAX;
    std::array<double, kKinds.size()> own;

    Drift(Random& random, double pace)
    {
        for (int i = 0; i < 3; ++i) {
            phase[i] = random.between(0.0, 2.0);
            speed[i] = pace * random.between(0.5, 1.5);
        }
        importance = random.between(0.5, 1.0);
        for (double& factor : own)
            factor = cost::exp2Exactly(random.between(-0.2, 0.2)); // 8 % among lights, as in the cost model's tests
    }
    /// Triangle wave in [0, 1], its corners rounded by a cubic.
    double at(int i, double seconds) const
    {
        const double t = phase[i] + speed[i] * seconds;
        const double x = t - 2.0 * std::floor(t / 2.0);
        const double y = x < 1.0 ? x : 2.0 - x;
        return y * y * (3.0 - 2.0 * y);
    }
};

void fillLight(Trace& trace, uint32_t frame, uint32_t slot, const Drift& drift, double seconds, double slowness)
{
    TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
    const double distance = 5.0 + 80.0 * drift.at(0, seconds);
    const double nearness = std::clamp((60.0 - distance) / 30.0, 0.0, 1.0);
    light.present = true;
    light.fresh = frame == drift.bornAt;
    light.importance = static_cast<float>(drift.importance);
    light.floor = nearness >= 0.5;
    light.minimumQuality = 0.8f;
    light.pixels = static_cast<float>(cost::exp2Exactly(13.0 + 5.0 * drift.at(1, seconds) + 1.5 * nearness));
    light.casterTriangles = static_cast<float>(cost::exp2Exactly(11.0 + 6.0 * drift.at(2, seconds)));
    trace.factValues[trace.cell(frame, slot)] = static_cast<float>(distance);
    for (uint32_t m = 0; m < kKinds.size(); ++m) {
        const Kind& kind = kKinds[m];
        TraceMethod& method = trace.measure(frame, slot, m);
        const double factor = drift.own[m] * slowness;
        method.updateGpuMs = static_cast<float>(factor * (0.01 + kind.perTriangles * light.casterTriangles / 1e5 +
                                                          kind.perTexels * kind.texels / 1e6 * 0.3));
        method.resolveGpuMs = static_cast<float>(factor * (0.01 + kind.perPixels * light.pixels / 1e6));
        method.error = static_cast<float>(kind.farError + (kind.nearError - kind.farError) * nearness);
        method.spread = 1.1f;
        method.quality = static_cast<float>(1.0 / (1.0 + 12.5 * double{method.error})); // 0.8 at 2 % wrong pixels
        // Near, exactness is wanted, far it is a luxury: what a rule base would say.
        const double exactness = 1.0 - std::min(1.0, kind.nearError / 0.06);
        const double wanted = 0.35 + 0.6 * (nearness * exactness + (1.0 - nearness) * (0.6 + 0.4 * exactness));
        method.suitability = static_cast<int16_t>(4096.0 * wanted);
    }
}

} // namespace

Trace syntheticTrace(const SyntheticOptions& options)
{
    Random random(options.seed * 1000 + static_cast<uint64_t>(options.kind));
    Trace trace;
    trace.frames = options.frames;
    trace.lights = options.lights;
    trace.facts = {"viewerDistance"};
    for (const Kind& kind : kKinds)
        trace.methods.emplace_back(kind.name);
    trace.allocate();
    for (uint32_t m = 0; m < kKinds.size(); ++m)
        trace.mapTexels[m] = kKinds[m].texels;

    const bool stress = options.kind == SyntheticKind::stress;
    const double pace = options.kind == SyntheticKind::still ? 0.0 : stress ? 0.06 : 0.012; // half periods a second
    std::vector<Drift> drifts;
    for (uint32_t slot = 0; slot < options.lights; ++slot)
        drifts.emplace_back(random, pace);
    for (uint32_t frame = 0; frame < options.frames; ++frame) {
        const double seconds = frame * double{trace.frameSeconds};
        trace.cuts[frame] = frame == 0 || (stress && frame % 480 == 0);
        const double share = double{1} * frame / options.frames;
        const double slowness = stress && share >= 0.6 && share < 0.8 ? 2.0 : 1.0;
        for (uint32_t slot = 0; slot < options.lights; ++slot) {
            Drift& drift = drifts[slot];
            if (frame > 0 && trace.cuts[frame])
                for (double& phase : drift.phase)
                    phase += random.between(0.3, 0.7);
            if (stress && slot % 4 == 3 && frame % 600 == slot * 30) { // every fourth light is replaced, then missing
                drift = Drift(random, pace);
                drift.bornAt = frame;
                drift.diesAt = frame + 450;
            }
            if (frame < drift.diesAt) fillLight(trace, frame, slot, drift, seconds, slowness);
        }
    }
    auto timesCheapest = [](double factor) {
        std::string text;
        appendFixed(text, factor, 6);
        text += 'x';
        return text;
    };
    std::string budgets = timesCheapest(options.budgetOverCheapest);
    if (options.kind == SyntheticKind::budgetStep)
        budgets = budgets + "," + timesCheapest(options.budgetOverCheapest * 2.0 / 3.0) + "," + budgets;
    if (trace.frames > 0) (void)setBudgets(trace, budgets); // the text is ours
    return trace;
}

} // namespace gnomon::demo
