/** \file gnomon.h
\brief Adaptive shadows for Vulkan renderers.

A host registers geometry and lights once, hands over camera and depth every frame, and gets back a *visibility* image
per view: one layer per light, 1 = lit, 0 = umbra. Behind that call stand many shadow algorithms; fuzzy rules pick, for
every light and every frame, which *method* (an algorithm with settings) runs, and say why.

    gnCreateContext -> gnLoadRules -> gnCreateMesh, gnCreateInstance, gnCreateLight, gnCreateView
    each frame: gnSubmitShadows (or gnCmdRenderShadows into your command buffer), then sample gnGetVisibility()

Conventions. Column vectors, metres, right-handed world space; 4x4 matrices are column-major, rotations and bases of 9 or
12 numbers row-major, as each says. Zero the whole structure, then
set what differs from the defaults; a member that is 0 or null means its default. Numbers are finite; positions, lengths
and factors are at most 1e18 (a light of unlimited range has range 0). On failure outputs are null or zero and nothing has
changed, unless a call says otherwise. No C++ exception leaves these functions, and the host's locale and floating-point
mode are neither read nor changed.

Threads: mesh and instance calls from any thread; all other calls one at a time per context. Callbacks must not call
gnomon.
*/
#ifndef GNOMON_GNOMON_H
#define GNOMON_GNOMON_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#if defined(_WIN32)
#define GN_CALL __stdcall
#define GN_EXPORT __declspec(dllexport)
#else
#define GN_CALL
#define GN_EXPORT __attribute__((visibility("default")))
#endif
#ifndef GN_API
#define GN_API GN_EXPORT
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define GN_VERSION_MAJOR 0
#define GN_VERSION_MINOR 1
#define GN_VERSION_PATCH 0
/** Of this header. */
#define GN_VERSION VK_MAKE_API_VERSION(0, GN_VERSION_MAJOR, GN_VERSION_MINOR, GN_VERSION_PATCH)

/** One library instance on one device. */
VK_DEFINE_HANDLE(GnContext)
/** Triangles in object space. Carries a generation: a stale handle is an error, never another mesh. */
VK_DEFINE_NON_DISPATCHABLE_HANDLE(GnMesh)
/** A mesh (or a host-drawn caster) placed in the world. */
VK_DEFINE_NON_DISPATCHABLE_HANDLE(GnInstance)
/** A light of one of the three kinds. */
VK_DEFINE_NON_DISPATCHABLE_HANDLE(GnLight)
/** One camera's visibility image and what is remembered for it between frames. */
VK_DEFINE_NON_DISPATCHABLE_HANDLE(GnView)

/* --- results and messages ------------------------------------------------------------------------------------- */

/** Zero is success, positive is success with a remark, negative is failure. */
typedef enum GnResult {
    GN_SUCCESS = 0,
    GN_NOT_READY = 1,  ///< Only while no method at all is ready; visibility is 1 everywhere meanwhile.
    GN_TIMEOUT = 2,    ///< gnFinishShadows: host passes still run; call it again.
    GN_INCOMPLETE = 3, ///< The array or buffer was too small; what fits was written.
    GN_ERROR_UNKNOWN = -1,
    GN_ERROR_OUT_OF_HOST_MEMORY = -2,
    GN_ERROR_OUT_OF_DEVICE_MEMORY = -3,
    GN_ERROR_DEVICE_LOST = -4,      ///< Vulkan said so, or the device hangs (GnContextCreateInfo::waitLimitMs). Every
                                    ///< call but destruction returns it from then on.
    GN_ERROR_INVALID_HANDLE = -5,   ///< A handle of an object is null, foreign or already destroyed.
    GN_ERROR_NULL_ARGUMENT = -6,    ///< A required pointer, or the context, is null.
    GN_ERROR_NOT_A_NUMBER = -7,     ///< NaN in the input.
    GN_ERROR_INFINITE = -8,         ///< Infinity where a finite value is needed.
    GN_ERROR_OUT_OF_RANGE = -9,     ///< A finite value outside its range, or an index past its array.
    GN_ERROR_EMPTY = -10,           ///< A mesh without triangles, a view of no pixels.
    GN_ERROR_TOO_MANY = -11,        ///< More lights, views, methods (32) or triangles than agreed or than fit.
    GN_ERROR_FEATURE_MISSING = -12, ///< The device lacks, or was created without, something required.
    GN_ERROR_RULES = -13,           ///< The rule base has errors; the last good one stays in force.
    GN_ERROR_UNKNOWN_METHOD = -14,  ///< No method, algorithm or setting of that name, or none for this kind of light.
    GN_ERROR_FRAME_ORDER = -15,     ///< Frames not growing by one, memory of a frame in flight, calls out of order.
    GN_ERROR_UNSUPPORTED = -16,     ///< Built without the part that is needed (Embree, OpenMesh, YAML).
    GN_ERROR_KNOWLEDGE = -17,       ///< The knowledge base cannot be used; what was known before stays.
    GN_RESULT_MAX_ENUM = 0x7FFFFFFF
} GnResult;

