#include "runtime/api/plugin.hpp"

#include <algorithm>
#include <bit>
#include <dlfcn.h>

#include "runtime/api/plugin_abi.hpp"
#include "runtime/base/hash.hpp"
#include "runtime/base/number_text.hpp"

namespace {

using namespace gnomon;

/// GnShadowTask::casterStamp. Of casters that the host draws, which a plug-in cannot draw, it tells where they are:
/// they may have another shape in every frame.
std::uint64_t casterStamp(const ShadowTask& task)
{
    std::uint64_t hash = mixed(task.casters->staticStamp, task.light->revision);
    for (const Caster* caster : task.casters->dynamics) {
        hash = mixed(hash, caster->id);
        if (!caster->hostDrawn) {
            hash = mixed(hash, caster->revision);
            continue;
        }
        const auto add = [&](const glm::vec3& v) {
            for (int i = 0; i < 3; ++i)
                hash = mixed(hash, std::bit_cast<std::uint32_t>(v[i]));
        };
        for (int column = 0; column < 3; ++column)
            add(caster->basis[column]);
        add(caster->translation);
        add(caster->bounds.lower);
        add(caster->bounds.upper);
    }
    return hash ? hash : 1; // 0 is a stamp that nothing has
}

GnTaskCaster foreignCaster(const Caster& caster)
{
    GnTaskCaster out{.isStatic = caster.isStatic, .closed = caster.closed};
    if (caster.mesh) {
        out.vertexBuffer = caster.mesh->vertexBuffer;
        out.indexBuffer = caster.mesh->indexBuffer;
        out.indexCount = 3 * caster.mesh->triangleCount();
    }
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            out.worldFromObject[4 * row + column] = caster.basis[column][row];
        out.worldFromObject[4 * row + 3] = caster.translation[row];
        out.boundsMin[row] = caster.bounds.lower[row];
        out.boundsMax[row] = caster.bounds.upper[row];
    }
    return out;
}

} // namespace

namespace gnomon {

/// Speaks C to the plug-in and C++ to the runtime.
class PluginShadow final : public ShadowAlgorithm {
public:
    explicit PluginShadow(const PluginAlgorithm& plugin) : plugin_(plugin) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        std::span<GnTaskCaster> casters = passes.arena().array<GnTaskCaster>(task.casters->all.size());
        std::transform(task.casters->all.begin(), task.casters->all.end(), casters.begin(),
                       [](const Caster* caster) { return foreignCaster(*caster); });
        const gpu::LightConstants& light = task.light->constants;
        GnShadowTask out{.extent = task.view->extent,
                         .area = task.view->area,
                         .depthConvention = task.view->convention,
                         .lightType = task.light->type,
                         .lightRange = light.range,
                         .coneAngle = task.light->coneAngle,
                         .sourceRadius = light.sourceRadius,
                         .casterStamp = casterStamp(task),
                         .casterCount = static_cast<uint32_t>(casters.size()),
                         .pCasters = casters.data(),
                         .settingCount = static_cast<uint32_t>(task.settings.size()),
                         .pSettings = task.settings.data(),
                         .visibility = refOf(task.visibility),
                         .layer = task.layer,
                         .depth = refOf(task.depth),
                         .normals = refOf(task.normals),
                         .frame = passes.frame(),
                         .completedFrame = passes.completedFrame()};
        for (int i = 0; i < 16; ++i)
            out.clipFromWorld[i] = task.view->constants.clipFromWorld[i / 4][i % 4];
        for (int i = 0; i < 3; ++i) {
            out.eye[i] = task.view->eye[i];
            out.lightPosition[i] = light.positionWs[i];
            out.lightDirection[i] = light.directionWs[i];
        }
        PluginBuilder builder{.passes = &passes, .roundTrips = plugin_.info_.roundTrips};
        plugin_.info_.pfnDeclare(plugin_.info_.pAlgorithm, reinterpret_cast<GnPassBuilder>(&builder), &out);
    }

private:
    const PluginAlgorithm& plugin_;
};

