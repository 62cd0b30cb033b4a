/** \file gnomon.h
\brief Adaptive shadows for Vulkan renderers.

A host registers geometry and lights once, hands over camera and depth every frame, and gets back a *visibility* image
per view: one layer per light, 1 = lit, 0 = umbra. Behind that call stand many shadow algorithms; fuzzy rules pick, for
every light and every frame, which *method* (an algorithm with settings) runs, and say why.

    gnCreateContext -> gnLoadRules -> gnCreateMesh, gnCreateInstance, gnCreateLight, gnCreateView
    each frame: gnSubmitShadows (or gnCmdRenderShadows into your command buffer), then sample gnGetVisibility()

\section gn_example A first frame

A renderer that has a device and draws depth gets the shadows of one sun by two functions. `demo/minimal.c` is a whole
program.

\code{.c}
#include <gnomon/gnomon.h>
#include <string.h>

typedef struct Renderer {
    VkInstance instance; VkPhysicalDevice gpu; VkDevice device; VkQueue queue; // the queue is of family 0
    const VkPhysicalDeviceFeatures2* pFeatures;                                // as given to vkCreateDevice
    VkImage depth; VkImageView depthView; VkExtent2D size;                     // D32_SFLOAT, reversed, infinite
    GnContext shadows; GnView view; GnLight sun;                               // what gnomon adds
} Renderer;

// Once. pPositions has three vertices a triangle, world space.
GnResult startShadows(Renderer* r, PFN_vkGetInstanceProcAddr load, const float* pPositions, uint32_t vertexCount)
{
    const GnContextCreateInfo contextInfo = {GN_INIT(GnContextCreateInfo), .instance = r->instance,
        .physicalDevice = r->gpu, .device = r->device, .queue = r->queue, .apiVersion = VK_API_VERSION_1_3,
        .pEnabledFeatures = r->pFeatures, .pfnGetInstanceProcAddr = load};
    const GnMeshCreateInfo mesh = {GN_INIT(GnMeshCreateInfo), .pPositions = pPositions, .positionCount = vertexCount};
    const GnLightInfo sunInfo = {GN_INIT(GnLightInfo), .type = GN_LIGHT_TYPE_DIRECTIONAL, .direction = {0, -1, 0}};
    GnInstanceCreateInfo placedInfo = {GN_INIT(GnInstanceCreateInfo), .flags = GN_INSTANCE_STATIC_BIT};
    GnInstance placed;
    GnResult result = gnCreateContext(&contextInfo, &r->shadows);
    if (result >= 0) result = gnLoadShippedRules(r->shadows, "default");
    if (result >= 0) result = gnCreateMesh(r->shadows, &mesh, &placedInfo.mesh);
    if (result >= 0) result = gnCreateInstance(r->shadows, &placedInfo, &placed);
    if (result >= 0) result = gnCreateLight(r->shadows, &sunInfo, &r->sun);
    if (result >= 0) result = gnCreateView(r->shadows, NULL, &r->view);
    return result >= 0 ? gnWarmUp(r->shadows) : result;
}

// Each frame, once depth is drawn and can be read. Layer 0 of pVisibility->imageView is the sun's.
GnResult recordShadows(Renderer* r, VkCommandBuffer commands, uint64_t frame, uint64_t completedFrame,
                       const float projection[16], GnVisibility* pVisibility)
{
    GnViewFrame view = {GN_INIT(GnViewFrame), .view = r->view, .eye = {0.0, 2.0, 5.0},
        .viewFromWorld = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .depthImage = r->depth, .depthView = r->depthView,
        .depthFormat = VK_FORMAT_D32_SFLOAT, .imageExtent = r->size, .lightCount = 1, .pLights = &r->sun};
    const GnFrameInfo info = {GN_INIT(GnFrameInfo), .frame = frame, .completedFrame = completedFrame,
        .viewCount = 1, .pViews = &view};
    memcpy(view.projection, projection, sizeof view.projection);
    const GnResult result = gnCmdRenderShadows(r->shadows, commands, &info);
    return result >= 0 ? gnGetVisibility(r->shadows, r->view, pVisibility) : result;
}
\endcode

\section gn_structures Structures

A structure that passes through a pointer begins with `structSize`, the host's sizeof of it. By it a library and a host
of different versions understand each other:
- Zero means the default for every other member. A host zeroes the whole structure, gives the size, then sets what
  differs: #GN_INIT in C; in C++ `GnLightInfo sun{};` has its size.
- New members go to the end. Those that an older host's structure lacks read as zero, and of a structure that is filled
  for it, as much is written as it has room for.
- A newer host's structure is larger. Members that the library does not know must be zero, else the call fails with
  #GN_ERROR_UNSUPPORTED; where the library fills the structure, it leaves zero in them.
- A structSize that ends before the last required member, that no sizeof can be, or above 4096 is
  #GN_ERROR_OUT_OF_RANGE. Messages name the structure and the size.
- In an array the size is the stride. All elements of an array that is read have the same; for an array that is filled,
  the first element says it, and the library sets it in the others.
- In structures that a callback is given, structSize is the library's: a newer host or plug-in reads a member only if it
  lies within.

Small *values* have no size and never change: GnTransform, GnSemaphorePoint, GnSettingInfo, GnTaskCaster. They lie
within other structures, or in arrays that the library owns.

Vulkan's sType and pNext would do the same by chains of structures. gnomon has few structures, which grow seldom and in
one place, so that one number is enough, and nothing has to be walked or allocated.

\section gn_frames_in_flight Frames in flight

Frames are numbered by the host: GnFrameInfo::frame grows by one. GnContextCreateInfo::framesInFlight is how many may be
with the device at once. gnomon never waits for one of them: it uses the memory of a frame again once the host says, by
GnFrameInfo::completedFrame, that the device is done with it, the host's own reads of visibility included. A host
usually waits for the fence or the timeline value of the frame `framesInFlight` before this one, and gives that one's
number. A frame that fails does not count, and the next attempt has its number; gnDropFrame() takes back a recorded one.
Timings and measured facts are of completed frames, so they come a few frames late.

\section gn_synchronization Synchronization

There are three ways to run a frame, and each view's images cross the border in SHADER_READ_ONLY_OPTIMAL both ways.
- gnCmdRenderShadows() records into the host's command buffer. The host's barrier before it makes depth and normals
  available to all commands and brings them into the layout; gnomon's last barrier makes visibility available to reads
  of fragment and compute shaders that come later on the queue. No semaphore is needed. Methods that need the CPU
  between passes cannot serve here.
- gnSubmitShadows() submits to the context's queue and waits for the device where a method needs its results on the CPU.
  What drew depth was submitted to this queue before, with such a barrier at its end, or signals one of
  GnFrameInfo::pWaits. What reads visibility comes later on this queue, or waits for one of GnFrameInfo::pSignals.
- gnBeginShadows() and gnFinishShadows() are the same in two halves, between which the host works on other things.

After any of them gnomon's reads of depth and normals are pending on the queue. The host's next writes to them come
after a barrier with ALL_COMMANDS as its source.

\section gn_threads Threads

| handle | calls |
| --- | --- |
| GnMesh, GnInstance | any thread, at any time, also during a frame: what they change is seen by the next one |
| GnLight, GnView | one at a time per context |
| GnContext: frames, rules, methods, questions | one at a time per context |
| GnContext: gnGetLastError() | any thread; each has an error of its own |
| GnPassBuilder, GnPassContext | the thread of the callback that got it, during that callback |

The queue is touched inside the calls only, between GnContextCreateInfo::pfnLockQueue and pfnUnlockQueue. Work for the
CPU runs on gnomon's own threads or on the host's (GnContextCreateInfo::pfnScheduleJob). Callbacks must not call gnomon,
but for PFN_gnPluginMain and what GnPluginInterface offers.

\section gn_memory Memory

Device memory is gnomon's own, or comes from GnContextCreateInfo::pfnAllocateMemory, in blocks, up to
GnContextCreateInfo::memoryLimit; what a frame needs beyond that serves its lights by other methods.
GnFrameStats::memory has the sum. Arrays and strings that the host gives are copied before
the call returns, those of a frame are read during the call; images and handles of Vulkan are borrowed. What the library
gives lives as long as the comment beside it says, and is never the host's to free. Nothing that the device may still
use is destroyed: gnDestroyMesh() and its like keep memory until the frames that were begun before are completed. The
host's memory comes from operator new, and for what Vulkan allocates from GnContextCreateInfo::pAllocationCallbacks.
Once a scene stands still, a frame allocates nothing of either.

\section gn_conventions Conventions

Column vectors, metres, right-handed world space; 4x4 matrices are column-major, rotations and bases of 9 or 12 numbers
row-major, as each says. Numbers are finite; positions, lengths and factors are at most 1e18 (a light of unlimited range
has range 0). On failure outputs are null or zero and nothing has changed, unless a call says otherwise. No C++
exception leaves these functions, and the host's locale and floating-point mode are neither read nor changed.
*/
#ifndef GNOMON_GNOMON_H
#define GNOMON_GNOMON_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#if defined(_WIN32)
#define GN_CALL __stdcall
#define GN_EXPORT __declspec(dllexport)
#define GN_IMPORT __declspec(dllimport)
#else
#define GN_CALL
#define GN_EXPORT __attribute__((visibility("default")))
#define GN_IMPORT
#endif
/* Of what the library offers. GN_SHARED_LIBRARY comes with the shared one: CMake's target and gnomon.pc define it. */
#ifndef GN_API
#ifdef GN_SHARED_LIBRARY
#define GN_API GN_IMPORT
#else
#define GN_API GN_EXPORT
#endif
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

