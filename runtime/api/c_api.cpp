// The C API; boundary.hpp has what its entry points share.
#include <algorithm>

#include "runtime/api/boundary.hpp"

using namespace gnomon;

extern "C" {

GnResult GN_CALL gnCreateContext(const GnContextCreateInfo* pCreateInfo, GnContext* pContext)
{
    if (pContext) *pContext = nullptr;
    if (!pCreateInfo || !pContext) return GN_ERROR_NULL_ARGUMENT;
    const uint32_t size = structSizeOf(pCreateInfo);
    if (!isStructSize<GnContextCreateInfo>(size)) return GN_ERROR_OUT_OF_RANGE; // and pfnMessage may be anywhere
    const FloatMode mode;
    const GnContextCreateInfo known = knownPart<GnContextCreateInfo>(pCreateInfo, size);
    try {
        const Messages messages(known.pfnMessage, known.pUserData, known.pName);
        const Result<GnContextCreateInfo> info = readStruct<GnContextCreateInfo>(pCreateInfo, "pCreateInfo");
        Result<std::unique_ptr<Context>> made = info ? Context::create(*info) : info.error();
        if (!made) {
            messages.error(made.error());
            return made.error().result;
        }
        *pContext = new GnContext_T{std::move(*made), {}};
        return GN_SUCCESS;
    } catch (const std::bad_alloc&) {
        return failedContext(known, GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory", "host allocation failed");
    } catch (const std::exception& exception) { // no thread was to be had, for instance
        return failedContext(known, GN_ERROR_UNKNOWN, "Unexpected", exception.what());
    } catch (...) {
        return failedContext(known, GN_ERROR_UNKNOWN, "Unexpected", "unexpected exception");
    }
}

void GN_CALL gnDestroyContext(GnContext context)
{
    const FloatMode mode;
    if (context && context->impl && !context->impl->drain()) {
        context->impl->abandon();
        static_cast<void>(context->impl.release());
    }
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

GnResult GN_CALL gnGetPipelineCacheData(GnContext context, size_t* pSize, void* pData)
{
    return giveBytes(context, pSize, pData, [](Context& c) { return c.pipelineCacheData(); });
}

// --- geometry ---

GnResult GN_CALL gnCreateMesh(GnContext context, const GnMeshCreateInfo* pCreateInfo, GnMesh* pMesh)
{
    return create(context, pCreateInfo, "pCreateInfo", pMesh, "pMesh",
                  [](Context& c, const GnMeshCreateInfo& info) { return c.scene().createMesh(info); });
}

GnResult GN_CALL gnUpdateMeshPositions(GnContext context, GnMesh mesh, const float* pPositions, uint32_t positionCount,
                                       uint32_t positionStride)
{
    return atBoundary(context, [&](Context& c) {
        if (!pPositions) return nullArgument(context, "pPositions");
        return status(context, c.scene().updateMeshPositions(mesh, pPositions, positionCount, positionStride));
    });
}

GnResult GN_CALL gnUpdateMeshFromBuffer(GnContext context, GnMesh mesh, const VkDescriptorBufferInfo* pPositions,
                                        const float boundsMin[3], const float boundsMax[3])
{
    return atBoundary(context, [&](Context& c) {
        if (!pPositions) return nullArgument(context, "pPositions");
        return status(context, c.scene().updateMeshFromBuffer(mesh, *pPositions, boundsMin, boundsMax));
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
    return create(context, pCreateInfo, "pCreateInfo", pInstance, "pInstance",
                  [](Context& c, const GnInstanceCreateInfo& info) { return c.scene().createInstance(info); });
}

GnResult GN_CALL gnCreateInstances(GnContext context, const GnInstanceCreateInfo* pCreateInfo, uint32_t count,
                                   const GnTransform* pTransforms, GnInstance* pInstances)
{
    if (pInstances) std::fill_n(pInstances, count, GnInstance(VK_NULL_HANDLE));
    return withStruct(context, pCreateInfo, "pCreateInfo", [&](Context& c, const GnInstanceCreateInfo& info) {
        if (!pTransforms && count && !info.pTransformBuffer) return nullArgument(context, "pTransforms");
        if (!pInstances && count) return nullArgument(context, "pInstances");
        if (!info.pTransformBuffer)
            return status(context, c.scene().createInstances(info, {pTransforms, count}, pInstances));
        if (pTransforms)
            return report(context, {GN_ERROR_OUT_OF_RANGE, "TransformsTwice",
                                    "pTransforms and pCreateInfo->pTransformBuffer are both given"});
        return status(context, c.scene().createPlacedInstances(info, count, pInstances));
    });
}

GnResult GN_CALL gnUpdateInstancesFromBuffer(GnContext context, uint32_t count, const GnInstance* pInstances,
                                             const GnTransformBuffer* pTransformBuffer)
{
    return withStruct(context, pTransformBuffer, "pTransformBuffer", [&](Context& c, const GnTransformBuffer& from) {
        if (!pInstances && count) return nullArgument(context, "pInstances");
        return status(context, c.scene().updatePlacedInstances({pInstances, count}, from));
    });
}

GnResult GN_CALL gnSetInstanceTransforms(GnContext context, uint32_t count, const GnInstance* pInstances,
                                         const GnTransform* pTransforms)
{
    return atBoundary(context, [&](Context& c) {
        if (!pInstances && count) return nullArgument(context, "pInstances");
        if (!pTransforms && count) return nullArgument(context, "pTransforms");
        return status(context, c.scene().setInstanceTransforms({pInstances, count}, {pTransforms, count}));
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
    return create(context, pInfo, "pInfo", pLight, "pLight",
                  [](Context& c, const GnLightInfo& info) { return c.scene().createLight(info); });
}

GnResult GN_CALL gnUpdateLight(GnContext context, GnLight light, const GnLightInfo* pInfo)
{
    return withStruct(context, pInfo, "pInfo", [&](Context& c, const GnLightInfo& info) {
        return status(context, c.scene().updateLight(light, info));
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
    const GnViewCreateInfo defaults{};
    return create(context, pCreateInfo ? pCreateInfo : &defaults, "pCreateInfo", pView, "pView",
                  [](Context& c, const GnViewCreateInfo& info) { return c.createView(info); });
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
    return withFrame(context, pFrame, [&](Context& c, const GnFrameInfo& frame) {
        return status(context, c.recordFrame(commandBuffer, frame));
    });
}

GnResult GN_CALL gnDropFrame(GnContext context, uint64_t frame)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.dropFrame(frame)); });
}

GnResult GN_CALL gnBeginShadows(GnContext context, const GnFrameInfo* pFrame)
{
    return withFrame(context, pFrame, [&](Context& c, const GnFrameInfo& frame) {
        return status(context, c.beginFrame(frame, FrameMode::begin));
    });
}

GnResult GN_CALL gnFinishShadows(GnContext context, uint64_t timeoutNs)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.finishFrame(timeoutNs)); });
}

GnResult GN_CALL gnSubmitShadows(GnContext context, const GnFrameInfo* pFrame)
{
    return withFrame(context, pFrame, [&](Context& c, const GnFrameInfo& frame) {
        const Result<GnResult> begun = c.beginFrame(frame, FrameMode::submit);
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

GnResult GN_CALL gnGetSampledShadows(GnContext context, GnView view, const double pOrigin[3],
                                     GnSampledShadows* pShadows)
{
    return giveStruct(context, pShadows, "pShadows", [&](Context& c) { return c.sampledShadows(view, pOrigin); });
}

// --- methods, rules, decisions ---

GnResult GN_CALL gnEnumerateMethods(GnContext context, uint32_t* pCount, GnMethodInfo* pMethods)
{
    return list(context, pCount, pMethods, "pMethods",
                [](Context& c, const StructArray<GnMethodInfo>& out) { return Result<uint32_t>(c.methods(out)); });
}

GnResult GN_CALL gnAddMethod(GnContext context, const char* pName, const char* pAlgorithm)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.addMethod(pName, pAlgorithm)); });
}

