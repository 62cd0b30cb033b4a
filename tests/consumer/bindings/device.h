/* What a renderer has before gnomon comes: a device, and a depth image that shows a floor at one distance. The samples
share it, so that they have nothing but gnomon in them: all of Vulkan is behind these two functions. */
#ifndef CONSUMER_DEVICE_H
#define CONSUMER_DEVICE_H
#include <stdint.h>
#include <vulkan/vulkan.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CONSUMER_SIZE = 64 }; /* pixels a side of the depth image */

typedef struct ConsumerDevice {
    VkInstance instance;
    VkPhysicalDevice gpu;
    VkDevice device;
    VkQueue queue; /* of family 0 */
    const VkPhysicalDeviceFeatures2* pFeatures;
    PFN_vkGetInstanceProcAddr pfnGetInstanceProcAddr;
    VkImage depth; /* D32_SFLOAT, reversed: 0.1 m / 4 m; in SHADER_READ_ONLY_OPTIMAL */
    VkImageView depthView;
    VkDeviceMemory memory;
    VkCommandPool pool;
} ConsumerDevice;

/* 0, 77 where there is no device, or 1 after a message. */
__attribute__((visibility("default"))) int consumerOpen(ConsumerDevice* out);
__attribute__((visibility("default"))) void consumerClose(ConsumerDevice* device);

#ifdef __cplusplus
}
#endif
#endif
