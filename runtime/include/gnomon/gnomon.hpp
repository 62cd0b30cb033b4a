/** \file gnomon.hpp
\brief The C API for C++20: handles that destroy what they own, spans in place of pointer and count, results that carry
their message.

Header-only, and as thin as it looks: every function is one call of gnomon.h, whose comments hold here too. Nothing
allocates, and nothing throws but gn::Result::value() and gn::Status::require(). Names are those of the C API without
`gn`; calls about a mesh, an instance, a light or a view are its members. Structures are the C API's own, which have
their size and are zero by themselves: `GnLightInfo sun{.direction = {0, -1, 0}}`.

\section gn_hpp_example A first frame

\code{.cpp}
#include <gnomon/gnomon.hpp>

struct Shadows {
    gn::Context context; // before what is made from it: members are destroyed from the last to the first
    gn::Mesh mesh;
    gn::Instance placed;
    gn::Light sun;
    gn::View view;
};

// Throws gn::Failure with the library's sentence. Vertices begin with three floats; three of them are a triangle.
template <typename Vertex>
Shadows startShadows(const GnContextCreateInfo& info, std::span<const Vertex> vertices)
{
    Shadows s{.context = gn::Context::create(info).value()};
    s.context.loadShippedRules("default").require();
    s.mesh = s.context.createMesh(vertices).value();
    s.placed = s.context.createInstance({.flags = GN_INSTANCE_STATIC_BIT, .mesh = s.mesh.get()}).value();
    s.sun = s.context.createLight({.direction = {0, -1, 0}}).value();
    s.view = s.context.createView().value();
    s.context.warmUp().require();
    return s;
}

// Each frame. Tells what serves the sun, or why there is no frame; `camera` has all but lights.
inline const char* drawShadows(const Shadows& s, GnViewFrame camera, uint64_t frame, uint64_t completed)
{
    const GnLight lights[] = {s.sun.get()};
    gn::setLights(camera, lights);
    const gn::Status drawn = s.context.submitShadows({.frame = frame, .completedFrame = completed, .views = {&camera,
1}}); return drawn ? s.view.decision(s.sun)->pMethod : drawn.message();
}
\endcode
*/
#ifndef GNOMON_GNOMON_HPP
#define GNOMON_GNOMON_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>

#include <gnomon/algorithm.h>
#include <gnomon/gnomon.h>
#include <gnomon/handles.hpp>

/** The C++ layer. */
namespace gn {

/** gnResultName(). */
inline const char* name(GnResult result) noexcept
{
    return gnResultName(result);
}

/** gnGetVersion(). */
inline uint32_t version() noexcept
{
    return gnGetVersion();
}

/** gnQueryDeviceNeeds(). The value has the reason where the device cannot run gnomon. */
inline Result<GnDeviceNeeds> queryDeviceNeeds(VkInstance instance, VkPhysicalDevice physicalDevice,
                                              PFN_vkGetInstanceProcAddr getInstanceProcAddr) noexcept
{
    GnDeviceNeeds needs{};
    const GnResult status = gnQueryDeviceNeeds(instance, physicalDevice, getInstanceProcAddr, &needs);
    return {status, status < 0 ? gnResultName(status) : "", needs};
}

/** Lets a view's part of a frame name its lights, which must stay until the call. */
inline void setLights(GnViewFrame& view, std::span<const GnLight> lights) noexcept
{
    view.lightCount = static_cast<uint32_t>(lights.size());
    view.pLights = lights.data();
}

/** GnFrameInfo with spans. */
struct Frame {
    uint64_t frame = 0;                        ///< As GnFrameInfo's, as all of these.
    uint64_t completedFrame = 0;               ///< Newest that the device is done with.
    GnFrameFlags flags = 0;                    ///< Bits of #GnFrameFlagBits.
    float budgetMs = 0.0f;                     ///< 0: that of the rules.
    std::span<const GnViewFrame> views;        ///< One for each camera.
    std::span<const GnSemaphorePoint> waits;   ///< Not for gn::Context::cmdRenderShadows().
    std::span<const GnSemaphorePoint> signals; ///< Not for gn::Context::cmdRenderShadows().