/* --- sizes of structures ---------------------------------------------------------------------------------------- */

/** \brief Sets the size of a structure, as the first thing between its braces:
`GnLightInfo sun = {GN_INIT(GnLightInfo), .range = 10.0f};`. For C; in C++ the member has this value
by itself. See \ref gn_structures. */
#define GN_INIT(Type) .structSize = sizeof(Type)

/* The value that the member has by itself, where the language has such values. */
#ifdef __cplusplus
#define GN_SIZE_OF(Type) = sizeof(Type)
#else
#define GN_SIZE_OF(Type)
#endif

/* --- results and messages ------------------------------------------------------------------------------------- */

/** Zero is success, positive is success with a remark, negative is failure. */
typedef enum GnResult {
    GN_SUCCESS = 0,    ///< Done.
    GN_NOT_READY = 1,  ///< Only while no method at all is ready; visibility is 1 everywhere meanwhile.
    GN_TIMEOUT = 2,    ///< gnFinishShadows: host passes still run; call it again.
    GN_INCOMPLETE = 3, ///< The array or buffer was too small; what fits was written.
    GN_ERROR_UNKNOWN = -1,              ///< A fault of gnomon's own.
    GN_ERROR_OUT_OF_HOST_MEMORY = -2,   ///< Of operator new.
    GN_ERROR_OUT_OF_DEVICE_MEMORY = -3, ///< Of the device, or of GnContextCreateInfo::memoryLimit.
    GN_ERROR_DEVICE_LOST = -4,      ///< Vulkan said so, or the device hangs (GnContextCreateInfo::waitLimitMs). Every
                                    ///< call but destruction returns it from then on.
    GN_ERROR_INVALID_HANDLE = -5,   ///< A handle of an object is null, foreign or already destroyed.
    GN_ERROR_NULL_ARGUMENT = -6,    ///< A required pointer, or the context, is null.
    GN_ERROR_NOT_A_NUMBER = -7,     ///< NaN in the input.
    GN_ERROR_INFINITE = -8,         ///< Infinity where a finite value is needed.
    GN_ERROR_OUT_OF_RANGE = -9,     ///< A finite value outside its range, or an index past its array.
    GN_ERROR_EMPTY = -10,           ///< A mesh without triangles, a view of no pixels.
    GN_ERROR_TOO_MANY = -11,        ///< More lights, views, methods (255) or triangles than agreed or than fit.
    GN_ERROR_FEATURE_MISSING = -12, ///< The device lacks, or was created without, something required.
    GN_ERROR_RULES = -13,           ///< The rule base has errors; the last good one stays in force.
    GN_ERROR_UNKNOWN_METHOD = -14,  ///< No method, algorithm or setting of that name, or none for this kind of light.
    GN_ERROR_FRAME_ORDER = -15,     ///< Frames not growing by one, memory of a frame in flight, calls out of order.
    GN_ERROR_UNSUPPORTED = -16,     ///< Built without the part that is needed (Embree, OpenMesh, YAML), or older than
                                    ///< a member of a structure that the host has set.
    GN_ERROR_KNOWLEDGE = -17,       ///< The knowledge base cannot be used; what was known before stays.
    GN_RESULT_MAX_ENUM = 0x7FFFFFFF
} GnResult;