typedef enum GnSeverity {
    GN_SEVERITY_INFO = 0,
    GN_SEVERITY_WARNING = 1,
    GN_SEVERITY_ERROR = 2,
    GN_SEVERITY_MAX_ENUM = 0x7FFFFFFF
} GnSeverity;

/** What went wrong or is worth knowing. Strings live during the callback only. */
typedef struct GnMessage {
    GnSeverity severity;
    GnResult result;   ///< The result the call is about to return, or #GN_SUCCESS for remarks.
    const char* pId;   ///< Stable identifier such as "MeshIndexOutOfRange".
    const char* pText; ///< A sentence naming the value at fault and the object's pName.
} GnMessage;

/** Called on the thread that caused the message; a worker thread for background work. Must not call gnomon. */
typedef void(GN_CALL* PFN_gnMessage)(const GnMessage* pMessage, void* pUserData);

/** \brief #GN_VERSION of the library. Structures are those of one version: a host that may meet another library than the
one it was compiled with compares the two before it creates a context. Any thread. */
GN_API uint32_t GN_CALL gnGetVersion(void);

/* --- device and context --------------------------------------------------------------------------------------- */

/** What gnomon wants from vkCreateDevice. Names are static. */
typedef struct GnDeviceNeeds {
    uint32_t apiVersion;                   ///< Lowest usable VK_API_VERSION (1.3).
    VkPhysicalDeviceFeatures required;     ///< Core features that must be enabled (none at present).
    VkPhysicalDeviceFeatures optional;     ///< Core features that make more methods eligible and that the device has.
    uint32_t optionalExtensionCount;       ///< Extensions the device has and some method can use.
    const char* ppOptionalExtensions[8];   ///< First `optionalExtensionCount` are set.
    VkBool32 supported;                    ///< The device can run gnomon at all.
    char reason[256];                      ///< Why not, if not.
} GnDeviceNeeds;

/** \brief Says what to enable before the device exists. dynamicRendering, synchronization2 and timelineSemaphore are
required besides what the structure lists.
\return #GN_ERROR_FEATURE_MISSING with `reason` filled if the device cannot run gnomon. */
GN_API GnResult GN_CALL gnQueryDeviceNeeds(VkInstance instance, VkPhysicalDevice physicalDevice,
                                           PFN_vkGetInstanceProcAddr pfnGetInstanceProcAddr, GnDeviceNeeds* pNeeds);

/** Serialises queue access with the host's other threads. */
typedef void(GN_CALL* PFN_gnQueueLock)(VkQueue queue, void* pUserData);
/** One piece of work for the host's job system. */
typedef void(GN_CALL* PFN_gnJob)(void* pJob);
/** Runs `pfnJob(pJob)` once, on any thread but the calling one, soon. gnomon waits for its jobs. */
typedef void(GN_CALL* PFN_gnScheduleJob)(PFN_gnJob pfnJob, void* pJob, void* pUserData);
/** Called on each thread of gnomon's own pool, the index-th, before it works: its name, its priority and the processors
it may use are the host's to set. On two cores a worker and its caller that are kept apart never wait for one another on
one of them while the other idles. Must not call gnomon. */
typedef void(GN_CALL* PFN_gnThreadStarted)(uint32_t index, void* pUserData);

