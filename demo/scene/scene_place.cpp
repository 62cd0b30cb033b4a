#include "demo/scene/primitives.hpp"
#include "demo/scene/scene_parts.hpp"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <numbers>

namespace gnomon::demo {
namespace {

const glm::dvec3 kUp{0.0, 1.0, 0.0};

/// Rotation from `rotate: {axis: [..], degrees: d}` or a list of such turns, applied in their order.
glm::dquat readRotation(const ReadContext& context, const YamlNode& node)
{
    if (node.kind == YamlNode::Kind::Sequence) {
        glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
        for (const YamlNode& child : node.children) {
            if (child.kind == YamlNode::Kind::Sequence) raise(context, child, "rotate must be a list of turns");
            rotation = readRotation(context, child) * rotation;
        }
        return rotation;
    }
    MapReader map(context, node, shapes::kTurn, "rotate");
    const glm::dvec3 axis = readDirection(context, map.need("axis"), "axis");
    const double angle = toRadians(map.needNumber("degrees"));
    map.finish();
    return glm::angleAxis(angle, axis);
}

/// `repeat: {count: [x, y, z], spacing: [x, y, z]}`: copies on a grid centred where the one would have stood, each
/// moved and, where `strewn`, turned and scaled by what its number and the seed say.
std::vector<Copy> readGrid(const ReadContext& context, const YamlNode& node, bool strewn)
{
    MapReader repeat(context, node, strewn ? shapes::kStrewn : shapes::kGrid, "repeat");
    const YamlNode& countNode = repeat.need("count");
    const std::vector<uint32_t> count = readIntegers(context, countNode, "count", shapes::kCounts);
    const glm::dvec3 spacing = repeat.needVector("spacing");
    const glm::dvec3 jitter = repeat.vector("jitter", glm::dvec3(0.0));
    const double turn = strewn ? toRadians(repeat.number("turn", 0.0)) : 0.0;
    const double grow = strewn ? repeat.number("grow", 0.0) : 0.0;
    const uint32_t seed = repeat.integer("seed", 1);
    repeat.finish();
    if (uint64_t(count[0]) * count[1] * count[2] > kMostInstances)
        raise(context, countNode, "more than " + std::to_string(kMostInstances) + " copies");
    std::vector<Copy> copies;
    for (uint32_t z = 0; z < count[2]; ++z)
        for (uint32_t y = 0; y < count[1]; ++y)
            for (uint32_t x = 0; x < count[0]; ++x) {
                // Of -1..1; the numbers of a copy are a column of the lattice.
                const auto random = [&](int32_t row) {
                    return 2.0 * double(latticeValue(int32_t(copies.size()), row, seed)) - 1.0;
                };
                Copy copy;
                copy.offset =
                    spacing * glm::dvec3(x - (count[0] - 1) * 0.5, y - (count[1] - 1) * 0.5, z - (count[2] - 1) * 0.5) +
                    jitter * glm::dvec3(random(0), random(1), random(2));
                copy.turn = glm::angleAxis(turn * random(3), kUp);
                copy.scale = 1.0 + grow * random(4);
                copies.push_back(copy);
            }
    return copies;
}

/// `ring: {count, center}`: copies turned evenly round the vertical axis through the centre.
std::vector<Copy> readRing(const ReadContext& context, const YamlNode& node)
{
    MapReader ring(context, node, shapes::kRing, "ring");
    const uint32_t count = readInteger(context, ring.need("count"), "count", shapes::kUpTo1024.range);
    const glm::dvec3 center = ring.vector("center", glm::dvec3(0.0));
    ring.finish();
    std::vector<Copy> copies(count);
    for (uint32_t i = 0; i < count; ++i) {
        copies[i].turn = glm::angleAxis(2.0 * std::numbers::pi * i / count, kUp);
        copies[i].center = center;
    }
    return copies;
}

} // namespace

Pose readPose(MapReader& map)
{
    Pose pose;
    pose.position = map.vector("at", pose.position);
    if (const YamlNode* rotate = map.find("rotate")) pose.rotation = readRotation(map.context(), *rotate);
    if (const YamlNode* scale = map.find("scale")) {
        pose.scale = scale->kind == YamlNode::Kind::Sequence
                         ? readVector(map.context(), *scale, "scale", shapes::kVector)
                         : glm::dvec3(readNumber(map.context(), *scale, "scale", shapes::kAny.range));
        // Thinner than this, a float matrix no longer inverts.
        if (glm::any(glm::lessThan(glm::abs(pose.scale), glm::dvec3(1e-6))))
            raise(map.context(), *scale, "scale must be 1e-6 at least, or -1e-6 at most where it mirrors");
    }
    return pose;
}

glm::dvec3 Copy::place(const glm::dvec3& position) const
{
    return center ? *center + turn * (position - *center) : position + offset;
}

std::vector<Copy> readCopies(MapReader& map, bool strewn)
{
    const YamlNode* grid = map.find("repeat");
    const YamlNode* ring = map.find("ring");
    if (grid != nullptr && ring != nullptr)
        raise(map.context(), *ring, "at most one of 'repeat' and 'ring' may be given");
    std::vector<Copy> copies(1);
    if (grid != nullptr) copies = readGrid(map.context(), *grid, strewn);
    if (ring != nullptr) copies = readRing(map.context(), *ring);
    for (size_t i = 0; copies.size() > 1 && i < copies.size(); ++i) {
        copies[i].suffix = '.';
        copies[i].suffix += std::to_string(i);
    }
    return copies;
}

double readTurnRate(MapReader& map, double framesPerSecond)
{
    const bool perFrame = map.has("degrees_per_frame"), perSecond = map.has("degrees_per_second");
    if (perFrame == perSecond)
        raise(map.context(), map.node(), "exactly one of 'degrees_per_second' and 'degrees_per_frame' must be given");
    return perFrame ? toRadians(map.number("degrees_per_frame", 0.0) * framesPerSecond)
                    : toRadians(map.number("degrees_per_second", 0.0));
}

Orbit readOrbit(MapReader& map, double framesPerSecond)
{
    Orbit orbit;
    const YamlNode* node = map.find("orbit");
    if (node == nullptr) return orbit;
    MapReader reader(map.context(), *node, shapes::kOrbit, "orbit");
    orbit.center = reader.vector("center", orbit.center);
    if (const YamlNode* axis = reader.find("axis")) orbit.axis = readDirection(map.context(), *axis, "axis");
    orbit.radiansPerSecond = readTurnRate(reader, framesPerSecond);
    reader.finish();
    return orbit;
}

} // namespace gnomon::demo
