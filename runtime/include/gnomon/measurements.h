/** \file measurements.h
\brief What frames, passes and lights took. Included by gnomon.h, not by hosts.
*/
#ifndef GNOMON_MEASUREMENTS_H
#define GNOMON_MEASUREMENTS_H

/** One pass of the newest frame whose timings are known. Strings live until the next frame call. */
typedef struct GnPassTiming {
    uint32_t structSize GN_SIZE_OF(GnPassTiming); ///< sizeof(GnPassTiming).
    const char* pName;
    GnView view;    ///< Null for light scope.
    GnLight light;  ///< Null for view scope.
    uint32_t round; ///< Number of CPU round trips before it.
    float gpuMs;    ///< 0 for host work. On software devices GPU time is CPU time.
    float cpuMs;    ///< Host and prepare passes, and recording.
    VkBool32 shared; ///< For all lights of the view, because a method needs it.
} GnPassTiming;

/** \brief Timings of the newest completed *timed* frame, two frames late. Timed are one frame in eight, four after a
method changed while time is counted, and every one with the flag. */
GN_API GnResult GN_CALL gnGetPassTimings(GnContext context, uint64_t* pFrame, uint32_t* pCount, GnPassTiming* pTimings);
/** \brief Names, views, lights and rounds of the passes of the *last* frame; times are 0. #GN_ERROR_FRAME_ORDER between
gnBeginShadows() and gnFinishShadows(): passes may still be added. */
GN_API GnResult GN_CALL gnGetFramePasses(GnContext context, uint32_t* pCount, GnPassTiming* pPasses);

/** What one light's own passes took in a timed frame. */
typedef struct GnLightTiming {
    uint32_t structSize GN_SIZE_OF(GnLightTiming); ///< sizeof(GnLightTiming).
    VkBool32 updated;       ///< False: what is kept per light was still valid, and the two times of updates are 0.
    uint64_t frame;         ///< The timed frame; 0: the light has not been timed yet, and nothing else is set.
    const char* pMethod;    ///< That served it. Lives as long as the context.
    float updateGpuMs;      ///< Maps, lists and volumes of the light. Scaled to a frame without full barriers.
    float updateCpuMs;
    float resolveGpuMs;     ///< What the view's pixels paid for the light.
    float resolveCpuMs;
} GnLightTiming;

/** \brief The newest timing of a light in a view: of a *timed* frame (see gnGetPassTimings()), two
frames late. */
GN_API GnResult GN_CALL gnGetLightTiming(GnContext context, GnView view, GnLight light, GnLightTiming* pTiming);

/** The sizes of a light's work in a timed frame: what the cost model thinks that its times depend on. For tools that
measure knowledge bases; a host that draws has no use for them. Other versions may have others. */
typedef struct GnLightWorkload {
    uint32_t structSize GN_SIZE_OF(GnLightWorkload); ///< sizeof(GnLightWorkload).
    GnLightType type;
    VkBool32 still;         ///< Neither light nor casters moved.
    uint64_t frame;         ///< GnLightTiming::frame; 0: the light has not been timed yet, and nothing else is set.
    double pixels;          ///< Reached by the light, as far as known.
    double casterTriangles; ///< In range.
    double drawnTriangles;  ///< Of them, those an update has to draw: all, or the moving ones of a light that rests.
    double casters;         ///< Instances in range.
    double mapTexels;       ///< Of the method's maps for the light; 0: none.
    double sharing;         ///< Lights of the view in that frame.
    double drawnPixels;     ///< Of the screen rectangle around what the light can reach.
    double viewPixels;      ///< Of the view's render area.
    double shadowPixels;    ///< Estimated, covered by the sides of shadow volumes; 0 for methods that draw none.
    double treeLevels;      ///< Estimated, of casters' trees on a ray's way to the light; 0 for methods that trace few.
    double mapFilled;       ///< Estimated share of the map that the casters an update draws fill; each counts.
    double mapTouched;      ///< Share of the light's maps, one or six faces, that these casters touch.
    double softPixels;      ///< `pixels` of a light with a radius; 0 for methods whose edges do not follow it.
} GnLightWorkload;

/** \brief The work that gnGetLightTiming() gives the times of. A row of a knowledge base is made of both. */
GN_API GnResult GN_CALL gnGetLightWorkload(GnContext context, GnView view, GnLight light, GnLightWorkload* pWorkload);

/** Counters and totals of the last frame; what stands still must cost nothing, and these say so. */
typedef struct GnFrameStats {
    uint32_t structSize GN_SIZE_OF(GnFrameStats); ///< sizeof(GnFrameStats).
    uint64_t frame;
    uint32_t rounds;            ///< 1 + GPU-CPU-GPU round trips.
    uint32_t submits;           ///< Also of a frame that failed.
    uint32_t hostWaits;         ///< Waits for this frame's own GPU results.
    uint32_t passesRun;
    uint32_t passesKept;        ///< Update passes skipped because their result was kept.
    uint32_t deviceAllocations; ///< Vulkan objects and memory made inside the frame calls.
    uint32_t indexListsBuilt;   ///< Silhouette or index lists built on the CPU.
    uint32_t pipelinesCreated;  ///< Inside the frame calls; warm-up excluded.
    uint32_t switches;          ///< Lights whose method differs from the frame before.
    uint32_t fading;            ///< Lights shown as a mix of two methods.
    uint64_t rays;              ///< Traced in the frame.
    float decideUs;             ///< Facts, rules and plan.
    float cpuMs;                ///< Time in which prepare and host passes ran; side by side counts once.
    float callMs;               ///< Wall time inside the frame calls.
    float gpuMs;                ///< Newest known GPU time of a whole frame (two frames late) ...
    uint64_t gpuFrame;          ///< ... which was this one; 0: none is known.
    float gpuFrameCpuMs;        ///< cpuMs of that frame: with gpuMs what its shadows took, and a budget is held
                                ///< against.
    VkDeviceSize memory;        ///< Device bytes held.
    float predictedMs;          ///< By the cost model, all lights, outgoing methods of fading ones included.
    float sharedMs;             ///< What belongs to no light, of the newest frames that were timed without being asked
                                ///< to: left out of predictedMs.
    float budgetMs;             ///< The budget the plan kept to: the host's, the rules' `shadowCapMs` where that is
                                ///< less or the host gives none, or that of `budget: auto`; 0: none.
    float raysMs;               ///< Inside the ray tracer's queries, wall time of every thread added up.
    uint32_t pagesEvicted;      ///< Pages of maps that made way for others, in a pool of fixed size.
    uint32_t pagesWithoutRoom;  ///< Pages that views asked for and that had no room: coarser ones answer for them.
} GnFrameStats;

/** \brief Of the newest frame, which may be one that failed (see gnSubmitShadows()); all zero before the first. */
GN_API GnResult GN_CALL gnGetFrameStats(GnContext context, GnFrameStats* pStats);

#endif /* GNOMON_MEASUREMENTS_H */
