#pragma once
// The context: owner of everything, and the one place where the trip of a frame is written down.
#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "runtime/api/last_error.hpp"
#include "runtime/api/plugin.hpp"
#include "runtime/api/plugin_abi.hpp"
#include "runtime/base/slot_map.hpp"
#include "runtime/passes/pass_executor.hpp"
#include "runtime/registry.hpp"
#include "runtime/select/auto_budget.hpp"
#include "runtime/select/depth_grid.hpp"
#include "runtime/select/frame_plan.hpp"
#include "runtime/select/record.hpp"
#include "runtime/select/selector.hpp"
#include "runtime/select/shared_parts.hpp"
#include "runtime/store/scene_registry.hpp"

namespace gnomon {

/// A view between frames.
struct View {
    std::string name;
    GnView handle = VK_NULL_HANDLE;
    std::uint32_t id = 0;
    std::uint32_t maxLights = 16;
    std::unique_ptr<PooledImage> visibility;
    std::unique_ptr<PooledImage> replaced; ///< Was `visibility` before the newest frame, which may yet be withdrawn.
    bool resized = false;                  ///< The newest frame made `visibility`.
    std::uint64_t madeIn = 0;              ///< Frame that made `visibility`.
    std::uint64_t replacedMadeIn = 0;      ///< The same of `replaced`.
    std::uint64_t revision = 0;
    std::unique_ptr<DepthGrid> grid;
    std::unordered_map<std::uint32_t, LightMemory> lights; ///< By light id.
    std::vector<LightDecision> decisions;                  ///< Of the last frame, in the order of its lights.
    RecordRing records;                                    ///< Of the last frames.
    CameraView camera;                                     ///< Of the frame under way.
    std::uint64_t lastFrame = 0;                           ///< The newest whose lights were decided.
};

/// What is known of a light whatever the view.
struct LightState {
    MotionHistory motion;
    std::uint32_t pinned = UINT32_MAX;
    GnLight handle = VK_NULL_HANDLE; ///< Of a light that was pinned.
    std::uint64_t lastFrame = 0;
};

enum class FrameMode : std::uint8_t { recorded, begin, submit };

class Context {
public:
    static Result<std::unique_ptr<Context>> create(const GnContextCreateInfo& info);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Waits for everything; before destruction. @return false where the device hangs: then abandon() takes the place
    /// of destruction
    bool drain() noexcept;
    /// Ends the threads. All else is left as it is, for the device may still use it.
    void abandon() noexcept;

    Result<void> warmUp();
    Result<void> warmUpMethod(const char* name);
    Result<GnView> createView(const GnViewCreateInfo& info);
    void destroyView(GnView view);
    Result<GnVisibility> visibility(GnView view);
    Result<void> setLightMethod(GnLight light, const char* method);
    Result<GnLightMap> lightMap(GnLight light);

    Result<void> addMethod(const char* name, const char* algorithm);
    Result<void> setMethodSetting(const char* method, const char* setting, double value);
    Result<void> registerAlgorithm(const GnAlgorithmInfo& info);
    Result<GnResult> loadPlugin(GnContext self, const char* path);
    const GnPluginInterface* pluginInterface() const { return &pluginInterface_; }
    std::uint32_t methods(std::span<GnMethodInfo> out);
    Result<void> loadRules(std::string_view text, std::string_view fileName);
    Result<void> loadShippedRules(std::string_view name);
    Result<void> loadKnowledge(std::string_view text, std::string_view fileName);

    Result<GnResult> recordFrame(VkCommandBuffer cmd, const GnFrameInfo& info);
    Result<GnResult> beginFrame(const GnFrameInfo& info, FrameMode mode);
    Result<GnResult> finishFrame(std::uint64_t timeoutNs);
    Result<void> dropFrame(std::uint64_t frame);

    Result<GnDecision> decision(GnView view, GnLight light);
    Result<std::string> explanation(GnView view, GnLight light);
    Result<std::string> answer(GnView view, GnLight light, const GnQuestion& question);
    Result<std::string> decisionLog(GnView view, std::uint64_t firstFrame, std::uint64_t frameOrigin);
    Result<GnLightTiming> lightTiming(GnView view, GnLight light);
    /// Fill what fits. @return how many there are.
    Result<std::uint32_t> facts(GnView view, GnLight light, std::span<GnFact> out);
    Result<std::uint32_t> candidates(GnView view, GnLight light, std::span<GnCandidate> out);
    std::uint32_t passTimings(std::uint64_t& frame, std::span<GnPassTiming> out);
    Result<std::uint32_t> framePasses(std::span<GnPassTiming> out);
    GnFrameStats stats() const { return stats_; }

