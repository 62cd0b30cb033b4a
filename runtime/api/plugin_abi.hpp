#pragma once
// The functions that algorithms from outside declare their passes with, and what their handles and references stand
// for.
#include <optional>

#include "gnomon/algorithm.h"
#include "runtime/base/result.hpp"
#include "runtime/passes/pass_builder.hpp"

namespace gnomon {

/// What one declaration builds with, and what its algorithm may do: a GnPassBuilder points to it.
struct PluginBuilder {
    PassBuilder* passes;
    std::uint32_t roundTrips;
};

// References are ids plus one, so that 0 is none.
inline ImageId imageOf(GnImageRef ref)
{
    return ref ? ImageId{ref - 1} : ImageId{};
}
inline BufferId bufferOf(GnBufferRef ref)
{
    return ref ? BufferId{ref - 1} : BufferId{};
}
inline GnImageRef refOf(ImageId id)
{
    return id ? id.index + 1 : 0;
}
inline GnBufferRef refOf(BufferId id)
{
    return id ? id.index + 1 : 0;
}

// What is wrong with what is to be declared, or nothing (plugin_faults.cpp).
std::optional<Error> faultOf(const GnImageInfo& info);
std::optional<Error> faultOf(const GnBufferInfo& info);
std::optional<Error> faultOf(const PassBuilder& passes, const GnPassInfo& info, std::uint32_t roundTrips);

GnPluginInterface makePluginInterface(VkDevice device, PFN_vkGetDeviceProcAddr getDeviceProcAddr);

} // namespace gnomon