    /** The same for the C API; it points into the spans. */
    GnFrameInfo info() const noexcept
    {
        GnFrameInfo out{};
        out.frame = frame;
        out.completedFrame = completedFrame;
        out.flags = flags;
        out.budgetMs = budgetMs;
        out.viewCount = static_cast<uint32_t>(views.size());
        out.pViews = views.data();
        out.waitCount = static_cast<uint32_t>(waits.size());
        out.pWaits = waits.data();
        out.signalCount = static_cast<uint32_t>(signals.size());
        out.pSignals = signals.data();
        return out;
    }
};

/** A mesh. */
class Mesh : public detail::Owned<GnMesh, &gnDestroyMesh> {
public:
    using Owned::Owned;

    /** gnUpdateMeshPositions(). Each vertex begins with its position, three floats. */
    template <typename Vertex>
    Status updatePositions(std::span<const Vertex> vertices) const noexcept
    {
        detail::checkVertex<Vertex>();
        return done(gnUpdateMeshPositions(context(), get(), reinterpret_cast<const float*>(vertices.data()),
                                          static_cast<uint32_t>(vertices.size()), sizeof(Vertex)));
    }
    /** gnUpdateMeshFromBuffer(); the bounds from before hold. */
    Status updateFromBuffer(const VkDescriptorBufferInfo& positions) const noexcept
    {
        return done(gnUpdateMeshFromBuffer(context(), get(), &positions, nullptr, nullptr));
    }
    /** gnUpdateMeshFromBuffer(). */
    Status updateFromBuffer(const VkDescriptorBufferInfo& positions, std::span<const float, 3> lower,
                            std::span<const float, 3> upper) const noexcept
    {
        return done(gnUpdateMeshFromBuffer(context(), get(), &positions, lower.data(), upper.data()));
    }
};

/** An instance. */
class Instance : public detail::Owned<GnInstance, &gnDestroyInstance> {
public:
    using Owned::Owned;

    /** gnSetInstanceTransform(). */
    Status setTransform(const GnTransform& transform) const noexcept
    {
        return done(gnSetInstanceTransform(context(), get(), &transform));
    }
    /** gnSetInstanceBounds(). */
    Status setBounds(std::span<const float, 3> lower, std::span<const float, 3> upper) const noexcept
    {
        return done(gnSetInstanceBounds(context(), get(), lower.data(), upper.data()));
    }
    /** gnSetInstanceCasterMask(). */
    Status setCasterMask(uint32_t casterMask) const noexcept
    {
        return done(gnSetInstanceCasterMask(context(), get(), casterMask));
    }
    /** gnSetInstanceMesh(). */
    Status setMesh(const Mesh& mesh) const noexcept { return done(gnSetInstanceMesh(context(), get(), mesh.get())); }
};

/** A light. */
class Light : public detail::Owned<GnLight, &gnDestroyLight> {
public:
    using Owned::Owned;

    /** gnUpdateLight(). */
    Status update(const GnLightInfo& info) const noexcept { return done(gnUpdateLight(context(), get(), &info)); }
    /** gnSetLightMethod(); null hands the light back to the rules. */
    Status setMethod(const char* method) const noexcept { return done(gnSetLightMethod(context(), get(), method)); }
    /** gnGetLightMap(). */
    Result<GnLightMap> map() const noexcept
    {
        return detail::filled<GnLightMap>(context(), [&](auto* out) { return gnGetLightMap(context(), get(), out); });
    }
};

/** A view, and what is known of lights in it. */
class View : public detail::Owned<GnView, &gnDestroyView> {
public:
    using Owned::Owned;