    SceneRegistry& scene() { return *scene_; }
    const Messages& messages() const { return messages_; }
    // From any thread.
    LastErrors& lastErrors() { return lastErrors_; }
    void noteLost() { lost_ = true; }
    bool lost() const { return lost_; }

private:
    struct ViewFrame {
        View* view = nullptr;
        ImageId depth, normals, visibility;
        PooledImage* depthImage = nullptr;
        PooledImage* normalImage = nullptr;
    };
    struct LightFrame {
        std::uint32_t id;
        GnLight handle;
        LightCasters casters;
    };
    struct RetiredGrid {
        std::uint64_t frame;
        std::unique_ptr<DepthGrid> grid;
    };
    /// A light of a view between assessment and declaration.
    struct PendingLight {
        std::uint32_t viewIndex;
        std::uint32_t layer;
        const LightView* light;
        const LightCasters* casters;
        LightDecision* decision;
        LightMemory* memory;
    };
    /// Of a task as declared, for gnGetLightMap.
    struct DeclaredMap {
        std::uint32_t lightId;
        ShadowAlgorithm::Map map;
    };

    explicit Context(const GnContextCreateInfo& info);
    Result<void> init(const GnContextCreateInfo& info);

    // The frame, stage by stage (frame.cpp).
    Result<GnResult> startFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd);
    template <typename Wanted>
    Result<void> warmUp(Wanted&& wanted); ///< Methods for which wanted(method) holds.
    Result<Method*> usableMethod(const char* name);
    template <typename Add>
    Result<void> admit(const char* name, GnTraits traits, Add&& add); ///< Adds a method that the rules bind to.
    void teachShared() noexcept;
    bool createOwnPipelines();
    void failOwnPipelines(const std::string& why);
    void settleWarmup(std::uint32_t owner);
    void noteWarmup(std::uint32_t owner) noexcept;
    void setReady(std::uint32_t owner, bool ready);
    /// Whose pipelines this frame runs for the first time, once they are compiled: one method a frame.
    std::uint32_t nextWarmup();
    void openStats(std::uint64_t frame, std::chrono::steady_clock::time_point start);
    Result<void> decide(const GnFrameInfo& info, FrameMode mode, std::span<const Caster> casters);
    Result<GnResult> runFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd,
                              std::chrono::steady_clock::time_point start);
    Result<void> takeInput(const GnFrameInfo& info);
    void collectLightMaps();
    Result<void> acceptViews(const GnFrameInfo& info);
    Result<void> checkSharedImages(const GnFrameInfo& info, std::uint32_t index, const std::string& name) const;
    Result<void> prepareView(View& view, const GnViewFrame& frame, std::span<const Caster> casters); // frame_view.cpp
    void keepVisibility();
    void restoreVisibility(bool memoryShort);
    void takeTimings();
    void noteTimedScale(const FrameTimings& timed);
    void noteShared(const FrameTimings& timings);
    void chargeLights(const FrameTimings& timings);
    void chargeLight(const FrameTimings& timings, const View& view, std::uint32_t light, LightMemory& memory,
                     bool disturbed);
    void openGraph(const GnFrameInfo& info);
    void assessView(std::uint32_t viewIndex, const GnViewFrame& frame, const GnFrameInfo& info, FrameMode mode);
    void planLights(const GnFrameInfo& info);
    void noteChanges(std::uint64_t frame);
    bool learnsFrom(std::uint64_t frame) const;
    double meanFrameRate() const;
    bool cameraCut() const;
    /// Of all shadow passes, GPU and host, of the newest frame that is known whole; < 0: none is.
    double measuredMs() const { return untimedGpuMs_ > 0.0f ? double{untimedGpuMs_} + double{untimedCpuMs_} : -1.0; }
    void updateBudget(const GnFrameInfo& info);
    void declareLight(const PendingLight& pending, FrameMode mode);
    std::optional<Error> declareMethod(const PendingLight& pending, std::uint32_t method, ImageId visibility,
                                       std::uint32_t layer, FrameMode mode);
    void noteFailure(const PendingLight& pending, const Error& error);
    void declareLit(std::uint32_t viewIndex, std::uint32_t layer);
    const LightCasters& castersOf(const LightView& light);

    // Cross-fades (frame_fade.cpp).
    bool showTheSame(const PendingLight& pending, std::uint32_t a, std::uint32_t b) const;
    FadeRequest nextFade(const PendingLight& pending, const rules::RuleBase* base);
    void settleFades();
    bool canShareLayer(const LightDecision& decision, std::uint32_t method) const;
    bool wantsProbe(const rules::RuleBase* base) const;
    void settleProbe();
    ImageId declareBeside(const PendingLight& pending, FrameMode mode);
    void declareMix(const PendingLight& pending, ImageId pair);
    void noteMixes(const FrameTimings& timings);
    void withdrawFades(std::uint64_t frame);
    void withdrawFrame(std::uint64_t frame, bool memoryShort);
    void forgetFrame(std::uint64_t frame, bool memoryShort);
    void loseFrame(std::uint64_t frame);

    // Records of decisions (explain.cpp).
    void recordDecisions();
    void noteMeasured(const FrameTimings& timings);
    const char* ruleBehind(const View& view, const LightDecision& decision);
    Result<DecisionRecord> recordOf(const View& view, GnLight light, std::uint64_t frame);

    void forgetOldLights();
    void finishStats();
    View* findView(GnView handle);
    Result<const LightDecision*> findDecision(GnView view, GnLight light);
    void finishUnderway() noexcept;
    GnPassTiming publicTiming(const PassTiming& timing) const;
    double msSince(std::chrono::steady_clock::time_point since) const;

    Messages messages_;
    bool background_;
    bool timeEveryFrame_;
    // Before everything that may call into them.
    std::vector<std::unique_ptr<SharedObject>> plugins_;
    std::vector<std::unique_ptr<PluginAlgorithm>> pluginAlgorithms_;
    GnPluginInterface pluginInterface_{};
    std::unique_ptr<DeviceTable> vk_;
    std::unique_ptr<DeviceMemory> memory_;
    std::unique_ptr<JobSystem> jobs_;
    std::unique_ptr<RayScene> rays_;
    std::unique_ptr<SceneRegistry> scene_;
    std::unique_ptr<SamplerSet> samplers_;
    std::unique_ptr<PipelineStore> pipelines_;
    std::unique_ptr<MethodTable> methods_;
    std::unique_ptr<Selector> selector_;
    std::shared_ptr<const rules::Engine> askedRules_; ///< By ruleBehind(), and what they infer.
    rules::Inference inference_;
    std::unique_ptr<FramePlan> plan_;
    plan::PlanReport planReport_;
    FrameArena arena_;
    std::unique_ptr<ResourcePool> pool_;
    std::unique_ptr<PassGraph> graph_;
    std::unique_ptr<PassExecutor> executor_;
    AlgorithmRegistry registry_;

    SlotMap<std::unique_ptr<View>> views_;
    std::uint32_t nextViewId_ = 1;
    std::unordered_map<std::uint32_t, LightState> lights_;

    std::uint64_t frame_ = 0;    ///< Newest begun; 0: none.
    std::uint64_t recorded_ = 0; ///< Newest recorded that may still be dropped.
    // How a frame ended that another call had to finish, for its gnFinishShadows(): with a result or an exception.
    std::optional<Result<GnResult>> finishedEarly_;
    std::exception_ptr thrownEarly_;
    std::uint64_t timingsTaken_ = 0;
    std::uint64_t changedAt_ = 0; ///< Frame of the switches whose methods are timed next.
    std::array<double, 3> origin_{};
    bool originSet_ = false;
    std::uint64_t originMovedIn_ = 0; ///< Frame; 0: it has not.
    PipelineId gridPipeline_, mixPipeline_;
    MedianOfFive mixMs_;     ///< Of a light's mix pass.
    bool gridReady_ = false; ///< The runtime's own pipelines have run once.
    bool ownFailed_ = false; ///< They never will.
    std::vector<View*> acceptedViews_;
    std::vector<ViewFrame> viewFrames_;
    std::vector<LightFrame> lightFrames_;
    std::vector<PendingLight> pending_;
    std::vector<FadeRequest> fades_; ///< As pending_.
    struct ProbeRun {                ///< One at a time.
        std::uint32_t view = 0, light = 0, method = UINT32_MAX;
        std::uint64_t since = 0; ///< Frame; 0: there was none yet.
    } probe_;
    std::vector<DeclaredMap> maps_; ///< Of the newest frame, unless it was withdrawn.
    std::vector<PooledImage*> visibilities_, imports_, lightMaps_;
    std::vector<RetiredGrid> retiredGrids_;
    std::vector<VkSemaphoreSubmitInfo> waits_, signals_;
    bool raysNeeded_ = false;
    float untimedGpuMs_ = 0.0f, untimedCpuMs_ = 0.0f; ///< Of untimedFrame_.
    std::uint64_t untimedFrame_ = 0;
    /// What no light is charged with, in frames timed unasked: one in four or more brings a grid.
    SecondOfEight sharedMs_;
    SecondOfEight unaskedMs_; ///< Of that, what no method asked for.
    SharedParts sharedParts_; ///< The rest.
    WeightedMedianOfFive timedRatios_;
    float timedScale_ = 1.0f;        ///< From what a pass takes in a timed frame to its share of an untimed one.
    double budgetMs_ = 0.0;          ///< In force; 0: none.
    double budgetPerCheapest_ = 0.0; ///< PlanInput::perCheapest.
    bool measuresBudget_ = false;    ///< The cheapest plan runs, for `budget: auto`.
    bool budgetBegins_ = false;      ///< It was measured; this is the first frame under the budget.
    AutoBudget autoBudget_;
    std::uint64_t autoBudgetRules_ = 0; ///< Hash of the rule base it was measured for.
    /// What is to be known of a frame when its timings come, two or more frames later.
    struct PastFrame {
        std::uint64_t frame = 0;
        std::uint64_t methods = 0; ///< A stamp: equal where lights, and all methods at work, are.
        bool beside = false;       ///< Methods ran beside those of the plan: fades, a probe.
        bool disturbed = false;    ///< Its timings are not the methods' doing.
        bool timedUnasked = false; ///< Whatever the host asked.
        std::uint32_t warmup =
            UINT32_MAX; ///< Whose pipelines it ran for the first time; that they did not fail is known.
        float cpuMs = 0.0f;
        double plannedMs = 0.0, cheapestMs = 0.0; ///< PlanReport's.
        double pixels = 0.0;                      ///< Of all views.
    };
    std::array<PastFrame, 16> past_{}; ///< A ring; twice the frames that may be in flight.
    PastFrame& present() { return past_[frame_ % past_.size()]; }
    const PastFrame& past(std::uint64_t frame) const; ///< Empty where the ring has moved on.
    std::uint64_t followed_ = 0;                      ///< The newest frame that `budget: auto` followed.
    double predictedMs_ = 0.0, lastPredictedMs_ = 0.0;
    std::array<float, 30> frameTimes_{};
    std::uint32_t frameTimeCount_ = 0;
    std::chrono::steady_clock::time_point lastFrameStart_{};
    std::uint64_t objectsBefore_ = 0, pipelinesBefore_ = 0, queriesBefore_ = 0; ///< When the frame began.
    GnFrameStats stats_{};
    std::atomic<bool> lost_ = false;
    bool drained_ = false; ///< drain() has waited.
    LastErrors lastErrors_;
};

/// #GN_ERROR_FRAME_ORDER: calls and frame numbers that do not follow each other (frame_checks.cpp).
Error frameOrder(const std::string& text);

/// Checks one view's part of a frame (frame_input.cpp). Nothing is kept.
Result<void> checkViewFrame(const GnViewFrame& frame, const char* viewName, std::uint32_t maxLights,
                            const DeviceTable& vk);
/// The camera relative to `origin`; the frame has been checked.
/// @param casters that may be seen
CameraView makeCameraView(const GnViewFrame& frame, const std::array<double, 3>& origin, std::uint32_t id,
                          std::span<const Caster> casters = {});

// A fading light's two methods write these layers of one image.
constexpr std::uint32_t kOutgoingLayer = 0, kIncomingLayer = 1;
/// Mixes them (frame_fade.cpp).
PipelineId fadeMixPipeline(PipelineLibrary& library);

/// One frame in this many carries full barriers and a pair of timestamps around every pass; they cost up to 20 % there.
constexpr std::uint64_t kTimedPeriod = 8;

/// The pipelines of the runtime itself have an owner of their own in the store.
constexpr std::uint32_t kRuntimeOwner = kMaxMethods;

} // namespace gnomon
