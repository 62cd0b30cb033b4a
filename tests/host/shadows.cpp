#include "shadows.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace stranger {
namespace {

void GN_CALL printMessage(const GnMessage* pMessage, void*)
{
    if (pMessage->severity != GN_SEVERITY_INFO) std::fprintf(stderr, "%s: %s\n", pMessage->pId, pMessage->pText);
}

std::string readFile(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error(path + ": cannot be read");
    return {std::istreambuf_iterator<char>(file), {}};
}

GnLightInfo describe(const FrameData& data, size_t lamp)
{
    GnLightInfo info{};
    info.type = GN_LIGHT_TYPE_POINT;
    for (int axis = 0; axis < 3; ++axis)
        info.position[axis] = static_cast<double>(data.lamps[lamp].position[axis]);
    info.range = data.lamps[lamp].range;
    return info;
}
} // namespace

Shadows::Shadows(const Device& device, const Options& options, std::span<const Mesh> meshes) : options_(options)
{
    GnContextCreateInfo info{};
    info.instance = device.instance;
    info.physicalDevice = device.gpu;
    info.device = device.device;
    info.queue = device.queue;
    info.apiVersion = VK_API_VERSION_1_3;
    info.pEnabledFeatures = &device.features;
    info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
    info.framesInFlight = kFramesInFlight;
    info.pfnMessage = printMessage;
    if (options.hooks) {
        heap_.device = device.device;
        info.pUserData = &heap_;
        info.pfnAllocateMemory = &giveMemory;
        info.pfnFreeMemory = &takeMemory;
    }
    STRANGER_CHECK(gnCreateContext(&info, &context_));
    try {
        if (options.rulesPath.empty()) {
            STRANGER_CHECK(gnLoadShippedRules(context_, "default"));
        } else {
            const std::string text = readFile(options.rulesPath);
            STRANGER_CHECK(gnLoadRules(context_, text.data(), text.size(), options.rulesPath.c_str()));
        }
        if (!options.knowledgePath.empty()) {
            const std::string text = readFile(options.knowledgePath);
            STRANGER_CHECK(gnLoadKnowledge(context_, text.data(), text.size(), options.knowledgePath.c_str()));
        }
        createScene(meshes);
    } catch (...) {
        gnDestroyContext(context_);
        throw;
    }
}

Shadows::~Shadows()
{
    gnDestroyContext(context_);
    if (heap_.given != heap_.taken) std::fprintf(stderr, "blocks of memory were not given back\n"), std::abort();
}

VkResult GN_CALL Shadows::giveMemory(const GnMemoryRequest* pRequest, GnMemoryBlock* pBlock, void* pUserData)
{
    Heap& heap = *static_cast<Heap*>(pUserData);
    VkMemoryAllocateFlagsInfo flags{};
    flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
    flags.flags = pRequest->allocateFlags;
    VkMemoryAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.pNext = pRequest->allocateFlags ? &flags : nullptr;
    info.allocationSize = pRequest->size;
    info.memoryTypeIndex = pRequest->memoryTypeIndex;
    VkResult result = vkAllocateMemory(heap.device, &info, nullptr, &pBlock->memory);
    if (result < 0) return result;
    if (pRequest->mapped) result = vkMapMemory(heap.device, pBlock->memory, 0, VK_WHOLE_SIZE, 0, &pBlock->pMapped);
    if (result < 0) {
        vkFreeMemory(heap.device, pBlock->memory, nullptr);
        pBlock->memory = VK_NULL_HANDLE;
        return result;
    }
    ++heap.given;
    return result;
}

void GN_CALL Shadows::takeMemory(const GnMemoryBlock* pBlock, void* pUserData)
{
    Heap& heap = *static_cast<Heap*>(pUserData);
    vkFreeMemory(heap.device, pBlock->memory, nullptr);
    ++heap.taken;
}

void Shadows::createScene(std::span<const Mesh> meshes)
{
    for (const Mesh& mesh : meshes) {
        GnMeshCreateInfo info{};
        info.pName = mesh.name;
        info.pPositions = mesh.positions.front().data();
        info.positionCount = static_cast<uint32_t>(mesh.positions.size());
        info.pIndices = mesh.indices.data();
        info.indexCount = static_cast<uint32_t>(mesh.indices.size());
        GnInstanceCreateInfo placed{};
        placed.flags = GN_INSTANCE_STATIC_BIT;
        placed.pName = mesh.name;
        GnInstance instance = VK_NULL_HANDLE;
        STRANGER_CHECK(gnCreateMesh(context_, &info, &placed.mesh));
        STRANGER_CHECK(gnCreateInstance(context_, &placed, &instance));
    }
    const FrameData first = frameDataAt(0.0, 1.0f);
    for (size_t i = 0; i < lights_.size(); ++i) {
        const GnLightInfo info = describe(first, i);
        STRANGER_CHECK(gnCreateLight(context_, &info, &lights_[i]));
    }
    STRANGER_CHECK(gnCreateView(context_, nullptr, &view_));
}

