#include "demo/host/shadow_host.hpp"

#include <algorithm>
#include <utility>

#include "demo/host/pin_thread.hpp"
#include "gnomon/algorithm.h"

namespace gnomon::demo {
namespace {

// Only this many messages are kept between two calls of takeMessages(): a fault may repeat every frame.
constexpr size_t kMaxMessages = 64;

GnInstanceFlags flagsOf(const Instance& instance)
{
    GnInstanceFlags flags = 0;
    if (instance.isStatic) flags |= GN_INSTANCE_STATIC_BIT;
    if (instance.alphaTested) flags |= GN_INSTANCE_ALPHA_TESTED_BIT;
    if (instance.hostDrawn) flags |= GN_INSTANCE_HOST_DRAWN_BIT;
    if (instance.sides == Sides::Front) flags |= GN_INSTANCE_SINGLE_SIDED_BIT;
    return flags;
}

bool sameTransform(const GnTransform& a, const GnTransform& b)
{
    return std::ranges::equal(a.basis, b.basis) && std::ranges::equal(a.translation, b.translation);
}

bool sameLight(const LightState& a, const LightState& b)
{
    return a.position == b.position && a.direction == b.direction;
}

} // namespace

GnTransform toGnTransform(const Transform& transform)
{
    GnTransform out{};
    const std::array<float, 9> basis = transform.linearRowMajor();
    std::copy(basis.begin(), basis.end(), out.basis);
    for (int i = 0; i < 3; ++i)
        out.translation[i] = transform.translation[i];
    return out;
}

GnLightInfo toGnLight(const Light& light, const LightState& state)
{
    GnLightInfo info{};
    info.type = light.kind == LightKind::Directional ? GN_LIGHT_TYPE_DIRECTIONAL
                : light.kind == LightKind::Spot      ? GN_LIGHT_TYPE_SPOT
                                                     : GN_LIGHT_TYPE_POINT;
    info.flags = light.isStatic ? GN_LIGHT_STATIC_BIT : 0;
    info.pName = light.name.c_str();
    for (int i = 0; i < 3; ++i) {
        info.position[i] = state.position[i];
        info.direction[i] = static_cast<float>(state.direction[i]);
    }
    info.range = light.range;
    info.coneAngle = light.kind == LightKind::Spot ? light.outerAngle : 0.0f;
    info.sourceRadius = light.radius;
    if (light.disc) info.sourceShape = GN_SOURCE_SHAPE_DISC;
    if (light.rectangle.x > 0.0f) {
        info.sourceRadius = 0.0f;
        info.sourceShape = GN_SOURCE_SHAPE_RECTANGLE;
        for (int i = 0; i < 2; ++i)
            info.sourceExtents[i] = light.rectangle[i];
        for (int i = 0; i < 3; ++i)
            info.sourceAxis[i] = static_cast<float>(light.rectangleAxis[i]);
    }
    info.importance = light.importance;
    info.casterMask = light.casterMask;
    return info;
}

ShadowHost::ShadowHost(const Device& device, const Scene& scene, const SceneGeometry& geometry,
                       const ShadowHostOptions& options)
    : scene_(scene), casterDrawer_(device, geometry)
{
    GnContextCreateInfo info = device.contextInfo();
    info.flags |= options.flags;
    info.memoryLimit = options.memoryLimit;
    info.pName = scene.name.c_str();
    info.framesInFlight = options.framesInFlight;
    info.pfnMessage = &onMessage;
    if (options.pinnedThreads) info.pfnThreadStarted = [](uint32_t index, void*) { pinThread(index + 1); };
    info.pUserData = this;
    if (gnCreateContext(&info, &context_) < 0) {
        const std::vector<std::string> messages = takeMessages();
        throw HostError("gnCreateContext: " + (messages.empty() ? std::string("no reason given") : messages.back()));
    }
    try {
        for (const std::string& plugin : options.plugins)
            expect(statusOf(gnLoadPlugin(context_, plugin.c_str())));
        createInstances(geometry);
        createLights();
        views_.resize(options.viewCount);
        for (GnView& view : views_) {
            const GnViewCreateInfo viewInfo{.maxLights = options.maxLights, .pName = "main"};
            expect(statusOf(gnCreateView(context_, &viewInfo, &view)));
        }
    } catch (...) {
        gnDestroyContext(context_);
        throw;
    }
}

ShadowHost::~ShadowHost()
{
    gnDestroyContext(context_);
}

void ShadowHost::createInstances(const SceneGeometry& geometry)
{
    for (const Mesh& mesh : scene_.meshes) {
        const GnMeshCreateInfo info{.pName = mesh.name.c_str(),
                                    .pPositions = &mesh.positions[0].x,
                                    .positionCount = static_cast<uint32_t>(mesh.positions.size()),
                                    .positionStride = sizeof(glm::vec3),
                                    .indexCount = static_cast<uint32_t>(mesh.indices.size()),
                                    .pIndices = mesh.indices.data()};
        GnMesh handle = VK_NULL_HANDLE;
        expect(statusOf(gnCreateMesh(context_, &info, &handle)));
        meshes_.push_back(handle);
    }
    hostDrawn_.resize(scene_.instances.size());
    for (size_t i = 0; i < scene_.instances.size(); ++i) {
        const Instance& instance = scene_.instances[i];
        const MeshRange& range = geometry.meshes[instance.mesh];
        hostDrawn_[i] = {.drawer = &casterDrawer_,
                         .mesh = &scene_.meshes[instance.mesh],
                         .range = range,
                         .alphaTested = instance.alphaTested,
                         .transform = instanceAt(instance, 0.0)};
        GnInstanceCreateInfo info{};
        info.flags = flagsOf(instance);
        info.pName = instance.name.c_str();
        info.mesh = meshes_[instance.mesh];
        info.transform = toGnTransform(hostDrawn_[i].transform);
        info.casterMask = instance.casterMask;
        for (int k = 0; k < 3; ++k) {
            info.boundsMin[k] = range.lower[k];
            info.boundsMax[k] = range.upper[k];
        }
        info.pfnDrawCasters = instance.hostDrawn ? &CasterDrawer::draw : nullptr;
        info.pfnOpacity = instance.alphaTested ? &CasterDrawer::opacity : nullptr;
        info.pUserData = &hostDrawn_[i];
        GnInstance handle = VK_NULL_HANDLE;
        expect(statusOf(gnCreateInstance(context_, &info, &handle)));
        instances_.push_back(handle);
        lastTransforms_.push_back(info.transform);
    }
}

void ShadowHost::createLights()
{
    for (const Light& light : scene_.lights) {
        lastLights_.push_back(lightAt(light, 0.0));
        const GnLightInfo info = toGnLight(light, lastLights_.back());
        GnLight handle = VK_NULL_HANDLE;
        expect(statusOf(gnCreateLight(context_, &info, &handle)));
        lights_.push_back(handle);
    }
}

void ShadowHost::update(const SceneState& state)
{
    for (size_t i = 0; i < instances_.size(); ++i) {
        const GnTransform transform = toGnTransform(state.instances[i]);
        if (sameTransform(transform, lastTransforms_[i])) continue;
        expect(statusOf(gnSetInstanceTransform(context_, instances_[i], &transform)));
        lastTransforms_[i] = transform;
        hostDrawn_[i].transform = state.instances[i];
    }
    for (size_t i = 0; i < lights_.size(); ++i) {
        if (sameLight(state.lights[i], lastLights_[i])) continue;
        const GnLightInfo info = toGnLight(scene_.lights[i], state.lights[i]);
        expect(statusOf(gnUpdateLight(context_, lights_[i], &info)));
        lastLights_[i] = state.lights[i];
    }
}

std::vector<GnLight> ShadowHost::present(const SceneState& state) const
{
    std::vector<GnLight> out;
    for (uint32_t light : state.present)
        out.push_back(lights_[light]);
    return out;
}

Status ShadowHost::warmUp()
{
    return statusOf(gnWarmUp(context_));
}

Status ShadowHost::warmUp(const std::string& method)
{
    return method.empty() ? warmUp() : statusOf(gnWarmUpMethod(context_, method.c_str()));
}

Status ShadowHost::loadRules(const std::string& text, const std::string& fileName, const std::string& preset)
{
    const auto read = [this](const Rules& rules) {
        return gnLoadRules(context_, rules.text.data(), rules.text.size(), rules.fileName.c_str()) >= 0;
    };
    const auto change = [this](const Rules& rules) {
        return rules.preset.empty() || gnSetPreset(context_, rules.preset.c_str()) >= 0;
    };
    Rules rules{text, fileName, preset};
    const bool isRead = read(rules);
    if (isRead && change(rules)) {
        rules_ = std::move(rules);
        return Done{};
    }
    const Status failed = Status::failure(faults());
    // The base without its preset is in force now: back to what was.
    if (isRead && !rules_.text.empty()) (void)(read(rules_) && change(rules_)); // both went well before
    return failed;
}

std::string ShadowHost::faults()
{
    // Every diagnostic came as a message of its own; the last error alone would hide the others. It repeats one of
    // them.
    std::vector<std::string> said;
    std::string all;
    for (std::string& message : takeMessages()) {
        if (std::find(said.begin(), said.end(), message) != said.end()) continue;
        all += (all.empty() ? "" : "\n") + message;
        said.push_back(std::move(message));
    }
    return all.empty() ? gnGetLastError(context_) : all;
}

Status ShadowHost::loadKnowledge(const std::string& text, const std::string& fileName) const
{
    return statusOf(gnLoadKnowledge(context_, text.data(), text.size(), fileName.c_str()));
}

Status ShadowHost::pin(uint32_t light, const std::string& method)
{
    return statusOf(gnSetLightMethod(context_, lights_.at(light), method.empty() ? nullptr : method.c_str()));
}

Status ShadowHost::pinAll(const std::string& method, std::vector<std::string>* refused)
{
    std::vector<std::string> reasons;
    for (uint32_t i = 0; i < lights_.size(); ++i)
        if (const Status status = pin(i, method); !status)
            reasons.push_back("light '" + scene_.lights[i].name + "': " + status.error());
    if (!reasons.empty() && reasons.size() == lights_.size()) return Status::failure(reasons.front());
    if (refused) *refused = std::move(reasons);
    return Done{};
}

Status ShadowHost::set(const std::string& method, const std::string& setting, double value)
{
    return statusOf(gnSetMethodSetting(context_, method.c_str(), setting.c_str(), value));
}

std::vector<GnMethodInfo> ShadowHost::methods() const
{
    uint32_t count = 0;
    gnEnumerateMethods(context_, &count, nullptr);
    std::vector<GnMethodInfo> methods(count);
    gnEnumerateMethods(context_, &count, methods.data());
    methods.resize(count);
    return methods;
}

GnFrameStats ShadowHost::stats() const
{
    GnFrameStats stats{};
    gnGetFrameStats(context_, &stats);
    return stats;
}

std::string ShadowHost::whyNot(uint32_t light, const std::string& method, uint64_t frame) const
{
    const GnQuestion question{.kind = GN_QUESTION_WHY_NOT, .pMethod = method.c_str(), .frame = frame};
    size_t size = 0;
    if (gnExplain(context_, views_.at(0), lights_.at(light), &question, &size, nullptr) < 0) return {};
    std::string text(size, ' ');
    gnExplain(context_, views_.at(0), lights_.at(light), &question, &size, text.data());
    text.resize(size - 1); // the terminating zero
    return text;
}

std::vector<std::string> ShadowHost::takeMessages()
{
    const std::lock_guard lock(mutex_);
    return std::exchange(messages_, {});
}

void GN_CALL ShadowHost::onMessage(const GnMessage* message, void* user)
{
    if (message->severity == GN_SEVERITY_INFO) return;
    auto& self = *static_cast<ShadowHost*>(user);
    const std::lock_guard lock(self.mutex_);
    if (self.messages_.size() < kMaxMessages) self.messages_.push_back(message->pText);
}

Status ShadowHost::statusOf(GnResult result) const
{
    if (result >= 0) return Done{};
    return Status::failure(std::string(gnResultName(result)) + ": " + gnGetLastError(context_));
}

} // namespace gnomon::demo
