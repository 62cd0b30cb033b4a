#pragma once
// Decision records as bytes, with everything that answers questions about them later, on any machine.
//
// A chunk, little-endian, no padding; a log file is any number of chunks in the order of their frames:
//
//     "GNDECID9"                                                     version in the last byte
//     u32 size of the chunk in bytes, hash included
//     u64 frame origin: subtracted from frame numbers when they are shown or asked for
//     u8 1: the device is the CPU
//     u8 methods x { text name; u32 traits (GnTraits); text why the device cannot run it, or empty }
//     u8 facts x text name
//     text name, text and preset of the rule base in force; empty: none
//     u32 lights x { u32 id; text name }
//     u16 refusals x text: reasons of methods that refused a light
//     u32 records x {
//         u64 frame, rule base hash, timings the cost model had learned from
//         u32 light id; u8 how many of the methods there were then; u8 method, wanted, incumbent, pinned (255: none)
//         u8 fallbacks x u8 method; u32 frames since the distance was measured (2^32 - 1: never)
//         u8 reason (GnReason), cause of the re-planning (Replan), hold (plan::Hold)
//         u8 flags: 1 budgeted, 2 switched, 4 near floor, 8 floor unmet, 16 priced, 32 guessed, 64 rectangle,
//             128 casters ask the host
//         u16 map side of the method (0: none), side that screen coverage asks for;
//         u8 frames from one drawing of the map to the next (0: whenever something moves), since the newest
//         f32 floor truth, floor strength, minimum quality, importance, suitability, measured ms, budget ms, usable ms,
//             plan ms, its standard error, threshold, least ms
//         facts x f64
//         u8 fired rules x { u32 rule; u32 limiting variable, term; f32 strength, membership, weight }
//         methods of then x { i16 suitability in 1/4096, -1 none; u8 exclusion, why;
//                     f32 quality, predicted ms, sure ms, first ms, shared ms;
//                     where excluded: u64 detail, u16 refusal (65535: none) } }
//     u64 FNV-1a of everything before
//
// A text is its length in u32 and its bytes. The exclusion, the why and the hold are the numbers of their enumerations.
#include <deque>
#include <string>
#include <string_view>

#include "runtime/base/result.hpp"
#include "runtime/select/record.hpp"

namespace gnomon {

constexpr std::size_t kMaxLogRulesBytes = std::size_t{1} << 20; ///< As a rule base may have.
constexpr std::size_t kMaxLogNameBytes = 1024;
constexpr std::uint32_t kMaxLogLights = 1u << 16;

struct LoggedMethod {
    std::string name;
    GnTraits traits = 0;
    std::string unavailable;
};

struct LoggedLight {
    std::uint32_t id = 0;
    std::string name;
};

struct DecisionLog {
    std::uint64_t frameOrigin = 0;
    bool software = false; ///< The device is the CPU.
    std::vector<LoggedMethod> methods;
    std::string rulesName, rulesText, preset;
    std::vector<LoggedLight> lights;
    std::vector<ReasonedHead> heads;   ///< By frame; each has as many of the methods above as there were then.
    std::vector<Candidate> candidates; ///< heads x methods; those of methods added later mean nothing.
    std::deque<std::string> refusals;  ///< Candidate::refusal points here after reading.

    void add(const DecisionRecord& record);
    DecisionRecord record(std::size_t index) const;
};

std::string writeDecisionLog(const DecisionLog& log);

/// Reads the first chunk of `bytes` and takes it off. Any bytes may come in: what is no chunk, was cut short or damaged
/// is an error that names the place. Safe on any input.
Result<DecisionLog> readDecisionLog(std::string_view& bytes);

} // namespace gnomon
