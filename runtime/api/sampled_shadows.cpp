// What hosts' shaders look up shadows with: gnGetSampledShadows().
#include <algorithm>
#include <cmath>

#include "runtime/api/context.hpp"

namespace gnomon {

static_assert(sizeof(gpu::ShadowSample) == GN_SAMPLED_LIGHT_SIZE);

namespace {

/// In the host's coordinates, whose zero is at `zero` of the world.
gpu::ShadowSample inHostCoordinates(gpu::ShadowSample sample, const CameraView& camera, const double* zero)
{
    float farthest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        sample.eye[axis] = static_cast<float>(camera.origin[axis] + double{camera.eye[axis]} - zero[axis]);
        farthest = std::fmax(farthest, std::fabs(sample.eye[axis]));
    }
    sample.map.offset.x += 0x1p-21f * farthest; // what the host's positions are rounded by, as shared/receiver.h has it
    const glm::mat4& clip = camera.constants.clipFromWorld;
    sample.ahead = gpu::isOrthographic(camera.constants) ? glm::vec4(0.0f, 0.0f, 0.0f, 1.0f)
                                                         : glm::vec4(clip[0][3], clip[1][3], clip[2][3], 0.0f);
    return sample;
}

Result<void> checkOrigin(const double* origin)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(origin[axis]))
            return Error{std::isnan(origin[axis]) ? GN_ERROR_NOT_A_NUMBER : GN_ERROR_INFINITE, "SampleOrigin",
                         "pOrigin[" + std::to_string(axis) + "] is " + std::to_string(origin[axis])};
    return {};
}

/// Of the disc that the light's source shows: metres, of a sun over the distance. Its rim is below the horizon at pi
/// / 2.
float discRadius(const LightView& light)
{
    const float radius = light.constants.sourceRadius;
    return light.type == GN_LIGHT_TYPE_DIRECTIONAL ? std::tan(std::fmin(radius, 1.5f)) : radius;
}

/// What hosts are told of each light of one of the frame's views. @param images what `out.maps` are known by
/// @return how many have a map
std::uint32_t describeLights(const Frame& frame, std::uint32_t viewIndex, PassGraph& graph, const double* origin,
                             SampledLights& out, std::vector<std::uint64_t>& images)
{
    const View& view = *frame.views[viewIndex].view;
    const std::size_t count = frame.views[viewIndex].lights;
    out.samples.assign(count, {});
    out.maps.assign(count, view.visibility->gpu.view); // something to bind
    out.methods.assign(count, nullptr);
    images.assign(count, view.revision);
    std::uint32_t found = 0;
    for (const ViewLight& light : frame.lights) {
        if (light.viewIndex != viewIndex || !light.light->sampled) continue;
        const auto map = std::find_if(frame.maps.begin(), frame.maps.end(), [&](const DeclaredMap& each) {
            return each.viewIndex == viewIndex && each.lightId == light.light->id &&
                   each.map.sample.kind != gpu::SAMPLE_NOTHING;
        });
        if (map == frame.maps.end()) continue;
        const PooledImage& image = graph.image(map->map.image);
        out.samples[light.layer] = inHostCoordinates(map->map.sample, view.camera, origin);
        out.samples[light.layer].eye.w = discRadius(*light.light);
        out.maps[light.layer] = image.gpu.view;
        out.methods[light.layer] = map->method;
        images[light.layer] = ~image.serial; // never a revision
        ++found;
    }
    return found;
}

} // namespace

Result<GnSampledShadows> Context::sampledShadows(GnView handle, const double* origin)
{
    static constexpr double kWorld[3] = {};
    View* view = views_.find(handle);
    if (!view) return invalidHandle("view");
    if (!origin) origin = kWorld;
    if (Result<void> finite = checkOrigin(origin); !finite) return finite.error();
    const auto in = std::find_if(frame_.views.begin(), frame_.views.end(),
                                 [view](const ViewFrame& each) { return each.view == view; });
    if (in == frame_.views.end() || view->lastFrame != frame_.number || frame_.dropped || !view->visibility)
        return Error{GN_ERROR_FRAME_ORDER, "NoFrameYet",
                     "view '" + view->name + "' was not in the newest frame, or that does not count"};
    const auto index = static_cast<std::uint32_t>(in - frame_.views.begin());
    const bool asked = std::any_of(frame_.lights.begin(), frame_.lights.end(), [index](const ViewLight& light) {
        return light.viewIndex == index && light.light->sampled;
    });
    if (!asked)
        return Error{GN_ERROR_EMPTY, "NotSampled",
                     "none of the " + std::to_string(in->lights) + " lights of view '" + view->name +
                         "' has GN_LIGHT_SAMPLED_BIT"};

    SampledLights& out = view->sampled;
    const std::uint32_t found = describeLights(frame_, index, *graph_, origin, out, sampledImages_);
    if (sampledImages_ != out.images || out.revision == 0) ++out.revision;
    std::swap(sampledImages_, out.images);
    return GnSampledShadows{.lightCount = in->lights,
                            .pMaps = out.maps.data(),
                            .pMethods = out.methods.data(),
                            .sampler = samplers_->get(SamplerKind::nearestBorderFar),
                            .pConstants = out.samples.data(),
                            .constantsSize = out.samples.size() * sizeof(gpu::ShadowSample),
                            .revision = out.revision,
                            .constantsStride = sizeof(gpu::ShadowSample),
                            .litCount = in->lights - found};
}

} // namespace gnomon
