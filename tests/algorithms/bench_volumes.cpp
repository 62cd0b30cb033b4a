// What finding and writing shadow volumes takes on the CPU: nanoseconds a face of the phases of Rautenbach 2008
// (facing, silhouette, caps, volume), with and without culling of faces beyond the light's range. Times drift with the
// machine: what is printed is the least of many rounds in which all variants take turns. See
// algorithms/volumes/README.md.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>

#include "algorithms/volumes/silhouette.hpp"
#include "tests/algorithms/volume_meshes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A torus of so many faces: the thesis's models (tiger, the unnamed one, battleship), 2 000 and 100 000.
struct Size {
    std::uint32_t ring, tube;
    std::uint32_t faces() const { return 2 * ring * tube; }
};
constexpr Size kSizes[] = {{20, 15}, {39, 21}, {40, 25}, {151, 32}, {250, 200}};

/// A torus before a light, and what the phases hand on.
struct Work {
    Placed placed;
    LightView light;
    gpu::FaceLight lightOs;
    std::vector<std::uint8_t> facing, inRange;
    std::vector<SilhouetteEdge> silhouette;
    std::vector<std::uint32_t> caps, sides;
    std::uint32_t edgeCount = 0, silhouetteCount = 0;

    explicit Work(const Size& size)
        : placed(torus(1.0f, 0.35f, size.ring, size.tube), glm::mat3(1.0f), glm::vec3(0.0f)),
          light(pointLight(glm::vec3(1.5f, 3.0f, 0.7f)))
    {
        const Topology& topology = placed.topology;
        lightOs = lightInObjectSpace(light, placed.caster);
        edgeCount = static_cast<std::uint32_t>(topology.edges.size());
        facing.resize(topology.facePlanes.size());
        inRange.resize(facing.size());
        silhouette.resize(edgeCount);
        culled_.resize(edgeCount);
        caps.resize(capCapacity(static_cast<std::uint32_t>(facing.size())));
        sides.resize(sideCapacity(topology, whole(), 0, edgeCount));
        light.constants.range = 3.4f; // about half of the torus
        facingPhase();
        cullPhase();
        silhouettePhase();
    }
    std::uint32_t faces() const { return static_cast<std::uint32_t>(facing.size()); }
    const Topology::Cluster& whole() const { return placed.topology.clusters[0]; }

    void facingPhase() { findFacing(placed.topology, lightOs, 0, facing); }
    void silhouettePhase()
    {
        silhouetteCount = findSilhouette(placed.topology, whole(), facing, 0, edgeCount, silhouette.data());
    }
    void capsPhase()
    {
        benchmark::DoNotOptimize(writeCaps(placed.topology, true, facing, false, 0, faces(), caps.data()));
    }
    void volumePhase()
    {
        benchmark::DoNotOptimize(writeSides(std::span(silhouette).first(silhouetteCount), sides.data()));
    }

    /// The thesis's culling: faces of which no corner is within the light's range are not asked.
    bool within(std::uint32_t vertex) const
    {
        const glm::vec3 toLight = placed.mesh.positions[vertex] - light.position();
        return glm::dot(toLight, toLight) <= light.constants.range * light.constants.range;
    }
    void cullPhase()
    {
        const std::uint32_t* corner = placed.topology.faceVerts.data();
        for (std::size_t face = 0; face < inRange.size(); ++face, corner += 3)
            inRange[face] = within(corner[0]) || within(corner[1]) || within(corner[2]);
    }
    void culledFacingPhase()
    {
        cullPhase();
        facingPhase();
        for (std::size_t face = 0; face < facing.size(); ++face)
            facing[face] &= inRange[face];
    }
    void culledVolumePhase()
    {
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < silhouetteCount; ++i)
            if (within(silhouette[i].from) || within(silhouette[i].to)) culled_[kept++] = silhouette[i];
        benchmark::DoNotOptimize(writeSides(std::span(culled_).first(kept), sides.data()));
    }

private:
    std::vector<SilhouetteEdge> culled_;
};

/// Nanoseconds a face of every variant: the least of many rounds in turn, since all that disturbs only adds.
std::vector<double> leastTimes(std::uint32_t faces, const std::vector<std::function<void()>>& variants)
{
    constexpr int kRounds = 60;
    constexpr std::uint32_t kFacesARound = 400000;
    const std::uint32_t calls = std::max(1u, kFacesARound / faces);
    std::vector<double> least(variants.size(), 1e300);
    for (int round = 0; round < kRounds; ++round) {
        for (std::size_t i = 0; i < variants.size(); ++i) {
            const auto begin = std::chrono::steady_clock::now();
            for (std::uint32_t call = 0; call < calls; ++call)
                variants[i]();
            const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
            least[i] = std::min(least[i], spent.count() / calls / faces);
        }
    }
    return least;
}

void printPhases()
{
    std::printf("\nphases, ns a face; culled: faces beyond the light's range are left out\n%8s %8s %8s %10s %8s %8s "
                "%12s %12s\n",
                "faces", "edges", "facing", "silhouette", "caps", "volume", "facing, c.", "volume, c.");
    for (const Size& size : kSizes) {
        Work work(size);
        const std::vector<double> least =
            leastTimes(work.faces(),
                       {[&] { work.culledFacingPhase(); }, [&] { work.facingPhase(); }, [&] { work.silhouettePhase(); },
                        [&] { work.capsPhase(); }, [&] { work.volumePhase(); }, [&] { work.culledVolumePhase(); }});
        std::printf("%8u %8u %8.3f %10.3f %8.3f %8.3f %12.3f %12.3f\n", work.faces(), work.silhouetteCount, least[1],
                    least[2], least[3], least[4], least[0], least[5]);
    }
}

} // namespace

int main()
{
    printPhases();
}
