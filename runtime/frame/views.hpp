#pragma once
// Views and lights between frames, and what a frame makes of a view: its camera, its images, its visibility.
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "runtime/accel/device_rays.hpp"
#include "runtime/base/slot_map.hpp"
#include "runtime/frame/host_images.hpp"
#include "runtime/passes/resources.hpp"
#include "runtime/select/depth_grid.hpp"
#include "runtime/select/drawn_map.hpp"
#include "runtime/select/record.hpp"
#include "runtime/store/scene_registry.hpp"
#include "shaders/shared/shadow_sample.h"

namespace gnomon {

class FramePlan;
struct Frame;
struct ViewFrame;

/// What gnGetSampledShadows() hands out, by light of the view's newest frame.
struct SampledLights {
    std::vector<gpu::ShadowSample> samples;
    std::vector<VkImageView> maps;
    std::vector<const char*> methods;
    std::vector<std::uint64_t> images; ///< What tells whether `maps` changed; handles may come back.
    std::uint64_t revision = 0;
};

/// A view between frames.
struct View {
    std::string name;
    GnView handle = VK_NULL_HANDLE;
    std::uint32_t id = 0;
    std::uint32_t maxLights = 16;
    bool packed = false; ///< GN_VIEW_PACKED_BIT.
    std::unique_ptr<PooledImage> visibility;
    std::unique_ptr<PooledImage> replaced; ///< Was `visibility` before the newest frame, which may yet be withdrawn.
    bool resized = false;                  ///< The newest frame made `visibility`.
    std::uint64_t madeIn = 0;              ///< Frame that made `visibility`.
    std::uint64_t replacedMadeIn = 0;      ///< The same of `replaced`.
    std::uint64_t revision = 0;
    std::unique_ptr<DepthGrid> grid;
    std::unordered_map<std::uint32_t, LightMemory> lights; ///< By light id.
    std::vector<LightDecision> decisions;                  ///< Of the last frame, in the order of its lights.
    std::vector<Candidate> candidates;                     ///< Of the decisions, light by light.
    RecordRing records;                                    ///< Of the last frames.
    CameraView camera;                                     ///< Of the frame under way.
    std::uint64_t movedIn = 0;                             ///< The newest frame in which its eye moved or turned.
    SampledLights sampled;                                 ///< As hosts were told last.
    std::uint64_t lastFrame = 0;                           ///< The newest whose lights were decided.
};

/// After which a view is at rest, as lights are (MotionHistory::rests()).
constexpr std::uint64_t kRestFrames = 4;

/// The views of a context.
class Views {
public:
    Result<GnView> add(const GnViewCreateInfo& info, const DeviceTable& vk, DeviceMemory& memory, ResourcePool& pool);
    View* find(GnView handle);

    /// Has room for what take() keeps; so that may not fail.
    void makeRoomToTake();
    /// The view leaves. Its depth grid stays until `frame` is completed: its buffers may be in flight as long.
    std::unique_ptr<View> take(GnView handle, std::uint64_t frame) noexcept;
    void release(std::uint64_t completedFrame);

    /// Calls body(view) for every view.
    template <typename Body>
    void forEach(Body&& body)
    {
        views_.forEach([&](std::unique_ptr<View>& view) { body(*view); });
    }

private:
    struct RetiredGrid {
        std::uint64_t frame;
        std::unique_ptr<DepthGrid> grid;
    };
    SlotMap<std::unique_ptr<View>> views_;
    std::vector<RetiredGrid> retiredGrids_;
    std::uint32_t nextId_ = 1;
};

/// What is known of a light whatever the view.
struct LightState {
    MotionHistory motion;
    MapSide mapSide;
    double wishedSide = 0.0;     ///< Largest of the frame's views.
    std::uint64_t sideFrame = 0; ///< In which the side was settled last.
    bool sideKnown = false;      ///< A receiver has been visible since the last camera cut.
    SideRequest maps;            ///< Of all of the frame's views.
    DrawnMap drawn;
    std::uint32_t pinned = UINT32_MAX;
    GnLight handle = VK_NULL_HANDLE; ///< Of a light that was pinned.
    std::uint64_t lastFrame = 0;
    UnbuiltCasters unbuilt;
};
using LightStates = std::unordered_map<std::uint32_t, LightState>; ///< By light id.

/// Now and then: forgets lights that no frame has asked for in a while.
void forgetOldLights(Views& views, LightStates& lights, const SceneRegistry& scene, FramePlan& plan,
                     std::uint64_t frame);

/// What opening a view takes.
struct ViewParts {
    ResourcePool& pool;
    PassGraph& graph;
    const std::array<double, 3>& origin;
    std::span<const Caster> casters; ///< That may be seen.
    HostImages& images;
};
/// The view's camera, its images, and visibility of the size of this frame. @param index in frame.views
Result<void> openView(Frame& frame, std::uint32_t index, const GnViewFrame& given, const ViewParts& parts);

/// The frame that these views were in stands, and with it the visibility images that it made.
void keepVisibility(std::span<const ViewFrame> views, ResourcePool& pool, std::uint64_t newest);
/// It does not: what hosts find is what they found before, unless another attempt may need its place.
void restoreVisibility(std::span<const ViewFrame> views, ResourcePool& pool, std::uint64_t newest, bool memoryShort);
/// The same once another attempt has failed: what was before the frame is not known any more.
void loseVisibility(View& view, ResourcePool& pool, std::uint64_t frame);

} // namespace gnomon
