/** \file frames.h
\brief Views and frames: what a camera sees goes in, visibility comes out. Included by gnomon.h, not by hosts.
*/
#ifndef GNOMON_FRAMES_H
#define GNOMON_FRAMES_H

/** What is special about a view. */
typedef enum GnViewCreateFlagBits {
    GN_VIEW_PACKED_BIT = 0x1, ///< Visibility of four lights a texel: R8G8B8A8_UNORM, light i in channel i % 4 of layer
                              ///< i / 4; 1 in channels without a light, and layers without any are left as they are. It
                              ///< is packed from layers of gnomon's own, a light each, by one pass for four lights.
    GN_VIEW_CREATE_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnViewCreateFlagBits;
/** Bits of #GnViewCreateFlagBits. */
typedef VkFlags64 GnViewCreateFlags;

/** Describes a view. */
typedef struct GnViewCreateInfo {
    uint32_t structSize GN_SIZE_OF(GnViewCreateInfo); ///< sizeof(GnViewCreateInfo).
    uint32_t maxLights; ///< Layers of visibility; 0 means 16. [1, 256] and the device's maximum.
    const char* pName;  ///< Optional.
    VkExtent2D imageExtent; ///< Optional: GnViewFrame::imageExtent of its frames. gnGetVisibility() gives the image
                            ///< from the start; frames of another size replace it. Zero: made in the first frame.
    GnViewCreateFlags flags;
} GnViewCreateInfo;

/** \brief Creates a view. It has no visibility until it has been in a frame, unless `imageExtent` is given. Its
decisions of 256 frames are kept for gnExplain(): some 59 kB of the host's memory a light and 12 kB a method more. */
GN_API GnResult GN_CALL gnCreateView(GnContext context, const GnViewCreateInfo* pCreateInfo, GnView* pView);
/** \brief Destroys a view, and finishes a frame under way first. Its visibility image stays until the frames that were
begun before are completed (GnFrameInfo::completedFrame): what reads it must have been submitted by then. */
GN_API void GN_CALL gnDestroyView(GnContext context, GnView view);

/** Which depth means near. */
typedef enum GnDepthConvention {
    GN_DEPTH_REVERSED_INFINITE = 0, ///< 1 at the near plane, 0 at infinity. Recommended.
    GN_DEPTH_REVERSED = 1,          ///< 1 near, 0 far.
    GN_DEPTH_STANDARD = 2,          ///< 0 near, 1 far.
    GN_DEPTH_CONVENTION_MAX_ENUM = 0x7FFFFFFF
} GnDepthConvention;

/** How texels of a normal image are read; xyz, or xy, as sampled. */
typedef enum GnNormalEncoding {
    GN_NORMAL_SIGNED = 0,              ///< xyz.
    GN_NORMAL_UNSIGNED = 1,            ///< 2 xyz - 1.
    GN_NORMAL_OCTAHEDRAL = 2,          ///< xy in [-1, 1]: the octahedron |x| + |y| + |z| = 1, its lower half folded out
                                       ///< (Cigolle et al. 2014, JCGT 3(2), `oct`).
    GN_NORMAL_OCTAHEDRAL_UNSIGNED = 3, ///< The same with 2 xy - 1.
    GN_NORMAL_ENCODING_MAX_ENUM = 0x7FFFFFFF
} GnNormalEncoding;

/** One view's part of a frame; read during the call only. Its images are in SHADER_READ_ONLY_OPTIMAL
on entry and again on return; what was drawn into them must be available (a barrier to ALL_COMMANDS, or a semaphore).
After the call gnomon's reads are pending on the queue: order your next writes after ALL_COMMANDS, and after
gnBeginShadows() keep the contents until gnFinishShadows() has returned. Mip level 0 is read. Views may share an image
(parts of it by renderArea, layers of it by imageLayer, samples of it by imageSample) through the same image view.

Depth images of several samples: a view judges one sample of each pixel, where that sample lies. Visibility is exactly
that of sample `imageSample`; at a pixel whose samples show several surfaces the others' may differ. Give one view per
sample for visibility per sample, or judge one sample and let lighting use it for the whole pixel.

Depth that is not one 2D image of D32_SFLOAT values, and that of an oblique near plane, is copied first: 4 bytes and one
full-screen pass a view; normals that are not 16-bit or 32-bit floats as they are, likewise 8 bytes. */
typedef struct GnViewFrame {
    uint32_t structSize GN_SIZE_OF(GnViewFrame); ///< sizeof(GnViewFrame); the same for all views of a frame.
    GnView view;              ///< Required.
    double eye[3];            ///< World position of the camera.
    float viewFromWorld[9];   ///< Row-major rotation; the translation is `eye`.
    float projection[16];     ///< Column-major clipFromView as it drew the depth, jitter included: a perspective, off
                              ///< centre or not, with a near plane that may be oblique ([2], [6]); or orthographic,
                              ///< sheared ([8], [9]) or not. Invertible. Insides of solids that an oblique near plane
                              ///< opens are dark by methods that trace every pixel, maybe lit by others. Clip y goes
                              ///< down the image, as in a viewport of positive height: hosts that draw with a negative
                              ///< one negate [1], [5], [9] and [13] here.
    GnDepthConvention depthConvention;
    VkImage depthImage;       ///< Required. SAMPLED, and TRANSFER_SRC where it is not copied first; its stencil is left
                              ///< alone.
    VkImageView depthView;    ///< Required. Depth aspect, 2D; with imageLayers 2D array.
    VkFormat depthFormat;     ///< D32_SFLOAT, D32_SFLOAT_S8_UINT, D24_UNORM_S8_UINT, X8_D24_UNORM_PACK32, D16_UNORM or
                              ///< D16_UNORM_S8_UINT. Shadows are as exact as the values: of 16 bits, reversed and
                              ///< infinite, one is 1.5 cm at 10 m from a near plane at 0.1 m.
    VkExtent2D imageExtent;   ///< Of the depth image, and of the visibility image.
    VkRect2D renderArea;      ///< Pixels drawn: the viewport of `projection`; a zero extent means the whole image.
    VkBool32 cameraCut;       ///< The camera jumped: measured facts and holds of the last frames do not apply.
    VkImage normalImage;      ///< Optional. Geometric normals, world space, finite; they need not be of unit length,
                              ///< and one of length 0 faces away from every light. SAMPLED and TRANSFER_SRC.
    VkImageView normalView;   ///< Samples, layers and kind of view as the depth image's.
    VkFormat normalFormat;    ///< R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT; or, read by `normalEncoding` and then
                              ///< copied, any other of floats or normalised integers that the device can sample.
    uint32_t lightCount;      ///< At most the view's maxLights.
    const GnLight* pLights;   ///< Layer i of the visibility image belongs to pLights[i]; each light at most once.
    uint32_t imageSamples;    ///< Of depth and normal image: 0 or 1, 2, 4 or 8. More than 1: at the device's
                              ///< standardSampleLocations, which it must have.
    uint32_t imageSample;     ///< The one that is judged, below imageSamples.
    uint32_t imageLayers;     ///< 0: image views are 2D. Else they are 2D arrays of so many layers, as of multiview.
    uint32_t imageLayer;      ///< The one that is the view's, below imageLayers.
    GnNormalEncoding normalEncoding;
    VkBool32 shadingNormals;  ///< Normals are bent by normal maps: they are not read. Depth alone says then where rays
                              ///< start, and nothing is dark for facing away.
    VkImage motionImage;      ///< Optional. Motion vectors, read by methods that average over frames (ray_soft): where
                              ///< the surface at a pixel was drawn in frame `frame` - 1. They count where the view and
                              ///< the light were in that frame, and it was not dropped. SAMPLED, one sample; layout
                              ///< and barriers as the depth image's.
    VkImageView motionView;   ///< 2D, whatever the depth image's layers are.
    VkFormat motionFormat;    ///< R16G16_SFLOAT, R32G32_SFLOAT, R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT.
    float motionScale[3];     ///< [0], [1]: times x and y it gives pixels from where the surface is to where it was,
                              ///< jitter included; 0 means 1. [2]: times z it gives metres that the surface was farther
                              ///< along the view's axis than it is; 0: not known, and z is not read. Finite.
} GnViewFrame;

/** What is special about a frame. */
typedef enum GnFrameFlagBits {
    GN_FRAME_TIMED_BIT = 0x1, ///< Time every pass of this frame.
    GN_FRAME_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnFrameFlagBits;
/** Bits of #GnFrameFlagBits. */
typedef VkFlags GnFrameFlags;

/** A point on a timeline semaphore; value 0 for a binary one. A value: see \ref gn_structures. */
typedef struct GnSemaphorePoint {
    VkSemaphore semaphore;
    uint64_t value;
} GnSemaphorePoint;

/** Describes a frame: all views come in one call. */
typedef struct GnFrameInfo {
    uint32_t structSize GN_SIZE_OF(GnFrameInfo); ///< sizeof(GnFrameInfo).
    uint64_t frame;          ///< Grows by one from call to call; the first may be any number > 0.
    uint64_t completedFrame; ///< Newest frame whose GPU work is finished, the host's reads of visibility included.
                             ///< Before `frame` by framesInFlight at most, else #GN_ERROR_FRAME_ORDER; 0: none yet.
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
#GN_ERROR_OUT_OF_DEVICE_MEMORY another attempt finds more room, the more so when frames in flight are completed: maps
and volumes kept for later frames have been given up, and so has the visibility of a view whose size was to change. */
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
    uint32_t structSize GN_SIZE_OF(GnVisibility); ///< sizeof(GnVisibility).
    VkImage image;
    VkImageView imageView; ///< 2D array of `format`.
    VkExtent2D extent;
    uint32_t layerCount;
    uint64_t revision;     ///< Grows when image or view handle change (resize): refresh descriptors. From 1 on.
    VkFormat format;       ///< R8_UNORM; of packed views R8G8B8A8_UNORM.
    uint32_t lightsPerTexel; ///< 1, or 4.
} GnVisibility;

/** \brief The newest visibility of a view; the same image from frame to frame, until the size of its views changes. The
one before stays until the frame that replaced it is completed.

A view that was created with its size has an image before its first frame: descriptors may be written, but nothing is in
it yet, its layout is undefined, and it must not be read. Where its first frames are dropped or fail, so it stays.
\return #GN_ERROR_FRAME_ORDER before the first frame of a view without a size. */
GN_API GnResult GN_CALL gnGetVisibility(GnContext context, GnView view, GnVisibility* pVisibility);

/** A method's map, for hosts with uses of their own (volumetric light, particles). Valid until the next frame call. As
visibility is: in SHADER_READ_ONLY_OPTIMAL, its writes available to fragment and compute shader reads later on the
queue. */
typedef struct GnLightMap {
    uint32_t structSize GN_SIZE_OF(GnLightMap); ///< sizeof(GnLightMap).
    VkImage image;
    VkImageView imageView;
    VkFormat format;
    VkExtent2D extent;
    uint32_t layerCount;
    uint32_t validLayers;       ///< Bit i: layer i holds this frame's casters. Layers that no receiver in a view
                                ///< can lie in are not drawn and may hold anything. Several layers of a
                                ///< directional light lie about slices of a view, finest first, the last one
                                ///< about all casters: look a receiver up in the first valid one that holds it.
    float clipFromWorld[6][16]; ///< One per layer, relative to `origin`; zero where a layer has no matrix.
    double origin[3];
} GnLightMap;

/** \brief The map the light's method kept after the last frame. \return #GN_ERROR_UNKNOWN_METHOD where it has none. */
GN_API GnResult GN_CALL gnGetLightMap(GnContext context, GnLight light, GnLightMap* pMap);

#define GN_SAMPLED_LIGHT_SIZE 432 ///< Bytes of one light in GnSampledShadows::pConstants.

/** What a host's shader looks up the shadows of a view's lights with, through gnomon/sample_shadow.h: for what is not
in the view's depth, such as glass and particles, or where there is no pass for lighting. Arrays have an element for
each of GnViewFrame::pLights of the newest frame and live until the next frame call, as GnLightMap does. */
typedef struct GnSampledShadows {
    uint32_t structSize GN_SIZE_OF(GnSampledShadows); ///< sizeof(GnSampledShadows).
    uint32_t lightCount;
    const VkImageView* pMaps;    ///< 2D arrays, to bind as sampled images in SHADER_READ_ONLY_OPTIMAL. Their writes are
                                 ///< available to fragment and compute shader reads later on the queue. What is not
                                 ///< looked up has any image there.
    const char* const* pMethods; ///< Whose map it is: the light's method, or what is drawn beside it. Null: the light
                                 ///< is lit everywhere, for lack of #GN_LIGHT_SAMPLED_BIT, of memory, or of a method
                                 ///< that is ready; or it reaches nothing that the view can see.
    VkSampler sampler;           ///< For all of them; lives as long as the context.
    const void* pConstants;      ///< For a uniform or storage buffer, of this frame alone. Depends on pOrigin.
    size_t constantsSize;        ///< lightCount * constantsStride.
    uint64_t revision;           ///< Grows when one of pMaps changes: write the descriptors again. From 1 on.
    uint32_t constantsStride;    ///< #GN_SAMPLED_LIGHT_SIZE of the header that goes with this library. Where it
                                 ///< differs, shaders have to be compiled with that header.
    uint32_t litCount;           ///< How many of pMethods are null.
} GnSampledShadows;

/** \brief What a view's lights were shadowed with in the newest frame, for shaders of the host's.

A method's filter goes into it (a disc as a box); lines and penumbrae are functions in gnomon/sample_shadow.h, and rays
are left out. #GN_LIGHT_SAMPLED_BIT asks for the map, not this call. Surfaces outside of the view have no shadows.
\param pOrigin World position, metres, of the zero of the positions that the shader gives: of a host with world
    coordinates (0, 0, 0), for which null stands, else the eye. Float positions far from it are as coarse as floats are.
\return #GN_ERROR_FRAME_ORDER if the view was not in the newest frame, or that does not count; #GN_ERROR_EMPTY if none
of its lights has #GN_LIGHT_SAMPLED_BIT. */
GN_API GnResult GN_CALL gnGetSampledShadows(GnContext context, GnView view, const double pOrigin[3],
                                            GnSampledShadows* pShadows);

#endif /* GNOMON_FRAMES_H */
