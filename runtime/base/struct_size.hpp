#pragma once
// How structures of the C API cross its boundary. The host may have been compiled with an older or a newer header:
// structSize says how much of a structure it knows, and what it does not know is zero.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "gnomon/algorithm.h"
#include "runtime/base/result.hpp"

namespace gnomon {

/// Bytes; above any structure of any version. What is not initialised is mostly larger.
constexpr std::uint32_t kLargestStruct = 4096;

/// Its name, and the smallest size that a host may give.
template <typename T>
struct StructTraits;

#define GN_END_OF(Type, member) (offsetof(Type, member) + sizeof(Type::member))

// `required`: the last member that a host has to know. `last`: the last one there is; nothing may come after it, since
// padding that an older host leaves undefined would be read once a new member lies there.
#define GN_SIZED_STRUCT(Type, required, last)                                                                          \
    template <>                                                                                                        \
    struct StructTraits<Type> {                                                                                        \
        static constexpr const char* name = #Type;                                                                     \
        static constexpr std::uint32_t smallest = GN_END_OF(Type, required);                                           \
        static_assert(offsetof(Type, structSize) == 0 && std::is_trivially_copyable_v<Type>);                          \
        static_assert(GN_END_OF(Type, last) == sizeof(Type) && sizeof(Type) <= kLargestStruct);                        \
    };

// Given by hosts and plug-ins.
GN_SIZED_STRUCT(GnContextCreateInfo, pfnGetInstanceProcAddr, pPipelineCacheData)
GN_SIZED_STRUCT(GnMeshCreateInfo, positionCount, flags)
GN_SIZED_STRUCT(GnMeshBuffers, boundsMax, boundsMax)
GN_SIZED_STRUCT(GnTransformBuffer, pBounds, pBounds)
GN_SIZED_STRUCT(GnInstanceCreateInfo, mesh, pTransformBuffer)
GN_SIZED_STRUCT(GnLightInfo, direction, sourceAxis)
GN_SIZED_STRUCT(GnViewCreateInfo, maxLights, flags)
GN_SIZED_STRUCT(GnViewFrame, imageExtent, motionScale)
GN_SIZED_STRUCT(GnFrameInfo, pViews, pSignals)
GN_SIZED_STRUCT(GnQuestion, kind, frame)
GN_SIZED_STRUCT(GnAlgorithmInfo, pfnDeclare, pAlgorithm)
GN_SIZED_STRUCT(GnAccess, buffer, clearValue)
GN_SIZED_STRUCT(GnImageInfo, extent, variant)
GN_SIZED_STRUCT(GnBufferInfo, size, variant)
GN_SIZED_STRUCT(GnPassInfo, pfnRun, pUserData)
// Filled for them.
GN_SIZED_STRUCT(GnDeviceNeeds, supported, pOptionalFeatures)
GN_SIZED_STRUCT(GnVisibility, imageView, lightsPerTexel)
GN_SIZED_STRUCT(GnLightMap, imageView, origin)
GN_SIZED_STRUCT(GnSampledShadows, revision, litCount)
GN_SIZED_STRUCT(GnMethodInfo, pName, pSettings)
GN_SIZED_STRUCT(GnDecision, pMethod, mapAge)
GN_SIZED_STRUCT(GnFact, value, value)
GN_SIZED_STRUCT(GnCandidate, pMethod, sharedMs)
GN_SIZED_STRUCT(GnPassTiming, pName, shared)
GN_SIZED_STRUCT(GnLightTiming, pMethod, resolveCpuMs)
GN_SIZED_STRUCT(GnLightWorkload, frame, softPixels)
GN_SIZED_STRUCT(GnFrameStats, frame, pagesWithoutRoom)
// Given to callbacks.
GN_SIZED_STRUCT(GnMessage, pText, pText)
GN_SIZED_STRUCT(GnMemoryRequest, mapped, mapped)
GN_SIZED_STRUCT(GnMemoryBlock, pAllocation, pAllocation)
GN_SIZED_STRUCT(GnCasterProjection, slopeBias, slopeBias)
GN_SIZED_STRUCT(GnShadowTask, completedFrame, completedFrame)
GN_SIZED_STRUCT(GnPluginInterface, pfnGetDeviceProcAddr, pfnGetDeviceProcAddr)
#undef GN_SIZED_STRUCT
#undef GN_END_OF

/// What a structure of any version begins with. Its type is not this library's.
inline std::uint32_t structSizeOf(const void* structure) noexcept
{
    std::uint32_t size = 0;
    std::memcpy(&size, structure, sizeof size);
    return size;
}

template <typename T>
constexpr bool isStructSize(std::uint32_t size) noexcept
{
    return size >= StructTraits<T>::smallest && size <= kLargestStruct && size % alignof(std::uint32_t) == 0;
}

/// An argument, or one element of it; made to words once something is wrong with it.
struct Argument {
    Argument(const char* argument) : name(argument) {}
    Argument(const char* argument, std::uint32_t element) : name(argument), index(element) {}
    std::string text() const
    {
        std::string words = name;
        if (index >= 0) words.append("[").append(std::to_string(index)).append("]");
        return words;
    }

