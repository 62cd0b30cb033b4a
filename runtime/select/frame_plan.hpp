#pragma once
// All lights of a frame together: what each method would cost (cost model), and which of them fit (plan step).
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/cost/method_measures.hpp"
#include "runtime/cost/teach.hpp"
#include "runtime/plan/probe.hpp"
#include "runtime/select/choice.hpp"
#include "runtime/select/selector.hpp"

namespace gnomon {

/// What a light's passes took in one timed frame.
struct LightTiming {
    std::uint64_t frame = 0;
    float updateGpuMs = 0.0f, updateCpuMs = 0.0f;   ///< Light scope: maps, volumes.
    float resolveGpuMs = 0.0f, resolveCpuMs = 0.0f; ///< Task scope.
    bool updated = false;                           ///< Some light-scope pass ran.
};

/// The newest timing of a light, and what it was for.
struct TimedLight {
    LightTiming timing;
    std::uint32_t method = 0;
    cost::Workload workload; ///< As that frame saw it.
};

class FramePlan {
public:
    FramePlan(const MethodTable& methods, bool sharedCores) : methods_(methods), sharedCores_(sharedCores)
    {
        model_.setSharedCores(sharedCores);
    }

    void begin();
    /// One light of one view; both references live until decide() is done.
    void add(LightDecision& decision, LightMemory& memory, const SelectionInput& input);

    struct Budget {
        double ms = 0.0;          ///< 0: none; the best suitability is kept.
        double perCheapest = 0.0; ///< As PlanInput's four.
        double sharedMs = 0.0;
        std::span<const plan::SharedPart> parts;
        double measuredMs = -1.0;
        bool cut = false;
        bool probe = false;        ///< probe() is wanted.
        double lastSecondMs = 0.0; ///< Of all shadow passes; 0: not known.
        std::uint64_t frame = 0;
    };
    /// Predicts, and with a budget and a rule base that says so, chooses again. @return the report of the plan step;
    /// where there was none, PlanReport::cheapestMs alone, and without a floor.
    plan::PlanReport decide(const rules::RuleBase* base, const Budget& budget);
    /// What the newest decide() would have measured; lights by the order of add().
    const plan::Probe& probe() const { return probe_; }

    /// Timings of one completed frame, light by light, then endFrame().
    void observe(LightMemory& memory, std::uint32_t method, const LightTiming& timing, bool disturbed);
    void endFrame() { model_.endFrame(); }
    /// The light is gone, its slot is free.
    void forget(LightMemory& memory);

    /// The device that predictions are for. @param kind "software", "integrated" or "discrete"
    struct Device {
        std::string name;
        std::string_view kind;
    };
    struct Taught {
        std::uint32_t methods = 0; ///< That were measured; with none nothing changes.
        std::string device;        ///< Whose numbers they are: of this device, else of one of its kind, else of any.
        bool same = false;
    };
    /// Starts the cost model again from what was measured elsewhere; methods added later learn from it too. Allocates.
    Taught teach(cost::KnowledgeBase base, const Device& device);
    /// What teach() took; null before.
    const cost::DeviceKnowledge* knowledge() const { return known_; }
    /// Grows with every timing that the cost model learns from.
    std::uint64_t knowledgeRevision() const { return model_.samples(); }
    /// Null until a frame with the light was timed.
    const TimedLight* timed(const LightMemory& memory) const;
    /// Whether the newest decide() knew from a timing of this light how long the method takes for it.
    bool isTimed(const LightMemory& memory, std::uint32_t method) const;

