/** \file scene.h
\brief What casts and what shines: meshes, instances, lights. Included by gnomon.h, not by hosts.

Everything given here is kept until it is destroyed; a handle carries a generation, so that a stale one is an error and
never another object.
*/
#ifndef GNOMON_SCENE_H
#define GNOMON_SCENE_H

/* --- geometry -------------------------------------------------------------------------------------------------- */

/** \name Sides
The front of a triangle is the side from which its corners go counter-clockwise, in object space, or clockwise where
GnMeshCreateInfo::frontFace says so. All triangles stop light from both sides, whichever of them the host draws.
- A mesh is *closed* where every edge is used equally often in both directions; its fronts are the outside. The host may
  cull its backs or draw both sides.
- An *open* mesh is taken to be drawn from both sides. Of a host that draws fronts only, #GN_INSTANCE_SINGLE_SIDED_BIT
  says so: methods that count volumes would otherwise take the outline of what is missing for a shadow, as they do where
  a host draws nothing of what it registers, unless their setting `z_fail` is 1.
- A transform with a negative determinant *mirrors*: triangles go round the other way in the world, and the front stays
  the front. A host that culls turns its front face for such an instance; gnomon does so by itself.
- A closed shell of negative volume is *inside out*, unless it is a cavity in a solid of the same mesh: a room whose
  walls look inwards, or an exporter's mistake. It is reported once by name (message MeshInsideOut) and served like an
  open mesh of which the host draws either the fronts or both sides: right for either host, and slower than a solid.
- Normals that the host gives (GnViewFrame::normalImage) belong to the side that is seen, and look towards the eye. */