    /** gnGetVisibility(). */
    Result<GnVisibility> visibility() const noexcept
    {
        return detail::filled<GnVisibility>(context(),
                                            [&](auto* out) { return gnGetVisibility(context(), get(), out); });
    }
    /** gnGetSampledShadows(). \param origin Three numbers, or null. */
    Result<GnSampledShadows> sampledShadows(const double* origin = nullptr) const noexcept
    {
        return detail::filled<GnSampledShadows>(
            context(), [&](auto* out) { return gnGetSampledShadows(context(), get(), origin, out); });
    }
    /** gnGetDecision(). */
    Result<GnDecision> decision(const Light& light) const noexcept
    {
        return detail::filled<GnDecision>(context(),
                                          [&](auto* out) { return gnGetDecision(context(), get(), light.get(), out); });
    }
    /** gnGetFacts(): what of `room` was filled. */
    Result<std::span<GnFact>> facts(const Light& light, std::span<GnFact> room) const noexcept
    {
        return detail::listed<uint32_t>(
            context(), room, [&](auto* n, auto* out) { return gnGetFacts(context(), get(), light.get(), n, out); });
    }
    /** gnGetCandidates(): what of `room` was filled, one for each method where it is large enough. */
    Result<std::span<GnCandidate>> candidates(const Light& light, std::span<GnCandidate> room) const noexcept
    {
        return detail::listed<uint32_t>(context(), room, [&](auto* n, auto* out) {
            return gnGetCandidates(context(), get(), light.get(), n, out);
        });
    }
    /** gnExplain(): what of `room` was filled, without the zero that ends it. A null question asks why. */
    Result<std::string_view> explain(const Light& light, std::span<char> room,
                                     const GnQuestion* question = nullptr) const noexcept
    {
        std::size_t size = room.size();
        const GnResult status =
            gnExplain(context(), get(), light.get(), question, &size, room.empty() ? nullptr : room.data());
        const std::size_t written = std::min(size, room.size());
        const std::string_view text(room.data(), status < 0 || written == 0 ? 0 : written - 1);
        return detail::done(context(), status == GN_SUCCESS && size > room.size() ? GN_INCOMPLETE : status, text);
    }
    /** Room that explain() needs, in bytes. */
    Result<std::size_t> explanationSize(const Light& light, const GnQuestion* question = nullptr) const noexcept
    {
        return detail::counted<std::size_t>(
            context(), [&](auto* n, char* out) { return gnExplain(context(), get(), light.get(), question, n, out); });
    }
    /** gnGetDecisionLog(): all of it, or nothing and #GN_INCOMPLETE. */
    Result<std::span<std::byte>> decisionLog(std::span<std::byte> room, uint64_t firstFrame = 0,
                                             uint64_t frameOrigin = 0) const noexcept
    {
        return detail::listed<std::size_t>(context(), room, [&](auto* n, auto* out) {
            return gnGetDecisionLog(context(), get(), firstFrame, frameOrigin, n, out);
        });
    }
    /** Room that decisionLog() needs, in bytes. */
    Result<std::size_t> decisionLogSize(uint64_t firstFrame = 0, uint64_t frameOrigin = 0) const noexcept
    {
        return detail::counted<std::size_t>(context(), [&](auto* n, void* out) {
            return gnGetDecisionLog(context(), get(), firstFrame, frameOrigin, n, out);
        });
    }
    /** gnGetLightTiming(). */
    Result<GnLightTiming> timing(const Light& light) const noexcept
    {
        return detail::filled<GnLightTiming>(
            context(), [&](auto* out) { return gnGetLightTiming(context(), get(), light.get(), out); });
    }
    /** gnGetLightWorkload(). */
    Result<GnLightWorkload> workload(const Light& light) const noexcept
    {
        return detail::filled<GnLightWorkload>(
            context(), [&](auto* out) { return gnGetLightWorkload(context(), get(), light.get(), out); });
    }
};

/** Timings of the passes of one frame. */
struct PassTimings {
    uint64_t frame = 0;             ///< Whose they are; 0: of none yet.
    std::span<GnPassTiming> passes; ///< What of the room was filled.
};

/** A context. It must outlive what is made from it. */
class Context {
public:
    /** Null. */
    Context() noexcept = default;
    /** Takes over a context of the C API. */
    explicit Context(GnContext context) noexcept : context_(context) {}
    /** gnCreateContext(). GnContextCreateInfo::pfnMessage is told what went wrong; here is the result's name. */
    static Result<Context> create(const GnContextCreateInfo& info) noexcept
    {
        GnContext made = nullptr;
        const GnResult status = gnCreateContext(&info, &made);
        return {status, status < 0 ? gnResultName(status) : "", Context(made)};
    }

    /** For the C API. */
    GnContext get() const noexcept { return context_.get(); }
    /** There is one. */
    explicit operator bool() const noexcept { return get() != nullptr; }
    /** Destroys it now. */
    void reset() noexcept { context_.reset(); }
    /** Hands it out, to be destroyed by the caller. */
    [[nodiscard]] GnContext release() noexcept { return context_.release(); }

    /** gnGetLastError(). */
    const char* lastError() const noexcept { return gnGetLastError(get()); }
    /** gnWarmUp(). */
    Status warmUp() const noexcept { return done(gnWarmUp(get())); }
    /** gnWarmUpMethod(). */
    Status warmUp(const char* method) const noexcept { return done(gnWarmUpMethod(get(), method)); }
    /** gnGetPipelineCacheData(): all of it, or nothing and #GN_INCOMPLETE. */
    Result<std::span<std::byte>> pipelineCacheData(std::span<std::byte> room) const noexcept
    {
        return detail::listed<std::size_t>(get(), room,
                                           [&](auto* n, auto* out) { return gnGetPipelineCacheData(get(), n, out); });
    }
    /** Room that pipelineCacheData() needs, in bytes. */
    Result<std::size_t> pipelineCacheSize() const noexcept
    {
        return detail::counted<std::size_t>(get(),
                                            [&](auto* n, void* out) { return gnGetPipelineCacheData(get(), n, out); });
    }

