#include "runtime/api/plugin.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <dlfcn.h>
#include <optional>

#include "rules/engine/number_text.hpp"
#include "runtime/api/context.hpp"

// The opaque handles of the C door are pointers to what they stand for.
namespace {

using namespace gnomon;

/// What one declaration builds with, and what its algorithm may do.
struct ForeignBuilder {
    PassBuilder* passes;
    std::uint32_t roundTrips;
};
PassBuilder& builderOf(GnPassBuilder builder)
{
    return *reinterpret_cast<ForeignBuilder*>(builder)->passes;
}

/// What a callback sees: one of the two contexts.
struct ForeignContext {
    PassContext* gpu = nullptr;
    HostContext* host = nullptr;
};
ForeignContext& contextOf(GnPassContext context)
{
    return *reinterpret_cast<ForeignContext*>(context);
}

// References are ids plus one, so that 0 is none.
ImageId imageOf(GnImageRef ref)
{
    return ref ? ImageId{ref - 1} : ImageId{};
}
BufferId bufferOf(GnBufferRef ref)
{
    return ref ? BufferId{ref - 1} : BufferId{};
}
GnImageRef refOf(ImageId id)
{
    return id ? id.index + 1 : 0;
}
GnBufferRef refOf(BufferId id)
{
    return id ? id.index + 1 : 0;
}

/// No exception may unwind through the plug-in's frames: what fails here is noted in the builder's task.
template <typename Body>
auto guarded(GnPassBuilder builder, Body&& body, decltype(body()) otherwise = {}) noexcept
{
    try {
        return body();
    } catch (...) { // words so short that they need no memory
        builderOf(builder).fail({GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory", "no host memory"});
        return otherwise;
    }
}

Scope scopeOf(GnScope scope)
{
    return scope == GN_SCOPE_VIEW ? Scope::view : scope == GN_SCOPE_LIGHT ? Scope::light : Scope::task;
}

GnImageRef GN_CALL makeImage(GnPassBuilder builder, const GnImageInfo* info)
{
    const ImageInfo image{.name = info->pName,
                          .scope = scopeOf(info->scope),
                          .format = info->format,
                          .extent = info->extent,
                          .layers = std::max(info->layers, 1u),
                          .variant = info->variant};
    return guarded(builder, [&] {
        PassBuilder& passes = builderOf(builder);
        return refOf(info->persistent ? passes.persistent(image) : passes.transient(image));
    });
}

GnBufferRef GN_CALL makeBuffer(GnPassBuilder builder, const GnBufferInfo* info)
{
    const BufferInfo buffer{.name = info->pName,
                            .scope = scopeOf(info->scope),
                            .size = info->size,
                            .place = info->place == GN_BUFFER_UPLOAD     ? BufferPlace::upload
                                     : info->place == GN_BUFFER_READBACK ? BufferPlace::readback
                                                                         : BufferPlace::device,
                            .variant = info->variant};
    return guarded(builder, [&] {
        PassBuilder& passes = builderOf(builder);
        return refOf(info->persistent ? passes.persistent(buffer) : passes.transient(buffer));
    });
}

VkBool32 GN_CALL imageStale(GnPassBuilder builder, GnImageRef image, uint64_t stamp)
{
    return guarded(builder, [&]() -> VkBool32 { return builderOf(builder).stale(imageOf(image), stamp); });
}

VkBool32 GN_CALL bufferStale(GnPassBuilder builder, GnBufferRef buffer, uint64_t stamp)
{
    return guarded(builder, [&]() -> VkBool32 { return builderOf(builder).stale(bufferOf(buffer), stamp); });
}

void addAccess(PassRef& pass, const GnAccess& access)
{
    const ImageId image = imageOf(access.image);
    const BufferId buffer = bufferOf(access.buffer);
    const Part part{
        .layer = access.baseLayer,
        .layerCount = std::max(access.layerCount, 1u),
        .rect = {access.rect.offset.x, access.rect.offset.y, access.rect.extent.width, access.rect.extent.height},
        .clear = access.clear != VK_FALSE,
        .value = access.clearValue,
        .blend = access.load != VK_FALSE};
    switch (access.kind) {
    case GN_ACCESS_SAMPLED:
        pass.samples(image, part);
        break;
    case GN_ACCESS_READ:
        pass.reads(buffer);
        break;
    case GN_ACCESS_WRITE:
        image ? pass.writes(image, part) : pass.writes(buffer);
        break;
    case GN_ACCESS_UPDATE:
        image ? pass.updates(image, part) : pass.updates(buffer);
        break;
    case GN_ACCESS_COPY_SOURCE:
        pass.copies(image, part);
        break;
    case GN_ACCESS_DEPTH_TEST:
        pass.depthTest(image, part);
        break;
    case GN_ACCESS_DEPTH_WRITE:
        pass.depthWrite(image, part);
        break;
    case GN_ACCESS_STENCIL_TEST:
        pass.stencilTest(image, part);
        break;
    case GN_ACCESS_STENCIL_WRITE:
        pass.stencilWrite(image, part);
        break;
    case GN_ACCESS_VERTICES:
        pass.vertices(buffer);
        break;
    case GN_ACCESS_INDICES:
        pass.indices(buffer);
        break;
    case GN_ACCESS_INDIRECT:
        pass.indirect(buffer);
        break;
    case GN_ACCESS_KIND_MAX_ENUM:
        break;
    }
}

PassRef openPass(PassBuilder& passes, const GnPassInfo& info)
{
    const Scope scope = scopeOf(info.scope);
    switch (info.kind) {
    case GN_PASS_COMPUTE:
        return passes.compute(info.pName, scope, info.variant);
    case GN_PASS_TRANSFER:
        return passes.transfer(info.pName, scope, info.variant);
    case GN_PASS_PREPARE:
        return passes.prepare(info.pName, scope, info.variant);
    case GN_PASS_HOST:
        return passes.host(info.pName, scope, info.variant);
    case GN_PASS_RASTER:
    case GN_PASS_KIND_MAX_ENUM:
        break;
    }
    return passes.raster(info.pName, scope, info.variant);
}

constexpr std::uint32_t kMaxUserData = 256;

/// Images are made without storage usage, which takes compression from them on some devices, and lie where the CPU does
/// not reach them: passes render to them or copy to them.
bool writesImageOtherwise(const GnPassInfo& info)
{
    const bool mayWrite = info.kind == GN_PASS_RASTER || info.kind == GN_PASS_TRANSFER;
    return std::any_of(info.pAccesses, info.pAccesses + info.accessCount, [&](const GnAccess& access) {
        return access.image && (access.kind == GN_ACCESS_UPDATE || (access.kind == GN_ACCESS_WRITE && !mayWrite));
    });
}

bool isAttachmentWrite(const GnPassInfo& info, const GnAccess& access)
{
    return info.kind == GN_PASS_RASTER && access.image && access.kind == GN_ACCESS_WRITE;
}

/// What is wrong with a pass, or nothing.
std::optional<Error> faultOf(const PassBuilder& passes, const GnPassInfo& info, std::uint32_t roundTrips)
{
    if (!info.pName) return Error{GN_ERROR_NULL_ARGUMENT, "PassName", "a pass has no pName"};
    const auto fault = [&](GnResult result, const char* id, const std::string& what) {
        return Error{result, id, "pass '" + std::string(info.pName) + "': " + what};
    };
    const bool cpu = info.kind == GN_PASS_PREPARE || info.kind == GN_PASS_HOST;
    if (cpu && !info.pfnRun) return fault(GN_ERROR_NULL_ARGUMENT, "PassRun", "pfnRun is null");
    if (!cpu && !info.pfnRecord) return fault(GN_ERROR_NULL_ARGUMENT, "PassRecord", "pfnRecord is null");
    if (info.accessCount && !info.pAccesses) return fault(GN_ERROR_NULL_ARGUMENT, "PassAccesses", "pAccesses is null");
    if (info.userDataSize && !info.pUserData) return fault(GN_ERROR_NULL_ARGUMENT, "PassUserData", "pUserData is null");
    if (info.userDataSize > kMaxUserData)
        return fault(GN_ERROR_TOO_MANY, "PassUserData",
                     "userDataSize is " + std::to_string(info.userDataSize) + ", above " +
                         std::to_string(kMaxUserData));
    if (info.kind == GN_PASS_HOST && roundTrips == 0) // recorded frames would run without it
        return fault(GN_ERROR_UNSUPPORTED, "PassRoundTrips", "a host pass, but the algorithm's roundTrips is 0");
    std::uint32_t colors = 0;
    for (std::uint32_t i = 0; i < info.accessCount; ++i) {
        const GnAccess& access = info.pAccesses[i];
        const std::uint32_t layers = std::max(access.layerCount, 1u);
        const bool there = (!access.image || passes.has(imageOf(access.image), access.baseLayer, layers)) &&
                           (!access.buffer || passes.has(bufferOf(access.buffer)));
        if (!there)
            return fault(GN_ERROR_OUT_OF_RANGE, "PassAccess",
                         "pAccesses[" + std::to_string(i) + "] names image " + std::to_string(access.image) +
                             ", layers " + std::to_string(access.baseLayer) + " + " + std::to_string(layers) +
                             ", buffer " + std::to_string(access.buffer) + ", which this frame has not");
        colors += isAttachmentWrite(info, access) ? 1 : 0;
    }
    if (colors > kMaxColorAttachments)
        return fault(GN_ERROR_TOO_MANY, "PassAttachments",
                     std::to_string(colors) + " colour attachments, above " + std::to_string(kMaxColorAttachments));
    if (writesImageOtherwise(info))
        return fault(GN_ERROR_UNSUPPORTED, "StorageImage",
                     "it writes an image that is neither its attachment nor what it copies to");
    return std::nullopt;
}

GnResult declare(GnPassBuilder builder, const GnPassInfo* info)
{
    PassBuilder& passes = builderOf(builder);
    if (const std::optional<Error> fault =
            faultOf(passes, *info, reinterpret_cast<ForeignBuilder*>(builder)->roundTrips)) {
        passes.fail(*fault);
        return fault->result;
    }
    const bool cpu = info->kind == GN_PASS_PREPARE || info->kind == GN_PASS_HOST;
    PassRef pass = openPass(passes, *info);
    for (uint32_t i = 0; i < info->accessCount; ++i)
        addAccess(pass, info->pAccesses[i]);
    if (info->area.extent.width)
        pass.area({info->area.offset.x, info->area.offset.y, info->area.extent.width, info->area.extent.height});
    void* data = nullptr;
    if (info->userDataSize) {
        data = passes.arena().allocate(info->userDataSize, alignof(std::max_align_t));
        std::memcpy(data, info->pUserData, info->userDataSize);
    }
    if (cpu) {
        const PFN_gnRun run = info->pfnRun;
        pass.run([=](HostContext& host) {
            ForeignContext context{.host = &host};
            run(reinterpret_cast<GnPassContext>(&context), data);
        });
    } else {
        const PFN_gnRecord record = info->pfnRecord;
        pass.record([=](PassContext& gpu) {
            ForeignContext context{.gpu = &gpu};
            record(reinterpret_cast<GnPassContext>(&context), gpu.cmd, &gpu.area, data);
        });
    }
    return GN_SUCCESS;
}

GnResult GN_CALL declarePass(GnPassBuilder builder, const GnPassInfo* info)
{
    return guarded(
        builder, [&] { return declare(builder, info); }, GN_ERROR_OUT_OF_HOST_MEMORY);
}

VkImage GN_CALL vkImageOf(GnPassContext context, GnImageRef image)
{
    const ForeignContext& c = contextOf(context);
    return c.gpu && image ? c.gpu->image(imageOf(image)) : VK_NULL_HANDLE;
}

VkImageView GN_CALL vkImageViewOf(GnPassContext context, GnImageRef image, uint32_t layer)
{
    const ForeignContext& c = contextOf(context);
    return c.gpu && image ? c.gpu->imageView(imageOf(image), layer) : VK_NULL_HANDLE;
}

VkBuffer GN_CALL vkBufferOf(GnPassContext context, GnBufferRef buffer)
{
    const ForeignContext& c = contextOf(context);
    return c.gpu && buffer ? c.gpu->buffer(bufferOf(buffer)) : VK_NULL_HANDLE;
}

void* GN_CALL mappedOf(GnPassContext context, GnBufferRef buffer)
{
    const ForeignContext& c = contextOf(context);
    return c.host && buffer ? c.host->write<std::byte>(bufferOf(buffer)).data() : nullptr;
}

/// Adds 64 bits to a running hash: a round of splitmix64.
std::uint64_t mixed(std::uint64_t hash, std::uint64_t value)
{
    hash += value + 0x9e3779b97f4a7c15ull;
    hash = (hash ^ hash >> 30) * 0xbf58476d1ce4e5b9ull;
    hash = (hash ^ hash >> 27) * 0x94d049bb133111ebull;
    return hash ^ hash >> 31;
}

/// GnShadowTask::casterStamp. Of casters that the host draws, which a plug-in cannot draw, it tells where they are:
/// they may have another shape in every frame.
std::uint64_t casterStamp(const ShadowTask& task)
{
    std::uint64_t hash = mixed(task.casters->staticStamp, task.light->revision);
    for (const Caster* caster : task.casters->movings) {
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
        out.indexCount = static_cast<uint32_t>(caster.mesh->indices.size());
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
class ForeignShadow final : public ShadowAlgorithm {
public:
    explicit ForeignShadow(const ForeignAlgorithm& foreign) : foreign_(foreign) {}

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
        ForeignBuilder builder{.passes = &passes, .roundTrips = foreign_.info_.roundTrips};
        foreign_.info_.pfnDeclare(foreign_.info_.pAlgorithm, reinterpret_cast<GnPassBuilder>(&builder), &out);
    }

private:
    const ForeignAlgorithm& foreign_;
};

Result<void> checkAlgorithmInfo(const GnAlgorithmInfo& info)
{
    if (!info.pName || !*info.pName) return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmName", "pName is null or empty"};
    const std::string who = "algorithm '" + std::string(info.pName) + "': ";
    if (!info.pfnDeclare) return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmDeclare", who + "pfnDeclare is null"};
    if (!(info.traits & (GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT)))
        return Error{GN_ERROR_EMPTY, "AlgorithmLights", who + "traits name no kind of light"};
    if (info.settingCount && !info.pSettings)
        return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmSettings", who + "pSettings is null"};
    for (uint32_t i = 0; i < info.settingCount; ++i) {
        const GnSettingInfo& s = info.pSettings[i];
        const std::string which = who + "pSettings[" + std::to_string(i) + "].";
        if (!s.pName) return Error{GN_ERROR_NULL_ARGUMENT, "AlgorithmSettings", which + "pName is null"};
        if (!(s.minimum <= s.value && s.value <= s.maximum))
            return Error{GN_ERROR_OUT_OF_RANGE, "AlgorithmSettings",
                         which + "value, of '" + s.pName + "', is " + rules::shortestText(s.value) + ", outside [" +
                             rules::shortestText(s.minimum) + ", " + rules::shortestText(s.maximum) + "]"};
    }
    return {};
}

ForeignAlgorithm::ForeignAlgorithm(const GnAlgorithmInfo& info)
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
              .maxRounds = 0, // a foreign host pass declares nothing
              .settings = settings_,
              .foreign = this,
              .createForeign = [](const ForeignAlgorithm& self) -> std::unique_ptr<ShadowAlgorithm> {
                  return std::make_unique<ForeignShadow>(self);
              },
              .bytesPerPixel = info.memoryPerPixel};
}

ForeignAlgorithm::~ForeignAlgorithm()
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

GnPluginInterface makePluginInterface(VkDevice device, PFN_vkGetDeviceProcAddr getDeviceProcAddr)
{
    return {.size = sizeof(GnPluginInterface),
            .pfnRegisterAlgorithm = &gnRegisterAlgorithm,
            .pfnImage = &makeImage,
            .pfnBuffer = &makeBuffer,
            .pfnImageStale = &imageStale,
            .pfnBufferStale = &bufferStale,
            .pfnPass = &declarePass,
            .pfnVkImage = &vkImageOf,
            .pfnVkImageView = &vkImageViewOf,
            .pfnVkBuffer = &vkBufferOf,
            .pfnMapped = &mappedOf,
            .device = device,
            .pfnGetDeviceProcAddr = getDeviceProcAddr};
}

} // namespace gnomon
