// Fuzz entry point for traces: any bytes are read; what is accepted must be whole and must survive writing and reading.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "demo/replay/trace.hpp"

using namespace gnomon::demo;

namespace {

void require(bool holds)
{
    if (!holds) std::abort();
}

void checkTrace(const Trace& trace)
{
    const size_t cells = size_t{trace.frames} * trace.lights;
    require(trace.frames <= kTraceMostFrames && trace.lights <= kTraceMostLights);
    require(trace.methods.size() <= kTraceMostMethods && trace.facts.size() <= kTraceMostFacts);
    require(trace.lightStates.size() == cells && trace.factValues.size() == cells * trace.facts.size());
    require(trace.measures.size() == cells * trace.methods.size());
    require(trace.budgetsMs.size() == trace.frames && trace.cuts.size() == trace.frames);
    for (const TraceMethod& method : trace.measures)
        require(std::isfinite(method.ms()) && method.spread >= 1.0f &&
                method.error >= 0.0f && method.error <= 1.0f);
}

void readAndCheck(const std::string& bytes)
{
    const Outcome<Trace> trace = readTrace(bytes);
    require(bool(trace) == trace.error().empty());
    if (!trace) return;
    checkTrace(*trace);
    const std::string written = writeTrace(*trace);
    const Outcome<Trace> again = readTrace(written);
    require(bool(again));
    require(writeTrace(*again) == written);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    std::string bytes(reinterpret_cast<const char*>(data), size);
    readAndCheck(bytes);
    if (size < 8) return 0;
    // No mutation hits the hash at the end, so the same again with the right one: FNV-1a, see trace.hpp.
    bytes.resize(size - 8);
    uint64_t hash = 14695981039346656037u;
    for (const char c : bytes)
        hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211u;
    for (int i = 0; i < 8; ++i)
        bytes.push_back(static_cast<char>(hash >> (8 * i) & 0xff));
    readAndCheck(bytes);
    return 0;
}
