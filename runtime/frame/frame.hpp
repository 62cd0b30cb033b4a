#pragma once
// One frame, as it goes from stage to stage:
//
//     readFrame -> openView -> measureFacts -> choose -> declareLights -> submitFrame -> learn
//
// A stage is a function of the frame and of the parts of the context that it names. Vectors keep their memory, so that
// a steady frame allocates nothing.
#include <cstdint>
#include <vector>

#include "runtime/frame/views.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/plan/plan.hpp"
#include "runtime/select/fade.hpp"
#include "runtime/select/selector.hpp"

namespace gnomon {

enum class FrameMode : std::uint8_t { recorded, begin, submit };

/// What the host said of a frame, once it has been checked.
struct FrameInput {
    std::vector<View*> views; ///< In the order of GnFrameInfo::pViews.
    std::vector<VkSemaphoreSubmitInfo> waits, signals;
};

/// A view in one frame.
struct ViewFrame {
    View* view = nullptr;
    ImageId depth, normals, motion, visibility;
    ImageId packed;           ///< What the host sees, of a packed view; `visibility` is then gnomon's own.
    std::uint32_t lights = 0; ///< Layers of `visibility` in use.
};

/// The casters of a light, found once whatever the views.
struct LightFrame {
    std::uint32_t id;
    GnLight handle;
    LightCasters casters;
};

/// A light of a view, from facts to passes.
struct ViewLight {
    std::uint32_t viewIndex; ///< In Frame::views.
    std::uint32_t layer;     ///< Of the view's visibility.
    const LightView* light;
    const LightCasters* casters;
    LightMemory* memory;
    LightState* state;
    SelectionInput facts;
    LightDecision* decision = nullptr; ///< From the choice on; lies in View::decisions.
};

/// Of a light in a view as declared, for gnGetLightMap() and gnGetSampledShadows().
struct DeclaredMap {
    std::uint32_t lightId;
    std::uint32_t viewIndex; ///< In Frame::views.
    const char* method;      ///< Whose map it is.
    bool beside;             ///< Only for hosts' shaders: the method that serves the light looks none up.
    ShadowAlgorithm::Map map;
};

struct Frame {
    std::uint64_t number = 0;
    FrameMode mode = FrameMode::submit;
    std::vector<ViewFrame> views;
    std::vector<PooledImage*> visibilities, imports; ///< Of the views.
    std::vector<LightFrame> casters;                 ///< By light.
    std::vector<ViewLight> lights;                   ///< View by view.
    std::vector<std::uint32_t> planned;              ///< Of `lights`, those that a method may serve.

    plan::PlanReport plan;
    double predictedMs = 0.0;          ///< Of the methods that serve.
    std::vector<FadeRequest> fades;    ///< As `lights`.
    std::uint32_t warmup = UINT32_MAX; ///< Whose pipelines run for the first time.

    std::vector<DeclaredMap> maps;
    std::vector<PooledImage*> lightMaps; ///< Theirs, each once.
    bool raysNeeded = false;
    bool dropped = false; ///< It failed, or was taken back: nobody will see it.

    GnFrameStats stats{};

    /// Of any view.
    bool cameraCut() const;
    /// A frame begins: nothing of the one before is left but memory, and its plan until there is another.
    void begin(std::uint64_t frame, FrameMode how);
};

/// LightDecision::noFade of a light whose outgoing method cannot run.
inline constexpr const char* kCannotServe = "the method before can no longer serve";

/// The pass that mixes the two methods of a fading light.
inline constexpr const char* kFadePass = "view.fade";

/// The pipelines of the runtime itself have an owner of their own in the store.
constexpr std::uint32_t kRuntimeOwner = kMaxMethods;
/// Those that read meshes out of buffers: made with the first of these, and warmed up by no frame. Behind those of host
/// images.
constexpr std::uint32_t kMeshOwner = 2 * kMaxMethods;

} // namespace gnomon
