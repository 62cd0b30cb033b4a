#pragma once
// The runs behind `gnomon compare`: adaptive ones and fixed choices in turns, each from a fresh context.
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "demo/compare/stage.hpp"
#include "demo/compare/trial.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/other_work.hpp"
#include "demo/program/shadow_times.hpp"
#include "demo/replay/budget.hpp"

namespace gnomon::demo {

/// Where a method, or one with maps of one side, served in adaptive runs.
struct Service {
    uint64_t lightFrames = 0;
    /// From the eye to the light's nearest receiver that is seen. Nearest above farthest: none was ever seen.
    float nearestMetres = std::numeric_limits<float>::infinity(), farthestMetres = 0.0f;
};

/// CompareOptions::maps as numbers. Throws HostError where they are none.
std::vector<uint32_t> mapSides(const CompareOptions& options);

class Sentinel;

class Contest {
public:
    Contest(const CompareOptions& options, const std::string& scene);
    ~Contest();

    /// Tries the methods, then runs everybody in turns.
    void run();

    const Scene& scene() const { return scene_; }
    const Stage& stage() const { return stage_; }
    const EqualQuality& quality() const { return quality_; }
    /// What the host gives the adaptive runs for each frame, ms; NaN: none. Empty: none for all.
    std::span<const double> hostBudgetMs(bool warm) const { return hostBudgetMs_[warm]; }
    /// Above 0: it gives so many times the cheapest fixed choice of equal quality.
    double budgetFactor() const { return budget_ && budget_->relative ? budget_->value : 0.0; }
    /// Of what was tried and not run, in words.
    const std::vector<std::string>& notes() const { return notes_; }
    /// The cold row of each contestant, the adaptive ones first, and behind it its warm one where there is one.
    const std::vector<Row>& rows() const { return rows_; }
    /// Of the first adaptive contestant, all its runs together: "ray_traced", "shadow_map at 512".
    const std::map<std::string, Service>& services() const { return services_; }

private:
    struct Contestant {
        RuleText rules;     ///< Of an adaptive one.
        FixedChoice choice; ///< Of the others.
        size_t row = 0;     ///< The cold one.
    };

    void addAdaptive();
    void prepare();
    void addFixed();
    void addContestant(Contestant contestant, const std::string& name);
    std::unique_ptr<Session> begin(const Contestant& contestant);
    void runOnce(const Contestant& contestant);
    std::vector<uint64_t> pass(Session& session, Row& row, ShadowTimes& shadows);
    void noteServices(const Session& session);
    void setBudgets();
    float budgetMs(const Row& row, uint32_t frame) const;
    bool worthRepeating(const Contestant& contestant) const;

    CompareOptions options_;
    Scene scene_;
    std::unique_ptr<Device> device_;
    Stage stage_;
    EqualQuality quality_;
    std::optional<BudgetPart> budget_;
    std::array<std::vector<double>, 2> hostBudgetMs_; ///< Cold and warm.
    std::vector<TriedMethod> methods_;
    Truths truths_;
    std::vector<std::string> notes_;
    std::vector<Contestant> contestants_;
    std::vector<Row> rows_;
    std::map<std::string, Service> services_;
    std::unique_ptr<Sentinel> sentinel_;
    OtherWork others_;
};

} // namespace gnomon::demo
