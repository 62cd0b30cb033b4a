#pragma once
// Decisions outside of a frame: the real rules, the real choice and the real plan step, on facts and times that a test
// makes up. What the runtime adds to it is the device.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/select/explain.hpp"

namespace gnomon::test {

/// The engine of a rule base over the runtime's facts and the built-in methods.
std::optional<rules::Engine> bindRules(std::string_view text);
/// Two rules, a veto, a floor below 45 m, `allocation: budget`.
std::string_view fixtureRules();

/// Names of the built-in methods, in registry order.
const std::vector<MethodWords>& methodWords();
std::uint32_t methodNamed(std::string_view name);

/// Everything a light's choice rests on.
struct Situation {
    FactValues facts{};
    std::vector<Candidate> candidates; ///< Exclusion, detail, quality and times; the rest is filled in.
    std::uint32_t incumbent = UINT32_MAX;
    std::uint32_t pinned = UINT32_MAX;
    double importance = 1.0;
    double budgetMs = 0.0; ///< 0: no plan.
    double othersMs = 0.0; ///< What another light, pinned, takes of it.
    std::vector<plan::SharedPart> parts;
    bool cut = false;

    Situation();
    double& fact(Fact which) { return facts[static_cast<std::size_t>(which)]; }
    Candidate& method(std::string_view name) { return candidates[methodNamed(name)]; }
};

class SelectorFixture {
public:
    explicit SelectorFixture(rules::Engine engine) : engine_(std::move(engine)) {}

    /// One frame of a light; the plan remembers what it decided before.
    DecisionRecord decide(const Situation& situation);
    const rules::Engine& engine() const { return engine_; }
    ExplainWords words() const { return {.methods = methodWords(), .engine = &engine_, .light = "lamp"}; }
    std::uint64_t frame() const { return frame_; }

private:
    void plan(const Situation& situation, LightDecision& decision, FrameRecord& frame);

    rules::Engine engine_;
    plan::PlanStep plan_;
    plan::LightMemory memory_, other_;
    std::uint64_t frame_ = 0;
};

std::size_t lineCount(const std::string& text);
bool contains(const std::string& text, std::string_view part);

} // namespace gnomon::test