    /// What makes a light harder than those that knowledge is of.
    struct Coarseness {
        double texels = 1.0;    ///< Width of the light's texels, times the usual one.
        double outlines = 1.0;  ///< Length of its shadows' outlines, likewise.
        double hardEdges = 0.0; ///< penumbraPercent().
    };

private:
    struct Request {
        LightDecision* decision;
        LightMemory* memory;
        std::uint32_t pinned;
        float importance;
        std::uint32_t height;              ///< Of the picture.
        std::uint32_t mostSide;            ///< MapSide::most().
        std::uint32_t suited = UINT32_MAX; ///< Without a budget: the best suited within the near floor, if it holds.
        Coarseness coarseness;             ///< coarsenessOf(), once a frame.
        double allowance = 1.0; ///< Of wrong pixels, over what others have: where the floor is of all lights.
    };
    struct Cost {
        cost::Prediction steady;
        double sureMs = 0.0;  ///< Candidate::sureMs.
        double firstMs = 0.0; ///< What the first frame takes beyond that.
    };
    void requestLights(const rules::RuleBase* base, const Budget& budget);
    void fill(const rules::RuleBase* base, const Budget& budget);
    Coarseness coarsenessOf(const LightMemory& memory, std::uint32_t height) const;
    float quality(std::uint32_t method, std::uint32_t side, const Coarseness& light) const;
    std::uint32_t leastSide(std::uint32_t method, float least, const Coarseness& light) const;
    std::size_t cellOf(const LightMemory& memory, std::uint32_t method) const
    {
        return std::size_t{memory.costSlot} * methods_.size() + method;
    }
    void economise(const rules::Policy& policy, const Budget& budget);
    void tryUnknown(const rules::Policy& policy, std::span<const std::int32_t> users, const Budget& budget);
    double trialMs(const Request& request, std::uint32_t own, std::uint32_t method, double shareMs) const;
    double fadeMs(const rules::RuleBase* base, std::uint32_t own, std::uint32_t method,
                  std::span<const Cost> costs) const;
    void holdFloor(Request& request, const plan::LightRequest& light, const rules::Policy& policy,
                   const Budget& budget);
    std::uint32_t forItsPrice(const Request& request, const Budget& budget) const;
    double takePrice(const Request& request, std::uint32_t method, const Budget& budget, double roomMs);
    bool isTrial(const Request& request, std::uint32_t method, const Budget& budget) const;
    bool mayTry(const Request& request, std::uint32_t method, const Budget& budget);
    void explainWithoutPlan(const Request& request, bool hasRules) const;
    std::uint32_t slotOf(LightMemory& memory);
    void growModel(std::uint32_t slots);
    void measure(std::uint32_t slots);
    std::span<const Cost> predict(const LightMemory& memory, std::uint64_t frame);
    std::vector<cost::TaughtMethod> algorithms() const;

    static constexpr std::uint64_t kNever = UINT64_MAX;
    /// Beside a slot of the cost model. Timings come a few frames late: the workloads wait for them.
    struct SlotHistory {
        struct Entry {
            std::uint64_t frame = 0;
            cost::Workload workload;
        };
        /// By frame. Eight may be in flight, and the timing of the oldest comes in after the newest is noted.
        std::array<Entry, 16> recent{};
        TimedLight timed;
        std::uint64_t predictedAt = kNever;  ///< Frame.
        std::uint64_t predictedRevision = 0; ///< The cost model's.
        cost::Workload predictedFor;
    };
    const MethodTable& methods_;
    const bool sharedCores_; ///< Of this device.
    cost::CostModel model_;
    plan::PlanStep plan_;
    plan::Probe probe_;
    std::vector<Request> requests_;
    std::vector<std::uint32_t> priced_; ///< Methods by request, where there is no budget.
    std::vector<plan::LightRequest> lights_;
    std::vector<plan::Candidate> candidates_;
    std::vector<std::uint32_t> freeSlots_;
    std::vector<SlotHistory> histories_;         ///< By slot.
    std::vector<Cost> costs_;                    ///< slots x methods
    std::vector<cost::MethodMeasures> measures_; ///< By method.
    std::vector<float> wrong_;                   ///< Percent, by map side (kMapSides) and method, with this frame's
                                                 ///< settings and texels of a usual width.
    std::vector<float> sharesMs_;                ///< By method: of a light, if all had it; a plan knows better.
    cost::KnowledgeBase knowledge_;
    const cost::DeviceKnowledge* known_ = nullptr; ///< In knowledge_.
    std::uint32_t slots_ = 0, slotsUsed_ = 0, modelMethods_ = 0;
    bool budgeted_ = false;        ///< The frame has a budget.
    std::uint64_t triedUntil_ = 0; ///< Frame: a light has changed to a method that it, or no light, was timed with.
    double savedMs_ = 0.0;         ///< For trials.
};

/// Share of the truth a method keeps with its settings, by what its author says and a knowledge base measured
/// (MethodMeasures::quality).
float qualityOf(const Method& method, const cost::KnowledgeBase& knowledge);

} // namespace gnomon