typedef enum GnContextCreateFlagBits {
    GN_CONTEXT_TIME_EVERY_FRAME_BIT = 0x1, ///< Every frame is a timed one (see gnGetPassTimings()); for measuring.
    GN_CONTEXT_NO_BACKGROUND_BIT = 0x2,    ///< Topology, trees and pipelines are built inside the calls that need
                                           ///< them: reproducible runs and tests.
    GN_CONTEXT_CREATE_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnContextCreateFlagBits;
typedef VkFlags GnContextCreateFlags;

/** Describes a new #GnContext. */
typedef struct GnContextCreateInfo {
    GnContextCreateFlags flags;                        ///< Bits of #GnContextCreateFlagBits.
    const char* pName;                                 ///< Optional. Messages begin with it and a colon.
    VkInstance instance;                               ///< Required. Borrowed until gnDestroyContext().
    VkPhysicalDevice physicalDevice;                   ///< Required.
    VkDevice device;                                   ///< Required. See gnQueryDeviceNeeds().
    VkQueue queue;                                     ///< Required. Graphics and compute; touched only inside calls.
    uint32_t queueFamilyIndex;                         ///< Family of `queue`.
    uint32_t apiVersion;                               ///< Required. The version given to vkCreateInstance, >= 1.3.
    const VkPhysicalDeviceFeatures2* pEnabledFeatures; ///< Required. The chain given to vkCreateDevice;
    uint32_t enabledExtensionCount;                    ///< Vulkan cannot be asked for either afterwards,
    const char* const* ppEnabledExtensionNames;        ///< so the host repeats them here.
    PFN_vkGetInstanceProcAddr pfnGetInstanceProcAddr;  ///< Required. gnomon links no loader of its own.
    PFN_gnQueueLock pfnLockQueue;                      ///< Optional. Called around every submit, on its thread.
    PFN_gnQueueLock pfnUnlockQueue;                    ///< Optional, with pfnLockQueue.
    uint32_t visibilityQueueFamilyCount;               ///< Other families that read visibility; 0: only ours.
    const uint32_t* pVisibilityQueueFamilies;
    uint32_t framesInFlight;                           ///< 0 means 2. [1, 8]. A frame begins when the frame this many
                                                       ///< before it is completed (GnFrameInfo::completedFrame).
    VkDeviceSize memoryLimit;                          ///< Device bytes, persistent plus transient; 0: half the heap.
    const VkAllocationCallbacks* pAllocationCallbacks; ///< Optional, copied. Handed to every Vulkan create call.
    VkPipelineCache pipelineCache;                     ///< Optional: all pipelines are made with it, on worker threads
                                                       ///< too (not EXTERNALLY_SYNCHRONIZED). Borrowed, the host's
                                                       ///< to fill, save and destroy. Null: one of gnomon's own.
    PFN_gnScheduleJob pfnScheduleJob;                  ///< Optional. Absent: gnomon runs one pool of its own.
    uint32_t jobThreadCount;                           ///< Threads that may work at once, the calling one counted in;
                                                       ///< 0: as many as cores. 1: all work in the calls, as with
                                                       ///< #GN_CONTEXT_NO_BACKGROUND_BIT, and no thread is started.
    PFN_gnThreadStarted pfnThreadStarted;              ///< Optional. Not called where pfnScheduleJob is given.
    PFN_gnMessage pfnMessage;                          ///< Optional. Absent means silent.
    void* pUserData;                                   ///< Given to all callbacks above.
    uint32_t waitLimitMs;                              ///< 0 means 10 000. A call that waits for the device ends with
                                                       ///< #GN_ERROR_DEVICE_LOST once the device has made no progress
                                                       ///< for so long. What a submitted frame's pWaits delay counts.
} GnContextCreateInfo;

/** \brief Creates a context. No method is ready at first; see gnWarmUp(). What went wrong is told to `pfnMessage` alone. */
GN_API GnResult GN_CALL gnCreateContext(const GnContextCreateInfo* pCreateInfo, GnContext* pContext);

/** \brief Destroys the context and all that was made from it. Null is allowed.

The one call that waits for all that is on the context's queue; gnWarmUp(), and frames with round trips, wait for what
they submitted themselves. Recorded frames must have been
submitted there or never be; what the host reads of visibility on other queues must be finished. Where the device makes no
progress for GnContextCreateInfo::waitLimitMs, the context's Vulkan objects are left undestroyed, since it may still use
them; a message says so. */
GN_API void GN_CALL gnDestroyContext(GnContext context);

/** \brief Name of a result, such as "GN_ERROR_EMPTY". Never null. */
GN_API const char* GN_CALL gnResultName(GnResult result);

/** \brief The sentence of the calling thread's last failed call on this context, valid until the thread's next call on it.
Never null; empty where none failed. From any thread. */
GN_API const char* GN_CALL gnGetLastError(GnContext context);

/** \brief Compiles and runs once every method that the enabled device can run, and waits for meshes in preparation.
Compiles on all job threads; submits to the queue and waits for those submits; for loading screens. Without it, one method
a frame becomes ready: those that serve while others are not ready, then those that lights are pinned to, then, unless all
lights are pinned and served, the others. */
GN_API GnResult GN_CALL gnWarmUp(GnContext context);

/** \brief gnWarmUp() for one method and what serves in its place where it cannot (GN_TRAIT_FALLBACK_BIT): a host that
pins its lights need not compile what it never asks for. Fails with GN_ERROR_UNKNOWN_METHOD, or with
GN_ERROR_FEATURE_MISSING where the device cannot run it. */
GN_API GnResult GN_CALL gnWarmUpMethod(GnContext context, const char* pMethod);

#include <gnomon/scene.h>

/* --- views and frames -------------------------------------------------------------------------------------------- */

/** Describes a view. */
typedef struct GnViewCreateInfo {
    const char* pName;  ///< Optional.
    uint32_t maxLights; ///< Layers of the visibility image; 0 means 16. [1, 256] and the device's maximum.
} GnViewCreateInfo;

/** \brief Creates a view. It has no visibility until it has been in a frame. Its decisions of 256 frames are kept for
gnExplain(): some 50 kB of the host's memory a light and 12 kB a method more, 280 kB with all that are built in. */
GN_API GnResult GN_CALL gnCreateView(GnContext context, const GnViewCreateInfo* pCreateInfo, GnView* pView);
/** \brief Destroys a view, and finishes a frame under way first. Its visibility image stays until the frames that were
begun before are completed (GnFrameInfo::completedFrame): what reads it must have been submitted by then. */
GN_API void GN_CALL gnDestroyView(GnContext context, GnView view);

typedef enum GnDepthConvention {
    GN_DEPTH_REVERSED_INFINITE = 0, ///< 1 at the near plane, 0 at infinity. Recommended.
    GN_DEPTH_REVERSED = 1,          ///< 1 near, 0 far.
    GN_DEPTH_STANDARD = 2,          ///< 0 near, 1 far.
    GN_DEPTH_CONVENTION_MAX_ENUM = 0x7FFFFFFF
} GnDepthConvention;

/** One view's part of a frame; read during the call only. The depth and normal images are in SHADER_READ_ONLY_OPTIMAL
on entry and again on return; what was drawn into them must be available (a barrier to ALL_COMMANDS, or a semaphore).
After the call gnomon's reads are pending on the queue: order your next writes after ALL_COMMANDS, and after
gnBeginShadows() keep the contents until gnFinishShadows() has returned. Mip level 0 and array layer 0 are read. Views may
share an image (parts of it, by renderArea) through the same image view. */
typedef struct GnViewFrame {
    GnView view;              ///< Required.
    double eye[3];            ///< World position of the camera.
    float viewFromWorld[9];   ///< Row-major rotation; the translation is `eye`.
    float projection[16];     ///< Column-major clipFromView as it drew the depth, jitter included; perspective. Clip y
                              ///< goes down the image, as in a viewport of positive height: hosts that draw with a
                              ///< negative one negate [1], [5], [9] and [13] here.
    GnDepthConvention depthConvention;
    VkImage depthImage;       ///< Required. Single sample, SAMPLED and TRANSFER_SRC; its stencil is left alone.
    VkImageView depthView;    ///< Required. Depth aspect, 2D.
    VkFormat depthFormat;     ///< D32_SFLOAT or D32_SFLOAT_S8_UINT.
    VkExtent2D imageExtent;   ///< Of the depth image, and of the visibility image.
    VkRect2D renderArea;      ///< Pixels drawn: the viewport of `projection`; a zero extent means the whole image.
    VkImage normalImage;      ///< Optional. Geometric normals, world space, xyz, finite; they need not be of unit
                              ///< length, and one of length 0 faces away from every light. SAMPLED and TRANSFER_SRC.
    VkImageView normalView;
    VkFormat normalFormat;    ///< R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT.
    uint32_t lightCount;      ///< At most the view's maxLights.
    const GnLight* pLights;   ///< Layer i of the visibility image belongs to pLights[i]; each light at most once.
    VkBool32 cameraCut;       ///< The camera jumped: measured facts and holds of the last frames do not apply.
} GnViewFrame;

typedef enum GnFrameFlagBits {
    GN_FRAME_PRESUBMIT_BIT = 0x1, ///< Allows a batch that waits for the CPU on the queue. Never needed; not made use of
                                  ///< at present: levels are submitted when their host passes are done.
    GN_FRAME_TIMED_BIT = 0x2,     ///< Time every pass of this frame.
    GN_FRAME_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnFrameFlagBits;
typedef VkFlags GnFrameFlags;

/** A point on a timeline semaphore; value 0 for a binary one. */
typedef struct GnSemaphorePoint {
    VkSemaphore semaphore;
    uint64_t value;
} GnSemaphorePoint;

/** Describes a frame: all views come in one call. */
typedef struct GnFrameInfo {
    uint64_t frame;          ///< Grows by one from call to call; the first may be any number > 0.
    uint64_t completedFrame; ///< Newest frame whose GPU work is finished, the host's reads of visibility included. Before
                             ///< `frame` by framesInFlight at most, else #GN_ERROR_FRAME_ORDER; 0: none yet.
    GnFrameFlags flags;
    float budgetMs;          ///< For all shadows of this frame, GPU and CPU. 0: that of the rules (`shadowCapMs`, or
                             ///< what `budget: auto` allows), or none. A `shadowCapMs` that is less lowers it.
    uint32_t viewCount;
    const GnViewFrame* pViews; ///< Coordinates are computed in float about a point near an eye of one of them: of views
                               ///< kilometres apart, the others' shadows are as coarse as floats are so far out.
    uint32_t waitCount;      ///< Waited for before the first pass. Not for gnCmdRenderShadows.
    const GnSemaphorePoint* pWaits;
    uint32_t signalCount;    ///< Signalled after the last pass. Not for gnCmdRenderShadows.
    const GnSemaphorePoint* pSignals;
} GnFrameInfo;

/** \brief Records this frame's shadow passes into the host's command buffer.

\param commandBuffer Primary, recording, outside a rendering scope. This call neither submits nor waits; all command
    buffer state (pipelines, sets, push constants, dynamic state) is undefined afterwards.
\param pFrame Views, lights and receiver depth; read during the call only.
\return #GN_NOT_READY only while no method at all is ready; visibility is 1 everywhere meanwhile.

Methods that need the CPU between passes (roundTrips > 0) are not eligible here. A recorded buffer is submitted once, to
the context's queue, in the order of recording; gnDropFrame() withdraws it before the next frame is recorded.

After a failure the command buffer may hold part of the frame's commands, which name what is gone: it must be reset
and must not be submitted. As with the other calls that begin a frame, nothing of it counts then, and the next call has
the same frame number: gnGetVisibility() gives the images of the frame before, and gnGetLightMap() none. After
#GN_ERROR_OUT_OF_DEVICE_MEMORY another attempt finds more room, the more so when frames in flight are completed: maps and
volumes kept for later frames have been given up, and so has the visibility of a view whose size was to change. */
GN_API GnResult GN_CALL gnCmdRenderShadows(GnContext context, VkCommandBuffer commandBuffer, const GnFrameInfo* pFrame);

/** \brief The frame last recorded by gnCmdRenderShadows() will not be submitted. Of it only the number counts. Where an
attempt at the next frame has failed by then, a view whose size the dropped one changed has no visibility until its next
frame. */
GN_API GnResult GN_CALL gnDropFrame(GnContext context, uint64_t frame);

/** \brief Submits what needs no host result and starts host passes on workers. Pair with gnFinishShadows(). */
GN_API GnResult GN_CALL gnBeginShadows(GnContext context, const GnFrameInfo* pFrame);
/** \brief Waits for host passes and submits the rest.
\param timeoutNs Nanoseconds; UINT64_MAX waits. \return #GN_TIMEOUT if the frame is not finished; call again.

After a failure, too, nothing of the frame counts and the next call that begins one has the same number. But some of its
passes have run: what it waits for was waited for, its signals do not come, and its visibility is undefined (that of a
view whose size was to change: as it was). gnDestroyView() and gnWarmUp() finish a frame under way; how that went is
still told here. */
GN_API GnResult GN_CALL gnFinishShadows(GnContext context, uint64_t timeoutNs);
/** \brief gnBeginShadows() and gnFinishShadows() in one, failures included: it failed like the latter where
GnFrameStats::frame is this frame and `submits` not 0. */
GN_API GnResult GN_CALL gnSubmitShadows(GnContext context, const GnFrameInfo* pFrame);

/** Where a view's visibility is found after a frame. In SHADER_READ_ONLY_OPTIMAL, its writes available to fragment and
compute shader reads later on the queue. Sample through gnomon/visibility.glsl. */
typedef struct GnVisibility {
    VkImage image;
    VkImageView imageView; ///< 2D array, R8_UNORM.
    VkExtent2D extent;
    uint32_t layerCount;
    uint64_t revision;     ///< Grows when image or view handle change (resize): refresh descriptors.
} GnVisibility;

/** \brief The newest visibility of a view; the same image from frame to frame, until the size of its views changes. The one
before stays until the frame that replaced it is completed.
\return #GN_ERROR_FRAME_ORDER before the view's first frame. */
GN_API GnResult GN_CALL gnGetVisibility(GnContext context, GnView view, GnVisibility* pVisibility);

/** A method's map, for hosts with uses of their own (volumetric light, particles). Valid until the next frame call. As
visibility is: in SHADER_READ_ONLY_OPTIMAL, its writes available to fragment and compute shader reads later on the queue. */
typedef struct GnLightMap {
    VkImage image;
    VkImageView imageView;
    VkFormat format;
    VkExtent2D extent;
    uint32_t layerCount;
    float clipFromWorld[6][16]; ///< One per layer, relative to `origin`; zero where a layer has no matrix.
    double origin[3];
    uint32_t validLayers;       ///< Bit i: layer i holds this frame's casters. Layers that no receiver in a view
                                ///< can lie in are not drawn and may hold anything. Several layers of a
                                ///< directional light lie about slices of a view, finest first, the last one
                                ///< about all casters: look a receiver up in the first valid one that holds it.
} GnLightMap;

/** \brief The map the light's method kept after the last frame. \return #GN_ERROR_UNKNOWN_METHOD where it has none. */
GN_API GnResult GN_CALL gnGetLightMap(GnContext context, GnLight light, GnLightMap* pMap);

/* --- methods, rules, decisions ------------------------------------------------------------------------------------ */

typedef enum GnTraitBits {
    GN_TRAIT_DIRECTIONAL_BIT = 0x1,     ///< Serves directional lights.
    GN_TRAIT_SPOT_BIT = 0x2,            ///< Serves spot lights.
    GN_TRAIT_POINT_BIT = 0x4,           ///< Serves point lights.
    GN_TRAIT_HARD_BIT = 0x8,            ///< Hard shadow edges.
    GN_TRAIT_FIXED_PENUMBRA_BIT = 0x10, ///< Edges softened by a constant width.
    GN_TRAIT_SOFT_PENUMBRA_BIT = 0x20,  ///< Penumbra follows source radius and distance.
    GN_TRAIT_EXACT_BIT = 0x40,          ///< Answers by geometry, not by samples.
    GN_TRAIT_CPU_GEOMETRY_BIT = 0x80,   ///< Reads triangles: cannot see host-drawn casters.
    GN_TRAIT_TOPOLOGY_BIT = 0x100,      ///< Needs the topology of the casters.
    GN_TRAIT_RAYS_BIT = 0x200,          ///< Needs ray-tracing trees of the casters.
    GN_TRAIT_FALLBACK_BIT = 0x400,      ///< Serves while the chosen method is not ready.
    GN_TRAIT_PLANAR_BIT = 0x800,        ///< Right on the plane that most receivers lie on, and nowhere else.
    GN_TRAIT_MAX_ENUM = 0x7FFFFFFF
} GnTraitBits;
typedef VkFlags GnTraits;

/** A knob of a method. */
typedef struct GnSettingInfo {
    const char* pName;        ///< Static.
    const char* pDescription; ///< Static; with unit.
    double minimum, maximum, value;
} GnSettingInfo;

/** A method as the registry knows it. Strings live as long as the context. */
typedef struct GnMethodInfo {
    const char* pName;
    const char* pAlgorithm;
    const char* pSource;      ///< Thesis section or paper.
    GnTraits traits;
    uint32_t roundTrips;      ///< GPU-CPU-GPU round trips; 0 may be recorded by gnCmdRenderShadows().
    VkBool32 ready;
    const char* pUnavailable; ///< Null, or why no light can use it on this device ("needs geometryShader").
    uint32_t settingCount;
    const GnSettingInfo* pSettings;
} GnMethodInfo;

/** \brief Lists methods. With null `pMethods` only the count is written. */
GN_API GnResult GN_CALL gnEnumerateMethods(GnContext context, uint32_t* pCount, GnMethodInfo* pMethods);
/** \brief Adds a method: a second set of settings for an algorithm, under a name rules can use. \return #GN_ERROR_RULES
where the rules in force use the name for something else, #GN_ERROR_OUT_OF_RANGE where a method has it. */
GN_API GnResult GN_CALL gnAddMethod(GnContext context, const char* pName, const char* pAlgorithm);
/** \brief Changes a setting from the next frame on. Out of range: an error naming the range, nothing changes. */
GN_API GnResult GN_CALL gnSetMethodSetting(GnContext context, const char* pMethod, const char* pSetting, double value);

/** \brief Loads a rule base from YAML text. On errors every one is reported as a message with `pFileName`, line and
column, #GN_ERROR_RULES is returned and the rules in force stay. Without any rules the first eligible exact method, or
else the fallback, serves each light. */
GN_API GnResult GN_CALL gnLoadRules(GnContext context, const char* pText, size_t size, const char* pFileName);

/** \brief gnLoadRules() with one of the bases that the library carries: "default", "quality", "battery", "thesis".
\return #GN_ERROR_OUT_OF_RANGE for another name, #GN_ERROR_UNSUPPORTED where the library was built without YAML. */
GN_API GnResult GN_CALL gnLoadShippedRules(GnContext context, const char* pName);

/** \brief Starts the cost model anew from a knowledge base: the CSV text that `gnomon calibrate` writes.

Rows of this device are used where there are any; else those of the device with most rows, and how much faster or
slower this one is is learned from the first timed frames. What running frames had taught is forgotten; methods added
later start from the rows of their algorithm. A row that cannot be used (NaN, a negative time, a missing cell) is left
out and reported as a message with `pFileName` and its line. A table without any row, or with rows of other algorithms
only, is a warning and changes nothing: predictions go on as they were.
\return #GN_ERROR_KNOWLEDGE for text that is no knowledge base, one of another version, or one whose rows are all
unusable; what was known before stays. */
GN_API GnResult GN_CALL gnLoadKnowledge(GnContext context, const char* pText, size_t size, const char* pFileName);

#include <gnomon/decisions.h>
#include <gnomon/measurements.h>

#ifdef __cplusplus
}
#endif
#endif /* GNOMON_GNOMON_H */
