#include "runtime/scene/mesh_chunks.hpp"

#include <glm/common.hpp>

namespace gnomon {

std::vector<Aabb> chunkBounds(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    constexpr std::size_t kStep = std::size_t{3} * kChunkFaces;
    std::vector<Aabb> chunks;
    chunks.reserve((indices.size() + kStep - 1) / kStep);
    for (std::size_t first = 0; first < indices.size(); first += kStep) {
        Aabb box{positions[indices[first]], positions[indices[first]]};
        for (const std::uint32_t index : indices.subspan(first, std::min(kStep, indices.size() - first))) {
            box.lower = glm::min(box.lower, positions[index]);
            box.upper = glm::max(box.upper, positions[index]);
        }
        chunks.push_back(box);
    }
    return chunks;
}

glm::vec3 edgeSpan(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    glm::vec3 span(0.0f);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const glm::vec3 a = positions[indices[i]], b = positions[indices[i + 1]], c = positions[indices[i + 2]];
        span = glm::max(span, glm::max(a, glm::max(b, c)) - glm::min(a, glm::min(b, c)));
    }
    return span;
}

} // namespace gnomon
