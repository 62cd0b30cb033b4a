#include "runtime/frame/read_frame.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/base/number_text.hpp"
#include "runtime/frame/camera_view.hpp"
#include "runtime/store/scene_input.hpp"

namespace gnomon {

Error frameOrder(const std::string& text)
{
    return {GN_ERROR_FRAME_ORDER, "FrameOrder", text};
}

namespace {

// --- one view ---

Error wrong(GnResult result, const char* id, const char* viewName, const std::string& what)
{
    return {result, id, "view '" + std::string(viewName) + "': " + what};
}

std::string sizeText(VkExtent2D extent)
{
    return std::to_string(extent.width) + "x" + std::to_string(extent.height);
}

template <typename T>
Result<void> checkFinite(std::span<const T> values, const char* name, const char* viewName)
{
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue; // no words for what is right: this runs every frame
        const std::string where = std::string(name) + "[" + std::to_string(i) + "]";
        if (std::isnan(values[i])) return wrong(GN_ERROR_NOT_A_NUMBER, "CameraNaN", viewName, where + " is NaN");
        return wrong(GN_ERROR_INFINITE, "CameraInfinite", viewName, where + " is infinite");
    }
    return {};
}

bool isOrthographic(const GnViewFrame& frame)
{
    return frame.projection[15] != 0.0f;
}

bool oblique(const GnViewFrame& frame)
{
    return frame.projection[2] != 0.0f || frame.projection[6] != 0.0f;
}

/// Of a perspective clip w is +-view z, and rays leave from the eye; the frustum may be off centre (8, 9), and the near
/// plane oblique (2, 6). Orthographic clip w is 1; rays may leave the view's plane at an angle (8, 9).
Result<void> checkElements(const float* p, bool orthographic, const char* viewName)
{
    const auto is = [&](int i, const char* what) {
        return wrong(
            GN_ERROR_OUT_OF_RANGE, orthographic ? "ProjectionNotOrthographic" : "ProjectionNotPerspective", viewName,
            std::string("projection is not ") + (orthographic ? "an orthographic" : "a perspective") +
                " matrix: projection[" + std::to_string(i) + "] is " + shortestText(double{p[i]}) + ", not " + what);
    };
    for (const int i : {1, 3, 4, 7})
        if (p[i] != 0.0f) return is(i, "0");
    for (const int i : {orthographic ? 2 : 12, orthographic ? 6 : 13})
        if (p[i] != 0.0f) return is(i, "0");
    if (orthographic ? p[11] != 0.0f : std::abs(p[11]) != 1.0f) return is(11, orthographic ? "0" : "1 or -1");
    if (orthographic && p[15] != 1.0f) return is(15, "1, or 0 for a perspective");
    for (const int i : {0, 5, orthographic ? 10 : 14}) // smaller ones have no inverse in single precision to speak of
        if (!(std::abs(p[i]) >= 1e-18f)) return is(i, p[i] == 0.0f ? "different from 0" : "1e-18 or more");
    return {};
}

/// Which way is ahead follows from the convention; infinite it cannot be.
Result<void> checkOrthographic(const GnViewFrame& frame, const char* viewName)
{
    if (frame.depthConvention != GN_DEPTH_REVERSED_INFINITE) return {};
    return wrong(GN_ERROR_OUT_OF_RANGE, "DepthConvention", viewName,
                 "depthConvention " + std::to_string(frame.depthConvention) +
                     " does not fit the projection (orthographic, finite far)");
}

Result<void> checkProjection(const GnViewFrame& frame, const char* viewName)
{
    const float* p = frame.projection;
    const bool orthographic = isOrthographic(frame);
    if (Result<void> ok = checkElements(p, orthographic, viewName); !ok) return ok;
    if (frame.depthConvention < GN_DEPTH_REVERSED_INFINITE || frame.depthConvention > GN_DEPTH_STANDARD)
        return wrong(GN_ERROR_OUT_OF_RANGE, "DepthConvention", viewName,
                     "depthConvention is " + std::to_string(frame.depthConvention) + ", not a GnDepthConvention");
    // Which depth belongs to the near plane follows from the matrix; the convention must agree.
    const bool infinite = p[10] == 0.0f && !oblique(frame);
    // depth = p10 / p11 + p14 / w; orthographic it is p10 z + p14, and either way along z may be ahead.
    if (orthographic) return checkOrthographic(frame, viewName);
    const bool reversed = p[14] > 0.0f;
    const bool saysReversed = frame.depthConvention != GN_DEPTH_STANDARD;
    if (reversed != saysReversed ||
        (frame.depthConvention == GN_DEPTH_REVERSED_INFINITE && !infinite && !oblique(frame)))
        return wrong(GN_ERROR_OUT_OF_RANGE, "DepthConvention", viewName,
                     "depthConvention " + std::to_string(frame.depthConvention) + " does not fit the projection (" +
                         (reversed ? "reversed" : "standard") + (infinite ? ", infinite far)" : ", finite far)"));
    return {};
}

Result<void> checkRotation(const GnViewFrame& frame, const char* viewName)
{
    const float* r = frame.viewFromWorld;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) {
            const float d = r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
            if (std::abs(d - (i == j ? 1.0f : 0.0f)) > 1e-3f)
                return wrong(GN_ERROR_OUT_OF_RANGE, "CameraNotRotation", viewName,
                             "viewFromWorld is not a rotation: rows " + std::to_string(i) + " and " +
                                 std::to_string(j) + " have dot product " + shortestText(double{d}));
        }
    return {};
}

