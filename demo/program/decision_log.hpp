#pragma once
// decisions.gnlog: what a run decided, for questions afterwards.

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "demo/host/shadow_host.hpp"
#include "demo/program/commands.hpp"
#include "runtime/select/record_log.hpp"

namespace gnomon::demo {

/// A log keeps the newest frames that fit: some 40 000 decisions.
constexpr size_t kMaxDecisionLogBytes = size_t{16} << 20;

/// Collects gnomon's records while a scene runs.
class DecisionCollector {
public:
    /// After every frame. \param frame gnomon's number of it; the first one is frame 0 of the tables.
    void frame(const ShadowHost& shadows, uint64_t frame);
    /// What has not been collected yet; before other rules are loaded, and at the end.
    void collect(const ShadowHost& shadows);
    std::string bytes() const;

private:
    std::deque<std::string> chunks_;
    size_t size_ = 0;
    uint64_t origin_ = 0, next_ = 0, newest_ = 0;
};

enum class Asked : uint8_t { why, whyNot, whatIf, changed, changedSinceSwitch };

struct WhyQuestion {
    Asked asked = Asked::why;
    uint32_t frame = 0;
    std::string light; ///< Name, or number of the light in the log.
    std::string method;
};

/// Answers from a log's bytes; what is wrong with the log or the question is an error that names it.
Outcome<std::string> answerFromLog(std::string_view bytes, const WhyQuestion& question);

/// Prints the answers of what was collected; throws HostError at the first question that has none.
void printAnswers(const DecisionCollector& decisions, const std::vector<WhyQuestion>& questions);

/// "FRAME:LIGHT[:METHOD]".
Outcome<WhyQuestion> parseWhy(const std::string& text);
/// Each of them; throws HostError naming the first that is none.
std::vector<WhyQuestion> parseQuestions(const std::vector<std::string>& texts);

/// Each asks about a light of the run's scene, a method of this build and one of the run's frames; a window's run has
/// as many as it is given time for. Throws HostError. A light's number in the log is known to the log alone, and
/// passes.
void requireAnswers(const std::vector<WhyQuestion>& questions, const RunOptions& options);

} // namespace gnomon::demo
