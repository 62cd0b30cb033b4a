/** \file decisions.h
\brief Decisions, their facts and candidates, and questions about them. Included by gnomon.h, not by hosts.

Every view remembers what was decided for its lights in its last 256 frames: facts, rules, candidates, plan; numbers of
fixed size, text only when asked.
*/
#ifndef GNOMON_DECISIONS_H
#define GNOMON_DECISIONS_H

/** Why a method is a light's. */
typedef enum GnReason {
    GN_REASON_RULES = 0,          ///< Highest suitability among the eligible.
    GN_REASON_PINNED = 1,         ///< gnSetLightMethod().
    GN_REASON_INCUMBENT = 2,      ///< A tie; the method already running stays.
    GN_REASON_FALLBACK = 3,       ///< The wanted method is not ready; the fallback serves.
    GN_REASON_NOTHING_READY = 4,  ///< No method can serve; visibility is 1.
    GN_REASON_NO_OPINION = 5,     ///< No rule spoke for any eligible method; registry order or the plan's prices
                                  ///< decided.
    GN_REASON_BUDGET = 6,         ///< The plan: the best suitability does not fit the budget.
    GN_REASON_HELD = 7,           ///< The plan would change it, but does not yet: the gain is below the threshold,
                                  ///< others change in this frame, there has not been room in the budget for
                                  ///< long enough, the method flipped lately, the first frame of another one costs more
                                  ///< than it gains, others would give up more, or another light tries it first.
    GN_REASON_PRICE = 8,          ///< Another one suits better, but this one shows as much for less, or more for about
                                  ///< as much.
    GN_REASON_FLOOR = 9,          ///< Another one suits better, but its quality is below the floor under what is near.
    GN_REASON_UTILITY = 10,         ///< The plan: another one suits better, but with its quality is worth no more.
    GN_REASON_NOT_RECORDABLE = 11,  ///< The method that the host pinned needs the CPU between its passes, and the frame
                                    ///< is recorded (gnCmdRenderShadows()): the rules chose another one.
    GN_REASON_UNSEEN = 12,        ///< No pixel can be in the light's range: no method runs, and visibility is 1.
    GN_REASON_TRIAL = 13,         ///< It may be cheaper than what serves the light otherwise, shows as much or no plan
                                  ///< keeps the budget, and serves for a few frames so that its time is known.
    GN_REASON_MAX_ENUM = 0x7FFFFFFF
} GnReason;

/** What was decided for a light in a view in the last frame. */
typedef struct GnDecision {
    uint32_t structSize GN_SIZE_OF(GnDecision); ///< sizeof(GnDecision).
    const char* pMethod;           ///< Name, or null for #GN_REASON_NOTHING_READY. Lives as long as the context.
    GnReason reason;
    float suitability;             ///< [0, 1].
    float predictedMs;             ///< By the cost model, GPU and CPU; a guess until the method has been timed.
    float measuredMs;              ///< Of the newest timed frame of this light and method; 0 if none.
    float viewerDistance;          ///< Metres from the eye to the light's nearest visible receiver.
    VkBool32 viewerDistanceMeasured; ///< False: a lower bound.
    VkBool32 switched;             ///< Differs from the frame before.
    const char* pRule;             ///< Id of the strongest rule behind the method, or null. Valid until the next frame.
    const char* pOutgoing;         ///< The method the picture fades from, which runs as well; null: there is no fade.
    float fade;                    ///< (0, 1]. Share of `pMethod` in what is shown; 1: all of it.
    const char* pProbed;           ///< A method that runs unseen to be measured (`policy.probing`); null: there is
                                   ///< none.
    uint32_t mapSide;              ///< Texels per side of the method's maps for this light; 0: it has none.
    uint32_t wantedMapSide;        ///< What screen coverage asks for. Above `mapSide`: the memory for maps serves what
                                   ///< shows more (GnContextCreateInfo::memoryLimit), or another light has its turn.
    uint32_t redrawEvery;          ///< Frames from one drawing of the map to the next, as light and casters move now:
                                   ///< 1, 2, 4 or 8. 0: no map, or one that is drawn whenever anything in it moves.
    uint32_t mapAge;               ///< Frames since the map in use was drawn, where `redrawEvery` is not 0.
} GnDecision;

/** \brief What was decided for a light in a view in its last frame. \return #GN_ERROR_INVALID_HANDLE if the light was
not in that. */
GN_API GnResult GN_CALL gnGetDecision(GnContext context, GnView view, GnLight light, GnDecision* pDecision);

/** What a decision rested on. Strings are static. */
typedef struct GnFact {
    uint32_t structSize GN_SIZE_OF(GnFact); ///< sizeof(GnFact).
    const char* pName; ///< As rules spell it: "viewerDistance".
    const char* pUnit; ///< "m".
    double value;      ///< NaN: unknown.
} GnFact;

/** Why a method is not a light's. */
typedef enum GnElimination {
    GN_ELIMINATION_NONE = 0,       ///< It is the one.
    GN_ELIMINATION_UNABLE = 1,     ///< Cannot serve: kind of light, device, casters, memory.
    GN_ELIMINATION_NOT_READY = 2,  ///< Its pipelines have not run yet, or it was added after the frame.
    GN_ELIMINATION_PINNED = 3,     ///< The host pinned another one.
    GN_ELIMINATION_NEVER = 4,      ///< Vetoed by a rule.
    GN_ELIMINATION_NO_OPINION = 5, ///< No rule speaks about it, but rules speak about others.
    GN_ELIMINATION_FLOOR = 6,      ///< Near, and below the rule base's minimum quality.
    GN_ELIMINATION_BUDGET = 7,     ///< Worth more, but the time is not there.
    GN_ELIMINATION_HYSTERESIS = 8, ///< Worth more and affordable, but held back.
    GN_ELIMINATION_OUTSCORED = 9,  ///< Worth no more than the chosen one.
    GN_ELIMINATION_PRICE = 10,     ///< Suits better, but shows no more and is predicted to take longer.
    GN_ELIMINATION_MAX_ENUM = 0x7FFFFFFF
} GnElimination;