Result<void> checkNormals(const GnViewFrame& frame, const char* viewName, const DeviceTable& vk)
{
    if (frame.normalEncoding < GN_NORMAL_SIGNED || frame.normalEncoding > GN_NORMAL_OCTAHEDRAL_UNSIGNED)
        return wrong(GN_ERROR_OUT_OF_RANGE, "NormalEncoding", viewName,
                     "normalEncoding is " + std::to_string(frame.normalEncoding) + ", not a GnNormalEncoding");
    if (!judgedByNormals(frame)) return {};
    if (frame.normalFormat == VK_FORMAT_UNDEFINED || aspectsOf(frame.normalFormat) != VK_IMAGE_ASPECT_COLOR_BIT)
        return wrong(GN_ERROR_OUT_OF_RANGE, "NormalFormat", viewName,
                     "normalFormat " + std::to_string(frame.normalFormat) + " is not a colour format");
    for (const VkFormat plain : {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32_SFLOAT})
        if (frame.normalFormat == plain) return {}; // every device samples them
    // Integers that are not normalised are never filtered.
    if (!supports(vk, frame.normalFormat,
                  VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT))
        return wrong(GN_ERROR_UNSUPPORTED, "NormalFormat", viewName,
                     "normalFormat " + std::to_string(frame.normalFormat) +
                         " is not one of floats or normalised integers that the device can sample");
    return {};
}

Result<void> checkMotion(const GnViewFrame& frame, const char* viewName)
{
    if ((frame.motionImage != VK_NULL_HANDLE) != (frame.motionView != VK_NULL_HANDLE))
        return wrong(GN_ERROR_NULL_ARGUMENT, "MotionHalf", viewName, "motionImage and motionView go together");
    if (!frame.motionImage) return {};
    if (auto r = checkFinite<float>(frame.motionScale, "motionScale", viewName); !r) return r;
    switch (frame.motionFormat) {
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32G32_SFLOAT:
        if (frame.motionScale[2] == 0.0f) return {};
        return wrong(GN_ERROR_OUT_OF_RANGE, "MotionFormat", viewName,
                     "motionScale[2] is " + shortestText(double{frame.motionScale[2]}) + ", but motionFormat " +
                         std::to_string(frame.motionFormat) + " has no third channel");
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32B32A32_SFLOAT:
        return {};
    default:
        return wrong(GN_ERROR_OUT_OF_RANGE, "MotionFormat", viewName,
                     "motionFormat " + std::to_string(frame.motionFormat) +
                         " is not one of two or four floats of 16 or 32 bits");
    }
}

