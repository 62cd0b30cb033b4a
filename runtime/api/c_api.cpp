// The C boundary: checks pointers, keeps exceptions and the floating-point mode inside, turns results into codes.
#include <algorithm>
#include <cstring>
#include <new>
#include <span>
#include <utility>

#include "rules/engine/float_mode.hpp"
#include "runtime/api/context.hpp"

struct GnContext_T {
    std::unique_ptr<gnomon::Context> impl;
};

namespace {

using namespace gnomon;

GnResult report(GnContext context, const Error& error) noexcept
{
    try {
        if (error.result == GN_ERROR_DEVICE_LOST) context->impl->noteLost();
        context->impl->lastErrors().set(error.text);
        context->impl->messages().error(error);
    } catch (...) { // no memory for the words; the code still says it
    }
    return error.result;
}

/// Of what was caught. Where memory is short there may be none for the words either; the code is returned all the same.
GnResult reportCaught(GnContext context, GnResult result, const char* id, const char* text) noexcept
{
    try {
        return report(context, {result, id, text});
    } catch (...) {
    }
    return result;
}

/// What every call answers once one of them has noticed the loss; that one alone has told it as a message.
GnResult refusedAsLost(Context& context) noexcept
{
    try {
        context.lastErrors().set("the device is lost");
    } catch (...) { // no memory for the words
    }
    return GN_ERROR_DEVICE_LOST;
}

/// Every entry point with a context runs in here.
template <typename Body>
GnResult atBoundary(GnContext context, Body&& body) noexcept
{
    if (!context || !context->impl) return GN_ERROR_NULL_ARGUMENT;
    const rules::FloatMode mode; // the host's is put aside: same inputs, same decision
    try {
        if (context->impl->lost()) return refusedAsLost(*context->impl);
        return body(*context->impl);
    } catch (const std::bad_alloc&) {
        return reportCaught(context, GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory", "host allocation failed");
    } catch (const std::exception& exception) {
        return reportCaught(context, GN_ERROR_UNKNOWN, "Unexpected", exception.what());
    } catch (...) {
        return reportCaught(context, GN_ERROR_UNKNOWN, "Unexpected", "unexpected exception");
    }
}

/// Told the host at once, since there is no context that could be asked; needs no memory.
GnResult failedContext(const GnContextCreateInfo& info, GnResult result, const char* id, const char* text) noexcept
{
    const GnMessage message{GN_SEVERITY_ERROR, result, id, text};
    if (info.pfnMessage) info.pfnMessage(&message, info.pUserData);
    return result;
}

GnResult nullArgument(GnContext context, const char* name)
{
    return report(context, {GN_ERROR_NULL_ARGUMENT, "NullArgument", std::string(name) + " is null"});
}

/// A value into *out, or the error; *out is untouched then (the caller cleared it).
template <typename T, typename Out>
GnResult give(GnContext context, const Result<T>& result, Out* out)
{
    if (!result) return report(context, result.error());
    *out = *result;
    return GN_SUCCESS;
}

GnResult status(GnContext context, const Result<void>& result)
{
    return result ? GN_SUCCESS : report(context, result.error());
}

GnResult status(GnContext context, const Result<GnResult>& result)
{
    return result ? *result : report(context, result.error());
}

/// As much of make(context)'s text as fits, ended by a zero; *pSize becomes the whole size, or 0 where it fails.
template <typename Make>
GnResult giveText(GnContext context, size_t* pSize, char* pText, Make&& make)
{
    const size_t room = pSize ? std::exchange(*pSize, 0) : 0;
    return atBoundary(context, [&](Context& c) {
        if (!pSize) return nullArgument(context, "pSize");
        const Result<std::string> text = make(c);
        if (!text) return report(context, text.error());
        const size_t wanted = text->size() + 1;
        *pSize = wanted;
        if (!pText) return GN_SUCCESS;
        if (room == 0) return GN_INCOMPLETE;
        const size_t fits = std::min(room, wanted) - 1;
        std::memcpy(pText, text->data(), fits);
        pText[fits] = '\0';
        return room < wanted ? GN_INCOMPLETE : GN_SUCCESS;
    });
}

/// fill(context, span) writes what fits into its span and says how many there are; *pCount becomes 0 where it fails.
template <typename T, typename Fill>
GnResult list(GnContext context, uint32_t* pCount, T* pOut, Fill&& fill)
{
    const uint32_t given = pCount ? std::exchange(*pCount, 0) : 0, room = pOut ? given : 0;
    return atBoundary(context, [&](Context& c) {
        if (!pCount) return nullArgument(context, "pCount");
        const Result<uint32_t> all = fill(c, std::span<T>(pOut, room));
        if (!all) return report(context, all.error());
        *pCount = pOut ? std::min(room, *all) : *all;
        return pOut && room < *all ? GN_INCOMPLETE : GN_SUCCESS;
    });
}

/// A value of make(context) into *pOut, which is zero where it fails.
template <typename Out, typename Make>
GnResult giveStruct(GnContext context, Out* pOut, const char* name, Make&& make)
{
    if (pOut) *pOut = {};
    return atBoundary(context, [&](Context& c) {
        if (!pOut) return nullArgument(context, name);
        return give(context, make(c), pOut);
    });
}

} // namespace

extern "C" {

GnResult GN_CALL gnCreateContext(const GnContextCreateInfo* pCreateInfo, GnContext* pContext)
{
    if (pContext) *pContext = nullptr;
    if (!pCreateInfo || !pContext) return GN_ERROR_NULL_ARGUMENT;
    const rules::FloatMode mode;
    try {
        const Messages messages(pCreateInfo->pfnMessage, pCreateInfo->pUserData, pCreateInfo->pName);
        Result<std::unique_ptr<Context>> made = Context::create(*pCreateInfo);
        if (!made) {
            messages.error(made.error());
            return made.error().result;
        }
        *pContext = new GnContext_T{std::move(*made)};
        return GN_SUCCESS;
    } catch (const std::bad_alloc&) {
        return failedContext(*pCreateInfo, GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory", "host allocation failed");
    } catch (const std::exception& exception) { // no thread was to be had, for instance
        return failedContext(*pCreateInfo, GN_ERROR_UNKNOWN, "Unexpected", exception.what());
    } catch (...) {
        return failedContext(*pCreateInfo, GN_ERROR_UNKNOWN, "Unexpected", "unexpected exception");
    }
}

void GN_CALL gnDestroyContext(GnContext context)
{
    const rules::FloatMode mode;
    delete context;
}

const char* GN_CALL gnGetLastError(GnContext context)
{
    return context && context->impl ? context->impl->lastErrors().get() : "the context is null";
}

GnResult GN_CALL gnWarmUp(GnContext context)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.warmUp()); });
}

