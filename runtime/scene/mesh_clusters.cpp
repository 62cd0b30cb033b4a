#include "runtime/scene/mesh_clusters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <queue>

#include <glm/geometric.hpp>

#include "runtime/scene/aabb.hpp"

namespace gnomon {

namespace {

// What a cluster costs, in sides: a draw takes 0.6 us on a software device, a side, two triangles, 0.5 us, and as much
// is allowed for choosing. With 8 many boxes of `rooms`, merged into one mesh, stay in pairs, of which none can conceal
// another.
constexpr double kSidesPerDraw = 2.0;

constexpr int kBins = 16; // of centres along an axis; a group is cut between two of them

/// Faces that hang together.
struct Shell {
    Aabb bounds;
    double sides = 0.0; ///< Of its volume, on average.
};

/// A run of shells that is, or may become, a cluster.
struct Group {
    std::uint32_t first = 0, count = 0;
    Aabb bounds;
    double sides = 0.0;
};

/// Where a group is cut in two: shells with centres below `at` go to the left.
struct Cut {
    int axis = 0;
    float at = 0.0f;
    double gain = 0.0; ///< Square metres times sides.
};

/// Disjoint sets of faces, each known by the first of them.
class FaceSets {
public:
    explicit FaceSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::uint32_t face)
    {
        while (parent_[face] != face)
            face = parent_[face] = parent_[parent_[face]];
        return face;
    }
    void unite(std::uint32_t a, std::uint32_t b)
    {
        a = find(a), b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parent_;
};

double surfaceArea(const Aabb& box)
{
    const glm::dvec3 size(box.upper - box.lower);
    return 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
}

// --- crowded edges: more than two faces ---

/// The angle at which a face leaves an edge, about its direction. @param across two axes
double angleOf(const glm::dvec3& from, const glm::dvec3& third, const glm::dvec3 (&across)[2])
{
    const glm::dvec3 away = third - from;
    return std::atan2(glm::dot(away, across[1]), glm::dot(away, across[0]));
}

std::uint32_t thirdCorner(const Topology& topology, const Topology::Edge& edge, std::uint32_t face)
{
    const std::uint32_t* corner = &topology.faceVerts[std::size_t{3} * face];
    return *std::find_if(corner, corner + 3,
                         [&](std::uint32_t vertex) { return vertex != edge.v0 && vertex != edge.v1; });
}

/// Unites the two faces at each of the solids that meet at an edge: what runs v0 -> v1 has its solid clockwise, up to
/// the next face that runs the other way. Of faces in one place each has a solid of its own.
void uniteSolidsAt(const Topology& topology, std::span<const glm::vec3> positions, const Topology::Edge& edge,
                   FaceSets& sets)
{
    constexpr double kTurn = 6.283185307179586, kSame = 1e-6;
    const glm::dvec3 from(positions[edge.v0]), along = glm::dvec3(positions[edge.v1]) - from;
    const glm::dvec3 least = glm::abs(along.x) < glm::abs(along.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 first = glm::normalize(glm::cross(along, least));
    const glm::dvec3 across[2] = {first, glm::normalize(glm::cross(along, first))};
    std::array<double, kMostUses> angles;
    std::array<bool, kMostUses> taken{};
    const std::span<const Topology::EdgeUse> uses = usesOf(topology, edge);
    for (std::size_t i = 0; i < uses.size(); ++i)
        angles[i] = angleOf(from, glm::dvec3(positions[thirdCorner(topology, edge, uses[i].face)]), across);
    for (std::size_t i = 0; i < uses.size(); ++i) {
        if (uses[i].sign < 0.0f) continue;
        std::size_t best = uses.size();
        double nearest = 2.0 * kTurn;
        for (std::size_t j = 0; j < uses.size(); ++j) {
            if (uses[j].sign > 0.0f || taken[j]) continue;
            double turn = angles[i] - angles[j];
            while (turn < kSame) // twice where one angle is just above -pi and the other just below pi
                turn += kTurn;
            if (turn >= nearest) continue;
            best = j;
            nearest = turn;
        }
        if (best == uses.size()) continue;
        taken[best] = true;
        sets.unite(uses[i].face, uses[best].face);
    }
}

/// Unites the sets that run an edge more often one way than the other: fins, and what has holes.
void uniteOpenAt(std::span<const Topology::EdgeUse> uses, FaceSets& sets)
{
    std::uint32_t open = UINT32_MAX;
    for (const Topology::EdgeUse& use : uses) {
        const std::uint32_t set = sets.find(use.face);
        float sum = 0.0f;
        for (const Topology::EdgeUse& other : uses)
            if (sets.find(other.face) == set) sum += other.sign;
        if (sum == 0.0f) continue;
        if (open != UINT32_MAX) sets.unite(open, set);
        open = set;
    }
}

/// The shells in the order of their first faces. @param shellOf of every face
std::vector<Shell> findShells(const Topology& topology, std::span<const glm::vec3> positions,
                              std::vector<std::uint32_t>& shellOf)
{
    const std::size_t faces = topology.faceVerts.size() / 3;
    FaceSets sets(faces);
    for (const Topology::Edge& edge : topology.edges)
        if (edge.useCount == 2 || edge.useCount > kMostUses)
            for (const Topology::EdgeUse& use : usesOf(topology, edge))
                sets.unite(topology.uses[edge.firstUse].face, use.face);
    const auto crowded = [](const Topology::Edge& edge) { return edge.useCount > 2 && edge.useCount <= kMostUses; };
    for (const Topology::Edge& edge : topology.edges)
        if (crowded(edge)) uniteSolidsAt(topology, positions, edge, sets);
    for (const Topology::Edge& edge : topology.edges)
        if (crowded(edge)) uniteOpenAt(usesOf(topology, edge), sets);

    shellOf.resize(faces);
    std::vector<Shell> shells;
    for (std::uint32_t face = 0; face < faces; ++face) {
        const std::uint32_t* corner = &topology.faceVerts[std::size_t{3} * face];
        const std::uint32_t first = sets.find(face);
        if (first == face) {
            shellOf[face] = static_cast<std::uint32_t>(shells.size());
            shells.push_back({{positions[*corner], positions[*corner]}, 0.0});
        } else {
            shellOf[face] = shellOf[first];
        }
        Shell& shell = shells[shellOf[face]];
        for (int i = 0; i < 3; ++i)
            shell.bounds = unionOf(shell.bounds, {positions[corner[i]], positions[corner[i]]});
    }
    for (const Topology::Edge& edge : topology.edges)
        shells[shellOf[topology.uses[edge.firstUse].face]].sides += meanSides(topology, edge, true);
    return shells;
}

Group groupOf(std::span<const Shell> shells, std::span<const std::uint32_t> order, std::uint32_t first,
              std::uint32_t count)
{
    Group group{first, count, shells[order[first]].bounds, 0.0};
    for (const std::uint32_t shell : order.subspan(first, count)) {
        group.bounds = unionOf(group.bounds, shells[shell].bounds);
        group.sides += shells[shell].sides;
    }
    return group;
}

/// Shells side by side.
struct Bin {
    std::uint32_t shells = 0;
    Aabb bounds;
    double sides = 0.0;

    void add(const Bin& other)
    {
        if (other.shells == 0) return;
        bounds = shells == 0 ? other.bounds : unionOf(bounds, other.bounds);
        shells += other.shells;
        sides += other.sides;
    }
    double cost() const { return surfaceArea(bounds) * sides; }
};

/// The best of kBins - 1 cuts across the axis along which centres are farthest apart; none: no cut gains anything.
std::optional<Cut> bestCut(std::span<const Shell> shells, std::span<const std::uint32_t> order, const Group& group)
{
    if (group.count < 2) return std::nullopt;
    const std::span<const std::uint32_t> members = order.subspan(group.first, group.count);
    const glm::vec3 firstCenter = shells[members.front()].bounds.center();
    Aabb centers{firstCenter, firstCenter};
    for (const std::uint32_t shell : members) {
        const glm::vec3 center = shells[shell].bounds.center();
        centers = unionOf(centers, {center, center});
    }
    const glm::vec3 spread = centers.upper - centers.lower;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    if (!(spread[axis] > 0.0f)) return std::nullopt;

    std::array<float, kBins + 1> border;
    for (int i = 0; i <= kBins; ++i)
        border[static_cast<std::size_t>(i)] = centers.lower[axis] + spread[axis] * (static_cast<float>(i) / kBins);
    std::array<Bin, kBins> bins;
    for (const std::uint32_t shell : members) {
        const float center = shells[shell].bounds.center()[axis];
        const auto above = std::upper_bound(border.begin() + 1, border.end() - 1, center);
        bins[static_cast<std::size_t>(above - border.begin() - 1)].add({1, shells[shell].bounds, shells[shell].sides});
    }
    std::array<double, kBins> after{}; // of bins i and above
    Bin right;
    for (std::size_t i = kBins; i-- > 1;) {
        right.add(bins[i]);
        after[i] = right.cost();
    }
    const double whole = surfaceArea(group.bounds) * (group.sides - kSidesPerDraw);
    Cut best{.axis = axis};
    Bin left;
    for (std::size_t i = 1; i < kBins; ++i) {
        left.add(bins[i - 1]);
        const double gain = whole - left.cost() - after[i];
        if (left.shells == 0 || left.shells == group.count || gain <= best.gain) continue;
        best.at = border[i];
        best.gain = gain;
    }
    return best.gain > 0.0 ? std::optional(best) : std::nullopt;
}

/// Groups, cut for as long as it gains; `order` is sorted by them.
std::vector<Group> cutGroups(std::span<const Shell> shells, std::span<std::uint32_t> order)
{
    struct Candidate {
        Cut cut;
        std::size_t group;
        bool operator<(const Candidate& other) const { return cut.gain < other.cut.gain; }
    };
    std::vector<Group> groups{groupOf(shells, order, 0, static_cast<std::uint32_t>(order.size()))};
    std::priority_queue<Candidate> candidates;
    const auto consider = [&](std::size_t group) {
        if (const std::optional<Cut> cut = bestCut(shells, order, groups[group])) candidates.push({*cut, group});
    };
    consider(0);
    while (!candidates.empty() && groups.size() < kMostClusters) {
        const Cut cut = candidates.top().cut;
        const std::size_t index = candidates.top().group;
        candidates.pop();
        const Group whole = groups[index];
        const auto begin = order.begin() + whole.first;
        const auto middle = std::stable_partition(begin, begin + whole.count, [&](std::uint32_t shell) {
            return shells[shell].bounds.center()[cut.axis] < cut.at;
        });
        const auto left = static_cast<std::uint32_t>(middle - begin);
        groups[index] = groupOf(shells, order, whole.first, left);
        groups.push_back(groupOf(shells, order, whole.first + left, whole.count - left));
        consider(index);
        consider(groups.size() - 1);
    }
    return groups;
}

/// The cluster of every face; empty: there is only one.
std::vector<std::uint8_t> findClusters(Topology& topology, std::span<const glm::vec3> positions)
{
    std::vector<std::uint32_t>& shellOf = topology.shellOfFace;
    const std::vector<Shell> shells = findShells(topology, positions, shellOf);
    topology.shellCount = static_cast<std::uint32_t>(shells.size());
    if (shells.size() < 2) {
        shellOf = std::vector<std::uint32_t>(); // and its memory
        return {};
    }
    std::vector<std::uint32_t> order(shells.size());
    std::iota(order.begin(), order.end(), 0u);
    const std::vector<Group> groups = cutGroups(shells, order);
    if (groups.size() < 2) return {};

    std::vector<std::uint32_t> groupOfShell(shells.size());
    for (std::uint32_t i = 0; i < groups.size(); ++i)
        for (const std::uint32_t shell : std::span(order).subspan(groups[i].first, groups[i].count))
            groupOfShell[shell] = i;
    std::vector<std::uint32_t> number(groups.size(), UINT32_MAX);
    std::vector<std::uint8_t> ofFace(shellOf.size());
    std::uint32_t count = 0;
    for (std::size_t face = 0; face < shellOf.size(); ++face) {
        std::uint32_t& cluster = number[groupOfShell[shellOf[face]]];
        if (cluster == UINT32_MAX) cluster = count++;
        ofFace[face] = static_cast<std::uint8_t>(cluster);
    }
    return ofFace;
}

void sortFaces(Topology& topology)
{
    topology.facesInOrder.resize(topology.clusterOfFace.size());
    std::iota(topology.facesInOrder.begin(), topology.facesInOrder.end(), 0u);
    std::stable_sort(topology.facesInOrder.begin(), topology.facesInOrder.end(), [&](std::uint32_t a, std::uint32_t b) {
        return topology.clusterOfFace[a] < topology.clusterOfFace[b];
    });
    for (const std::uint8_t cluster : topology.clusterOfFace)
        ++topology.clusters[cluster].faceCount;
    for (std::size_t i = 1; i < topology.clusters.size(); ++i)
        topology.clusters[i].firstFace = topology.clusters[i - 1].firstFace + topology.clusters[i - 1].faceCount;
}

/// Edges and uses of one cluster.
struct ClusterEdges {
    std::vector<Topology::Edge> edges;
    std::vector<Topology::EdgeUse> uses;
};

/// Hands every use of an edge to its face's cluster, which has an edge of its own for it.
void handOut(const Topology& topology, const Topology::Edge& edge, std::span<ClusterEdges> clusters)
{
    const auto clusterOf = [&](const Topology::EdgeUse& use) { return topology.clusterOfFace[use.face]; };
    const std::span<const Topology::EdgeUse> uses = usesOf(topology, edge);
    for (std::size_t i = 0; i < uses.size(); ++i) {
        const auto sameCluster = [&](const Topology::EdgeUse& use) { return clusterOf(use) == clusterOf(uses[i]); };
        ClusterEdges& own = clusters[clusterOf(uses[i])];
        if (std::none_of(uses.begin(), uses.begin() + static_cast<std::ptrdiff_t>(i), sameCluster))
            own.edges.push_back({edge.v0, edge.v1, static_cast<std::uint32_t>(own.uses.size()), 0});
        ++own.edges.back().useCount;
        own.uses.push_back(uses[i]);
    }
}

void sortEdges(Topology& topology)
{
    std::vector<ClusterEdges> clusters(topology.clusters.size());
    for (const Topology::Edge& edge : topology.edges)
        handOut(topology, edge, clusters);
    topology.edges.clear();
    topology.uses.clear();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
        const auto firstUse = static_cast<std::uint32_t>(topology.uses.size());
        topology.clusters[i].firstEdge = static_cast<std::uint32_t>(topology.edges.size());
        topology.clusters[i].edgeCount = static_cast<std::uint32_t>(clusters[i].edges.size());
        for (Topology::Edge& edge : clusters[i].edges) {
            edge.firstUse += firstUse;
            topology.edges.push_back(edge);
        }
        topology.uses.insert(topology.uses.end(), clusters[i].uses.begin(), clusters[i].uses.end());
    }
}

} // namespace

void makeClusters(Topology& topology, std::span<const glm::vec3> positions)
{
    topology.clusterOfFace = findClusters(topology, positions);
    topology.facesInOrder.clear();
    if (topology.clusterOfFace.empty()) {
        topology.clusters.assign(1, {.edgeCount = static_cast<std::uint32_t>(topology.edges.size()),
                                     .faceCount = static_cast<std::uint32_t>(topology.faceVerts.size() / 3)});
        return;
    }
    const std::size_t count = *std::max_element(topology.clusterOfFace.begin(), topology.clusterOfFace.end()) + 1u;
    topology.clusters.assign(count, {});
    sortFaces(topology);
    sortEdges(topology);
}

} // namespace gnomon