/// Samples and layers.
Result<void> checkSource(const GnViewFrame& frame, const char* viewName, const DeviceTable& vk)
{
    const std::uint32_t samples = frame.imageSamples;
    if (samples > 8 || (samples & (samples - 1)) != 0)
        return wrong(GN_ERROR_OUT_OF_RANGE, "ImageSamples", viewName,
                     "imageSamples is " + std::to_string(samples) + ", not 0, 1, 2, 4 or 8");
    if (frame.imageSample >= std::max(samples, 1u))
        return wrong(GN_ERROR_OUT_OF_RANGE, "ImageSample", viewName,
                     "imageSample is " + std::to_string(frame.imageSample) + " of " +
                         std::to_string(std::max(samples, 1u)));
    const VkPhysicalDeviceLimits& limits = vk.properties.limits;
    if (samples > 1 && !(limits.sampledImageDepthSampleCounts & samples))
        return wrong(GN_ERROR_UNSUPPORTED, "ImageSamples", viewName,
                     "imageSamples is " + std::to_string(samples) +
                         ", which is not in the device's sampledImageDepthSampleCounts");
    if (samples > 1 && !limits.standardSampleLocations)
        return wrong(GN_ERROR_UNSUPPORTED, "ImageSamples", viewName,
                     "imageSamples is " + std::to_string(samples) +
                         ", but the device has no standardSampleLocations to say where they lie");
    if (frame.imageLayers > limits.maxImageArrayLayers)
        return wrong(GN_ERROR_OUT_OF_RANGE, "ImageLayers", viewName,
                     "imageLayers is " + std::to_string(frame.imageLayers) + ", above the device's " +
                         std::to_string(limits.maxImageArrayLayers));
    if (frame.imageLayer >= std::max(frame.imageLayers, 1u))
        return wrong(GN_ERROR_OUT_OF_RANGE, "ImageLayer", viewName,
                     "imageLayer is " + std::to_string(frame.imageLayer) + ", but imageLayers " +
                         std::to_string(frame.imageLayers));
    return {};
}

Result<void> checkImages(const GnViewFrame& frame, const char* viewName, const DeviceTable& vk)
{
    if (!frame.depthImage || !frame.depthView)
        return wrong(GN_ERROR_NULL_ARGUMENT, "DepthMissing", viewName, "depthImage and depthView are required");
    if (!(aspectsOf(frame.depthFormat) & VK_IMAGE_ASPECT_DEPTH_BIT))
        return wrong(GN_ERROR_OUT_OF_RANGE, "DepthFormat", viewName,
                     "depthFormat " + std::to_string(frame.depthFormat) + " is not a depth format");
    const bool everywhere = frame.depthFormat == VK_FORMAT_D32_SFLOAT || frame.depthFormat == VK_FORMAT_D16_UNORM;
    if (!everywhere && !supports(vk, frame.depthFormat, VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT))
        return wrong(GN_ERROR_UNSUPPORTED, "DepthFormat", viewName,
                     "depthFormat " + std::to_string(frame.depthFormat) + " cannot be sampled by the device");
    if ((frame.normalImage != VK_NULL_HANDLE) != (frame.normalView != VK_NULL_HANDLE))
        return wrong(GN_ERROR_NULL_ARGUMENT, "NormalsHalf", viewName, "normalImage and normalView go together");
    if (Result<void> ok = checkNormals(frame, viewName, vk); !ok) return ok;
    if (Result<void> ok = checkMotion(frame, viewName); !ok) return ok;
    if (Result<void> ok = checkSource(frame, viewName, vk); !ok) return ok;
    const VkExtent2D extent = frame.imageExtent;
    if (extent.width == 0 || extent.height == 0)
        return wrong(GN_ERROR_EMPTY, "ViewEmpty", viewName, "imageExtent is " + sizeText(extent));
    const std::uint32_t limit = vk.properties.limits.maxImageDimension2D;
    if (extent.width > limit || extent.height > limit)
        return wrong(GN_ERROR_OUT_OF_RANGE, "ViewTooLarge", viewName,
                     "imageExtent " + sizeText(extent) + " is above the device's " + std::to_string(limit));
    const VkRect2D area = frame.renderArea;
    const bool inside = area.offset.x >= 0 && area.offset.y >= 0 &&
                        std::uint64_t(area.offset.x) + area.extent.width <= extent.width &&
                        std::uint64_t(area.offset.y) + area.extent.height <= extent.height;
    if (!inside || (area.extent.width == 0) != (area.extent.height == 0))
        return wrong(GN_ERROR_OUT_OF_RANGE, "RenderArea", viewName,
                     "renderArea, " + sizeText(area.extent) + " at " + std::to_string(area.offset.x) + ", " +
                         std::to_string(area.offset.y) +
                         (inside ? ", is empty" : ", does not lie inside imageExtent, " + sizeText(extent)));
    return {};
}

