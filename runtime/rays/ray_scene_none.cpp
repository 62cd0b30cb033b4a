// In place of ray_scene.cpp where gnomon is built without Embree: no trees, and nothing is ever hit.
#include "runtime/rays/ray_scene.hpp"

#include <algorithm>

namespace gnomon {

bool castsRays(const Caster&)
{
    return false;
}

class MeshRaysHistory::Impl {};
MeshRaysHistory::MeshRaysHistory() = default;
MeshRaysHistory::~MeshRaysHistory() = default;

struct MeshRays::Impl {};
MeshRays::MeshRays(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MeshRays::~MeshRays() = default;
std::size_t MeshRays::memoryBytes() const noexcept
{
    return 0;
}

bool MeshRays::moved() const noexcept
{
    return false;
}

const std::shared_ptr<const TriangleTree>& MeshRays::tree() const noexcept
{
    static const std::shared_ptr<const TriangleTree> none;
    return none;
}

struct RayScene::Impl {};
RayScene::RayScene() = default;
RayScene::~RayScene() = default;
std::unique_ptr<MeshRays> RayScene::build(std::span<const glm::vec3>, std::span<const std::uint32_t>, MeshRaysHistory*)
{
    return nullptr;
}
bool RayScene::update(std::span<const Caster>)
{
    return true;
}
void RayScene::occluded(std::span<const ShadowRay>, std::uint32_t, std::span<std::uint8_t> occluded) const
{
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
}
void RayScene::occluded(std::span<RayPacket>, std::uint32_t) const {}
std::uint64_t RayScene::queryNanoseconds() const noexcept
{
    return 0;
}

std::size_t RayScene::memoryBytes() const noexcept
{
    return 0;
}

} // namespace gnomon