    /** gnCreateMesh(). */
    Result<Mesh> createMesh(const GnMeshCreateInfo& info) const noexcept
    {
        return made<Mesh, GnMesh>([&](auto* out) { return gnCreateMesh(get(), &info, out); });
    }
    /** gnCreateMesh() of vertices that begin with their position, three floats. Without indices, each three of them are
    a triangle. */
    template <typename Vertex>
    Result<Mesh> createMesh(std::span<const Vertex> vertices, std::span<const uint32_t> indices = {},
                            const char* name = nullptr) const noexcept
    {
        detail::checkVertex<Vertex>();
        GnMeshCreateInfo info{};
        info.pName = name;
        info.pPositions = reinterpret_cast<const float*>(vertices.data());
        info.positionCount = static_cast<uint32_t>(vertices.size());
        info.positionStride = sizeof(Vertex);
        info.indexCount = static_cast<uint32_t>(indices.size());
        info.pIndices = indices.data();
        return createMesh(info);
    }
    /** gnCreateInstance(). */
    Result<Instance> createInstance(const GnInstanceCreateInfo& info) const noexcept
    {
        return made<Instance, GnInstance>([&](auto* out) { return gnCreateInstance(get(), &info, out); });
    }
    /** gnCreateInstances(), as many as there are transforms, into handles of the C API: Instance(context, handle) takes
    one over. */
    Status createInstances(const GnInstanceCreateInfo& info, std::span<const GnTransform> transforms,
                           std::span<GnInstance> instances) const noexcept
    {
        if (instances.size() != transforms.size()) return differ();
        return done(gnCreateInstances(get(), &info, static_cast<uint32_t>(transforms.size()), transforms.data(),
                                      instances.data()));
    }
    /** gnCreateInstances() of info.pTransformBuffer, which holds as many transforms as there are handles. */
    Status createInstances(const GnInstanceCreateInfo& info, std::span<GnInstance> instances) const noexcept
    {
        return done(
            gnCreateInstances(get(), &info, static_cast<uint32_t>(instances.size()), nullptr, instances.data()));
    }
    /** gnUpdateInstancesFromBuffer(). */
    Status updateInstances(std::span<const GnInstance> instances, const GnTransformBuffer& transforms) const noexcept
    {
        return done(
            gnUpdateInstancesFromBuffer(get(), static_cast<uint32_t>(instances.size()), instances.data(), &transforms));
    }
    /** gnSetInstanceTransforms(). */
    Status setTransforms(std::span<const GnInstance> instances, std::span<const GnTransform> transforms) const noexcept
    {
        if (instances.size() != transforms.size()) return differ();
        return done(gnSetInstanceTransforms(get(), static_cast<uint32_t>(transforms.size()), instances.data(),
                                            transforms.data()));
    }
    /** gnCreateLight(). */
    Result<Light> createLight(const GnLightInfo& info) const noexcept
    {
        return made<Light, GnLight>([&](auto* out) { return gnCreateLight(get(), &info, out); });
    }
    /** gnCreateView(). */
    Result<View> createView(const GnViewCreateInfo& info = {}) const noexcept
    {
        return made<View, GnView>([&](auto* out) { return gnCreateView(get(), &info, out); });
    }

    /** gnCmdRenderShadows(). */
    Status cmdRenderShadows(VkCommandBuffer commandBuffer, const Frame& frame) const noexcept
    {
        const GnFrameInfo info = frame.info();
        return done(gnCmdRenderShadows(get(), commandBuffer, &info));
    }
    /** gnDropFrame(). */
    Status dropFrame(uint64_t frame) const noexcept { return done(gnDropFrame(get(), frame)); }
    /** gnBeginShadows(). */
    Status beginShadows(const Frame& frame) const noexcept
    {
        const GnFrameInfo info = frame.info();
        return done(gnBeginShadows(get(), &info));
    }
    /** gnFinishShadows(). */
    Status finishShadows(uint64_t timeoutNs = UINT64_MAX) const noexcept
    {
        return done(gnFinishShadows(get(), timeoutNs));
    }
    /** gnSubmitShadows(). */
    Status submitShadows(const Frame& frame) const noexcept
    {
        const GnFrameInfo info = frame.info();
        return done(gnSubmitShadows(get(), &info));
    }

