/** \file decisions.h
\brief Questions about decisions. Included by gnomon.h, not by hosts.

Every view remembers what was decided for its lights in its last 256 frames: facts, rules, candidates, plan; numbers of
fixed size, text only when asked.
*/
#ifndef GNOMON_DECISIONS_H
#define GNOMON_DECISIONS_H

typedef enum GnQuestionKind {
    GN_QUESTION_WHY = 0,          ///< Why this method: rules, facts, plan, cost, the runner-up.
    GN_QUESTION_WHY_NOT = 1,      ///< Why not `pMethod`: what eliminated it, and what would let it win.
    GN_QUESTION_WHAT_IF = 2,      ///< The smallest change of each single fact that flips the choice.
    GN_QUESTION_WHAT_CHANGED = 3, ///< What differs from the light's frame before.
    GN_QUESTION_KIND_MAX_ENUM = 0x7FFFFFFF
} GnQuestionKind;

typedef enum GnQuestionFlagBits {
    GN_QUESTION_SINCE_SWITCH_BIT = 0x1, ///< What changed: since the last frame in which another method served.
    GN_QUESTION_FLAG_BITS_MAX_ENUM = 0x7FFFFFFF
} GnQuestionFlagBits;
typedef VkFlags GnQuestionFlags;

/** A question about one decision. */
typedef struct GnQuestion {
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
