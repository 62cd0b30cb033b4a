// All that gnomon adds to the engine; docs/integration.md explains the steps.
#pragma once

#include <cstdio>
#include <cstring>

#include <gnomon/gnomon.hpp>

#include "gpu.hpp"
#include "scene.hpp"

namespace embed {

class Shadows {
public:
    Shadows(const Gpu& gpu, const Scene& scene)
    {
        GnContextCreateInfo info{};
        info.instance = *gpu.instance;
        info.physicalDevice = *gpu.physical;
        info.device = *gpu.device;
        info.queue = *gpu.queue;
        info.queueFamilyIndex = gpu.family;
        info.apiVersion = VK_API_VERSION_1_3;
        info.pEnabledFeatures = reinterpret_cast<const VkPhysicalDeviceFeatures2*>(&gpu.features);
        info.enabledExtensionCount = uint32_t(gpu.extensions.size());
        info.ppEnabledExtensionNames = gpu.extensions.data();
        info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
        info.pfnMessage = [](const GnMessage* message, void*) {
            if (message->severity != GN_SEVERITY_INFO) std::fprintf(stderr, "%s: %s\n", message->pId, message->pText);
        };
        context = gn::Context::create(info).value();
        context.loadShippedRules("default").require();
        for (const Object& object : scene.objects) {
            if (object.colour.a < 1.0f) continue; // glass casts no shadow
            const std::span at(&scene.positions[object.firstVertex], object.vertexCount);
            const std::span of(&scene.indices[object.firstIndex], object.indexCount);
            meshes_.push_back(context.createMesh(at, of, object.name).value());
            GnInstanceCreateInfo placed{.flags = GN_INSTANCE_STATIC_BIT, .pName = object.name};
            placed.mesh = meshes_.back().get(); // in the world already: by the identity
            instances_.push_back(context.createInstance(placed).value());
        }
        for (size_t i = 0; i < kLights; ++i)
            lights[i] = context.createLight(describe(i, lightsAt(0.0)[i])).value();
        view = context.createView().value();
        context.warmUp().require(); // behind the loading screen
    }

    /// \param commands Recorded into; null: gnomon submits to the queue.
    void render(vk::CommandBuffer commands, const Camera& camera, const Lights& now, const Image& depth,
                const Image& normals, vk::Extent2D size, uint64_t frame, uint64_t completed) const
    {
        std::array<GnLight, kLights> handles{};
        for (size_t i = 0; i < kLights; ++i) {
            lights[i].update(describe(i, now[i])).require();
            handles[i] = lights[i].get();
        }
        GnViewFrame seen{.view = view.get(),
                         .depthImage = *depth.image,
                         .depthView = *depth.view,
                         .depthFormat = VkFormat(depth.format),
                         .imageExtent = size,
                         .normalImage = *normals.image,
                         .normalView = *normals.view,
                         .normalFormat = VkFormat(normals.format)};
        gn::setLights(seen, handles);
        std::copy_n(&camera.eye.x, 3, seen.eye);
        std::memcpy(seen.viewFromWorld, &camera.worldFromView, sizeof seen.viewFromWorld); // its columns are rows
        std::memcpy(seen.projection, &camera.clipFromView, sizeof seen.projection);
        const gn::Frame all{.frame = frame, .completedFrame = completed, .views = {&seen, 1}};
        (commands ? context.cmdRenderShadows(commands, all) : context.submitShadows(all)).require();
    }

    gn::Context context; // before what is made from it: members are destroyed from the last to the first
    std::array<gn::Light, kLights> lights;
    gn::View view;

private:
    static GnLightInfo describe(size_t index, const Light& light)
    {
        GnLightInfo info{.type = GnLightType(index), .flags = GN_LIGHT_SAMPLED_BIT, .pName = kLightNames[index]};
        std::copy_n(&light.positionAndRange.x, 3, info.position);
        std::copy_n(&light.direction.x, 3, info.direction);
        info.range = light.positionAndRange.w;
        info.coneAngle = index == GN_LIGHT_TYPE_SPOT ? std::acos(light.direction.w) : 0.0f;
        return info;
    }

    std::vector<gn::Mesh> meshes_;
    std::vector<gn::Instance> instances_;
};

} // namespace embed
