#pragma once
// Questions about a decision, answered from its record in at most twelve lines: why, why not, what if, what changed.
// The same code answers in a running context, from a log (record_log.hpp) and in tests; none of it needs a device.
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/select/choice.hpp"
#include "runtime/select/record.hpp"

namespace gnomon {

constexpr std::size_t kMostExplanationLines = 12;

/// A method as text needs it.
struct MethodWords {
    std::string_view name;
    std::string_view unavailable; ///< Why the device cannot run it; empty: it can.
    bool rays = false;            ///< Traces rays, on the CPU.
    bool deviceRays = false;      ///< And on the device.
    bool discs = false;           ///< Has penumbrae, of discs alone.
};

/// The names behind the numbers of a record.
struct ExplainWords {
    std::span<const MethodWords> methods;  ///< At least DecisionRecord::methods.
    const rules::Engine* engine = nullptr; ///< The record's rule base; null: none, or it is no longer there.
    std::string_view light;
    std::uint64_t frameOrigin = 0; ///< Subtracted from frame numbers in text.
    bool software = false;         ///< The device is the CPU.
};

/// Why this method: the reason, the rules behind it with what limits them, facts, cost, and the runner-up.
std::string explainWhy(const DecisionRecord& record, const ExplainWords& words);
/// What eliminated a method (an index below record.methods), and what would let it win.
std::string explainWhyNot(const DecisionRecord& record, std::uint32_t method, const ExplainWords& words);
/// The smallest change of each single fact that flips the choice, nearest first.
std::string explainWhatIf(const DecisionRecord& record, const ExplainWords& words);
/// What differs from an earlier decision about the same light. @param before null: there is none to compare with
std::string explainWhatChanged(const DecisionRecord& record, const DecisionRecord* before, const ExplainWords& words);

/// The newest earlier record of the light, or the newest one in which another method served. @param find fills a record
/// of a frame, or says that there is none
std::optional<DecisionRecord> earlierRecord(const DecisionRecord& record, std::uint64_t oldest, bool otherMethod,
                                            const std::function<bool(std::uint64_t, DecisionRecord&)>& find);

/// Why a method that is able to serve the light does not, in the long explanation of the newest frame: "outscored".
std::string passedOverText(const LightDecision& decision, const Candidate& candidate);

// Words for single things (explain_words.cpp), also used by the long explanation of the newest frame.
const char* reasonText(GnReason reason);
std::string exclusionText(const Candidate& candidate, std::string_view unavailable, const rules::Engine* engine);
const char* holdText(plan::Hold hold);
const char* replanText(Replan replan);
/// "12.40 m"; "unknown" for NaN.
std::string factText(Fact fact, double value);
/// "unknown" for NaN.
std::string knownText(double value, int digits);
/// "1.20 ms", below a tenth with four digits.
std::string msText(double value);
/// Predicted, and what is not sure of it: "1.20 ms (not timed here: up to 2.00 ms)".
std::string costText(const Candidate& candidate);
/// Of a method that does not serve: with what the change takes, where that is no trifle.
std::string changeCostText(const Candidate& candidate);
/// What GN_REASON_PRICE holds against a better suited method.
std::string priceText(const Candidate& chosen, const Candidate& candidate);
/// Empty but where the device is the CPU and the method traces rays.
std::string softwareText(std::uint32_t chosen, const ExplainWords& words);
/// Its name, or "none".
std::string_view methodText(std::uint32_t method, std::span<const MethodWords> methods);

/// " at 512", of the side of a method's maps; empty for a method without maps.
std::string mapSideText(std::uint32_t side);

/// Collects lines up to the limit; what comes later is left out, so the important comes first.
class ExplanationLines {
public:
    void add(std::string line);
    std::size_t left() const { return kMostExplanationLines - count_; }
    std::string take() { return std::move(text_); }

private:
    std::string text_;
    std::size_t count_ = 0;
};

} // namespace gnomon