/// One view's part of a frame.
Result<void> checkViewFrame(const GnViewFrame& frame, const char* viewName, std::uint32_t maxLights,
                            const DeviceTable& vk)
{
    if (auto r = checkFinite<double>(frame.eye, "eye", viewName); !r) return r;
    for (int i = 0; i < 3; ++i)
        if (std::abs(frame.eye[i]) > kLargestMagnitude)
            return wrong(GN_ERROR_OUT_OF_RANGE, "CameraTooFar", viewName,
                         "eye[" + std::to_string(i) + "] is " + shortestText(frame.eye[i]) +
                             ", beyond 1e18 m of the world's zero");
    if (auto r = checkFinite<float>(frame.viewFromWorld, "viewFromWorld", viewName); !r) return r;
    if (auto r = checkFinite<float>(frame.projection, "projection", viewName); !r) return r;
    if (auto r = checkRotation(frame, viewName); !r) return r;
    if (auto r = checkProjection(frame, viewName); !r) return r;
    if (auto r = checkImages(frame, viewName, vk); !r) return r;
    if (frame.lightCount > maxLights)
        return wrong(GN_ERROR_TOO_MANY, "TooManyLights", viewName,
                     std::to_string(frame.lightCount) + " lights, the view holds " + std::to_string(maxLights));
    if (frame.lightCount && !frame.pLights)
        return wrong(GN_ERROR_NULL_ARGUMENT, "LightsMissing", viewName, "pLights is null");
    return {};
}

// --- all views ---

/// Views may share their images (two parts of one). Layouts belong to an image, which is one thing for all of them.
Result<void> checkSharedImages(const GnFrameInfo& info, std::uint32_t index, const std::string& name)
{
    const GnViewFrame& frame = info.pViews[index];
    for (std::uint32_t i = 0; i < index; ++i) {
        const GnViewFrame& other = info.pViews[i];
        const bool depth = other.depthImage == frame.depthImage;
        const bool normals = frame.normalImage && other.normalImage == frame.normalImage;
        const bool sameSize =
            other.imageExtent.width == frame.imageExtent.width && other.imageExtent.height == frame.imageExtent.height;
        const bool sameKind = other.imageSamples == frame.imageSamples && other.imageLayers == frame.imageLayers;
        const bool same = sameSize && sameKind && (!depth || other.depthView == frame.depthView) &&
                          (!normals || other.normalView == frame.normalView);
        if (frame.motionImage && other.motionImage == frame.motionImage && other.motionView != frame.motionView)
            return Error{GN_ERROR_OUT_OF_RANGE, "ImageShared",
                         "view '" + name + "' shares motionImage with pViews[" + std::to_string(i) +
                             "], but not its image view"};
        if ((depth || normals) && !same)
            return Error{GN_ERROR_OUT_OF_RANGE, "ImageShared",
                         "view '" + name + "' shares " + (depth ? "depthImage" : "normalImage") + " with pViews[" +
                             std::to_string(i) +
                             "], but not its image view, imageExtent, imageSamples and imageLayers"};
    }
    return {};
}

Result<void> checkLights(const GnViewFrame& frame, const std::string& name, const SceneRegistry& scene)
{
    for (std::uint32_t k = 0; k < frame.lightCount; ++k) {
        const GnLight* earlier = std::find(frame.pLights, frame.pLights + k, frame.pLights[k]);
        if (earlier != frame.pLights + k)
            return Error{GN_ERROR_OUT_OF_RANGE, "LightTwice",
                         "view '" + name + "': pLights[" + std::to_string(k) + "] is pLights[" +
                             std::to_string(earlier - frame.pLights) + "] again"};
        if (!scene.validLight(frame.pLights[k]))
            return Error{GN_ERROR_INVALID_HANDLE, "InvalidHandle",
                         "view '" + name + "': pLights[" + std::to_string(k) + "] is not a live light of this context"};
    }
    return {};
}

