#pragma once
// The context: owner of everything that outlives a frame, and the one place where the trip of a frame is written down.
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/accel/device_rays.hpp"
#include "runtime/api/last_error.hpp"
#include "runtime/api/plugin.hpp"
#include "runtime/api/plugin_abi.hpp"
#include "runtime/base/struct_size.hpp"
#include "runtime/frame/frame_budget.hpp"
#include "runtime/frame/frame_costs.hpp"
#include "runtime/frame/learn.hpp"
#include "runtime/frame/own_pipelines.hpp"
#include "runtime/frame/probe_run.hpp"
#include "runtime/frame/submit.hpp"
#include "runtime/frame/views.hpp"
#include "runtime/frame/world_origin.hpp"
#include "runtime/registry.hpp"

namespace gnomon {

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
    Result<std::string> pipelineCacheData() { return pipelines_->cacheData(); }
    Result<GnView> createView(const GnViewCreateInfo& info);
    void destroyView(GnView view);
    Result<GnVisibility> visibility(GnView view);
    Result<void> setLightMethod(GnLight light, const char* method);
    Result<GnLightMap> lightMap(GnLight light);
    Result<GnSampledShadows> sampledShadows(GnView view, const double* origin); ///< Null: the world's.

    Result<void> addMethod(const char* name, const char* algorithm);
    Result<void> setMethodSetting(const char* method, const char* setting, double value);
    Result<void> registerAlgorithm(const GnAlgorithmInfo& info);
    Result<GnResult> loadPlugin(GnContext self, const char* path);
    const GnPluginInterface* pluginInterface() const { return &pluginInterface_; }
    std::uint32_t methods(const StructArray<GnMethodInfo>& out);
    Result<void> loadRules(std::string_view text, std::string_view fileName);
    Result<void> loadShippedRules(std::string_view name);
    Result<void> setPreset(std::string_view name);
    Result<void> loadKnowledge(std::string_view text, std::string_view fileName);
    void loadShippedKnowledge();

    Result<GnResult> recordFrame(VkCommandBuffer cmd, const GnFrameInfo& info);
    Result<GnResult> beginFrame(const GnFrameInfo& info, FrameMode mode);
    Result<GnResult> finishFrame(std::uint64_t timeoutNs);
    Result<void> dropFrame(std::uint64_t frame);

    Result<GnDecision> decision(GnView view, GnLight light);
    Result<std::string> answer(GnView view, GnLight light, const GnQuestion& question);
    Result<std::string> decisionLog(GnView view, std::uint64_t firstFrame, std::uint64_t frameOrigin);
    Result<GnLightTiming> lightTiming(GnView view, GnLight light);
    Result<GnLightWorkload> lightWorkload(GnView view, GnLight light);
    /// Fill what fits. @return how many there are.
    Result<std::uint32_t> facts(GnView view, GnLight light, const StructArray<GnFact>& out);
    Result<std::uint32_t> candidates(GnView view, GnLight light, const StructArray<GnCandidate>& out);
    std::uint32_t passTimings(std::uint64_t& frame, const StructArray<GnPassTiming>& out);
    Result<std::uint32_t> framePasses(const StructArray<GnPassTiming>& out);
    GnFrameStats stats() const { return frame_.stats; }

    SceneRegistry& scene() { return *scene_; }
    const Messages& messages() const { return messages_; }
    // From any thread.
    LastErrors& lastErrors() { return lastErrors_; }
    void noteLost() { lost_ = true; }
    bool lost() const { return lost_; }

private:
    using Time = std::chrono::steady_clock::time_point;

    explicit Context(const GnContextCreateInfo& info);
    Result<void> init(const GnContextCreateInfo& info);
    void beginPipelineCache(const GnContextCreateInfo& info);
    void sendFindings(std::span<const rules::Diagnostic> findings);

