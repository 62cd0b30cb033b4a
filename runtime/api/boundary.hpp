#pragma once
// What every entry point of the C API goes through: pointers are checked, exceptions and the floating-point mode stay
// inside, results become codes and words.
#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "runtime/api/context.hpp"
#include "runtime/base/float_mode.hpp"
#include "runtime/base/struct_size.hpp"

struct GnContext_T {
    std::unique_ptr<gnomon::Context> impl;
    std::vector<GnViewFrame> views; ///< Of the frame that begins; here so that its memory stays.
};

namespace gnomon {

inline GnResult report(GnContext context, const Error& error) noexcept
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
inline GnResult reportCaught(GnContext context, GnResult result, const char* id, const char* text) noexcept
{
    try {
        return report(context, {result, id, text});
    } catch (...) {
    }
    return result;
}

/// What every call answers once one of them has noticed the loss; that one alone has told it as a message.
inline GnResult refusedAsLost(Context& context) noexcept
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
    const FloatMode mode; // the host's is put aside: same inputs, same decision
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
inline GnResult failedContext(const GnContextCreateInfo& info, GnResult result, const char* id,
                              const char* text) noexcept
{
    const GnMessage message{.severity = GN_SEVERITY_ERROR, .result = result, .pId = id, .pText = text};
    if (info.pfnMessage) info.pfnMessage(&message, info.pUserData);
    return result;
}

inline GnResult nullArgument(GnContext context, const char* name)
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

inline GnResult status(GnContext context, const Result<void>& result)
{
    return result ? GN_SUCCESS : report(context, result.error());
}

inline GnResult status(GnContext context, const Result<GnResult>& result)
{
    return result ? *result : report(context, result.error());
}

/// All of make(context)'s bytes, or none where there is too little room; *pSize becomes their number, or 0 where it
/// fails.
template <typename Make>
GnResult giveBytes(GnContext context, size_t* pSize, void* pData, Make&& make)
{
    const size_t room = pSize ? std::exchange(*pSize, 0) : 0;
    return atBoundary(context, [&](Context& c) {
        if (!pSize) return nullArgument(context, "pSize");
        const Result<std::string> bytes = make(c);
        if (!bytes) return report(context, bytes.error());
        *pSize = bytes->size();
        if (!pData) return GN_SUCCESS;
        if (room < bytes->size()) return GN_INCOMPLETE;
        std::memcpy(pData, bytes->data(), bytes->size());
        return GN_SUCCESS;
    });
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

/// body(context, info) on a whole copy of what the host gave.
template <typename In, typename Body>
GnResult withStruct(GnContext context, const In* pIn, const char* name, Body&& body)
{
    return atBoundary(context, [&](Context& c) {
        const Result<In> in = readStruct<In>(pIn, name);
        return in ? body(c, *in) : report(context, in.error());
    });
}

/// What make(context, info) gives into *pOut, which is null where it fails.
template <typename In, typename Out, typename Make>
GnResult create(GnContext context, const In* pIn, const char* inName, Out* pOut, const char* outName, Make&& make)
{
    if (pOut) *pOut = VK_NULL_HANDLE;
    return withStruct(context, pIn, inName, [&](Context& c, const In& in) {
        return pOut ? give(context, make(c, in), pOut) : nullArgument(context, outName);
    });
}

/// body(context, frame) on a whole copy of a frame and its views.
template <typename Body>
GnResult withFrame(GnContext context, const GnFrameInfo* pFrame, Body&& body)
{
    return withStruct(context, pFrame, "pFrame", [&](Context& c, GnFrameInfo frame) {
        context->views.clear();
        if (frame.pViews) {
            const Result<void> read = readStructs(frame.pViews, frame.viewCount, "pViews",
                                                  [&](const GnViewFrame& view) { context->views.push_back(view); });
            if (!read) return report(context, read.error());
            frame.pViews = context->views.data();
        }
        return body(c, frame);
    });
}

/// fill(context, array) writes what fits into its array and says how many there are; *pCount becomes 0 where it fails.
template <typename T, typename Fill>
GnResult list(GnContext context, uint32_t* pCount, T* pOut, const char* name, Fill&& fill)
{
    const StructArray<T> out(pOut, pCount ? std::exchange(*pCount, 0) : 0);
    return atBoundary(context, [&](Context& c) {
        if (!pCount) return nullArgument(context, "pCount");
        if (!out.fits()) return report(context, wrongStructSize<T>(out.stride(), {name, 0}));
        const Result<uint32_t> all = fill(c, out);
        if (!all) return report(context, all.error());
        *pCount = pOut ? std::min(out.size(), *all) : *all;
        return pOut && out.size() < *all ? GN_INCOMPLETE : GN_SUCCESS;
    });
}

/// A value of make(context) into *pOut, which is zero where it fails.
template <typename Out, typename Make>
GnResult giveStruct(GnContext context, Out* pOut, const char* name, Make&& make)
{
    const StructArray<Out> out(pOut, 1);
    if (pOut && out.fits()) out.put(0, {});
    return atBoundary(context, [&](Context& c) {
        if (!pOut) return nullArgument(context, name);
        if (!out.fits()) return report(context, wrongStructSize<Out>(out.stride(), name));
        const Result<Out> made = make(c);
        if (!made) return report(context, made.error());
        out.put(0, *made);
        return GN_SUCCESS;
    });
}

} // namespace gnomon