void Shadows::warmUp(const char* pMethod)
{
    STRANGER_CHECK(pMethod ? gnWarmUpMethod(context_, pMethod) : gnWarmUp(context_));
}

bool Shadows::pin(const char* pMethod)
{
    for (GnLight light : lights_)
        if (gnSetLightMethod(context_, light, pMethod) < 0) return false;
    return true;
}

std::vector<std::string> Shadows::methods() const
{
    uint32_t count = 0;
    STRANGER_CHECK(gnEnumerateMethods(context_, &count, nullptr));
    std::vector<GnMethodInfo> all(count);
    STRANGER_CHECK(gnEnumerateMethods(context_, &count, all.data()));
    std::vector<std::string> names;
    for (const GnMethodInfo& method : all) {
        const bool point = method.traits & GN_TRAIT_POINT_BIT, planar = method.traits & GN_TRAIT_PLANAR_BIT;
        if (point && !planar && !method.pUnavailable && (!options_.recorded || method.roundTrips == 0))
            names.emplace_back(method.pName);
    }
    return names;
}

GnResult Shadows::render(VkCommandBuffer commands, const FrameData& data, const Image& depth, const Image& normals,
                         uint64_t frame, uint64_t completedFrame)
{
    for (size_t i = 0; i < lights_.size(); ++i) {
        const GnLightInfo info = describe(data, i);
        STRANGER_CHECK(gnUpdateLight(context_, lights_[i], &info));
    }
    GnViewFrame view{};
    view.view = view_;
    const float* rows[3] = {data.viewRight, data.viewUp, data.viewBack};
    for (int row = 0; row < 3; ++row) {
        view.eye[row] = static_cast<double>(data.eye[row]);
        std::memcpy(&view.viewFromWorld[3 * row], rows[row], 3 * sizeof(float));
    }
    fillProjection(data, view.projection);
    view.depthImage = depth.image;
    view.depthView = depth.view;
    view.depthFormat = depth.format;
    view.imageExtent = options_.size;
    view.normalImage = normals.image;
    view.normalView = normals.view;
    view.normalFormat = normals.format;
    view.lightCount = kLampCount;
    view.pLights = lights_.data();
    GnFrameInfo info{};
    info.frame = frame;
    info.completedFrame = completedFrame;
    info.budgetMs = options_.budgetMs;
    info.viewCount = 1;
    info.pViews = &view;
    const GnResult result = commands ? gnCmdRenderShadows(context_, commands, &info) : gnSubmitShadows(context_, &info);
    if (result < 0) throw std::runtime_error(std::string(gnResultName(result)) + ": " + gnGetLastError(context_));
    return result;
}

GnVisibility Shadows::visibility() const
{
    GnVisibility result{};
    STRANGER_CHECK(gnGetVisibility(context_, view_, &result));
    return result;
}

GnFrameStats Shadows::stats() const
{
    GnFrameStats result{};
    STRANGER_CHECK(gnGetFrameStats(context_, &result));
    return result;
}

std::array<Choice, kLampCount> Shadows::choices() const
{
    std::array<Choice, kLampCount> result;
    for (size_t i = 0; i < lights_.size(); ++i) {
        GnDecision decision{};
        STRANGER_CHECK(gnGetDecision(context_, view_, lights_[i], &decision));
        result[i] = {decision.pMethod, decision.reason, decision.predictedMs, decision.switched != VK_FALSE};
    }
    return result;
}

std::string Shadows::explain(int light, const char* pMethod) const
{
    GnQuestion question{};
    question.kind = pMethod ? GN_QUESTION_WHY_NOT : GN_QUESTION_WHY;
    question.pMethod = pMethod;
    size_t size = 0;
    STRANGER_CHECK(gnExplain(context_, view_, lights_[static_cast<size_t>(light)], &question, &size, nullptr));
    std::string text(size, '\0');
    STRANGER_CHECK(gnExplain(context_, view_, lights_[static_cast<size_t>(light)], &question, &size, text.data()));
    text.resize(size - 1); // without the terminating zero
    return text;
}

const char* reasonText(GnReason reason)
{
    switch (reason) {
    case GN_REASON_RULES:
        return "rules";
    case GN_REASON_PINNED:
        return "pinned";
    case GN_REASON_INCUMBENT:
        return "tie, kept";
    case GN_REASON_FALLBACK:
        return "fallback, the wanted one is not ready";
    case GN_REASON_NOTHING_READY:
        return "nothing is ready";
    case GN_REASON_NO_OPINION:
        return "no rule spoke";
    case GN_REASON_BUDGET:
        return "budget";
    case GN_REASON_HELD:
        return "held";
    case GN_REASON_PRICE:
        return "price";
    case GN_REASON_FLOOR:
        return "near floor";
    case GN_REASON_UTILITY:
        return "worth more";
    case GN_REASON_TRIAL:
        return "trial";
    default:
        return "unknown to this host";
    }
}
} // namespace stranger