GnResult GN_CALL gnWarmUpMethod(GnContext context, const char* pMethod)
{
    return atBoundary(context, [&](Context& c) {
        return pMethod ? status(context, c.warmUpMethod(pMethod)) : nullArgument(context, "pMethod");
    });
}

// --- geometry ---

GnResult GN_CALL gnCreateMesh(GnContext context, const GnMeshCreateInfo* pCreateInfo, GnMesh* pMesh)
{
    if (pMesh) *pMesh = VK_NULL_HANDLE;
    return atBoundary(context, [&](Context& c) {
        if (!pCreateInfo) return nullArgument(context, "pCreateInfo");
        if (!pMesh) return nullArgument(context, "pMesh");
        return give(context, c.scene().createMesh(*pCreateInfo), pMesh);
    });
}

GnResult GN_CALL gnUpdateMeshPositions(GnContext context, GnMesh mesh, const float* pPositions, uint32_t positionCount,
                                       uint32_t positionStride)
{
    return atBoundary(context, [&](Context& c) {
        if (!pPositions) return nullArgument(context, "pPositions");
        return status(context, c.scene().updateMeshPositions(mesh, pPositions, positionCount, positionStride));
    });
}

void GN_CALL gnDestroyMesh(GnContext context, GnMesh mesh)
{
    atBoundary(context, [&](Context& c) {
        c.scene().destroyMesh(mesh);
        return GN_SUCCESS;
    });
}

