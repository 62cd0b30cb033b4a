#pragma once

#include "demo/scene/scene.hpp"

#include <vector>

/// Slow and obvious questions about meshes and scenes, for tests.
namespace gnomon::demo {

struct EdgeCount {
    uint64_t edges = 0;
    uint64_t border = 0;     ///< Used by one triangle.
    uint64_t unbalanced = 0; ///< Used by two or more, but not as often one way as the other.
    uint64_t crowded = 0;    ///< Used by more than two.

    bool closed() const { return edges > 0 && border == 0 && unbalanced == 0; }
};

/// Counts by position: vertices with bit-equal positions are one.
EdgeCount countEdges(const Mesh& mesh);

/// Six times the signed volume, divided by six; positive where a closed mesh winds outward.
double signedVolume(const Mesh& mesh);

double smallestArea(const Mesh& mesh);

struct WorldTriangle {
    glm::dvec3 a, b, c;
    uint32_t instance = 0;
};

std::vector<WorldTriangle> worldTriangles(const Scene& scene, double time);

double distanceToTriangle(const glm::dvec3& point, const WorldTriangle& triangle);

/// Whether a light in this state can reach the point, by range and cone alone.
bool reaches(const Light& light, const LightState& state, const glm::dvec3& point);

/// Unit vector towards the light.
glm::dvec3 towardsLight(const Light& light, const LightState& state, const glm::dvec3& point);

/// What a shipped scene must contain to be able to fail.
struct FailFeatures {
    bool contactEdge = false;       ///< The lowest point of one instance lies on the flat top of another.
    bool thinWall = false;          ///< A closed part thinner than a texel of some light's 1024 map over it.
    bool grazedReceiver = false;    ///< More than 0.5 m2 in one triangle at 84..86 degrees to a light that reaches it.
    bool casterBehindEye = false;   ///< A whole instance behind the camera's plane.
    bool casterBehindLight = false; ///< A whole instance behind a spot light, or up the way a directional one comes.
    bool openPart = false;          ///< A mesh with a border that is no mere floor: it stands above another part.
};

FailFeatures findFailFeatures(const Scene& scene, double time);

} // namespace gnomon::demo
