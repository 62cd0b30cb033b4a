#pragma once
// Passes in which the pixels of a light ask rays of the device.
#include "runtime/algorithm.hpp"
#include "shaders/hybrid/ray_query.h"

namespace gnomon {

/// Why the device cannot trace the task, or null.
const char* refusesDeviceRays(const ShadowTask& task);

/// What RayQueryConstants say of a task. @param lit, dark bytes of visibility
gpu::RayQueryConstants rayConstants(const ShadowTask& task, std::uint8_t lit = 255, std::uint8_t dark = 0);

/// A raster pass whose fragment shader includes shaders/hybrid/asked_ray.glsl. Constants of any kind are at binding 0.
class DeviceTrace {
public:
    enum class Asks : std::uint8_t {
        all,    ///< Pixels that the light may reach.
        listed, ///< Those of a list (shaders/hybrid/undecided.comp).
    };
    /// @param fragment with specialization constant 0: the host gives normals
    DeviceTrace(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> fragment,
                VkFormat target, Asks asks = Asks::all);

    /// Writes the pixels that it asks. @param part with a clear of all others, or a blend that keeps them
    template <typename Block>
    void declare(PassBuilder& passes, const ShadowTask& task, const Block& block, ImageId target, const Part& part,
                 BufferId list = {}) const
    {
        const Pixels pixels(task, list);
        const Block* const constants = passes.arena().make(block);
        open(passes, task, target, part, list).record([=, pipeline = pipelines_[pixels.hasNormals]](PassContext& gpu) {
            draw(gpu, pixels, pipeline, gpu.constants(0, *constants));
        });
    }

private:
    struct Pixels {
        Pixels(const ShadowTask& task, BufferId list);
        ImageId depth, normals;
        bool hasNormals;
        TracedScene scene;
        BufferId list;
        VkRect2D reached;
    };
    PassRef open(PassBuilder& passes, const ShadowTask& task, ImageId target, const Part& part, BufferId list) const;
    static void draw(PassContext& gpu, const Pixels& pixels, PipelineId pipeline, const Bound& constants);

    const char* name_;
    PipelineId pipelines_[2]; ///< [has normals]
};

} // namespace gnomon