GnResult GN_CALL gnCreateInstance(GnContext context, const GnInstanceCreateInfo* pCreateInfo, GnInstance* pInstance)
{
    if (pInstance) *pInstance = VK_NULL_HANDLE;
    return atBoundary(context, [&](Context& c) {
        if (!pCreateInfo) return nullArgument(context, "pCreateInfo");
        if (!pInstance) return nullArgument(context, "pInstance");
        return give(context, c.scene().createInstance(*pCreateInfo), pInstance);
    });
}

GnResult GN_CALL gnSetInstanceTransform(GnContext context, GnInstance instance, const GnTransform* pTransform)
{
    return atBoundary(context, [&](Context& c) {
        if (!pTransform) return nullArgument(context, "pTransform");
        return status(context, c.scene().setInstanceTransform(instance, *pTransform));
    });
}

GnResult GN_CALL gnSetInstanceBounds(GnContext context, GnInstance instance, const float boundsMin[3],
                                     const float boundsMax[3])
{
    return atBoundary(context, [&](Context& c) {
        if (!boundsMin) return nullArgument(context, "boundsMin");
        if (!boundsMax) return nullArgument(context, "boundsMax");
        const float lower[3] = {boundsMin[0], boundsMin[1], boundsMin[2]},
                    upper[3] = {boundsMax[0], boundsMax[1], boundsMax[2]};
        return status(context, c.scene().setInstanceBounds(instance, lower, upper));
    });
}

GnResult GN_CALL gnSetInstanceCasterMask(GnContext context, GnInstance instance, uint32_t casterMask)
{
    return atBoundary(
        context, [&](Context& c) { return status(context, c.scene().setInstanceCasterMask(instance, casterMask)); });
}

GnResult GN_CALL gnSetInstanceMesh(GnContext context, GnInstance instance, GnMesh mesh)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.scene().setInstanceMesh(instance, mesh)); });
}

void GN_CALL gnDestroyInstance(GnContext context, GnInstance instance)
{
    atBoundary(context, [&](Context& c) {
        c.scene().destroyInstance(instance);
        return GN_SUCCESS;
    });
}

// --- lights ---

GnResult GN_CALL gnCreateLight(GnContext context, const GnLightInfo* pInfo, GnLight* pLight)
{
    if (pLight) *pLight = VK_NULL_HANDLE;
    return atBoundary(context, [&](Context& c) {
        if (!pInfo) return nullArgument(context, "pInfo");
        if (!pLight) return nullArgument(context, "pLight");
        return give(context, c.scene().createLight(*pInfo), pLight);
    });
}

GnResult GN_CALL gnUpdateLight(GnContext context, GnLight light, const GnLightInfo* pInfo)
{
    return atBoundary(context, [&](Context& c) {
        if (!pInfo) return nullArgument(context, "pInfo");
        return status(context, c.scene().updateLight(light, *pInfo));
    });
}

GnResult GN_CALL gnSetLightMethod(GnContext context, GnLight light, const char* pMethod)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.setLightMethod(light, pMethod)); });
}

void GN_CALL gnDestroyLight(GnContext context, GnLight light)
{
    atBoundary(context, [&](Context& c) {
        c.scene().destroyLight(light);
        return GN_SUCCESS;
    });
}

// --- views and frames ---

GnResult GN_CALL gnCreateView(GnContext context, const GnViewCreateInfo* pCreateInfo, GnView* pView)
{
    if (pView) *pView = VK_NULL_HANDLE;
    return atBoundary(context, [&](Context& c) {
        if (!pView) return nullArgument(context, "pView");
        return give(context, c.createView(pCreateInfo ? *pCreateInfo : GnViewCreateInfo{}), pView);
    });
}

