/** \file algorithm.h
\brief Shadow algorithms from outside: registered from C, or loaded from a shared object exporting gnPluginMain().

An algorithm declares passes and what they touch; order, barriers, memory and round trips follow. The built-in ones
speak through the same pass graph. An algorithm registered here is a method of the same name: rules may favour it,
gnEnumerateMethods() lists it, lights may be pinned to it.
*/
#ifndef GNOMON_ALGORITHM_H
#define GNOMON_ALGORITHM_H

#include <gnomon/gnomon.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Valid during one call of #PFN_gnDeclare. */
typedef struct GnPassBuilder_T* GnPassBuilder;
/** Valid during one call of #PFN_gnRecord or #PFN_gnRun. */
typedef struct GnPassContext_T* GnPassContext;

/** An image or buffer of this frame; 0 is none. */
typedef uint32_t GnImageRef;
typedef uint32_t GnBufferRef;

/** Where a pass runs. */
typedef enum GnPassKind {
    GN_PASS_RASTER = 0,   ///< A rendering scope with the declared attachments.
    GN_PASS_COMPUTE = 1,
    GN_PASS_TRANSFER = 2,
    GN_PASS_PREPARE = 3,  ///< CPU work that needs no GPU result of this frame; on a worker, before recording.
    GN_PASS_HOST = 4,     ///< CPU work between GPU passes; sees buffers only. Needs roundTrips > 0.
    GN_PASS_KIND_MAX_ENUM = 0x7FFFFFFF
} GnPassKind;

/** How often a pass or resource exists. The same scope, name and variant is the same pass or resource. */
typedef enum GnScope {
    GN_SCOPE_VIEW = 0,  ///< Once per view, whatever the lights.
    GN_SCOPE_LIGHT = 1, ///< Once per light, whatever the views.
    GN_SCOPE_TASK = 2,  ///< Once per (view, light, method).
    GN_SCOPE_MAX_ENUM = 0x7FFFFFFF
} GnScope;

/** What a pass does with an image or a buffer. */
typedef enum GnAccessKind {
    GN_ACCESS_SAMPLED = 0,       ///< Image, SHADER_READ_ONLY_OPTIMAL.
    GN_ACCESS_READ = 1,          ///< Buffer: storage, host or transfer source, as the pass kind says.
    GN_ACCESS_WRITE = 2,         ///< Image: colour attachment or transfer target; there are no storage images.
                                 ///< Buffer: storage, host write or transfer target, as the pass kind says.
    GN_ACCESS_UPDATE = 3,        ///< Buffer, read and written.
    GN_ACCESS_COPY_SOURCE = 4,   ///< Image, TRANSFER_SRC_OPTIMAL.
    GN_ACCESS_DEPTH_TEST = 5,
    GN_ACCESS_DEPTH_WRITE = 6,
    GN_ACCESS_STENCIL_TEST = 7,
    GN_ACCESS_STENCIL_WRITE = 8,
    GN_ACCESS_VERTICES = 9,
    GN_ACCESS_INDICES = 10,
    GN_ACCESS_INDIRECT = 11,
    GN_ACCESS_KIND_MAX_ENUM = 0x7FFFFFFF
} GnAccessKind;

/** One thing a pass touches. Writes to different layers or disjoint rectangles are unordered and get no barrier. */
typedef struct GnAccess {
    uint32_t structSize GN_SIZE_OF(GnAccess); ///< sizeof(GnAccess); the same for all accesses of a pass.
    GnAccessKind kind;
    GnImageRef image;     ///< Either this ...
    GnBufferRef buffer;   ///< ... or this; with neither the access is none.
    uint32_t baseLayer;
    uint32_t layerCount;  ///< 0 means 1. Attachments: the same for all of a pass, and several begin with layer 0.
    VkRect2D rect;        ///< Zero extent: everything.
    VkBool32 clear;       ///< Attachments: cleared to `clearValue` first.
    VkBool32 load;        ///< Attachments: what is there is read as well.
    VkClearValue clearValue;
} GnAccess;

/** Describes an image of the frame, or one that is kept. */
typedef struct GnImageInfo {
    uint32_t structSize GN_SIZE_OF(GnImageInfo); ///< sizeof(GnImageInfo).
    VkBool32 persistent; ///< Content is kept from frame to frame; see GnPluginInterface::pfnImageStale.
    const char* pName;   ///< "algorithm.what"; static storage.
    GnScope scope;
    VkFormat format;     ///< The device must sample, copy and render to it; else the task fails (pfnPass).
    VkExtent2D extent;
    uint32_t layers;     ///< 0 means 1.
    uint32_t variant;    ///< Distinguishes settings.
} GnImageInfo;