GnResult GN_CALL gnRegisterAlgorithm(GnContext context, const GnAlgorithmInfo* pInfo)
{
    return withStruct(context, pInfo, "pInfo", [&](Context& c, const GnAlgorithmInfo& info) {
        return status(context, c.registerAlgorithm(info));
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

GnResult GN_CALL gnSetPreset(GnContext context, const char* pName)
{
    return atBoundary(context, [&](Context& c) { return status(context, c.setPreset(pName ? pName : "")); });
}

GnResult GN_CALL gnLoadKnowledge(GnContext context, const char* pText, size_t size, const char* pFileName)
{
    return atBoundary(context, [&](Context& c) {
        if (!pText) return nullArgument(context, "pText");
        return status(context, c.loadKnowledge({pText, size}, pFileName ? pFileName : "knowledge"));
    });
}

GnResult GN_CALL gnLoadShippedKnowledge(GnContext context)
{
    return atBoundary(context, [&](Context& c) {
        c.loadShippedKnowledge();
        return GN_SUCCESS;
    });
}

GnResult GN_CALL gnGetLightTiming(GnContext context, GnView view, GnLight light, GnLightTiming* pTiming)
{
    return giveStruct(context, pTiming, "pTiming", [&](Context& c) { return c.lightTiming(view, light); });
}

GnResult GN_CALL gnGetLightWorkload(GnContext context, GnView view, GnLight light, GnLightWorkload* pWorkload)
{
    return giveStruct(context, pWorkload, "pWorkload", [&](Context& c) { return c.lightWorkload(view, light); });
}

GnResult GN_CALL gnGetDecision(GnContext context, GnView view, GnLight light, GnDecision* pDecision)
{
    return giveStruct(context, pDecision, "pDecision", [&](Context& c) { return c.decision(view, light); });
}

GnResult GN_CALL gnGetFacts(GnContext context, GnView view, GnLight light, uint32_t* pCount, GnFact* pFacts)
{
    return list(context, pCount, pFacts, "pFacts",
                [&](Context& c, const StructArray<GnFact>& out) { return c.facts(view, light, out); });
}

GnResult GN_CALL gnGetCandidates(GnContext context, GnView view, GnLight light, uint32_t* pCount,
                                 GnCandidate* pCandidates)
{
    return list(context, pCount, pCandidates, "pCandidates",
                [&](Context& c, const StructArray<GnCandidate>& out) { return c.candidates(view, light, out); });
}

GnResult GN_CALL gnExplain(GnContext context, GnView view, GnLight light, const GnQuestion* pQuestion, size_t* pSize,
                           char* pText)
{
    const GnQuestion why{};
    return giveText(context, pSize, pText, [&](Context& c) -> Result<std::string> {
        const Result<GnQuestion> question = readStruct<GnQuestion>(pQuestion ? pQuestion : &why, "pQuestion");
        return question ? c.answer(view, light, *question) : question.error();
    });
}

GnResult GN_CALL gnGetDecisionLog(GnContext context, GnView view, uint64_t firstFrame, uint64_t frameOrigin,
                                  size_t* pSize, void* pData)
{
    return giveBytes(context, pSize, pData, [&](Context& c) { return c.decisionLog(view, firstFrame, frameOrigin); });
}

GnResult GN_CALL gnGetPassTimings(GnContext context, uint64_t* pFrame, uint32_t* pCount, GnPassTiming* pTimings)
{
    if (pFrame) *pFrame = 0;
    return list(context, pCount, pTimings, "pTimings", [&](Context& c, const StructArray<GnPassTiming>& out) {
        uint64_t frame = 0;
        const uint32_t count = c.passTimings(frame, out);
        if (pFrame) *pFrame = frame;
        return Result<uint32_t>(count);
    });
}

GnResult GN_CALL gnGetFramePasses(GnContext context, uint32_t* pCount, GnPassTiming* pPasses)
{
    return list(context, pCount, pPasses, "pPasses",
                [](Context& c, const StructArray<GnPassTiming>& out) { return c.framePasses(out); });
}

GnResult GN_CALL gnGetFrameStats(GnContext context, GnFrameStats* pStats)
{
    return giveStruct(context, pStats, "pStats", [](Context& c) { return Result<GnFrameStats>(c.stats()); });
}

} // extern "C"