    const char* name;
    std::int64_t index = -1;
};

template <typename T>
Error wrongStructSize(std::uint32_t size, const Argument& where)
{
    const std::string name = StructTraits<T>::name;
    return {GN_ERROR_OUT_OF_RANGE, "StructSize",
            where.text() + ": " + name + "::structSize is " + std::to_string(size) + ", not sizeof(" + name +
                ") of any version; here it is " + std::to_string(sizeof(T))};
}

/// What this library knows of a host's structure of a size; what an older host lacks is zero.
template <typename T>
T knownPart(const void* from, std::uint32_t size) noexcept
{
    T out{};
    std::memcpy(static_cast<void*>(&out), from, std::min<std::size_t>(size, sizeof(T)));
    out.structSize = sizeof(T);
    return out;
}

/// The host's structure as this library's. Fails where the host says what the library does not know.
template <typename T>
Result<T> readStruct(const void* from, const Argument& where)
{
    if (!from) return Error{GN_ERROR_NULL_ARGUMENT, "NullArgument", where.text() + " is null"};
    const std::uint32_t size = structSizeOf(from);
    if (!isStructSize<T>(size)) return wrongStructSize<T>(size, where);
    const auto* bytes = static_cast<const std::byte*>(from);
    const std::byte* set = std::find_if(bytes + std::min<std::size_t>(size, sizeof(T)), bytes + size,
                                        [](std::byte b) { return b != std::byte{}; });
    if (set != bytes + size)
        return Error{GN_ERROR_UNSUPPORTED, "StructNewer",
                     where.text() + ": " + StructTraits<T>::name + "::structSize is " + std::to_string(size) +
                         " and byte " + std::to_string(set - bytes) + " is not 0, but this library knows " +
                         std::to_string(sizeof(T)) + " bytes"};
    return knownPart<T>(from, size);
}

/// take(element) for each of an array; the first one's size is the stride.
template <typename T, typename Take>
Result<void> readStructs(const T* first, std::uint32_t count, const char* where, Take&& take)
{
    const auto* next = reinterpret_cast<const std::byte*>(first);
    std::uint32_t stride = 0;
    for (std::uint32_t i = 0; i < count; ++i, next += stride) {
        const Argument element(where, i);
        const Result<T> read = readStruct<T>(next, element);
        if (!read) return read.error();
        const std::uint32_t size = structSizeOf(next);
        if (i == 0) stride = size;
        if (size != stride)
            return Error{GN_ERROR_OUT_OF_RANGE, "StructSize",
                         element.text() + ": " + StructTraits<T>::name + "::structSize is " + std::to_string(size) +
                             ", but that of " + where + "[0] is " + std::to_string(stride)};
        take(*read);
    }
    return {};
}

/// As much of a value as the host's structure has room for; what only the host knows is zero.
template <typename T>
void writeStruct(void* to, std::uint32_t size, T value) noexcept
{
    value.structSize = size;
    const std::size_t known = std::min<std::size_t>(size, sizeof(T));
    std::memcpy(to, &value, known);
    std::memset(static_cast<std::byte*>(to) + known, 0, size - known);
}

/// A host's array that is filled. The first element's size is the stride, and becomes that of the others.
template <typename T>
class StructArray {
public:
    StructArray(T* first, std::uint32_t count) noexcept
        : first_(reinterpret_cast<std::byte*>(first)), count_(first ? count : 0),
          stride_(count_ ? structSizeOf(first) : 0)
    {
    }

    /// How many elements there is room for.
    std::uint32_t size() const noexcept { return count_; }
    std::uint32_t stride() const noexcept { return stride_; }
    bool fits() const noexcept { return count_ == 0 || isStructSize<T>(stride_); }
    void put(std::size_t index, const T& value) const noexcept
    {
        writeStruct(first_ + index * stride_, stride_, value);
    }

private:
    std::byte* first_;
    std::uint32_t count_, stride_;
};

} // namespace gnomon