/** How bad it is. */
typedef enum GnSeverity {
    GN_SEVERITY_INFO = 0,
    GN_SEVERITY_WARNING = 1,
    GN_SEVERITY_ERROR = 2,
    GN_SEVERITY_MAX_ENUM = 0x7FFFFFFF
} GnSeverity;

/** What went wrong or is worth knowing. Strings live during the callback only. */
typedef struct GnMessage {
    uint32_t structSize GN_SIZE_OF(GnMessage); ///< The library's sizeof(GnMessage).
    GnSeverity severity;
    GnResult result;   ///< The result the call is about to return, or #GN_SUCCESS for remarks.
    const char* pId;   ///< Stable identifier such as "MeshIndexOutOfRange".
    const char* pText; ///< A sentence naming the value at fault and the object's pName.
} GnMessage;

/** Called on the thread that caused the message; a worker thread for background work. Must not call gnomon. */
typedef void(GN_CALL* PFN_gnMessage)(const GnMessage* pMessage, void* pUserData);

/** \brief #GN_VERSION of the library, which may be another one than that of the header a host was compiled with: see
\ref gn_structures. Any thread. */
GN_API uint32_t GN_CALL gnGetVersion(void);

/* --- device and context --------------------------------------------------------------------------------------- */

/** What gnomon wants from vkCreateDevice. Names are static. */
typedef struct GnDeviceNeeds {
    uint32_t structSize GN_SIZE_OF(GnDeviceNeeds); ///< sizeof(GnDeviceNeeds).
    uint32_t apiVersion;                   ///< Lowest usable VK_API_VERSION (1.3).
    VkPhysicalDeviceFeatures required;     ///< Core features that must be enabled (none at present).
    VkPhysicalDeviceFeatures optional;     ///< Core features that make more methods eligible and that the device has.
    VkBool32 supported;                    ///< The device can run gnomon at all.
    uint32_t optionalExtensionCount;       ///< Extensions the device has and some method can use.
    const char* ppOptionalExtensions[8];   ///< First `optionalExtensionCount` are set.
    char reason[256];                      ///< Why not, if not.
    /// Feature structures of those extensions, with what gnomon uses on, to be appended to the chain given to
    /// vkCreateDevice; static, null where there are none. Where it is not null, bufferDeviceAddress of Vulkan 1.2 is to
    /// be enabled with it. Methods that need any of this say so where it is not enabled.
    const void* pOptionalFeatures;
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

/** A block of device memory that gnomon wants. It is at most 64 MiB, or of the size of one image or buffer. */
typedef struct GnMemoryRequest {
    uint32_t structSize GN_SIZE_OF(GnMemoryRequest); ///< The library's sizeof(GnMemoryRequest).
    uint32_t memoryTypeIndex; ///< One of the device's memory types.
    VkDeviceSize size;        ///< Bytes. Multiple of bufferImageGranularity.
    VkDeviceSize alignment;   ///< A power of two, and a multiple of bufferImageGranularity: whatever lies beside the
                              ///< block in the same VkDeviceMemory is far enough away.
    VkMemoryAllocateFlags allocateFlags; ///< To allocate with, by VkMemoryAllocateFlagsInfo; mostly 0.
    VkBool32 mapped;          ///< GnMemoryBlock::pMapped is required.
} GnMemoryRequest;

/** The block that the host gives. All zero when #PFN_gnAllocateMemory is called. */
typedef struct GnMemoryBlock {
    uint32_t structSize GN_SIZE_OF(GnMemoryBlock); ///< The library's sizeof(GnMemoryBlock).
    VkDeviceMemory memory; ///< Of the device and the memory type. The host's, which may keep other things in it.
    VkDeviceSize offset;   ///< Of the block in `memory`, bytes; a multiple of the alignment asked for.
    void* pMapped;         ///< Address of the block's first byte, valid until it is freed.
    void* pAllocation;     ///< For the host's own use, such as a VmaAllocation.
} GnMemoryBlock;

/** \brief Allocates, and maps where that is asked for, device memory for gnomon. One call at a time per context, on any
thread; during warm-up, scene calls and frames. In frames that repeat themselves it is not called. Must not call gnomon.
\return VK_SUCCESS, or a failure as of vkAllocateMemory() or vkMapMemory(): gnomon then asks for less, or of another
memory type; where that fails as well, other methods serve. */
typedef VkResult(GN_CALL* PFN_gnAllocateMemory)(const GnMemoryRequest* pRequest, GnMemoryBlock* pBlock,
                                                void* pUserData);
/** Takes a block back. The device does not use it any more. As #PFN_gnAllocateMemory; also in gnDestroyContext(). */
typedef void(GN_CALL* PFN_gnFreeMemory)(const GnMemoryBlock* pBlock, void* pUserData);

/** How a context works. */
typedef enum GnContextCreateFlagBits {
    GN_CONTEXT_TIME_EVERY_FRAME_BIT = 0x1, ///< Every frame is a timed one (see gnGetPassTimings()); for measuring.
    GN_CONTEXT_NO_BACKGROUND_BIT = 0x2,    ///< Topology, trees and pipelines are built inside the calls that need
                                           ///< them: reproducible runs and tests.
    GN_CONTEXT_DEVICE_RAYS_BIT = 0x4,      ///< Methods that trace on the CPU or on the device do so on the device even
                                           ///< where that is a software one (VK_PHYSICAL_DEVICE_TYPE_CPU), which
                                           ///< takes longer. Recorded frames may use them then.
    GN_CONTEXT_CREATE_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnContextCreateFlagBits;
/** Bits of #GnContextCreateFlagBits. */
typedef VkFlags GnContextCreateFlags;

/** Describes a new #GnContext. */
typedef struct GnContextCreateInfo {
    uint32_t structSize GN_SIZE_OF(GnContextCreateInfo); ///< sizeof(GnContextCreateInfo).
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
    uint32_t waitLimitMs;                              ///< A call that waits for the device ends with
                                                       ///< #GN_ERROR_DEVICE_LOST once the device has made no progress
                                                       ///< for so long. What a submitted frame's pWaits delay counts.
                                                       ///< 0 means 10 000, and 60 000 in gnWarmUp(), in which software
                                                       ///< devices compile.
    VkDeviceSize memoryLimit;                          ///< Device bytes, persistent plus transient; 0: half the heap,
                                                       ///< or of its budget where VK_EXT_memory_budget is enabled.
                                                       ///< Maps whose sides follow screen coverage take half of it at
                                                       ///< most: beyond, sides shrink where the least is seen of them.
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
    void* pUserData;                                   ///< Given to all callbacks.
    PFN_gnAllocateMemory pfnAllocateMemory;            ///< Optional. Absent: vkAllocateMemory().
    PFN_gnFreeMemory pfnFreeMemory;                    ///< Optional, with pfnAllocateMemory.
    size_t pipelineCacheDataSize;                      ///< Bytes of pPipelineCacheData; 0: there are none.
    const void* pPipelineCacheData;                    ///< Optional, copied: what gnGetPipelineCacheData() once gave,
                                                       ///< to begin gnomon's own cache with. Of another device or
                                                       ///< driver, or damaged: message PipelineCacheData says so, and
                                                       ///< the cache begins empty. Not with `pipelineCache`.
} GnContextCreateInfo;

/** \brief Creates a context. No method is ready at first; see gnWarmUp(). What went wrong is told to `pfnMessage`
alone; of a structSize that is none, by which that member cannot be found, the result alone tells. */
GN_API GnResult GN_CALL gnCreateContext(const GnContextCreateInfo* pCreateInfo, GnContext* pContext);

/** \brief Destroys the context and all that was made from it. Null is allowed.

The one call that waits for all that is on the context's queue; gnWarmUp(), and frames with round trips, wait for what
they submitted themselves. Recorded frames must have been
submitted there or never be; what the host reads of visibility on other queues must be finished. Where the device makes
no progress for GnContextCreateInfo::waitLimitMs, the context's Vulkan objects are left undestroyed, since it may still
use them; a message says so. */
GN_API void GN_CALL gnDestroyContext(GnContext context);

/** \brief Name of a result, such as "GN_ERROR_EMPTY". Never null. */
GN_API const char* GN_CALL gnResultName(GnResult result);

/** \brief The sentence of the calling thread's last failed call on this context, valid until the thread's next call on
it. Never null; empty where none failed. From any thread. */
GN_API const char* GN_CALL gnGetLastError(GnContext context);

/** \brief Compiles and runs once every method that the enabled device can run, and waits for meshes in preparation.
Compiles on all job threads; submits to the queue and waits for those submits; for loading screens. Without it, one
method a frame becomes ready: those that serve while others are not ready, then those that lights are pinned to, then,
unless all lights are pinned and served, those that a rule in force speaks for; without rules, all. */
GN_API GnResult GN_CALL gnWarmUp(GnContext context);

/** \brief gnWarmUp() for one method and what serves in its place where it cannot (GN_TRAIT_FALLBACK_BIT): a host that
pins its lights need not compile what it never asks for. Fails with GN_ERROR_UNKNOWN_METHOD, or with
GN_ERROR_FEATURE_MISSING where the device cannot run it. */
GN_API GnResult GN_CALL gnWarmUpMethod(GnContext context, const char* pMethod);

/** \brief Writes what gnomon's own pipeline cache holds, for GnContextCreateInfo::pPipelineCacheData of a later run:
the driver's bytes behind a header with a checksum. Best asked for once the context is warm.

With null `pData` only the size is written, which may grow while pipelines are made.
\return #GN_INCOMPLETE if the buffer was too small, and nothing was written; #GN_ERROR_UNSUPPORTED with a pipeline cache
of the host's, which saves it itself. */
GN_API GnResult GN_CALL gnGetPipelineCacheData(GnContext context, size_t* pSize, void* pData);

#include <gnomon/scene.h>
#include <gnomon/frames.h>

/* --- methods, rules, decisions ------------------------------------------------------------------------------------ */

/** What a method is and needs. */
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
    GN_TRAIT_DEVICE_RAYS_BIT = 0x1000,  ///< Traces rays on the device: needs its acceleration structures of casters. Of
                                        ///< built-in methods alone.
    GN_TRAIT_GPU_POSITIONS_BIT = 0x2000, ///< Reads positions on the GPU alone: sees meshes in buffers that are written
                                         ///< in every frame; with topology once they have been copied in some pose.
    GN_TRAIT_FLAT_SOURCE_BIT = 0x4000,   ///< Shows penumbrae of rectangles and discs (#GnSourceShape) as they are.
    GN_TRAIT_GPU_TRANSFORMS_BIT = 0x8000, ///< Reads transforms on the GPU alone: sees instances that have theirs in a
                                          ///< buffer (GnTransformBuffer). Of built-in methods alone.
    GN_TRAIT_MAX_ENUM = 0x7FFFFFFF
} GnTraitBits;
/** Bits of #GnTraitBits. */
typedef VkFlags GnTraits;

/** A knob of a method. A value: see \ref gn_structures. */
typedef struct GnSettingInfo {
    const char* pName;        ///< Static.
    const char* pDescription; ///< Static; with unit.
    double minimum, maximum, value; ///< `value` may be 0 below `minimum`: by screen coverage (gnSetMethodSetting()).
} GnSettingInfo;

/** A method as the registry knows it. Strings live as long as the context. */
typedef struct GnMethodInfo {
    uint32_t structSize GN_SIZE_OF(GnMethodInfo); ///< sizeof(GnMethodInfo).
    const char* pName;
    const char* pAlgorithm;
    const char* pSource;      ///< Thesis section or paper.
    GnTraits traits;
    uint32_t roundTrips;      ///< GPU-CPU-GPU round trips on this device; 0 may be recorded by gnCmdRenderShadows().
                              ///< What may trace on the CPU as well takes one for lights with casters that are
                              ///< alpha-tested by pfnOpacity.
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
/** \brief Changes a setting from the next frame on. Out of range: an error naming the range, nothing changes.

`resolution`, the side of shadow maps, also takes 0, the default: by light and frame, from 128 to 4096 texels, so that a
texel is about a pixel where the light's receivers are nearest, and so that all its maps have four texels at most for a
pixel that the light reaches. GnDecision::mapSide says which side that is. It is 1024, or what corresponds to that for
the method, until receivers have been measured; without rules nothing is measured. A kept map is drawn once for another
side, one light a frame.

A value in range that counts as less with the method's other settings (the exponents of EVSM with 16 bits a moment) is
taken, and the message `SettingClamped` says so once. */
GN_API GnResult GN_CALL gnSetMethodSetting(GnContext context, const char* pMethod, const char* pSetting, double value);

/** \brief Loads a rule base from YAML text. On errors every one is reported as a message with `pFileName`, line and
column, #GN_ERROR_RULES is returned and the rules in force stay. Without any rules the first eligible exact method, or
else the fallback, serves each light. */
GN_API GnResult GN_CALL gnLoadRules(GnContext context, const char* pText, size_t size, const char* pFileName);

/** \brief gnLoadRules() with one of the bases that the library carries: "default", "quality", "battery", "thesis".
\return #GN_ERROR_OUT_OF_RANGE for another name, #GN_ERROR_UNSUPPORTED where the library was built without YAML. */
GN_API GnResult GN_CALL gnLoadShippedRules(GnContext context, const char* pName);

/** \brief Changes the rules in force as their text says under `presets`, from the next frame on: "default" has "low",
"medium", "high" and "ultra". Each is a change of the loaded base, not of the preset before it; null or "" is the base
as it stands, and so is what gnLoadRules() loads. Reads the text again: for a menu, not for every frame.
\return #GN_ERROR_OUT_OF_RANGE for a name that the base does not have, with a message that lists those it has,
    #GN_ERROR_RULES where no rules are loaded. The rules in force stay. */
GN_API GnResult GN_CALL gnSetPreset(GnContext context, const char* pName);

/** \brief Starts the cost model again from a knowledge base: the CSV text that `gnomon calibrate` writes.

Rows of this device are used where there are any; else those of the first device of its kind (software, integrated,
discrete), and how much faster or slower this one is is learned from the first timed frames. What running frames had
taught is forgotten; methods added later start from the rows of their algorithm, and those that nobody has measured from
the costliest of their kind. A row that cannot be used (NaN, a negative time, a missing cell) refuses the whole text, with
a message that has `pFileName`, its line and the value. A table without any row, or with rows of other algorithms only,
is a warning and changes nothing: predictions go on as they were.

A context begins with the knowledge that the library carries (gnLoadShippedKnowledge()); a host need not call either.
\return #GN_ERROR_KNOWLEDGE for text that is no knowledge base, one of another version, or one with a row that cannot be
used; what was known before stays, the library's own included. */
GN_API GnResult GN_CALL gnLoadKnowledge(GnContext context, const char* pText, size_t size, const char* pFileName);

/** \brief gnLoadKnowledge() with what the library carries of the device nearest to this one: as a context begins. */
GN_API GnResult GN_CALL gnLoadShippedKnowledge(GnContext context);

#include <gnomon/decisions.h>
#include <gnomon/measurements.h>

#ifdef __cplusplus
}
#endif
#endif /* GNOMON_GNOMON_H */