/** Who reaches a buffer. */
typedef enum GnBufferPlace {
    GN_BUFFER_DEVICE = 0,   ///< GPU only: pfnMapped gives null.
    GN_BUFFER_UPLOAD = 1,   ///< Written by prepare or host passes.
    GN_BUFFER_READBACK = 2, ///< Read by host passes.
    GN_BUFFER_PLACE_MAX_ENUM = 0x7FFFFFFF
} GnBufferPlace;

/** Describes a buffer of the frame, or one that is kept. */
typedef struct GnBufferInfo {
    uint32_t structSize GN_SIZE_OF(GnBufferInfo); ///< sizeof(GnBufferInfo).
    VkBool32 persistent; ///< As GnImageInfo's.
    const char* pName;   ///< As GnImageInfo's.
    GnScope scope;
    VkDeviceSize size;   ///< At most 2 GiB.
    GnBufferPlace place;
    uint32_t variant;
} GnBufferInfo;

/** Records a GPU pass into the command buffer; raster passes are inside their rendering scope. */
typedef void(GN_CALL* PFN_gnRecord)(GnPassContext context, VkCommandBuffer commandBuffer, const VkRect2D* pArea,
                                    void* pUserData);
/** Runs a prepare or host pass; on a worker thread. */
typedef void(GN_CALL* PFN_gnRun)(GnPassContext context, void* pUserData);

/** A pass. `pUserData` is copied bytewise (`userDataSize` bytes) and handed to the callback. */
typedef struct GnPassInfo {
    uint32_t structSize GN_SIZE_OF(GnPassInfo); ///< sizeof(GnPassInfo).
    const char* pName; ///< "algorithm.stage", static storage: debug label, timing and log word.
    GnPassKind kind;
    GnScope scope;
    uint32_t variant;
    uint32_t accessCount;
    const GnAccess* pAccesses;
    VkRect2D area;      ///< Raster, which has an attachment; within all of them. Zero extent: the first one's `rect`.
    PFN_gnRecord pfnRecord; ///< GPU passes.
    PFN_gnRun pfnRun;       ///< CPU passes.
    uint32_t userDataSize;  ///< At most 256.
    const void* pUserData;
} GnPassInfo;

/** A caster in the light's range. A value: see \ref gn_structures. Coordinates are relative to the frame's origin,
metres. */
typedef struct GnTaskCaster {
    VkBuffer vertexBuffer;  ///< float3 positions, object space; null for host-drawn casters.
    VkBuffer indexBuffer;   ///< uint32, counter-clockwise triangles.
    uint32_t indexCount;
    float worldFromObject[12]; ///< Three rows of (basis row, translation).
    float boundsMin[3], boundsMax[3];
    VkBool32 isStatic, closed;
} GnTaskCaster;

/** One light in one view: what a declaration turns into passes. Coordinates are relative to the frame's origin. */
typedef struct GnShadowTask {
    uint32_t structSize GN_SIZE_OF(GnShadowTask); ///< The library's sizeof(GnShadowTask).
    VkExtent2D extent;       ///< Of depth and visibility.
    VkRect2D area;           ///< Pixels to write; every one of them.
    float clipFromWorld[16];
    float eye[3];
    GnDepthConvention depthConvention;
    GnLightType lightType;
    float lightPosition[3];
    float lightDirection[3]; ///< Unit; the way light travels.
    float lightRange;        ///< Very large where unlimited.
    float coneAngle;         ///< Spot: half angle, radians.
    float sourceRadius;      ///< Metres (directional: radians); of a rectangle, of a disc of the same area.
    uint64_t casterStamp;    ///< Changes with light, casters in range or any of their transforms, not with what
                             ///< host-drawn casters draw; for pfnImageStale and pfnBufferStale.
    uint32_t casterCount;
    const GnTaskCaster* pCasters;
    uint32_t settingCount;
    const double* pSettings; ///< In the order of GnAlgorithmInfo::pSettings.
    GnImageRef visibility;   ///< R8_UNORM array; write layer `layer`.
    uint32_t layer;
    GnImageRef depth;        ///< Of clipFromWorld, 32-bit floats, the host's or a copy; sampled and copied only.
    GnImageRef normals;      ///< Geometric normals, 16-bit or 32-bit floats, or 0.
    uint64_t frame;          ///< GnFrameInfo's; descriptor sets last used in completedFrame or before may be rewritten.
    uint64_t completedFrame;
} GnShadowTask;

/** Declares the passes that write the task's visibility layer. Once per task and frame, on the frame's thread. */
typedef void(GN_CALL* PFN_gnDeclare)(void* pAlgorithm, GnPassBuilder builder, const GnShadowTask* pTask);

