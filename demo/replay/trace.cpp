#include "demo/replay/trace.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "runtime/base/bytes.hpp"
#include "runtime/base/hash.hpp"
#include "runtime/cost/exponent.hpp"

namespace gnomon::demo {

namespace {

constexpr std::string_view kMagic = "GNTRACE3";
constexpr size_t kMostCells = size_t{1} << 24; ///< (frame, light, method) triples: 340 MB in memory.
constexpr double kTimeSteps = 2048.0, kTimeShift = 20.0, kSpreadSteps = 32.0;

uint16_t packTime(float ms)
{
    if (!(ms > 0.0f)) return 0;
    return static_cast<uint16_t>(std::clamp(1.5 + (cost::log2Exactly(ms) + kTimeShift) * kTimeSteps, 1.0, 65535.0));
}
uint16_t packShare(float share)
{
    return static_cast<uint16_t>(std::clamp(share, 0.0f, 1.0f) * 65535.0f + 0.5f);
}
float unpackTime(uint16_t packed)
{
    return packed == 0 ? 0.0f : static_cast<float>(cost::exp2Exactly((packed - 1) / kTimeSteps - kTimeShift));
}

class Writer : public ByteWriter {
public:
    void name(std::string_view text)
    {
        text = text.substr(0, 255);
        integer(static_cast<uint8_t>(text.size()));
        bytes += text;
    }
};

class Reader : public ByteReader {
public:
    using ByteReader::ByteReader;
    /// Numbers of a trace are finite and not negative; facts alone may be NaN (unknown) or of either sign.
    float measure()
    {
        const float value = real32();
        if (!std::isfinite(value) || value < 0.0f) failed = true;
        return value;
    }
    std::string name() { return std::string(take(integer<uint8_t>())); }
};

/// The sizes of a light's workload in the order of the file.
std::array<float*, 9> sizesOf(TraceLight& light)
{
    return {&light.pixels,     &light.casterTriangles, &light.drawnTriangles, &light.casters, &light.drawnPixels,
            &light.viewPixels, &light.shadowPixels,    &light.treeLevels,     &light.sharing};
}

void readLight(Reader& in, Trace& trace, uint32_t frame, uint32_t slot)
{
    TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
    light.present = true;
    light.importance = in.measure();
    light.minimumQuality = in.measure();
    const auto flags = in.integer<uint8_t>();
    light.floor = flags & 1, light.still = flags & 2, light.fresh = flags & 4, light.directional = flags & 8;
    light.point = flags & 16;
    for (float* size : sizesOf(light))
        *size = in.measure();
    for (size_t i = 0; i < trace.facts.size(); ++i)
        trace.factValues[trace.cell(frame, slot) * trace.facts.size() + i] = in.real32();
    for (uint32_t m = 0; m < trace.methods.size(); ++m) {
        TraceMethod& method = trace.measure(frame, slot, m);
        for (float* time : {&method.updateGpuMs, &method.updateCpuMs, &method.resolveGpuMs, &method.resolveCpuMs})
            *time = unpackTime(in.integer<uint16_t>());
        method.error = static_cast<float>(in.integer<uint16_t>()) / 65535.0f;
        method.spread = static_cast<float>(cost::exp2Exactly(in.integer<uint8_t>() / kSpreadSteps));
        method.quality = static_cast<float>(in.integer<uint16_t>()) / 65535.0f;
        method.suitability = in.integer<int16_t>();
        if (method.suitability < kTraceVetoed || method.suitability > 4096) in.failed = true;
    }
}

void writeLight(Writer& out, const Trace& trace, uint32_t frame, uint32_t slot)
{
    const TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
    out.real(light.importance);
    out.real(light.minimumQuality);
    out.integer(static_cast<uint8_t>(light.floor | light.still << 1 | light.fresh << 2 | light.directional << 3 |
                                     light.point << 4));
    TraceLight sizes = light;
    for (const float* size : sizesOf(sizes))
        out.real(*size);
    for (size_t i = 0; i < trace.facts.size(); ++i)
        out.real(trace.factValues[trace.cell(frame, slot) * trace.facts.size() + i]);
    for (uint32_t m = 0; m < trace.methods.size(); ++m) {
        const TraceMethod& method = trace.measure(frame, slot, m);
        for (const float time : {method.updateGpuMs, method.updateCpuMs, method.resolveGpuMs, method.resolveCpuMs})
            out.integer(packTime(time));
        out.integer(packShare(method.error));
        const double spread = cost::log2Exactly(std::max(1.0f, method.spread)) * kSpreadSteps;
        out.integer(static_cast<uint8_t>(std::min(spread + 0.5, 255.0)));
        out.integer(packShare(method.quality));
        out.integer(method.suitability);
    }
}

} // namespace

void Trace::allocate()
{
    const size_t cells = size_t{frames} * lights;
    mapTexels.resize(methods.size());
    drawsVolumes.resize(methods.size());
    tracesPixels.resize(methods.size());
    budgetsMs.resize(frames);
    cuts.resize(frames);
    lightStates.resize(cells);
    factValues.resize(cells * facts.size());
    measures.resize(cells * methods.size());
}

bool fitsTrace(uint32_t frames, uint32_t lights, size_t methods, size_t facts) noexcept
{
    return frames <= kTraceMostFrames && lights <= kTraceMostLights && methods <= kTraceMostMethods &&
           facts <= kTraceMostFacts && size_t{frames} * lights * (methods + facts + 1) <= kMostCells;
}

std::string writeTrace(const Trace& trace)
{
    Writer out;
    out.bytes = kMagic;
    for (const size_t count : {size_t{trace.frames}, size_t{trace.lights}, trace.methods.size(), trace.facts.size()})
        out.integer(static_cast<uint32_t>(count));
    out.real(trace.frameSeconds);
    for (size_t m = 0; m < trace.methods.size(); ++m) {
        out.name(trace.methods[m]);
        out.real(trace.mapTexels[m]);
        out.integer(static_cast<uint8_t>(trace.drawsVolumes[m] | trace.tracesPixels[m] << 1));
    }
    for (const std::string& fact : trace.facts)
        out.name(fact);
    for (uint32_t frame = 0; frame < trace.frames; ++frame) {
        out.real(trace.budgetsMs[frame]);
        out.integer(static_cast<uint8_t>(trace.cuts[frame] ? 1 : 0));
        for (uint32_t slot = 0; slot < trace.lights; ++slot)
            out.integer(static_cast<uint8_t>(trace.lightStates[trace.cell(frame, slot)].present));
        for (uint32_t slot = 0; slot < trace.lights; ++slot)
            if (trace.lightStates[trace.cell(frame, slot)].present) writeLight(out, trace, frame, slot);
    }
    const uint64_t hash = hashOfBytes(out.bytes);
    out.integer(hash);
    return std::move(out.bytes);
}

Outcome<Trace> readTrace(std::string_view bytes)
{
    auto failure = [](const char* why) { return Outcome<Trace>::failure(why); };
    if (!bytes.starts_with(kMagic.substr(0, 7))) return failure("not a trace");
    if (!bytes.starts_with(kMagic)) return failure("a trace of another version; record it again");
    Reader in(bytes.substr(kMagic.size()));
    Trace trace;
    trace.frames = in.integer<uint32_t>();
    trace.lights = in.integer<uint32_t>();
    const auto methods = in.integer<uint32_t>(), facts = in.integer<uint32_t>();
    trace.frameSeconds = in.measure();
    // Before anything is allocated: no more cells than memory is meant for, and a frame takes at least its head.
    if (!fitsTrace(trace.frames, trace.lights, methods, facts) || !(trace.frameSeconds > 0.0f))
        return failure("the trace's header is out of bounds");
    if (in.left() < size_t{trace.frames} * (5 + trace.lights))
        return failure("the trace is shorter than its header says");
    std::vector<float> texels;
    std::vector<uint8_t> volumes, traces;
    for (uint32_t m = 0; m < methods && !in.failed; ++m) {
        trace.methods.push_back(in.name());
        texels.push_back(in.measure());
        const auto flags = in.integer<uint8_t>();
        volumes.push_back(flags & 1);
        traces.push_back(flags >> 1 & 1);
    }
    for (uint32_t f = 0; f < facts && !in.failed; ++f)
        trace.facts.push_back(in.name());
    if (in.failed) return failure("the trace's names are damaged");
    trace.allocate();
    trace.mapTexels = std::move(texels);
    trace.drawsVolumes = std::move(volumes);
    trace.tracesPixels = std::move(traces);
    std::vector<uint8_t> present(trace.lights);
    for (uint32_t frame = 0; frame < trace.frames; ++frame) {
        trace.budgetsMs[frame] = in.measure();
        trace.cuts[frame] = in.integer<uint8_t>() & 1;
        for (uint8_t& flag : present)
            flag = in.integer<uint8_t>();
        for (uint32_t slot = 0; slot < trace.lights && !in.failed; ++slot)
            if (present[slot]) readLight(in, trace, frame, slot);
        if (in.failed) return Outcome<Trace>::failure("frame " + std::to_string(frame) + " of the trace is damaged");
    }
    if (in.left() != 8) return failure("the trace does not end where it should");
    if (in.integer<uint64_t>() != hashOfBytes(bytes.substr(0, bytes.size() - 8)))
        return failure("the trace's hash differs");
    return trace;
}

} // namespace gnomon::demo
