// All that gnomon adds to the engine; docs/integration.md explains the steps.
#pragma once

#include <cstdio>
#include <cstring>

#include "gpu.hpp"
#include "scene.hpp"

namespace embed {

struct Shadows {
    Shadows(const Gpu& gpu, const Scene& scene)
    {
        GnContextCreateInfo info{.instance = *gpu.instance, .physicalDevice = *gpu.physical, .device = *gpu.device};
        info.queue = *gpu.queue; // of family 0
        info.apiVersion = VK_API_VERSION_1_3;
        info.pEnabledFeatures = &static_cast<const VkPhysicalDeviceFeatures2&>(gpu.features.get());
        info.enabledExtensionCount = uint32_t(gpu.extensions.size());
        info.ppEnabledExtensionNames = gpu.extensions.data();
        info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
        info.pfnMessage = [](const GnMessage* message, void*) {
            if (message->severity != GN_SEVERITY_INFO) std::fprintf(stderr, "%s: %s\n", message->pId, message->pText);
        };
        context = gn::Context::create(info).value();
        context.loadShippedRules("default").require();
        for (const Object& object : scene.opaque) {
            const std::span corners(&scene.corners[object.first], object.count); // indices may follow
            meshes.push_back(context.createMesh(corners, {}, object.name).value());
            GnInstanceCreateInfo placed{.flags = GN_INSTANCE_STATIC_BIT, .pName = object.name};
            placed.mesh = meshes.back().get(); // in the world already: by the identity
            instances.push_back(context.createInstance(placed).value());
        }
        for (size_t i = 0; i < kLights; ++i)
            lights[i] = context.createLight(describe(i, lightsAt(0.0)[i])).value();
        view = context.createView().value();
        context.warmUp().require(); // behind the loading screen
    }

    /// \param commands Recorded into; null: gnomon submits to the queue.
    /// \param surfaces Albedo, normals, depth, which can be read.
    void render(vk::CommandBuffer commands, const Camera& camera, const glm::mat4& clipFromView, const Lights& now,
                const Canvas& surfaces, uint64_t frame, uint64_t completed) const
    {
        std::array<GnLight, kLights> handles{};
        for (size_t i = 0; i < kLights; ++i) {
            lights[i].update(describe(i, now[i])).require();
            handles[i] = lights[i].get();
        }
        const Image &normals = surfaces.images[1], &depth = surfaces.images[2];
        GnViewFrame seen{.view = view.get(), .imageExtent = surfaces.size};
        seen.depthImage = *depth.image;
        seen.depthView = *depth.view;
        seen.depthFormat = VkFormat(depth.format);
        seen.normalImage = *normals.image;
        seen.normalView = *normals.view;
        seen.normalFormat = VkFormat(normals.format);
        gn::setLights(seen, handles);
        const glm::vec3 eye = camera.eye();
        const glm::mat3 rows = glm::transpose(glm::mat3(camera.viewFromWorld()));
        std::copy_n(&eye.x, 3, seen.eye);
        std::copy_n(&rows[0].x, 9, seen.viewFromWorld);
        std::copy_n(&clipFromView[0].x, 16, seen.projection);
        const gn::Frame all{.frame = frame, .completedFrame = completed, .views = {&seen, 1}};
        (commands ? context.cmdRenderShadows(commands, all) : context.submitShadows(all)).require();
    }

    static GnLightInfo describe(size_t index, const Light& light)
    {
        return {.type = GnLightType(index),
                .flags = GN_LIGHT_SAMPLED_BIT,
                .pName = kLightNames[index],
                .position = {light.position.x, light.position.y, light.position.z},
                .direction = {light.direction.x, light.direction.y, light.direction.z},
                .range = light.colour.w,
                .coneAngle = index == GN_LIGHT_TYPE_SPOT ? std::acos(light.direction.w) : 0.0f};
    }

    gn::Context context; // before what is made from it: members are destroyed from the last to the first
    std::vector<gn::Mesh> meshes;
    std::vector<gn::Instance> instances;
    std::array<gn::Light, kLights> lights;
    gn::View view;
};

} // namespace embed