Result<void> readViews(const GnFrameInfo& info, const ReadParts& parts, std::vector<View*>& out)
{
    out.clear();
    for (std::uint32_t i = 0; i < info.viewCount; ++i) {
        const GnViewFrame& frame = info.pViews[i];
        View* view = parts.views.find(frame.view);
        if (!view)
            return Error{GN_ERROR_INVALID_HANDLE, "InvalidHandle",
                         "pViews[" + std::to_string(i) + "].view is not a live view of this context"};
        if (std::find(out.begin(), out.end(), view) != out.end())
            return Error{GN_ERROR_OUT_OF_RANGE, "ViewTwice", "view '" + view->name + "' appears twice in the frame"};
        if (Result<void> ok = checkViewFrame(frame, view->name.c_str(), view->maxLights, parts.vk); !ok) return ok;
        if (Result<void> ok = checkLights(frame, view->name, parts.scene); !ok) return ok;
        if (Result<void> ok = checkSharedImages(info, i, view->name); !ok) return ok;
        out.push_back(view);
    }
    return {};
}

// --- the frame ---

Result<void> checkOrder(const GnFrameInfo& info, const ReadParts& parts)
{
    if (parts.executor && parts.executor->underway())
        return frameOrder("gnFinishShadows of frame " + std::to_string(parts.newest) + " is missing");
    if (info.frame == 0) return frameOrder("frame is 0; the first frame is at least 1");
    if (parts.newest != 0 && info.frame != parts.newest + 1)
        return frameOrder("frame is " + std::to_string(info.frame) + " after " + std::to_string(parts.newest));
    if (const GnFrameFlags other = info.flags & ~GN_FRAME_TIMED_BIT)
        return unknownFlags("GnFrameInfo::flags", other, "GnFrameFlagBits");
    if (info.completedFrame >= info.frame)
        return frameOrder("completedFrame " + std::to_string(info.completedFrame) + " is not before frame " +
                          std::to_string(info.frame));
    return parts.executor ? parts.executor->checkSlot(info.frame, info.completedFrame) : Result<void>();
}

Result<void> checkBudget(float budgetMs)
{
    if (std::isnan(budgetMs)) return Error{GN_ERROR_NOT_A_NUMBER, "BudgetNaN", "budgetMs is NaN"};
    if (std::isinf(budgetMs)) return Error{GN_ERROR_INFINITE, "BudgetInfinite", "budgetMs is infinite"};
    if (budgetMs < 0.0f)
        return Error{GN_ERROR_OUT_OF_RANGE, "BudgetNegative", "budgetMs is " + shortestText(double{budgetMs})};
    return {};
}

Result<void> checkSemaphores(const GnSemaphorePoint* points, std::uint32_t count, const char* name)
{
    const auto missing = [name](const std::string& what) {
        return Error{GN_ERROR_NULL_ARGUMENT, "SemaphoresMissing", std::string(name).append(what).append(" is null")};
    };
    if (count && !points) return missing("");
    for (std::uint32_t i = 0; i < count; ++i)
        if (!points[i].semaphore) return missing(std::string("[") + std::to_string(i) + "].semaphore");
    return {};
}

void readSemaphores(const GnSemaphorePoint* points, std::uint32_t count, std::vector<VkSemaphoreSubmitInfo>& out)
{
    out.clear();
    for (std::uint32_t i = 0; i < count; ++i)
        out.push_back({.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                       .semaphore = points[i].semaphore,
                       .value = points[i].value,
                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
}

} // namespace

Result<void> readFrame(const GnFrameInfo& info, const ReadParts& parts, FrameInput& out)
{
    if (Result<void> ok = checkOrder(info, parts); !ok) return ok;
    if (Result<void> ok = checkBudget(info.budgetMs); !ok) return ok;
    if (info.viewCount && !info.pViews) return Error{GN_ERROR_NULL_ARGUMENT, "ViewsMissing", "pViews is null"};
    if (Result<void> ok = checkSemaphores(info.pWaits, info.waitCount, "pWaits"); !ok) return ok;
    if (Result<void> ok = checkSemaphores(info.pSignals, info.signalCount, "pSignals"); !ok) return ok;
    if (Result<void> ok = readViews(info, parts, out.views); !ok) return ok;
    readSemaphores(info.pWaits, info.waitCount, out.waits);
    readSemaphores(info.pSignals, info.signalCount, out.signals);
    return {};
}

} // namespace gnomon