void GN_CALL gnDestroyView(GnContext context, GnView view)
{
    atBoundary(context, [&](Context& c) {
        c.destroyView(view);
        return GN_SUCCESS;
    });
}

GnResult GN_CALL gnCmdRenderShadows(GnContext context, VkCommandBuffer commandBuffer, const GnFrameInfo* pFrame)
{
    return atBoundary(context, [&](Context& c) {
        if (!pFrame) return nullArgument(context, "pFrame");
        return status(context, c.recordFrame(commandBuffer, *pFrame));
    });
}

GnResult GN_CALL gnDropFrame(GnContext context, uint64_t frame)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.dropFrame(frame)); });
}

GnResult GN_CALL gnBeginShadows(GnContext context, const GnFrameInfo* pFrame)
{
    return atBoundary(context, [&](Context& c) {
        if (!pFrame) return nullArgument(context, "pFrame");
        return status(context, c.beginFrame(*pFrame, FrameMode::begin));
    });
}

GnResult GN_CALL gnFinishShadows(GnContext context, uint64_t timeoutNs)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.finishFrame(timeoutNs)); });
}

GnResult GN_CALL gnSubmitShadows(GnContext context, const GnFrameInfo* pFrame)
{
    return atBoundary(context, [&](Context& c) {
        if (!pFrame) return nullArgument(context, "pFrame");
        const Result<GnResult> begun = c.beginFrame(*pFrame, FrameMode::submit);
        if (!begun) return report(context, begun.error());
        return status(context, c.finishFrame(UINT64_MAX));
    });
}

GnResult GN_CALL gnGetVisibility(GnContext context, GnView view, GnVisibility* pVisibility)
{
    return giveStruct(context, pVisibility, "pVisibility", [&](Context& c) { return c.visibility(view); });
}

GnResult GN_CALL gnGetLightMap(GnContext context, GnLight light, GnLightMap* pMap)
{
    return giveStruct(context, pMap, "pMap", [&](Context& c) { return c.lightMap(light); });
}

// --- methods, rules, decisions ---

GnResult GN_CALL gnEnumerateMethods(GnContext context, uint32_t* pCount, GnMethodInfo* pMethods)
{
    return list(context, pCount, pMethods,
                [](Context& c, std::span<GnMethodInfo> out) { return Result<uint32_t>(c.methods(out)); });
}

GnResult GN_CALL gnAddMethod(GnContext context, const char* pName, const char* pAlgorithm)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.addMethod(pName, pAlgorithm)); });
}

GnResult GN_CALL gnRegisterAlgorithm(GnContext context, const GnAlgorithmInfo* pInfo)
{
    return atBoundary(context, [&](Context& c) {
        if (!pInfo) return nullArgument(context, "pInfo");
        return status(context, c.registerAlgorithm(*pInfo));
    });
}

GnResult GN_CALL gnGetPluginInterface(GnContext context, const GnPluginInterface** ppInterface)
{
    if (ppInterface) *ppInterface = nullptr;
    return atBoundary(context, [&](Context& c) {
        if (!ppInterface) return nullArgument(context, "ppInterface");
        *ppInterface = c.pluginInterface();
        return GN_SUCCESS;
    });
}

GnResult GN_CALL gnLoadPlugin(GnContext context, const char* pPath)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.loadPlugin(context, pPath)); });
}

GnResult GN_CALL gnSetMethodSetting(GnContext context, const char* pMethod, const char* pSetting, double value)
{
    return atBoundary(context,
                      [&](Context& c) { return status(context, c.setMethodSetting(pMethod, pSetting, value)); });
}

GnResult GN_CALL gnLoadRules(GnContext context, const char* pText, size_t size, const char* pFileName)
{
    return atBoundary(context, [&](Context& c) {
        if (!pText) return nullArgument(context, "pText");
        return status(context, c.loadRules({pText, size}, pFileName ? pFileName : "rules"));
    });
}