Result<void> checkAlgorithmInfo(const GnAlgorithmInfo& info)
{
    if (!info.pName || !*info.pName) return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmName", "pName is null or empty"};
    const std::string who = "algorithm '" + std::string(info.pName) + "': ";
    if (!info.pfnDeclare) return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmDeclare", who + "pfnDeclare is null"};
    if (!(info.traits & (GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT)))
        return Error{GN_ERROR_EMPTY, "AlgorithmLights", who + "traits name no kind of light"};
    if (info.traits & (GN_TRAIT_DEVICE_RAYS_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT))
        return Error{GN_ERROR_UNSUPPORTED, "AlgorithmTraits",
                     who +
                         (info.traits & GN_TRAIT_DEVICE_RAYS_BIT
                              ? "traits have GN_TRAIT_DEVICE_RAYS_BIT: structures of the device"
                              : "traits have GN_TRAIT_GPU_TRANSFORMS_BIT: transforms on the GPU") +
                         " are built-in methods' alone"};
    if (info.settingCount && !info.pSettings)
        return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmSettings", who + "pSettings is null"};
    for (uint32_t i = 0; i < info.settingCount; ++i) {
        const GnSettingInfo& s = info.pSettings[i];
        const std::string which = who + "pSettings[" + std::to_string(i) + "].";
        if (!s.pName) return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmSettings", which + "pName is null"};
        if (!(s.minimum <= s.value && s.value <= s.maximum))
            return Error{GN_ERROR_OUT_OF_RANGE, "AlgorithmSettings",
                         which + "value, of '" + s.pName + "', is " + shortestText(s.value) + ", outside [" +
                             shortestText(s.minimum) + ", " + shortestText(s.maximum) + "]"};
    }
    return {};
}

PluginAlgorithm::PluginAlgorithm(const GnAlgorithmInfo& info)
    : name_(info.pName), source_(info.pSource ? info.pSource : ""), info_(info)
{
    for (uint32_t i = 0; i < info.settingCount; ++i) {
        settingNames_.emplace_back(info.pSettings[i].pName);
        settingTexts_.emplace_back(info.pSettings[i].pDescription ? info.pSettings[i].pDescription : "");
    }
    for (uint32_t i = 0; i < info.settingCount; ++i)
        settings_.push_back({settingNames_[i].c_str(), settingTexts_[i].c_str(), info.pSettings[i].minimum,
                             info.pSettings[i].maximum, info.pSettings[i].value});
    entry_ = {.name = name_.c_str(),
              .source = source_.c_str(),
              .traits = info.traits,
              .roundTrips = info.roundTrips,
              .maxRounds = 0, // a plugin host pass declares nothing
              .settings = settings_,
              .plugin = this,
              .createPlugin = [](const PluginAlgorithm& self) -> std::unique_ptr<ShadowAlgorithm> {
                  return std::make_unique<PluginShadow>(self);
              },
              .bytesPerPixel = info.memoryPerPixel};
}

PluginAlgorithm::~PluginAlgorithm()
{
    if (owned_ && info_.pfnDestroy) info_.pfnDestroy(info_.pAlgorithm);
}

Result<std::unique_ptr<SharedObject>> SharedObject::open(const char* path)
{
    std::unique_ptr<SharedObject> object(new SharedObject);
    object->handle_ = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!object->handle_)
        return Error{GN_ERROR_UNSUPPORTED, "PluginNotLoaded", std::string("plug-in not loaded: ") + dlerror()};
    object->main_ = reinterpret_cast<PFN_gnPluginMain>(dlsym(object->handle_, "gnPluginMain"));
    if (!object->main_)
        return Error{GN_ERROR_UNSUPPORTED, "PluginMain", std::string(path) + " exports no gnPluginMain"};
    const auto* version = static_cast<const uint32_t*>(dlsym(object->handle_, "gnPluginVersion"));
    if (!version || *version != GN_PLUGIN_VERSION)
        return Error{GN_ERROR_UNSUPPORTED, "PluginVersion",
                     std::string(path) +
                         (version ? " was compiled with GN_PLUGIN_VERSION " + std::to_string(*version)
                                  : " exports no gnPluginVersion") +
                         "; this is " + std::to_string(GN_PLUGIN_VERSION)};
    return object;
}

SharedObject::~SharedObject()
{
    if (handle_) dlclose(handle_);
}

} // namespace gnomon
