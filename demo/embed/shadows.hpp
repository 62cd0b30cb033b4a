// All that gnomon adds to the engine; docs/integration.md explains the steps.
#pragma once

#include <cstring>
#include <memory>

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
        GnContext context = nullptr;
        require(gnCreateContext(&info, &context));
        context_.reset(context);
        require(gnLoadShippedRules(context, "default"));
        for (const Object& object : scene.objects) // glass casts no shadow
            if (object.colour.a == 1.0f) addCaster(scene, object);
        for (size_t i = 0; i < lights_.size(); ++i) {
            const GnLightInfo light = describe(i, lightsAt(0.0)[i]);
            require(gnCreateLight(context, &light, &lights_[i]));
        }
        for (GnView& view : views_)
            require(gnCreateView(context, nullptr, &view));
        require(gnWarmUp(context)); // behind the loading screen
    }

    /// Both views show the same camera: one of what is opaque, the other with the glass in its depth.
    /// \param commands Recorded into; null: gnomon submits to the queue.
    void render(vk::CommandBuffer commands, const Camera& camera, const std::array<Light, 3>& lights,
                const Image& normals, std::array<const Image*, 2> depths, vk::Extent2D size, uint64_t frame,
                uint64_t completed)
    {
        for (size_t i = 0; i < lights_.size(); ++i) {
            const GnLightInfo light = describe(i, lights[i]);
            require(gnUpdateLight(context_.get(), lights_[i], &light));
        }
        std::array<GnViewFrame, 2> views{};
        for (size_t i = 0; i < views.size(); ++i) {
            views[i].view = views_[i];
            for (int axis = 0; axis < 3; ++axis)
                views[i].eye[axis] = double(camera.eye[axis]);
            std::memcpy(views[i].viewFromWorld, &camera.worldFromView, sizeof views[i].viewFromWorld); // rows: columns
            std::memcpy(views[i].projection, &camera.clipFromView, sizeof views[i].projection);
            views[i].depthImage = *depths[i]->image;
            views[i].depthView = *depths[i]->view;
            views[i].depthFormat = VkFormat(depths[i]->format);
            views[i].imageExtent = size;
            views[i].lightCount = uint32_t(lights_.size());
            views[i].pLights = lights_.data();
        }
        views[0].normalImage = *normals.image; // of the opaque; the other view takes them from its depth
        views[0].normalView = *normals.view;
        views[0].normalFormat = VkFormat(normals.format);
        GnFrameInfo info{};
        info.frame = frame;
        info.completedFrame = completed;
        info.viewCount = uint32_t(views.size());
        info.pViews = views.data();
        require(commands ? gnCmdRenderShadows(context_.get(), commands, &info)
                         : gnSubmitShadows(context_.get(), &info));
    }

    GnVisibility visibility(size_t view) const
    {
        GnVisibility result{};
        require(gnGetVisibility(context_.get(), views_[view], &result));
        return result;
    }
    GnContext context() const { return context_.get(); }
    GnView view() const { return views_[0]; } // of what is opaque
    const std::array<GnLight, 3>& lights() const { return lights_; }

private:
    void addCaster(const Scene& scene, const Object& object)
    {
        GnMeshCreateInfo mesh{};
        mesh.pName = object.name;
        mesh.pPositions = &scene.positions[object.firstVertex].x;
        mesh.positionCount = object.vertexCount;
        mesh.pIndices = &scene.indices[object.firstIndex];
        mesh.indexCount = object.indexCount;
        GnInstanceCreateInfo placed{}; // in the world already: the identity
        placed.flags = GN_INSTANCE_STATIC_BIT;
        placed.pName = object.name;
        GnInstance instance = VK_NULL_HANDLE;
        require(gnCreateMesh(context_.get(), &mesh, &placed.mesh));
        require(gnCreateInstance(context_.get(), &placed, &instance));
    }

    static GnLightInfo describe(size_t index, const Light& light)
    {
        GnLightInfo info{};
        info.type = GnLightType(index);
        info.pName = kLightNames[index];
        for (int axis = 0; axis < 3; ++axis) {
            info.position[axis] = double(light.positionAndRange[axis]);
            info.direction[axis] = light.direction[axis];
        }
        info.range = light.positionAndRange.w;
        info.coneAngle = index == GN_LIGHT_TYPE_SPOT ? std::acos(light.direction.w) : 0.0f;
        return info;
    }

    void require(GnResult result) const
    {
        if (result >= 0) return;
        throw std::runtime_error(std::string("gnomon: ") + gnResultName(result) + ": " +
                                 (context_ ? gnGetLastError(context_.get()) : "no context"));
    }

    std::unique_ptr<std::remove_pointer_t<GnContext>, decltype(&gnDestroyContext)> context_{nullptr, &gnDestroyContext};
    std::array<GnLight, 3> lights_{};
    std::array<GnView, 2> views_{};
};

} // namespace embed