    // A frame, stage by stage (frame.cpp).
    Result<GnResult> startFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd);
    Result<GnResult> runFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd, Time start);
    void openFrame(const GnFrameInfo& info, FrameMode mode, Time start);
    Result<void> decide(const GnFrameInfo& info, std::span<const Caster> casters);
    void beginBudget(const GnFrameInfo& info);
    bool isTimed(const GnFrameInfo& info);
    void finishStats();
    void finishUnderway() noexcept;
    void withdrawFrame(std::uint64_t frame, bool memoryShort);
    void forgetFrame(std::uint64_t frame, bool memoryShort);
    void loseFrame(std::uint64_t frame);
    ChooseParts chooseParts();
    SubmitParts submitParts();

    // Methods.
    template <typename Wanted>
    Result<void> warmUp(Wanted&& wanted); ///< Methods for which wanted(method) holds.
    Result<Method*> usableMethod(const char* name);
    template <typename Add>
    Result<void> admit(const char* name, GnTraits traits, Add&& add); ///< Adds a method that the rules bind to.
    void takeKnowledge(cost::KnowledgeBase base, const std::string& source);
    void teachShared() noexcept;

    // Questions about frames.
    const char* ruleBehind(const View& view, const LightDecision& decision);
    Result<DecisionRecord> recordOf(const View& view, GnLight light, std::uint64_t frame);
    Result<const LightDecision*> findDecision(GnView view, GnLight light);
    Result<std::string> explanation(GnView view, GnLight light, std::uint64_t frame);
    Result<const TimedLight*> timedLight(GnView view, GnLight light); ///< Null: it has not been timed yet.
    GnPassTiming publicTiming(const PassTiming& timing) const;

    Messages messages_;
    bool background_;
    bool timeEveryFrame_;
    // Before everything that may call into them.
    std::vector<std::unique_ptr<SharedObject>> plugins_;
    std::vector<std::unique_ptr<PluginAlgorithm>> pluginAlgorithms_;
    GnPluginInterface pluginInterface_{};

    // The device and what works on it.
    std::unique_ptr<DeviceTable> vk_;
    std::unique_ptr<DeviceMemory> memory_;
    std::unique_ptr<JobSystem> jobs_;
    std::unique_ptr<RayScene> rays_;
    std::unique_ptr<SceneRegistry> scene_;
    std::unique_ptr<SamplerSet> samplers_;
    std::unique_ptr<PipelineStore> pipelines_;
    OwnPipelines own_;
    HostImages images_;

    // Who chooses.
    std::unique_ptr<MethodTable> methods_;
    std::unique_ptr<Selector> selector_;
    std::unique_ptr<FramePlan> plan_;
    AlgorithmRegistry registry_;
    std::shared_ptr<const rules::Engine> askedRules_; ///< By ruleBehind(), and what they infer.
    rules::Inference inference_;

    // Who runs passes.
    FrameArena arena_;
    std::unique_ptr<ResourcePool> pool_;
    std::unique_ptr<PassGraph> graph_;
    std::unique_ptr<PassExecutor> executor_;
    std::unique_ptr<DeviceRays> deviceRays_; ///< Null where the device traces none.

    // Between frames.
    Views views_;
    std::vector<std::uint64_t> sampledImages_; ///< Scratch of sampledShadows().
    LightStates lights_;
    WorldOrigin origin_;
    FrameHistory history_;
    FrameBudget budget_;
    ProbeRun probe_;

    // The newest frame.
    FrameInput input_;
    Frame frame_;
    CountersBefore before_;
    std::uint64_t newest_ = 0;   ///< Newest begun; 0: none.
    std::uint64_t recorded_ = 0; ///< Newest recorded that may still be dropped.
    // How a frame ended that another call had to finish, for its gnFinishShadows(): with a result or an exception.
    std::optional<Result<GnResult>> finishedEarly_;
    std::exception_ptr thrownEarly_;

    std::atomic<bool> lost_ = false;
    bool drained_ = false; ///< drain() has waited.
    bool saidNoClock_ = false;
    LastErrors lastErrors_;
};

} // namespace gnomon
