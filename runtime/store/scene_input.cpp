#include "runtime/store/scene_input.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace gnomon {
namespace {

/// The same digits in every locale.
std::string text(double value)
{
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string text(Subject what)
{
    return what.text();
}

std::string text(const std::string& what)
{
    return what;
}

struct Number {
    double value;
    const char* name; ///< As in gnomon.h, "translation[2]".
};

/// Finite and not beyond kLargestMagnitude. `what` is a Subject or a text.
template <typename What>
Result<void> checkNumber(const What& subject, const Number& number)
{
    if (std::abs(number.value) <= kLargestMagnitude) return {};
    const std::string what = text(subject);
    if (std::isnan(number.value))
        return Error{GN_ERROR_NOT_A_NUMBER, "NotANumber", what + ": " + number.name + " is NaN"};
    if (std::isinf(number.value))
        return Error{GN_ERROR_INFINITE, "Infinite", what + ": " + number.name + " is infinite"};
    return Error{GN_ERROR_OUT_OF_RANGE, "TooLarge",
                 what + ": " + number.name + " is " + text(number.value) + ", larger than 1e18"};
}

Error outOfRange(Subject what, const char* name, double value, const char* range)
{
    return {GN_ERROR_OUT_OF_RANGE, "OutOfRange",
            what.text() + ": " + name + " is " + text(value) + ", not in " + range};
}

/// A basis whose inverse is within the library's numbers as well: rays are brought into the object's space by it. In
/// double, products of three floats neither vanish nor overflow.
Result<void> checkInverse(Subject what, const float (&m)[9])
{
    double cofactors[9]; // of m; those of element (row, column) divide into the inverse's (column, row)
    for (int i = 0; i < 9; ++i) {
        const int row1 = (i / 3 + 1) % 3 * 3, row2 = (i / 3 + 2) % 3 * 3, column1 = (i + 1) % 3, column2 = (i + 2) % 3;
        cofactors[i] = static_cast<double>(m[row1 + column1]) * m[row2 + column2] -
                       static_cast<double>(m[row1 + column2]) * m[row2 + column1];
    }
    const double determinant = m[0] * cofactors[0] + m[1] * cofactors[1] + m[2] * cofactors[2];
    if (determinant == 0.0)
        return Error{GN_ERROR_OUT_OF_RANGE, "TransformSingular",
                     what.text() + ": the basis is singular (determinant 0), it flattens the mesh"};
    for (int i = 0; i < 9; ++i) {
        const double element = cofactors[i % 3 * 3 + i / 3] / determinant;
        if (std::abs(element) <= kLargestMagnitude) continue;
        return Error{GN_ERROR_OUT_OF_RANGE, "TransformSingular",
                     what.text() + ": the basis is nearly singular: element [" + std::to_string(i) +
                         "] of its inverse is " + text(element) + ", larger than 1e18"};
    }
    return {};
}

bool hasArea(glm::vec3 a, glm::vec3 b, glm::vec3 c) noexcept
{
    const glm::vec3 area(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
    return area != glm::vec3(0.0f);
}

/// The index list of the host, or 0, 1, 2, ... where it gave none. As given: not turned yet.
Result<std::vector<std::uint32_t>> readIndices(Subject what, const GnMeshCreateInfo& info)
{
    const Result<std::uint32_t> count = readIndexCount(what, info, info.pIndices != nullptr);
    if (!count) return count.error();
    std::vector<std::uint32_t> indices(*count);
    for (std::uint32_t i = 0; i < *count; ++i)
        indices[i] = info.pIndices ? info.pIndices[i] : i;
    const auto wrong = std::find_if(indices.begin(), indices.end(),
                                    [&info](std::uint32_t index) { return index >= info.positionCount; });
    if (wrong != indices.end())
        return Error{GN_ERROR_OUT_OF_RANGE, "MeshIndexOutOfRange",
                     what.text() + ": index " + std::to_string(*wrong) + " at position " +
                         std::to_string(wrong - indices.begin()) + " is past the " +
                         std::to_string(info.positionCount) + " vertices"};
    return indices;
}

} // namespace

std::string named(const char* kind, const char* name)
{
    if (!name || !*name) return (*kind == 'i' ? "an " : "a ") + std::string(kind) + " without a name"; // instance
    return std::string(kind) + " '" + name + "'";
}

Result<std::vector<glm::vec3>> readPositions(Subject what, const float* positions, std::uint32_t count,
                                             std::uint32_t stride)
{
    if (!positions) return Error{GN_ERROR_NULL_ARGUMENT, "MeshPositionsNull", what.text() + ": pPositions is null"};
    if (stride == 0) stride = sizeof(glm::vec3);
    if (stride < sizeof(glm::vec3) || stride % 4 != 0)
        return Error{GN_ERROR_OUT_OF_RANGE, "MeshPositionStride",
                     what.text() + ": positionStride " + std::to_string(stride) +
                         " is not a multiple of 4, at least 12"};
    std::vector<glm::vec3> result(count + kPositionPadding, glm::vec3(0.0f));
    const char* from = reinterpret_cast<const char*>(positions);
    for (std::uint32_t i = 0; i < count; ++i, from += stride) {
        glm::vec3& to = result[i];
        std::memcpy(&to, from, sizeof to);
        if (std::abs(to.x) <= 1e18f && std::abs(to.y) <= 1e18f && std::abs(to.z) <= 1e18f) continue;
        const std::string vertex = what.text() + ", vertex " + std::to_string(i);
        for (const Number& number : {Number{to.x, "x"}, Number{to.y, "y"}, Number{to.z, "z"}})
            if (Result<void> check = checkNumber(vertex, number); !check) return check.error();
    }
    return result;
}

Result<void> checkNumber(Subject what, double value, const char* name)
{
    return checkNumber(what, Number{value, name});
}

Result<std::uint32_t> readIndexCount(Subject what, const GnMeshCreateInfo& info, bool hasIndices)
{
    const std::uint32_t count = hasIndices || info.indexCount ? info.indexCount : info.positionCount;
    if (count == 0) return Error{GN_ERROR_EMPTY, "MeshEmpty", what.text() + " has no triangles"};
    if (count % 3 != 0)
        return Error{GN_ERROR_OUT_OF_RANGE, "MeshIndexCount",
                     what.text() + ": " + std::to_string(count) + " indices are not a multiple of 3"};
    return count;
}

Result<void> checkMeshSize(Subject what, std::uint32_t positionCount, std::uint64_t bytes, const MeshLimits& limits)
{
    if (positionCount == 0) return Error{GN_ERROR_EMPTY, "MeshEmpty", what.text() + " has no vertices"};
    if (bytes > limits.bufferBytes)
        return Error{GN_ERROR_TOO_MANY, "MeshTooLarge",
                     what.text() + " needs a buffer of " + std::to_string(bytes) + " bytes; the device takes " +
                         std::to_string(limits.bufferBytes)};
    if (positionCount - 1 > limits.index)
        return Error{GN_ERROR_TOO_MANY, "MeshTooLarge",
                     what.text() + " has " + std::to_string(positionCount) +
                         " vertices; the largest index that the device draws is " + std::to_string(limits.index)};
    return {};
}

Result<bool> readFrontFace(Subject what, VkFrontFace frontFace)
{
    if (frontFace == VK_FRONT_FACE_COUNTER_CLOCKWISE || frontFace == VK_FRONT_FACE_CLOCKWISE)
        return frontFace == VK_FRONT_FACE_CLOCKWISE;
    return outOfRange(what, "frontFace", frontFace, "VkFrontFace");
}

Result<MeshInput> readMesh(const GnMeshCreateInfo& info, const MeshLimits& limits)
{
    const Subject what{"mesh", info.pName};
    if (!info.pPositions)
        return Error{GN_ERROR_NULL_ARGUMENT, "MeshPositionsNull",
                     what.text() + ": pPositions is null, and so is pBuffers"};
    if (info.flags) return outOfRange(what, "flags", info.flags, "{0}: they are of meshes in buffers");
    const std::uint64_t bytes = std::max(std::uint64_t{12} * info.positionCount, std::uint64_t{4} * info.indexCount);
    if (Result<void> fits = checkMeshSize(what, info.positionCount, bytes, limits); !fits) return fits.error();
    const Result<bool> clockwise = readFrontFace(what, info.frontFace);
    if (!clockwise) return clockwise.error();
    Result<std::vector<std::uint32_t>> indices = readIndices(what, info);
    if (!indices) return indices.error();
    if (*clockwise)
        for (std::size_t i = 0; i < indices->size(); i += 3)
            std::swap((*indices)[i + 1], (*indices)[i + 2]);
    Result<std::vector<glm::vec3>> positions =
        readPositions(what, info.pPositions, info.positionCount, info.positionStride);
    if (!positions) return positions.error();
    return MeshInput{info.pName ? info.pName : "", *clockwise, std::move(*positions), std::move(*indices)};
}

KeptTriangles withoutZeroArea(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    KeptTriangles kept;
    kept.indices.reserve(indices.size());
    bool all = true;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        if (hasArea(positions[indices[i]], positions[indices[i + 1]], positions[indices[i + 2]])) {
            kept.indices.insert(kept.indices.end(), indices.begin() + i, indices.begin() + i + 3);
            if (!all) kept.numbers.push_back(static_cast<std::uint32_t>(i / 3));
        } else if (all) { // the first to go: those before it keep their numbers
            all = false;
            kept.numbers.resize(i / 3);
            std::iota(kept.numbers.begin(), kept.numbers.end(), 0u);
        }
    }
    return kept;
}

Result<GnTransform> readTransform(Subject what, const GnTransform& transform)
{
    static constexpr const char* kBasis[] = {"basis[0]", "basis[1]", "basis[2]", "basis[3]", "basis[4]",
                                             "basis[5]", "basis[6]", "basis[7]", "basis[8]"};
    static constexpr const char* kTranslation[] = {"translation[0]", "translation[1]", "translation[2]"};
    for (int i = 0; i < 9; ++i)
        if (Result<void> check = checkNumber(what, {transform.basis[i], kBasis[i]}); !check) return check.error();
    for (int i = 0; i < 3; ++i)
        if (Result<void> check = checkNumber(what, {transform.translation[i], kTranslation[i]}); !check)
            return check.error();

    GnTransform result = transform;
    if (std::all_of(std::begin(result.basis), std::end(result.basis), [](float x) { return x == 0.0f; }))
        result.basis[0] = result.basis[4] = result.basis[8] = 1.0f;
    if (Result<void> inverse = checkInverse(what, result.basis); !inverse) return inverse.error();
    return result;
}

bool sameTransform(const GnTransform& a, const GnTransform& b) noexcept
{
    return std::equal(std::begin(a.basis), std::end(a.basis), std::begin(b.basis)) &&
           std::equal(std::begin(a.translation), std::end(a.translation), std::begin(b.translation));
}

Result<Aabb> readBounds(Subject what, const float (&lower)[3], const float (&upper)[3])
{
    static constexpr const char* kBounds[] = {"boundsMin[0]", "boundsMin[1]", "boundsMin[2]",
                                              "boundsMax[0]", "boundsMax[1]", "boundsMax[2]"};
    for (int i = 0; i < 6; ++i)
        if (Result<void> check = checkNumber(what, {i < 3 ? lower[i] : upper[i - 3], kBounds[i]}); !check)
            return check.error();
    for (int i = 0; i < 3; ++i)
        if (lower[i] > upper[i])
            return Error{GN_ERROR_OUT_OF_RANGE, "OutOfRange",
                         what.text() + ": " + kBounds[i] + " is " + text(lower[i]) + ", above " + kBounds[i + 3] +
                             ", which is " + text(upper[i])};
    return Aabb{{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
}

Result<GnInstanceCreateInfo> readInstance(const GnInstanceCreateInfo& info)
{
    const Subject what{"instance", info.pName};
    constexpr GnInstanceFlags kKnown = GN_INSTANCE_STATIC_BIT | GN_INSTANCE_ALPHA_TESTED_BIT |
                                       GN_INSTANCE_HOST_DRAWN_BIT | GN_INSTANCE_MAY_BE_MISSED_BIT |
                                       GN_INSTANCE_SINGLE_SIDED_BIT;
    if (info.flags & ~kKnown) return outOfRange(what, "flags", info.flags, "the bits of GnInstanceFlagBits");
    GnInstanceCreateInfo result = info;
    Result<GnTransform> transform = readTransform(what, info.transform);
    if (!transform) return transform.error();
    result.transform = *transform;
    if (result.casterMask == 0) result.casterMask = kAllMasks;
    if (!(info.flags & GN_INSTANCE_HOST_DRAWN_BIT)) return result;

    if (!info.pfnDrawCasters)
        return Error{GN_ERROR_NULL_ARGUMENT, "InstanceDrawCastersNull",
                     what.text() + " is host-drawn, but pfnDrawCasters is null"};
    if (Result<Aabb> bounds = readBounds(what, info.boundsMin, info.boundsMax); !bounds) return bounds.error();
    return result;
}

bool LightDescription::samePose(const LightDescription& other) const noexcept
{
    return type == other.type && position == other.position && direction == other.direction && range == other.range &&
           coneAngle == other.coneAngle;
}

bool LightDescription::sameLight(const LightDescription& other) const noexcept
{
    return samePose(other) && sourceRadius == other.sourceRadius && sourceX == other.sourceX &&
           sourceY == other.sourceY && sourceShape == other.sourceShape && mask == other.mask;
}

namespace {

Result<void> readPosition(Subject what, const GnLightInfo& info, LightDescription& light)
{
    static constexpr const char* kPosition[] = {"position[0]", "position[1]", "position[2]"};
    for (int i = 0; i < 3; ++i) {
        if (Result<void> check = checkNumber(what, {info.position[i], kPosition[i]}); !check) return check.error();
        light.position[i] = info.position[i];
    }
    if (Result<void> check = checkNumber(what, {info.range, "range"}); !check) return check.error();
    if (info.range < 0.0f) return outOfRange(what, "range", info.range, "[0, 1e18]");
    light.range = info.range == 0.0f ? kUnlimitedRange : info.range;
    return {};
}

Result<void> readDirection(Subject what, const GnLightInfo& info, LightDescription& light)
{
    static constexpr const char* kDirection[] = {"direction[0]", "direction[1]", "direction[2]"};
    for (int i = 0; i < 3; ++i)
        if (Result<void> check = checkNumber(what, {info.direction[i], kDirection[i]}); !check) return check.error();
    const glm::dvec3 direction(info.direction[0], info.direction[1], info.direction[2]);
    const double length = glm::length(direction);
    if (length == 0.0) return Error{GN_ERROR_OUT_OF_RANGE, "LightDirectionZero", what.text() + ": direction is zero"};
    for (int i = 0; i < 3; ++i)
        light.direction[i] = static_cast<float>(direction[i] / length);
    return {};
}

Result<void> readCone(Subject what, const GnLightInfo& info, LightDescription& light)
{
    if (Result<void> check = checkNumber(what, {info.coneAngle, "coneAngle"}); !check) return check.error();
    // The slack takes in hosts that compute the limit in float.
    constexpr float kWidest = std::numbers::pi_v<float> / 2.0f - 0.02f;
    if (info.coneAngle < 0.0f || info.coneAngle > kWidest + 1e-6f)
        return outOfRange(what, "coneAngle", info.coneAngle, "(0, pi/2 - 0.02]");
    light.coneAngle = info.coneAngle == 0.0f ? std::numbers::pi_v<float> / 4.0f : info.coneAngle;
    return {};
}

glm::dvec3 forwardOf(const LightDescription& light)
{
    return glm::normalize(glm::dvec3(light.direction[0], light.direction[1], light.direction[2]));
}

void setHalfAxes(LightDescription& light, const glm::dvec3& x, const glm::dvec3& y)
{
    for (int i = 0; i < 3; ++i) {
        light.sourceX[i] = static_cast<float>(x[i]);
        light.sourceY[i] = static_cast<float>(y[i]);
    }
}

/// Half axes; which ones is of no account. The light's direction and radius have been read.
Result<void> readDisc(Subject what, const GnLightInfo& info, LightDescription& light)
{
    if (info.type != GN_LIGHT_TYPE_SPOT)
        return outOfRange(what, "type", info.type, "a spot light's, which GN_SOURCE_SHAPE_DISC is for");
    const glm::dvec3 forward = forwardOf(light);
    const glm::dvec3 aside = std::abs(forward.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = double{light.sourceRadius} * glm::normalize(glm::cross(forward, aside));
    setHalfAxes(light, x, glm::cross(forward, x));
    return {};
}

/// Half axes, and the radius of a disc of the same area. The light's direction has been read.
Result<void> readRectangle(Subject what, const GnLightInfo& info, LightDescription& light)
{
    if (info.type != GN_LIGHT_TYPE_SPOT)
        return outOfRange(what, "type", info.type, "a spot light's, which GN_SOURCE_SHAPE_RECTANGLE is for");
    if (info.sourceRadius != 0.0f)
        return outOfRange(what, "sourceRadius", info.sourceRadius, "0, as a rectangle has sourceExtents");
    const double width = info.sourceExtents[0], height = info.sourceExtents[1];
    const Number numbers[] = {{width, "sourceExtents[0]"},
                              {height, "sourceExtents[1]"},
                              {info.sourceAxis[0], "sourceAxis[0]"},
                              {info.sourceAxis[1], "sourceAxis[1]"},
                              {info.sourceAxis[2], "sourceAxis[2]"}};
    for (const Number& number : numbers)
        if (Result<void> check = checkNumber(what, number); !check) return check.error();
    for (const Number& extent : {numbers[0], numbers[1]})
        if (extent.value < 0.0 || (extent.value == 0.0 && width + height > 0.0))
            return outOfRange(what, extent.name, extent.value, "(0, 1e18], or 0 like the other one");

    const glm::dvec3 forward = forwardOf(light);
    const glm::dvec3 axis(info.sourceAxis[0], info.sourceAxis[1], info.sourceAxis[2]);
    const glm::dvec3 x = glm::cross(glm::cross(forward, axis), forward); // what of the axis lies across
    // 1e-6: floats of a direction and of an axis along it leave 2^-23 of the axis.
    if (!(glm::length(x) > 1e-6 * glm::length(axis)))
        return Error{GN_ERROR_OUT_OF_RANGE, "LightSourceAxis",
                     what.text() + ": sourceAxis is zero, or lies along direction"};
    const glm::dvec3 unitX = glm::normalize(x), unitY = glm::cross(forward, unitX);
    setHalfAxes(light, width * unitX, height * unitY);
    light.sourceRadius = static_cast<float>(2.0 * std::sqrt(width * height / std::numbers::pi));
    return {};
}

} // namespace

Result<LightDescription> readLight(Subject what, const GnLightInfo& info)
{
    LightDescription light;
    light.type = info.type;
    light.isStatic = (info.flags & GN_LIGHT_STATIC_BIT) != 0;
    light.sampled = (info.flags & GN_LIGHT_SAMPLED_BIT) != 0;
    light.range = kUnlimitedRange;
    if (info.type != GN_LIGHT_TYPE_DIRECTIONAL && info.type != GN_LIGHT_TYPE_SPOT && info.type != GN_LIGHT_TYPE_POINT)
        return outOfRange(what, "type", info.type, "GnLightType");
    if (info.flags & ~GnLightFlags{GN_LIGHT_STATIC_BIT | GN_LIGHT_SAMPLED_BIT})
        return outOfRange(what, "flags", info.flags, "the bits of GnLightFlagBits");
    if (info.type != GN_LIGHT_TYPE_DIRECTIONAL)
        if (Result<void> check = readPosition(what, info, light); !check) return check.error();
    if (info.type != GN_LIGHT_TYPE_POINT)
        if (Result<void> check = readDirection(what, info, light); !check) return check.error();
    if (info.type == GN_LIGHT_TYPE_SPOT)
        if (Result<void> check = readCone(what, info, light); !check) return check.error();
    for (const Number& number : {Number{info.sourceRadius, "sourceRadius"}, Number{info.importance, "importance"}}) {
        if (Result<void> check = checkNumber(what, number); !check) return check.error();
        if (number.value < 0.0) return outOfRange(what, number.name, number.value, "[0, 1e18]");
    }
    light.sourceRadius = info.sourceRadius;
    if (info.sourceShape != GN_SOURCE_SHAPE_SPHERE && info.sourceShape != GN_SOURCE_SHAPE_RECTANGLE &&
        info.sourceShape != GN_SOURCE_SHAPE_DISC)
        return outOfRange(what, "sourceShape", info.sourceShape, "GnSourceShape");
    if (info.sourceShape == GN_SOURCE_SHAPE_RECTANGLE)
        if (Result<void> check = readRectangle(what, info, light); !check) return check.error();
    if (info.sourceShape == GN_SOURCE_SHAPE_DISC)
        if (Result<void> check = readDisc(what, info, light); !check) return check.error();
    light.sourceShape = info.sourceShape;
    light.importance = info.importance == 0.0f ? 1.0f : info.importance;
    light.mask = info.casterMask ? info.casterMask : kAllMasks;
    return light;
}

} // namespace gnomon