GnResult GN_CALL gnLoadShippedRules(GnContext context, const char* pName)
{
    return atBoundary(context, [&](Context& c) {
        if (!pName) return nullArgument(context, "pName");
        return status(context, c.loadShippedRules(pName));
    });
}

GnResult GN_CALL gnLoadKnowledge(GnContext context, const char* pText, size_t size, const char* pFileName)
{
    return atBoundary(context, [&](Context& c) {
        if (!pText) return nullArgument(context, "pText");
        return status(context, c.loadKnowledge({pText, size}, pFileName ? pFileName : "knowledge"));
    });
}

GnResult GN_CALL gnGetLightTiming(GnContext context, GnView view, GnLight light, GnLightTiming* pTiming)
{
    return giveStruct(context, pTiming, "pTiming", [&](Context& c) { return c.lightTiming(view, light); });
}

GnResult GN_CALL gnGetDecision(GnContext context, GnView view, GnLight light, GnDecision* pDecision)
{
    return giveStruct(context, pDecision, "pDecision", [&](Context& c) { return c.decision(view, light); });
}

GnResult GN_CALL gnGetFacts(GnContext context, GnView view, GnLight light, uint32_t* pCount, GnFact* pFacts)
{
    return list(context, pCount, pFacts, [&](Context& c, std::span<GnFact> out) { return c.facts(view, light, out); });
}

GnResult GN_CALL gnGetCandidates(GnContext context, GnView view, GnLight light, uint32_t* pCount,
                                 GnCandidate* pCandidates)
{
    return list(context, pCount, pCandidates,
                [&](Context& c, std::span<GnCandidate> out) { return c.candidates(view, light, out); });
}

GnResult GN_CALL gnExplainDecision(GnContext context, GnView view, GnLight light, size_t* pSize, char* pText)
{
    return giveText(context, pSize, pText, [&](Context& c) { return c.explanation(view, light); });
}

GnResult GN_CALL gnExplain(GnContext context, GnView view, GnLight light, const GnQuestion* pQuestion, size_t* pSize,
                           char* pText)
{
    return giveText(context, pSize, pText,
                    [&](Context& c) { return c.answer(view, light, pQuestion ? *pQuestion : GnQuestion{}); });
}

GnResult GN_CALL gnGetDecisionLog(GnContext context, GnView view, uint64_t firstFrame, uint64_t frameOrigin,
                                  size_t* pSize, void* pData)
{
    const size_t room = pSize ? std::exchange(*pSize, 0) : 0;
    return atBoundary(context, [&](Context& c) {
        if (!pSize) return nullArgument(context, "pSize");
        const Result<std::string> log = c.decisionLog(view, firstFrame, frameOrigin);
        if (!log) return report(context, log.error());
        *pSize = log->size();
        if (!pData) return GN_SUCCESS;
        if (room < log->size()) return GN_INCOMPLETE;
        std::memcpy(pData, log->data(), log->size());
        return GN_SUCCESS;
    });
}

GnResult GN_CALL gnGetPassTimings(GnContext context, uint64_t* pFrame, uint32_t* pCount, GnPassTiming* pTimings)
{
    if (pFrame) *pFrame = 0;
    return list(context, pCount, pTimings, [&](Context& c, std::span<GnPassTiming> out) {
        uint64_t frame = 0;
        const uint32_t count = c.passTimings(frame, out);
        if (pFrame) *pFrame = frame;
        return Result<uint32_t>(count);
    });
}

GnResult GN_CALL gnGetFramePasses(GnContext context, uint32_t* pCount, GnPassTiming* pPasses)
{
    return list(context, pCount, pPasses, [](Context& c, std::span<GnPassTiming> out) { return c.framePasses(out); });
}

GnResult GN_CALL gnGetFrameStats(GnContext context, GnFrameStats* pStats)
{
    return giveStruct(context, pStats, "pStats", [](Context& c) { return Result<GnFrameStats>(c.stats()); });
}

} // extern "C"