/** What a mesh in buffers is. */
typedef enum GnMeshFlagBits {
    GN_MESH_NO_CPU_COPY_BIT = 0x1, ///< Never copied to the CPU. Methods that need topology, rays or triangles there do
                                   ///< not serve lights that have it in range, and say so.
    GN_MESH_CLOSED_BIT = 0x2,      ///< The host knows that it is closed (see "Sides"): while no topology is there to
                                   ///< tell, it is drawn as a solid, without bias. Wrongly set, its shadow has holes.
    GN_MESH_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnMeshFlagBits;
/** Bits of #GnMeshFlagBits. */
typedef VkFlags GnMeshFlags;

/** Where a mesh lies in buffers of the host.

The GPU reads them once, in the first frame that begins after the call, into buffers of gnomon's own, as 12-byte
positions and 32-bit indices. Both buffers have VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, and belong to the context's queue
family or are shared with it. They must live, and keep their content, until that frame is in
GnFrameInfo::completedFrame; where it is dropped or fails, until the one after it is. Commands that the host gave to the
context's queue before that frame need no barrier towards it, nor do copies and compute passes that write the buffers
after it; other queues need their semaphores.

`range` is how many bytes from `offset` on may be read; VK_WHOLE_SIZE is no number. Where an index is past the vertices,
its triangle casts nothing; what is not finite, or beyond 1e18, becomes 0. Either is reported once, by message, when the
frame is completed. */
typedef struct GnMeshBuffers {
    uint32_t structSize GN_SIZE_OF(GnMeshBuffers); ///< sizeof(GnMeshBuffers).
    VkFormat positionFormat;          ///< R32G32B32_SFLOAT, R16G16B16A16_SFLOAT or R16G16B16A16_SNORM; w is not read.
    VkDescriptorBufferInfo positions; ///< Required. `offset`, a multiple of 4, is that of vertex 0.
    VkDescriptorBufferInfo indices; ///< `offset`, a multiple of the size of an index, is that of the first one; 16-bit
                                    ///< indices are read in pairs: up to the next multiple of 4. Null: 0, 1, 2, ...
    VkIndexType indexType;          ///< UINT16 or UINT32.
    int32_t vertexOffset;           ///< Added to every index, as by vkCmdDrawIndexed().
    float positionScale[3];         ///< Position = value * scale + bias. All zero means 1.
    float positionBias[3];          ///< Object space.
    float boundsMin[3], boundsMax[3]; ///< Required. Object space: what lies outside may be culled.
} GnMeshBuffers;

/** Describes a triangle mesh, in arrays, which are copied before the call returns, or in buffers. */
typedef struct GnMeshCreateInfo {
    uint32_t structSize GN_SIZE_OF(GnMeshCreateInfo); ///< sizeof(GnMeshCreateInfo).
    const char* pName;                                ///< Optional.
    const float* pPositions;                          ///< Required without pBuffers. xyz, object space, finite.
    uint32_t positionCount;                           ///< Number of vertices.
    uint32_t positionStride;       ///< Bytes between vertices; 0: those of a position. Multiple of 4.
    uint32_t indexCount;           ///< Multiple of 3.
    const uint32_t* pIndices;      ///< Three per triangle, in the order of frontFace; null: 0, 1, 2, ...
    const GnMeshBuffers* pBuffers; ///< Null: the mesh is in pPositions and pIndices, which are null otherwise.
    VkFrontFace frontFace;         ///< How the corners of a triangle go, seen from its front; 0: counter-clockwise.
    GnMeshFlags flags;             ///< Of a mesh in buffers; else 0.
} GnMeshCreateInfo;

/** \brief Adds a mesh. Topology and ray-tracing trees are built by workers; until then the mesh casts by the methods
that do not need them. Zero-area triangles are dropped with a warning. Any thread.

A mesh in buffers casts from the next frame on. Unless #GN_MESH_NO_CPU_COPY_BIT forbids it, its content is copied to
the CPU in its first frame, and again whenever eight frames in a row have not rewritten it, without a wait; some
frames later topology and trees are built of that. Until then methods that need them do not serve its lights, and say
so. One that is rewritten all the time stays so.
\return #GN_ERROR_EMPTY, #GN_ERROR_OUT_OF_RANGE (an index; `range` too small, with how much is needed; offset, stride
    or flags), #GN_ERROR_UNSUPPORTED (format or type of index), #GN_ERROR_NOT_A_NUMBER, #GN_ERROR_INFINITE,
    #GN_ERROR_TOO_MANY (more than a storage buffer of the device holds, or an index that it does not draw). */
GN_API GnResult GN_CALL gnCreateMesh(GnContext context, const GnMeshCreateInfo* pCreateInfo, GnMesh* pMesh);

/** \brief Replaces all positions of a mesh of arrays (same count as at creation). Seen from the next frame on. Any
thread. */
GN_API GnResult GN_CALL gnUpdateMeshPositions(GnContext context, GnMesh mesh, const float* pPositions,
                                              uint32_t positionCount, uint32_t positionStride);

/** \brief Replaces all positions of a mesh in buffers: skinning, cloth. Format, stride, scale, bias and count are those
of its creation. The GPU reads the buffer once, in the next frame, and before everything that this frame draws; what
GnMeshBuffers says of lifetime and order holds. The CPU does nothing per vertex. Any thread.
\param pPositions read during the call only.
\param boundsMin, boundsMax new bounds, object space; null: those from before hold.
\return #GN_ERROR_INVALID_HANDLE for a mesh of arrays, #GN_ERROR_OUT_OF_RANGE as gnCreateMesh(). */
GN_API GnResult GN_CALL gnUpdateMeshFromBuffer(GnContext context, GnMesh mesh, const VkDescriptorBufferInfo* pPositions,
                                               const float boundsMin[3], const float boundsMax[3]);

/** \brief Destroys the mesh; instances still using it cast nothing. Memory waits for the GPU by itself. Any thread. */
GN_API void GN_CALL gnDestroyMesh(GnContext context, GnMesh mesh);

/** Where something stands. A value: see \ref gn_structures. Row-major 3x3 (rotation, scale, shear) and a double
translation in metres. */
typedef struct GnTransform {
    float basis[9];        ///< Rows of the linear part; all zero means identity. The elements of its inverse are at
                           ///< most 1e18 as well. Rays and volumes work in the mesh's own units: at a scale of 1e-9
                           ///< (none at 1e-8) rays have been seen to lose a caster.
    double translation[3]; ///< World space, metres.
} GnTransform;

/** What an instance is. */
typedef enum GnInstanceFlagBits {
    GN_INSTANCE_STATIC_BIT = 0x1,           ///< Will not move. If it does: reported once, moving from then on.
                                            ///< Host-drawn: nor change its shape; without the bit it is drawn again in
                                            ///< every frame.
    GN_INSTANCE_ALPHA_TESTED_BIT = 0x2,     ///< Rays ask pfnOpacity. Depth maps draw the whole mesh, unless the host
                                            ///< draws the instance; volumes, planar shadows and spans refuse a light
                                            ///< that has it in range.
    GN_INSTANCE_HOST_DRAWN_BIT = 0x4,       ///< Drawn by pfnDrawCasters; methods that read triangles cannot see it.
    GN_INSTANCE_MAY_BE_MISSED_BIT = 0x8,    ///< Methods that cannot see this host-drawn or alpha-tested instance serve
                                            ///< its lights all the same, and leave it out.
    GN_INSTANCE_SINGLE_SIDED_BIT = 0x10,    ///< The host draws the front of an open mesh only: see "Sides" above.
    GN_INSTANCE_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnInstanceFlagBits;
/** Bits of #GnInstanceFlagBits. */
typedef VkFlags GnInstanceFlags;

/** How a raster pass looks at casters: what pfnDrawCasters needs to draw into it. */
typedef struct GnCasterProjection {
    uint32_t structSize GN_SIZE_OF(GnCasterProjection); ///< The library's sizeof(GnCasterProjection).
    float clipFromWorld[16];   ///< Column-major; world here means relative to `origin`.
    double origin[3];          ///< World position of the zero of `clipFromWorld`, metres.
    VkRect2D area;             ///< Viewport (depth 0 to 1) and scissor, set before each call.
    VkFormat depthFormat;      ///< The only attachment of the pass.
    float slopeBias;           ///< Third value of vkCmdSetDepthBias, the others being 0. Set before each call, for
                               ///< pipelines that enable depth bias and take it from dynamic state; others should have
                               ///< the same.
} GnCasterProjection;

/** Draws the host's casters of this instance, depth only: depth is 0 near the light and 1 far from it, compare LESS,
and what is nearer than the near end may be clipped: of what lies within the instance's bounds only what is nearer than
1/10000 of the distance of the farthest caster. Records into `commandBuffer` inside a rendering scope; may bind any
state. Called where the map is drawn: in every frame, once per pass that the instance's bounds touch, unless the
instance is #GN_INSTANCE_STATIC_BIT. On the thread of the call that begins the frame, or of its gnFinishShadows(). */
typedef void(GN_CALL* PFN_gnDrawCasters)(VkCommandBuffer commandBuffer, const GnCasterProjection* pProjection,
                                         void* pUserData);
/** Opacity in [0, 1] of a hit; below 0.5 the ray goes on. `triangle` counts as the mesh was given: its corners are
indices 3 * triangle and the two after. The hit is at (1 - u - v), u and v of the first, second and third corner. Called
from worker threads, concurrently. */
typedef float(GN_CALL* PFN_gnOpacity)(uint32_t triangle, float u, float v, void* pUserData);

/** Transforms of instances in a Vulkan buffer, where the GPU alone reads them: those of a crowd or of particles that
compute shaders move. Methods with #GN_TRAIT_GPU_TRANSFORMS_BIT show such instances; others do not serve lights that
have them in range.

An element is twelve floats, three rows of (basis, translation), as VkTransformMatrixKHR. The buffer has
VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, and belongs to the context's queue family or is shared with it. It is read at the
start of every frame: commands that the host gave to the context's queue before that frame need no barrier towards it,
nor do copies and compute passes that write the buffer after it. It must live until the instances are gone, or have
another one, and the frames that read it are in GnFrameInfo::completedFrame. An element that is no transform (not
finite, beyond 1e18, a basis without an inverse or with the wrong sign of its determinant) is reported once, by message,
and its instance casts nothing. */
typedef struct GnTransformBuffer {
    uint32_t structSize GN_SIZE_OF(GnTransformBuffer); ///< sizeof(GnTransformBuffer).
    uint32_t stride;                   ///< Bytes from one to the next, a multiple of 4, at least 48; 0 means 48.
    VkBool32 mirrored;                 ///< All determinants are negative; else all are positive.
    VkDescriptorBufferInfo transforms; ///< Required. Of the first instance on; VK_WHOLE_SIZE is no number.
    double origin[3];                  ///< World position of the zero of translations and bounds, metres. Near the
                                       ///< instances where these are far from the world's zero.
    const float* pBounds;              ///< Required. Six floats an instance, lower and upper corner of a box along the
                                       ///< world's axes that holds it until other bounds are given: what lies outside
                                       ///< may be culled. Relative to `origin`, metres. Read during the call.
} GnTransformBuffer;

/** Describes an instance. The host is taken to draw what it registers; "Sides" above says which sides. */
typedef struct GnInstanceCreateInfo {
    uint32_t structSize GN_SIZE_OF(GnInstanceCreateInfo); ///< sizeof(GnInstanceCreateInfo).
    GnInstanceFlags flags;
    const char* pName;                ///< Optional.
    GnMesh mesh;                      ///< Required unless host-drawn.
    GnTransform transform;
    uint32_t casterMask;              ///< Casts for a light if (casterMask & light mask) != 0; 0 means all bits.
    float boundsMin[3], boundsMax[3]; ///< Host-drawn: object-space bounds. Otherwise ignored.
    PFN_gnDrawCasters pfnDrawCasters; ///< Host-drawn: required.
    PFN_gnOpacity pfnOpacity;         ///< Alpha-tested: asked by methods that trace. Null: rays stop at all of the
                                      ///< mesh.
    void* pUserData;                  ///< For the two callbacks. What it points to must live until the frame that was
                                      ///< under way at gnDestroyInstance() is finished.
    const GnTransformBuffer* pTransformBuffer; ///< Optional: the transform lies there, and `transform` is ignored. Of
                                               ///< an instance with a mesh, which counts as moving in every frame.
} GnInstanceCreateInfo;

/** \brief Adds an instance. Any thread. */
GN_API GnResult GN_CALL gnCreateInstance(GnContext context, const GnInstanceCreateInfo* pCreateInfo,
                                         GnInstance* pInstance);
/** \brief Adds `count` instances that differ in their transforms alone: a forest. All of them, or on an error none.
Any thread.
\param pCreateInfo of each; its transform is ignored.
\param pTransforms `count` of them; null if pCreateInfo->pTransformBuffer holds as many. The message of an error says
    which one is at fault.
\param pInstances `count` handles, as gnCreateInstance() gives them. */
GN_API GnResult GN_CALL gnCreateInstances(GnContext context, const GnInstanceCreateInfo* pCreateInfo, uint32_t count,
                                          const GnTransform* pTransforms, GnInstance* pInstances);
/** \brief Moves many. Seen from the next frame on, all of them by the same one. On an error (a handle, a transform; the
message says which one) none moves. Any thread.
\param pInstances, pTransforms `count` of each; instances in any order, from any call. */
GN_API GnResult GN_CALL gnSetInstanceTransforms(GnContext context, uint32_t count, const GnInstance* pInstances,
                                                const GnTransform* pTransforms);
/** \brief New bounds, and if it is another one a new buffer, for instances that have their transforms in one. Seen from
the next frame on, all of them by the same one; on an error none changes. Any thread.
\param pInstances `count` of them, the first of which has the first element; in any order, from any call.
\return #GN_ERROR_INVALID_HANDLE for an instance that was made with a transform. */
GN_API GnResult GN_CALL gnUpdateInstancesFromBuffer(GnContext context, uint32_t count, const GnInstance* pInstances,
                                                    const GnTransformBuffer* pTransformBuffer);
/** \brief Moves it. Seen from the next frame on. Any thread. What is no transform
(NaN, infinity, a basis without an inverse): an error, the old one stays. */
GN_API GnResult GN_CALL gnSetInstanceTransform(GnContext context, GnInstance instance, const GnTransform* pTransform);
/** \brief New object-space bounds of a host-drawn instance, whose shape is the host's to change. Seen from the next
frame on. Any thread. \return #GN_ERROR_INVALID_HANDLE for an instance with a mesh. */
GN_API GnResult GN_CALL gnSetInstanceBounds(GnContext context, GnInstance instance, const float boundsMin[3],
                                            const float boundsMax[3]);
/** \brief For which lights it casts: those of a mask with a bit in common. 0 means all bits; a bit that no light has,
for none. Seen from the next frame on; what is static stays so. Any thread. */
GN_API GnResult GN_CALL gnSetInstanceCasterMask(GnContext context, GnInstance instance, uint32_t casterMask);
/** \brief Swaps the mesh (level of detail). Any thread. */
GN_API GnResult GN_CALL gnSetInstanceMesh(GnContext context, GnInstance instance, GnMesh mesh);
/** \brief Removes it. Any thread. */
GN_API void GN_CALL gnDestroyInstance(GnContext context, GnInstance instance);

/* --- lights ----------------------------------------------------------------------------------------------------- */

/** Kinds of light. */
typedef enum GnLightType {
    GN_LIGHT_TYPE_DIRECTIONAL = 0,
    GN_LIGHT_TYPE_SPOT = 1,
    GN_LIGHT_TYPE_POINT = 2,
    GN_LIGHT_TYPE_MAX_ENUM = 0x7FFFFFFF
} GnLightType;

/** What a light is. */
typedef enum GnLightFlagBits {
    GN_LIGHT_STATIC_BIT = 0x1, ///< Will not move. If it does: reported once, moving from then on.
    GN_LIGHT_SAMPLED_BIT = 0x2, ///< The host's shaders look its shadows up themselves (gnGetSampledShadows()), too.
                                ///< Where its method has no map for that, one is drawn beside it, in every frame in
                                ///< which something in it moves; budgets do not count it.
    GN_LIGHT_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnLightFlagBits;
/** Bits of #GnLightFlagBits. */
typedef VkFlags GnLightFlags;

/** What of a light shines. Visibility is the share of its area that a receiver sees. */
typedef enum GnSourceShape {
    GN_SOURCE_SHAPE_SPHERE = 0,    ///< Of `sourceRadius`, counted as the disc that it turns to a receiver. Directional:
                                   ///< a disc in the sky.
    GN_SOURCE_SHAPE_RECTANGLE = 1, ///< Spot: around `position`, across `direction`. Methods with
                                   ///< #GN_TRAIT_FLAT_SOURCE_BIT show its penumbra; others with penumbrae count it as a
                                   ///< disc of the same area, and #GN_QUESTION_WHY says so.
    GN_SOURCE_SHAPE_DISC = 2,      ///< Spot: of `sourceRadius` around `position`, across `direction`. Methods with
                                   ///< #GN_TRAIT_FLAT_SOURCE_BIT show its penumbra; others with penumbrae count it as a
                                   ///< sphere of the same radius, and #GN_QUESTION_WHY says so.
    GN_SOURCE_SHAPE_MAX_ENUM = 0x7FFFFFFF
} GnSourceShape;

/** Describes a light. */
typedef struct GnLightInfo {
    uint32_t structSize GN_SIZE_OF(GnLightInfo); ///< sizeof(GnLightInfo).
    GnLightType type;
    GnLightFlags flags;
    const char* pName;   ///< Optional; copied at creation, ignored by updates.
    double position[3];  ///< Spot and point. World space, metres.
    float direction[3];  ///< Directional and spot: the way light travels. Need not be normalised; not zero.
    float range;         ///< Metres; 0 means unlimited.
    float coneAngle;     ///< Spot: half angle in radians, (0, pi/2 - 0.02]; 0 means pi/4.
    float sourceRadius;  ///< Metres (directional: radians); 0 asks for hard shadows. Rectangle: 0.
    float importance;    ///< Weight of this light in the plan; 0 means 1.
    uint32_t casterMask; ///< 0 means all bits.
    GnSourceShape sourceShape;
    float sourceExtents[2]; ///< Rectangle: half its width and half its height, metres; both 0 ask for hard shadows.
    float sourceAxis[3];    ///< Rectangle: along its width; what of it lies along `direction` does not count. Need not
                            ///< be normalised; neither zero nor along `direction`.
} GnLightInfo;

/** \brief Adds a light; views name it in their frames. */
GN_API GnResult GN_CALL gnCreateLight(GnContext context, const GnLightInfo* pInfo, GnLight* pLight);
/** \brief Replaces everything but the name. An invalid description changes nothing. */
GN_API GnResult GN_CALL gnUpdateLight(GnContext context, GnLight light, const GnLightInfo* pInfo);
/** \brief Pins a method, overruling the rules; null hands the light back to them. A method that cannot serve the light
is refused with the reason. */
GN_API GnResult GN_CALL gnSetLightMethod(GnContext context, GnLight light, const char* pMethod);
/** \brief Removes it, its pin, and what was kept and learned of it. Frames begun before end with it. */
GN_API void GN_CALL gnDestroyLight(GnContext context, GnLight light);

#endif /* GNOMON_SCENE_H */