/** Describes an algorithm. Everything is copied. */
typedef struct GnAlgorithmInfo {
    uint32_t structSize GN_SIZE_OF(GnAlgorithmInfo); ///< sizeof(GnAlgorithmInfo).
    const char* pName;       ///< Required; the method's name.
    const char* pSource;     ///< Paper, or where it comes from.
    GnTraits traits;         ///< At least one light kind.
    uint32_t roundTrips;     ///< GPU-CPU-GPU; 0 may be recorded.
    uint32_t settingCount;
    const GnSettingInfo* pSettings; ///< `value` is the default.
    VkDeviceSize memoryPerPixel;    ///< Device bytes a light needs per pixel of the view.
    PFN_gnDeclare pfnDeclare;       ///< Required.
    void (GN_CALL* pfnDestroy)(void* pAlgorithm); ///< Optional.
    void* pAlgorithm;        ///< Handed to the callbacks.
} GnAlgorithmInfo;

/** \brief Registers an algorithm as a method of the same name. From the next frame on. Where it fails pfnDestroy is not
called: the algorithm stays the host's. \return as gnAddMethod(). */
GN_API GnResult GN_CALL gnRegisterAlgorithm(GnContext context, const GnAlgorithmInfo* pInfo);

struct GnPluginInterface;

/** Of the meaning of what this header declares. Members that are added at the end of a structure need no other version;
what else changes does. A plug-in, in C or in C++, says which it was compiled with:
`const uint32_t gnPluginVersion = GN_PLUGIN_VERSION;`. */
#define GN_PLUGIN_VERSION 1

/** What a plug-in exports under the name "gnPluginMain": registers its algorithms and returns the first failure. */
typedef GnResult(GN_CALL* PFN_gnPluginMain)(GnContext context, const struct GnPluginInterface* pInterface);

/** Defined by a plug-in as #GN_PLUGIN_VERSION; declared here for C linkage. */
extern GN_EXPORT const uint32_t gnPluginVersion;
/** Defined by a plug-in; see #PFN_gnPluginMain. Declared here for C linkage: hosts and gnomon have none. */
GN_EXPORT GnResult GN_CALL gnPluginMain(GnContext context, const struct GnPluginInterface* pInterface);

/** gnomon's side of the interface, so that a plug-in needs to link nothing. */
typedef struct GnPluginInterface {
    uint32_t structSize GN_SIZE_OF(GnPluginInterface); ///< The library's sizeof(GnPluginInterface).
    GnResult(GN_CALL* pfnRegisterAlgorithm)(GnContext context, const GnAlgorithmInfo* pInfo);
    GnImageRef(GN_CALL* pfnImage)(GnPassBuilder builder, const GnImageInfo* pInfo);
    GnBufferRef(GN_CALL* pfnBuffer)(GnPassBuilder builder, const GnBufferInfo* pInfo);
    VkBool32(GN_CALL* pfnImageStale)(GnPassBuilder builder, GnImageRef image, uint64_t stamp);
    VkBool32(GN_CALL* pfnBufferStale)(GnPassBuilder builder, GnBufferRef buffer, uint64_t stamp);
    /** After a failure the task's other passes are taken back, another method serves its light, or it is lit where none
    can, and the algorithm is asked for that light again after a second or more. An image written by a
    compute or CPU pass, or updated by any, and a host pass of an algorithm whose roundTrips is 0, are
    #GN_ERROR_UNSUPPORTED. The task fails as well by what the calls above do not take: their references are 0 then, and
    their stamps stale. */
    GnResult(GN_CALL* pfnPass)(GnPassBuilder builder, const GnPassInfo* pInfo);
    /** Null for what the frame has not. */
    VkImage(GN_CALL* pfnVkImage)(GnPassContext context, GnImageRef image);
    VkImageView(GN_CALL* pfnVkImageView)(GnPassContext context, GnImageRef image, uint32_t layer);
    VkBuffer(GN_CALL* pfnVkBuffer)(GnPassContext context, GnBufferRef buffer);
    void*(GN_CALL* pfnMapped)(GnPassContext context, GnBufferRef buffer); ///< CPU passes; null for #GN_BUFFER_DEVICE.
    VkDevice device;
    PFN_vkGetDeviceProcAddr pfnGetDeviceProcAddr;
} GnPluginInterface;

/** \brief The same interface for hosts that register algorithms of their own. Lives as long as the context. */
GN_API GnResult GN_CALL gnGetPluginInterface(GnContext context, const GnPluginInterface** ppInterface);

/** \brief Loads a shared object and calls its gnPluginMain. It stays loaded as long as the context.
\return #GN_ERROR_UNSUPPORTED with the loader's words if it cannot be loaded, exports no gnPluginMain or
    gnPluginVersion, or was compiled with another #GN_PLUGIN_VERSION; what gnPluginMain fails with. What it had
    registered by then stays. */
GN_API GnResult GN_CALL gnLoadPlugin(GnContext context, const char* pPath);

#ifdef __cplusplus
}
#endif
#endif /* GNOMON_ALGORITHM_H */