    /** gnEnumerateMethods(): what of `room` was filled. */
    Result<std::span<GnMethodInfo>> methods(std::span<GnMethodInfo> room) const noexcept
    {
        return detail::listed<uint32_t>(get(), room,
                                        [&](auto* n, auto* out) { return gnEnumerateMethods(get(), n, out); });
    }
    /** How many methods there are. */
    Result<uint32_t> methodCount() const noexcept
    {
        return detail::counted<uint32_t>(get(),
                                         [&](auto* n, GnMethodInfo* out) { return gnEnumerateMethods(get(), n, out); });
    }
    /** gnAddMethod(). */
    Status addMethod(const char* name, const char* algorithm) const noexcept
    {
        return done(gnAddMethod(get(), name, algorithm));
    }
    /** gnSetMethodSetting(). */
    Status setMethodSetting(const char* method, const char* setting, double value) const noexcept
    {
        return done(gnSetMethodSetting(get(), method, setting, value));
    }
    /** gnLoadRules(). */
    Status loadRules(std::string_view text, const char* fileName = nullptr) const noexcept
    {
        return done(gnLoadRules(get(), text.data(), text.size(), fileName));
    }
    /** gnLoadShippedRules(). */
    Status loadShippedRules(const char* name) const noexcept { return done(gnLoadShippedRules(get(), name)); }
    /** gnSetPreset(); null is the base as it stands. */
    Status setPreset(const char* name) const noexcept { return done(gnSetPreset(get(), name)); }
    /** gnLoadKnowledge(). */
    Status loadKnowledge(std::string_view text, const char* fileName = nullptr) const noexcept
    {
        return done(gnLoadKnowledge(get(), text.data(), text.size(), fileName));
    }
    /** gnLoadShippedKnowledge(). */
    Status loadShippedKnowledge() const noexcept { return done(gnLoadShippedKnowledge(get())); }

    /** gnGetPassTimings(). */
    Result<PassTimings> passTimings(std::span<GnPassTiming> room) const noexcept
    {
        PassTimings out;
        const auto read = detail::listed<uint32_t>(
            get(), room, [&](auto* n, auto* passes) { return gnGetPassTimings(get(), &out.frame, n, passes); });
        out.passes = *read;
        return detail::done(get(), read.status(), out);
    }
    /** gnGetFramePasses(): what of `room` was filled. */
    Result<std::span<GnPassTiming>> framePasses(std::span<GnPassTiming> room) const noexcept
    {
        return detail::listed<uint32_t>(get(), room,
                                        [&](auto* n, auto* out) { return gnGetFramePasses(get(), n, out); });
    }
    /** gnGetFrameStats(). */
    Result<GnFrameStats> frameStats() const noexcept
    {
        return detail::filled<GnFrameStats>(get(), [&](auto* out) { return gnGetFrameStats(get(), out); });
    }

    /** gnRegisterAlgorithm(). */
    Status registerAlgorithm(const GnAlgorithmInfo& info) const noexcept
    {
        return done(gnRegisterAlgorithm(get(), &info));
    }
    /** gnGetPluginInterface(). */
    Result<const GnPluginInterface*> pluginInterface() const noexcept
    {
        return detail::filled<const GnPluginInterface*>(get(),
                                                        [&](auto* out) { return gnGetPluginInterface(get(), out); });
    }
    /** gnLoadPlugin(). */
    Status loadPlugin(const char* path) const noexcept { return done(gnLoadPlugin(get(), path)); }

private:
    Status done(GnResult status) const noexcept { return detail::done(get(), status); }
    static Status differ() noexcept { return {GN_ERROR_OUT_OF_RANGE, "instances and transforms differ in number"}; }

    template <typename Object, typename Handle, typename Make>
    Result<Object> made(Make&& make) const noexcept
    {
        Handle handle = VK_NULL_HANDLE;
        const GnResult status = make(&handle);
        return detail::done(get(), status, Object(get(), handle));
    }

    struct Destroy {
        void operator()(GnContext context) const noexcept { gnDestroyContext(context); }
    };
    std::unique_ptr<std::remove_pointer_t<GnContext>, Destroy> context_;
};

} // namespace gn
#endif /* GNOMON_GNOMON_HPP */