#define GN_SUITABILITY_STEPS 4096      ///< Suitability 1 in the unit of GnCandidate::suitability.
#define GN_SUITABILITY_NO_OPINION (-1) ///< No rule speaks about the method, or there are no rules.
#define GN_SUITABILITY_UNABLE (-2)     ///< The method cannot serve the light, whatever the rules say.
#define GN_SUITABILITY_NEVER (-3)      ///< Vetoed by a rule.

/** One method as a decision saw it. */
typedef struct GnCandidate {
    uint32_t structSize GN_SIZE_OF(GnCandidate); ///< sizeof(GnCandidate).
    const char* pMethod;       ///< Lives as long as the context.
    int32_t suitability;       ///< [0, #GN_SUITABILITY_STEPS], or one of the negative values above.
    GnElimination elimination;
    float quality;             ///< (0, 1]: share of the truth the method keeps.
    float predictedMs;         ///< By the cost model, GPU and CPU.
    float sureMs;              ///< What the choice counts with: predictedMs where the light was timed with the method;
                               ///< else what methods of its kind hardly exceed, so that the unknown is never cheap.
    float sharedMs;            ///< Beside predictedMs: work for the whole view (copies of its depth, say) that the
                               ///< method needs. Under a budget, what no other light's method needs; else the light's
                               ///< part if all had it.
} GnCandidate;

/** \brief The facts of the last decision of a light in a view. With null `pFacts` only the count is written.
\return #GN_INCOMPLETE if `*pCount` was too small; #GN_ERROR_INVALID_HANDLE if the light was not in the view's last
frame. */
GN_API GnResult GN_CALL gnGetFacts(GnContext context, GnView view, GnLight light, uint32_t* pCount, GnFact* pFacts);
/** \brief Every method in registry order, as the last decision of a light in a view saw it. With null `pCandidates`
only the count is written. \return As gnGetFacts(). */
GN_API GnResult GN_CALL gnGetCandidates(GnContext context, GnView view, GnLight light, uint32_t* pCount,
                                        GnCandidate* pCandidates);
/** What can be asked about a decision. */
typedef enum GnQuestionKind {
    GN_QUESTION_WHY = 0,          ///< Why this method: rules, facts, plan, cost, the runner-up.
    GN_QUESTION_WHY_NOT = 1,      ///< Why not `pMethod`: what eliminated it, and what would let it win.
    GN_QUESTION_WHAT_IF = 2,      ///< The smallest change of each single fact that flips the choice.
    GN_QUESTION_WHAT_CHANGED = 3, ///< What differs from the light's frame before.
    GN_QUESTION_DECISION = 4,     ///< The whole decision: all facts, rules that fired, and candidates with why each
                                  ///< lost. Of the newest frame alone, and longer than twelve lines.
    GN_QUESTION_KIND_MAX_ENUM = 0x7FFFFFFF
} GnQuestionKind;

/** How it is asked. */
typedef enum GnQuestionFlagBits {
    GN_QUESTION_SINCE_SWITCH_BIT = 0x1, ///< What changed: since the last frame in which another method served.
    GN_QUESTION_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnQuestionFlagBits;
/** Bits of #GnQuestionFlagBits. */
typedef VkFlags GnQuestionFlags;

/** A question about one decision. */
typedef struct GnQuestion {
    uint32_t structSize GN_SIZE_OF(GnQuestion); ///< sizeof(GnQuestion).
    GnQuestionKind kind;
    GnQuestionFlags flags;
    const char* pMethod; ///< Why not: required.
    uint64_t frame;      ///< 0 means the view's newest. One of its last 256.
} GnQuestion;

/** \brief Answers a question about a light's decision in a view, in at most twelve lines: plain words with numbers and
units, ids of rules and why they are there.

With null `pText` only the size (including the terminating zero) is written.
\param pQuestion Null asks why, about the newest frame.
\return #GN_INCOMPLETE if the buffer was too small; #GN_ERROR_OUT_OF_RANGE for a frame that is not on record (the
message says which are) or an unknown kind; #GN_ERROR_INVALID_HANDLE if the light was not in that frame;
#GN_ERROR_UNKNOWN_METHOD. */
GN_API GnResult GN_CALL gnExplain(GnContext context, GnView view, GnLight light, const GnQuestion* pQuestion,
                                  size_t* pSize, char* pText);

/** \brief Writes the decisions on record as bytes: a flight recorder. `gnomon why` answers the same questions from them
on any machine; a file may hold any number of such chunks, oldest first. runtime/select/record_log.hpp has the format.

With null `pData` only the size is written; it holds until the next frame. The rule base in force goes with them: call
this before loading another one.
\param firstFrame Frames before it are left out; 0: all 256.
\param frameOrigin Subtracted from frame numbers when the log is asked: what the host calls frame 0.
\return #GN_INCOMPLETE if the buffer was too small, and nothing was written; #GN_ERROR_OUT_OF_RANGE if no frame from
`firstFrame` on is on record, or if `frameOrigin` is after the first. */
GN_API GnResult GN_CALL gnGetDecisionLog(GnContext context, GnView view, uint64_t firstFrame, uint64_t frameOrigin,
                                         size_t* pSize, void* pData);

#endif /* GNOMON_DECISIONS_H */
