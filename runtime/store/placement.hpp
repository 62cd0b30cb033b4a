#pragma once
// Instances whose transforms lie in a buffer of the host's, where the GPU alone reads them.
#include <array>
#include <memory>
#include <string>

#include "runtime/scene/aabb.hpp"
#include "runtime/store/mesh_store.hpp"

namespace gnomon {

/// What the GPU finds of the transforms of instances that were made by one call.
struct PlacementFindings {
    std::string what;   ///< "instance 'tree'".
    OwnedBuffer buffer; ///< Mapped: the least element that is no transform; UINT32_MAX: none.
    bool told = false;  ///< Guarded by the registry's mutex.
};

/// The part of a buffer with an array of transforms.
struct TransformArray {
    VkDescriptorBufferInfo range{}; ///< All of the call's elements, and no more.
    std::uint32_t stride = 0;       ///< Bytes.
    bool mirrored = false;
    std::array<double, 3> origin{}; ///< World position of the zero of translations and bounds.

    bool operator==(const TransformArray& other) const noexcept
    {
        return range.buffer == other.range.buffer && range.offset == other.range.offset &&
               range.range == other.range.range && stride == other.stride && mirrored == other.mirrored &&
               origin == other.origin;
    }
};

/// An element of it.
struct BufferPlacement {
    TransformArray array;
    std::uint32_t element = 0;
    Aabb bounds; ///< World, relative to TransformArray::origin.
    std::shared_ptr<PlacementFindings> findings;
};

/// Neighbours in the array that are neighbours in the frame's table of transforms.
struct PlacementRun {
    TransformArray array;
    std::uint32_t element = 0, index = 0, count = 0; ///< First of the array, first of the table; how many.
    std::array<float, 3> shift{};                    ///< Added to translations: the array's origin in the frame's.
    std::shared_ptr<PlacementFindings> findings;
};

} // namespace gnomon
