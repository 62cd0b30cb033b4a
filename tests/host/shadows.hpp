// How the stranger's renderer embeds gnomon: as the README says, through the C API alone.
#ifndef GNOMON_TESTS_HOST_SHADOWS_HPP
#define GNOMON_TESTS_HOST_SHADOWS_HPP

#include <array>
#include <atomic>
#include <span>
#include <string>
#include <vector>

#include <gnomon/gnomon.h>

#include "frame_data.hpp"
#include "vulkan_device.hpp"

namespace stranger {

/// What a user of the renderer chooses.
struct Options {
    bool recorded = false; ///< gnCmdRenderShadows(), else gnSubmitShadows().
    VkExtent2D size{1280, 720};
    float budgetMs = 0.0f;     ///< 0: none.
    std::string rulesPath;     ///< Empty: the shipped base "default".
    std::string knowledgePath; ///< Empty: none is loaded.
    bool hooks = false;        ///< Device memory comes from the host.
};

/// What was decided for a light.
struct Choice {
    const char* pMethod = nullptr; ///< Null: nothing can serve.
    GnReason reason = GN_REASON_NOTHING_READY;
    float predictedMs = 0.0f;
    bool switched = false;
};

class Shadows {
public:
    static constexpr uint32_t kFramesInFlight = 2;

    Shadows(const Device& device, const Options& options, std::span<const Mesh> meshes);
    ~Shadows();
    Shadows(const Shadows&) = delete;
    Shadows& operator=(const Shadows&) = delete;

    /// gnWarmUp(), or what one method needs.
    void warmUp(const char* pMethod = nullptr);
    /// All lights; null hands them back to the rules. False where the method is refused.
    bool pin(const char* pMethod);
    /// Methods that may serve point lights by this entry point, by what they say of themselves.
    std::vector<std::string> methods() const;

    /// Moves the lights and runs gnomon. \param commands Recorded into; null: gnomon submits to the queue.
    /// \return As the call of gnomon: GN_NOT_READY or a success. Throws on failures.
    GnResult render(VkCommandBuffer commands, const FrameData& data, const Image& depth, const Image& normals,
                    uint64_t frame, uint64_t completedFrame);

    /// Blocks of memory given so far (Options::hooks).
    size_t blocksGiven() const noexcept { return heap_.given; }
    GnVisibility visibility() const;
    GnFrameStats stats() const;
    std::array<Choice, kLampCount> choices() const;
    /// gnExplain(); `pMethod` asks why it is not the light's, null why the chosen one is.
    std::string explain(int light, const char* pMethod) const;

private:
    /// A host's memory at its simplest: a block of Vulkan's for each that is asked for.
    struct Heap {
        VkDevice device = VK_NULL_HANDLE;
        std::atomic<size_t> given{0}, taken{0}; ///< Any thread.
    };
    static VkResult GN_CALL giveMemory(const GnMemoryRequest* pRequest, GnMemoryBlock* pBlock, void* pUserData);
    static void GN_CALL takeMemory(const GnMemoryBlock* pBlock, void* pUserData);
    void createScene(std::span<const Mesh> meshes);

    Options options_;
    Heap heap_;
    GnContext context_ = nullptr;
    GnView view_ = VK_NULL_HANDLE;
    std::array<GnLight, kLampCount> lights_{};
};

/// The reason as a host would show it: "price".
const char* reasonText(GnReason reason);

} // namespace stranger
#endif
