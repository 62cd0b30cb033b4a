#include "runtime/api/plugin_abi.hpp"

#include <algorithm>
#include <cstring>

#include "runtime/base/struct_size.hpp"
#include "runtime/passes/pass_context.hpp"

// The opaque handles of the C plug-in interface are pointers to what they stand for.
namespace {

using namespace gnomon;

PluginBuilder& pluginOf(GnPassBuilder builder)
{
    return *reinterpret_cast<PluginBuilder*>(builder);
}
PassBuilder& builderOf(GnPassBuilder builder)
{
    return *pluginOf(builder).passes;
}

/// What a callback sees: one of the two contexts.
struct PluginContext {
    PassContext* gpu = nullptr;
    HostContext* host = nullptr;
};
PluginContext& contextOf(GnPassContext context)
{
    return *reinterpret_cast<PluginContext*>(context);
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

BufferPlace placeOf(GnBufferPlace place)
{
    return place == GN_BUFFER_UPLOAD     ? BufferPlace::upload
           : place == GN_BUFFER_READBACK ? BufferPlace::readback
                                         : BufferPlace::device;
}

/// What was asked for, where there is nothing wrong with it.
template <typename Info>
Result<Info> readInfo(const Info* pInfo, const char* argument)
{
    Result<Info> info = readStruct<Info>(pInfo, argument);
    if (!info) return info;
    if (const std::optional<Error> fault = faultOf(*info)) return *fault;
    return info;
}

GnImageRef GN_CALL makeImage(GnPassBuilder builder, const GnImageInfo* pInfo)
{
    return guarded(builder, [&]() -> GnImageRef {
        PassBuilder& passes = builderOf(builder);
        const Result<GnImageInfo> info = readInfo(pInfo, "pfnImage: pInfo");
        if (!info) return passes.fail(info.error()), 0;
        const ImageInfo image{.name = info->pName,
                              .scope = scopeOf(info->scope),
                              .format = info->format,
                              .extent = info->extent,
                              .layers = std::max(info->layers, 1u),
                              .variant = info->variant};
        return refOf(info->persistent ? passes.persistent(image) : passes.transient(image));
    });
}

GnBufferRef GN_CALL makeBuffer(GnPassBuilder builder, const GnBufferInfo* pInfo)
{
    return guarded(builder, [&]() -> GnBufferRef {
        PassBuilder& passes = builderOf(builder);
        const Result<GnBufferInfo> info = readInfo(pInfo, "pfnBuffer: pInfo");
        if (!info) return passes.fail(info.error()), 0;
        const BufferInfo buffer{.name = info->pName,
                                .scope = scopeOf(info->scope),
                                .size = info->size,
                                .place = placeOf(info->place),
                                .variant = info->variant};
        return refOf(info->persistent ? passes.persistent(buffer) : passes.transient(buffer));
    });
}

Error unknownReference(const char* call, const char* kind, std::uint32_t reference)
{
    return {GN_ERROR_OUT_OF_RANGE, "PassReference",
            std::string(call) + ": the frame has no " + kind + " " + std::to_string(reference)};
}

// A reference of 0 is what could not be made: its task has failed already.

VkBool32 GN_CALL imageStale(GnPassBuilder builder, GnImageRef image, uint64_t stamp)
{
    const auto answer = [&]() -> VkBool32 {
        PassBuilder& passes = builderOf(builder);
        if (!image || passes.has(imageOf(image), 0, 1)) return passes.stale(imageOf(image), stamp);
        passes.fail(unknownReference("pfnImageStale", "image", image));
        return VK_TRUE;
    };
    return guarded(builder, answer, VK_TRUE);
}

VkBool32 GN_CALL bufferStale(GnPassBuilder builder, GnBufferRef buffer, uint64_t stamp)
{
    const auto answer = [&]() -> VkBool32 {
        PassBuilder& passes = builderOf(builder);
        if (!buffer || passes.has(bufferOf(buffer))) return passes.stale(bufferOf(buffer), stamp);
        passes.fail(unknownReference("pfnBufferStale", "buffer", buffer));
        return VK_TRUE;
    };
    return guarded(builder, answer, VK_TRUE);
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

/// What is to be declared, its accesses copied for the frame, where there is nothing wrong with it.
Result<GnPassInfo> readPass(PassBuilder& passes, const GnPassInfo* pInfo, std::uint32_t roundTrips)
{
    Result<GnPassInfo> info = readStruct<GnPassInfo>(pInfo, "pfnPass: pInfo");
    if (!info) return info;
    if (info->pAccesses) {
        const std::span<GnAccess> accesses = passes.arena().array<GnAccess>(info->accessCount);
        auto next = accesses.begin();
        const Result<void> read = readStructs(info->pAccesses, info->accessCount, "pAccesses",
                                              [&](const GnAccess& access) { *next++ = access; });
        if (!read) return read.error();
        info->pAccesses = accesses.data();
    }
    if (const std::optional<Error> fault = faultOf(passes, *info, roundTrips)) return *fault;
    return info;
}

GnResult declare(GnPassBuilder builder, const GnPassInfo* pInfo)
{
    PassBuilder& passes = builderOf(builder);
    const Result<GnPassInfo> info = readPass(passes, pInfo, pluginOf(builder).roundTrips);
    if (!info) {
        passes.fail(info.error());
        return info.error().result;
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
            PluginContext context{.host = &host};
            run(reinterpret_cast<GnPassContext>(&context), data);
        });
    } else {
        const PFN_gnRecord record = info->pfnRecord;
        pass.record([=](PassContext& gpu) {
            PluginContext context{.gpu = &gpu};
            record(reinterpret_cast<GnPassContext>(&context), gpu.cmd, &gpu.area, data);
        });
    }
    return GN_SUCCESS;
}

GnResult GN_CALL declarePass(GnPassBuilder builder, const GnPassInfo* pInfo)
{
    return guarded(
        builder, [&] { return declare(builder, pInfo); }, GN_ERROR_OUT_OF_HOST_MEMORY);
}

VkImage GN_CALL vkImageOf(GnPassContext context, GnImageRef image)
{
    const PassContext* const gpu = contextOf(context).gpu;
    return gpu && gpu->has(imageOf(image), 0) ? gpu->image(imageOf(image)) : VK_NULL_HANDLE;
}

VkImageView GN_CALL vkImageViewOf(GnPassContext context, GnImageRef image, uint32_t layer)
{
    const PassContext* const gpu = contextOf(context).gpu;
    return gpu && gpu->has(imageOf(image), layer) ? gpu->imageView(imageOf(image), layer) : VK_NULL_HANDLE;
}

VkBuffer GN_CALL vkBufferOf(GnPassContext context, GnBufferRef buffer)
{
    const PassContext* const gpu = contextOf(context).gpu;
    return gpu && gpu->has(bufferOf(buffer)) ? gpu->buffer(bufferOf(buffer)) : VK_NULL_HANDLE;
}

void* GN_CALL mappedOf(GnPassContext context, GnBufferRef buffer)
{
    const HostContext* const host = contextOf(context).host;
    return host && host->has(bufferOf(buffer)) ? host->write<std::byte>(bufferOf(buffer)).data() : nullptr;
}

} // namespace

namespace gnomon {

GnPluginInterface makePluginInterface(VkDevice device, PFN_vkGetDeviceProcAddr getDeviceProcAddr)
{
    return {.pfnRegisterAlgorithm = &gnRegisterAlgorithm,
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
