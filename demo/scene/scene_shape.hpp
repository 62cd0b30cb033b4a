#pragma once

/// The format of scene files, as parseScene() reads it. demo/scenes/README.md explains the keys and has the defaults.

#include "rules/yaml/shape.hpp"

namespace gnomon::demo::shapes {

using yaml::Key;
using yaml::kFlag;
using yaml::kText;
using yaml::Shape;

// Bounds of what a file may ask for, far above any sensible scene: a typing error must not eat the memory.
inline constexpr uint32_t kMostTrianglesPerMesh = 4'000'000;
inline constexpr uint32_t kMostInstances = 100'000;
inline constexpr uint32_t kMostLights = 4096;
inline constexpr double kMost32Bits = 0xffffffffu;

inline constexpr Shape kAny = yaml::number({});
inline constexpr Shape kPositive = yaml::number({.low = 0.0, .lowOpen = true});
inline constexpr Shape kNotNegative = yaml::number({.low = 0.0});
inline constexpr Shape kMask = yaml::whole(0, kMost32Bits);
inline constexpr Shape kUpTo1024 = yaml::whole(1, 1024);
/// Metres. Products of three lengths, as areas and volumes have them, stay normal numbers in single precision.
inline constexpr Shape kLength = yaml::number({.low = 1e-4, .high = 1e6});
inline constexpr Shape kThickness = yaml::number({.low = 0.0, .high = 1e6});

inline constexpr Shape kVector = yaml::list(kAny, 3, 3);
inline constexpr Shape kPositiveVector = yaml::list(kNotNegative, 3, 3);
inline constexpr Shape kLengths = yaml::list(kLength, 3, 3);
inline constexpr Shape kArea = yaml::list(kLength, 2, 2);

// Shapes of meshes.
inline constexpr double kMostSegments = 4096;
inline constexpr Shape kSegments1 = yaml::whole(1, kMostSegments);
inline constexpr Shape kSegments2 = yaml::whole(2, kMostSegments);
inline constexpr Shape kSegments3 = yaml::whole(3, kMostSegments);
inline constexpr Shape kCells = yaml::list(kSegments1, 2, 2);
inline constexpr Shape kTurns = yaml::whole(1, 32);
inline constexpr Shape kCount256 = yaml::whole(1, 256);

inline constexpr Key kPlaneKeys[] = {{"size", &kArea}, {"cells", &kCells}};
inline constexpr Key kBoxKeys[] = {{"size", &kLengths}};
inline constexpr Key kSphereKeys[] = {{"radius", &kLength}, {"slices", &kSegments3}, {"stacks", &kSegments2}};
inline constexpr Key kTorusKeys[] = {
    {"radius", &kLength}, {"tube", &kLength}, {"ring_segments", &kSegments3}, {"tube_segments", &kSegments3}};
inline constexpr Key kTorusKnotKeys[] = {
    {"radius", &kLength},           {"sweep", &kLength},           {"tube", &kLength}, {"p", &kTurns}, {"q", &kTurns},
    {"knot_segments", &kSegments3}, {"tube_segments", &kSegments3}};
inline constexpr Key kCylinderKeys[] = {{"radius", &kLength},
                                        {"top_radius", &kLength},
                                        {"height", &kLength},
                                        {"segments", &kSegments3},
                                        {"rings", &kSegments1}};
inline constexpr Key kColumnKeys[] = {
    {"radius", &kLength}, {"height", &kLength}, {"segments", &kSegments3}, {"rings", &kSegments1}};
inline constexpr Key kArchKeys[] = {
    {"inner_radius", &kLength}, {"outer_radius", &kLength}, {"depth", &kLength}, {"segments", &kSegments2}};
inline constexpr Key kTerrainKeys[] = {{"size", &kArea},           {"height", &kLength}, {"feature_size", &kPositive},
                                       {"thickness", &kThickness}, {"cells", &kCells},   {"seed", &kMask}};
inline constexpr Shape kFolds = yaml::number({.low = 0.0, .high = 1e4});
inline constexpr Key kClothKeys[] = {
    {"size", &kArea}, {"amplitude", &kThickness}, {"folds", &kFolds}, {"cells", &kCells}};
inline constexpr Key kCardKeys[] = {{"size", &kArea}};
inline constexpr Shape kLeafCount = yaml::whole(1, kMostTrianglesPerMesh);
inline constexpr Shape kBlades = yaml::whole(1, 8);
inline constexpr Key kLeavesKeys[] = {{"size", &kLengths},
                                      {"length", &kLength},
                                      {"width", &kLength},
                                      {"count", &kLeafCount},
                                      {"seed", &kMask},
                                      {"closed", &kFlag},
                                      {"blades", &kBlades, "that share a leaf's axis; 1 where closed"}};
inline constexpr Key kBuildingKeys[] = {
    {"size", &kArea},     {"storey", &kLength},      {"floors", &kCount256},
    {"bays", &kCount256}, {"side_bays", &kCount256}, {"recess", &kLength, "of windows; a quarter of the size at most"}};

template <std::size_t Count>
constexpr Shape meshShape(const Key (&keys)[Count])
{
    Shape shape = yaml::map(keys);
    shape.mayBeEmpty = true; // all defaults
    return shape;
}
inline constexpr Shape kPlane = meshShape(kPlaneKeys), kBox = meshShape(kBoxKeys), kSphere = meshShape(kSphereKeys),
                       kTorus = meshShape(kTorusKeys), kTorusKnot = meshShape(kTorusKnotKeys),
                       kCylinder = meshShape(kCylinderKeys), kColumn = meshShape(kColumnKeys),
                       kArch = meshShape(kArchKeys), kTerrain = meshShape(kTerrainKeys), kCloth = meshShape(kClothKeys),
                       kCard = meshShape(kCardKeys), kLeaves = meshShape(kLeavesKeys),
                       kBuilding = meshShape(kBuildingKeys);

// Places.
inline constexpr Shape kDegrees = yaml::number({.low = -3600.0, .high = 3600.0});
inline constexpr Key kTurnKeys[] = {{"axis", &kVector, {}, true}, {"degrees", &kDegrees, {}, true}};
inline constexpr Shape kTurn = yaml::map(kTurnKeys);
inline constexpr Shape kTurnList = yaml::list(kTurn, 0, UINT32_MAX);
inline constexpr const Shape* kRotateChoices[] = {&kTurn, &kTurnList};
inline constexpr Shape kRotate = yaml::either(kRotateChoices);
inline constexpr const Shape* kScaleChoices[] = {&kAny, &kVector};
inline constexpr Shape kScale = yaml::either(kScaleChoices);
inline constexpr Key kAtKey{"at", &kVector, "position, metres"};
inline constexpr Key kRotateKey{"rotate", &kRotate, "turns in their order"};
inline constexpr Key kScaleKey{"scale", &kScale, "acts first; a negative one mirrors"};
inline constexpr Key kTimeKey{"time", &kNotNegative, "seconds; grows from key to key", true};

inline constexpr Key kOrbitKeys[] = {{"center", &kVector},
                                     {"axis", &kVector, "default y"},
                                     {"degrees_per_second", &kAny, "or degrees_per_frame"},
                                     {"degrees_per_frame", &kAny}};
inline constexpr Shape kOrbit = yaml::map(kOrbitKeys);
inline constexpr Key kOrbitKey{"orbit", &kOrbit, "carries position and direction round"};
inline constexpr Shape kCounts = yaml::list(kUpTo1024, 3, 3);
inline constexpr Shape kHalfTurn = yaml::number({.low = 0.0, .high = 180.0});
inline constexpr Shape kGrowth = yaml::number({.low = 0.0, .high = 0.9});
inline constexpr Key kRepeatKeys[] = {{"count", &kCounts, {}, true},
                                      {"spacing", &kPositiveVector, "metres", true},
                                      {"jitter", &kPositiveVector, "moves each by so much at most"},
                                      {"seed", &kMask},
                                      {"turn", &kHalfTurn, "degrees about y, at most"},
                                      {"grow", &kGrowth, "scales each by 1 - grow to 1 + grow"}};
/// Copies of lights are neither turned nor scaled.
inline constexpr Shape kStrewn = yaml::map(kRepeatKeys);
inline constexpr Shape kGrid{.kind = Shape::Kind::Map, .keys = kRepeatKeys, .keyCount = 4};
inline constexpr Key kRingKeys[] = {{"count", &kUpTo1024, {}, true}, {"center", &kVector}};
inline constexpr Shape kRing = yaml::map(kRingKeys);
inline constexpr Key kRingKey{"ring", &kRing, "copies turned evenly round the vertical axis through `center`"};

// Meshes.
inline constexpr std::string_view kUpWords[] = {"y", "z", "-z"};
inline constexpr Shape kUp = yaml::word(kUpWords);
#define GNOMON_MESH_SHAPES                                                                                             \
    {"plane", &kPlane}, {"box", &kBox}, {"sphere", &kSphere}, {"torus", &kTorus}, {"torus_knot", &kTorusKnot},         \
        {"cylinder", &kCylinder}, {"column", &kColumn}, {"arch", &kArch}, {"terrain", &kTerrain}, {"cloth", &kCloth},  \
        {"card", &kCard}, {"leaves", &kLeaves},                                                                        \
    {                                                                                                                  \
        "building", &kBuilding                                                                                         \
    }
inline constexpr Key kPartKeys[] = {GNOMON_MESH_SHAPES, kAtKey, kRotateKey, kScaleKey};
inline constexpr Shape kPart = yaml::map(kPartKeys);
inline constexpr Shape kParts = yaml::list(kPart, 1, UINT32_MAX);
inline constexpr Key kMeshKeys[] = {{"file", &kText, "OBJ, PLY, 3DS, glTF, or glmark2:NAME"},
                                    {"up", &kUp, "the file's upward axis"},
                                    {"fit_height", &kLength, "of the file's mesh, which then stands on y = 0"},
                                    {"parts", &kParts, "shapes put together"},
                                    GNOMON_MESH_SHAPES};
#undef GNOMON_MESH_SHAPES
inline constexpr Shape kMesh = yaml::map(kMeshKeys);
inline constexpr Shape kMeshes = yaml::named(kMesh, UINT32_MAX);

// Instances.
inline constexpr Key kInstanceKeyKeys[] = {kTimeKey, kAtKey, kRotateKey, kScaleKey};
inline constexpr Shape kInstanceKey = yaml::map(kInstanceKeyKeys);
inline constexpr Shape kInstanceKeys = yaml::list(kInstanceKey, 1, UINT32_MAX);
inline constexpr Key kSpinKeys[] = {{"axis", &kVector, "default y"},
                                    {"degrees_per_second", &kAny, "or degrees_per_frame"},
                                    {"degrees_per_frame", &kAny}};
inline constexpr Shape kSpin = yaml::map(kSpinKeys);
inline constexpr std::string_view kSideWords[] = {"by_mesh", "front", "both"};
inline constexpr Shape kSides = yaml::word(kSideWords);
inline constexpr Shape kUnit = yaml::number({.low = 0.0, .high = 1.0});
inline constexpr Shape kAlbedo = yaml::list(kUnit, 3, 3);
inline constexpr Key kInstanceEntries[] = {{"name", &kText, "for messages and logs"},
                                           {"mesh", &kText, "a name from `meshes`", true},
                                           {"keys", &kInstanceKeys, "poses over time"},
                                           kAtKey,
                                           kRotateKey,
                                           kScaleKey,
                                           {"spin", &kSpin, "endless, about an axis of the object"},
                                           kOrbitKey,
                                           {"static", &kFlag, "promises neither keys, spin nor orbit"},
                                           {"alpha_tested", &kFlag, "the host cuts holes"},
                                           {"host_drawn", &kFlag, "drawn into shadow maps by the host"},
                                           {"sides", &kSides, "that the host draws"},
                                           {"mask", &kMask, "which lights see it"},
                                           {"albedo", &kAlbedo},
                                           {"repeat", &kStrewn, "copies on a grid centred on `at`"},
                                           kRingKey};
inline constexpr Shape kInstance = yaml::map(kInstanceEntries);
inline constexpr Shape kInstances = yaml::list(kInstance, 0, kMostInstances);

// Lights.
inline constexpr std::string_view kLightWords[] = {"directional", "spot", "point"};
inline constexpr Shape kLightKind = yaml::word(kLightWords);
// A half angle of 90 degrees has no projection; 80 is still a texel stretch of 1 / cos^2 = 33.
inline constexpr Shape kOuter = yaml::number({.low = 0.0, .high = 80.0, .lowOpen = true});
inline constexpr Shape kInner = yaml::number({.low = 0.0, .high = 80.0});
inline constexpr Key kConeKeys[] = {{"outer", &kOuter, "half angle of no light, degrees", true},
                                    {"inner", &kInner, "half angle of full light"}};
inline constexpr Shape kCone = yaml::map(kConeKeys);
inline constexpr Key kRectangleKeys[] = {{"width", &kPositive, "metres", true},
                                         {"height", &kPositive, "metres", true},
                                         {"axis", &kVector, "of its width; not the light's direction"}};
inline constexpr Shape kRectangle = yaml::map(kRectangleKeys);
inline constexpr Key kDirectionKey{"direction", &kVector, "the way light travels; directional, spot"};
inline constexpr Key kAimKey{"aim", &kVector, "a point it looks at, instead of `direction`; spot"};
inline constexpr Key kLightKeyKeys[] = {kTimeKey, kAtKey, kDirectionKey, kAimKey};
inline constexpr Shape kLightKey = yaml::map(kLightKeyKeys);
inline constexpr Shape kLightKeys = yaml::list(kLightKey, 1, UINT32_MAX);
inline constexpr Shape kDisc = yaml::number({.low = 0.0, .high = 45.0});
inline constexpr Key kLightEntries[] = {{"name", &kText, "no two lights' the same"},
                                        {"kind", &kLightKind, {}, true},
                                        {"keys", &kLightKeys, "places over time"},
                                        kAtKey,
                                        kDirectionKey,
                                        kAimKey,
                                        {"cone", &kCone, "spot"},
                                        {"range", &kPositive, "metres; spot, point"},
                                        {"radius", &kNotNegative, "of the source, metres; spot, point"},
                                        {"disc", &kPositive, "radius of the source, metres, instead of `radius`; spot"},
                                        {"rectangle", &kRectangle, "the source, instead of `radius`; spot"},
                                        {"radius_degrees", &kDisc, "half angle of the source's disc; directional"},
                                        {"colour", &kPositiveVector},
                                        {"intensity", &kNotNegative},
                                        {"importance", &kPositive, "weight in the plan"},
                                        {"mask", &kMask, "which casters it sees"},
                                        {"appear", &kNotNegative, "seconds"},
                                        {"disappear", &kNotNegative, "seconds"},
                                        kOrbitKey,
                                        {"static", &kFlag, "promises neither keys nor orbit"},
                                        {"repeat", &kGrid, "copies on a grid centred on `at`"},
                                        kRingKey};
inline constexpr Shape kLight = yaml::map(kLightEntries);
inline constexpr Shape kLights = yaml::list(kLight, 0, kMostLights);

// Cameras.
inline constexpr Shape kFov = yaml::number({.low = 1.0, .high = 160.0});
inline constexpr Key kCameraKeyKeys[] = {{"time", &kNotNegative, "seconds; grows from key to key"},
                                         {"eye", &kVector, {}, true},
                                         {"target", &kVector, {}, true},
                                         {"fov", &kFov, "vertical, degrees; default: the key's before"},
                                         {"cut", &kFlag, "jumped to"}};
inline constexpr Shape kCameraKey = yaml::map(kCameraKeyKeys);
inline constexpr Shape kCamera = yaml::list(kCameraKey, 1, UINT32_MAX);

// The whole.
inline constexpr Shape kPixels = yaml::whole(1, 16384); // what Vulkan devices of today draw at most
inline constexpr Shape kSize = yaml::list(kPixels, 2, 2);
inline constexpr Shape kFrames = yaml::whole(1, 1'000'000);
inline constexpr Shape kRate = yaml::number({.low = 1.0, .high = 1000.0});
inline constexpr Shape kLightCount = yaml::whole(0, kMostLights);
inline constexpr std::string_view kConventionWords[] = {"reversed_infinite", "standard"};
inline constexpr Shape kConvention = yaml::word(kConventionWords);
inline constexpr Shape kNear = yaml::number({.low = 1e-4, .high = 1e6});
inline constexpr Key kDepthKeys[] = {
    {"convention", &kConvention}, {"near", &kNear, "metres"}, {"far", &kPositive, "metres; standard, beyond `near`"}};
inline constexpr Shape kDepth = yaml::map(kDepthKeys);
/// A scene with a base needs no key of its own.
inline constexpr Key kSceneKeys[] = {
    {"name", &kText},
    {"description", &kText},
    {"size", &kSize, "width and height, pixels"},
    {"frames", &kFrames, "length of a run"},
    {"fps", &kRate, "frame i shows time i / fps"},
    {"depth", &kDepth},
    {"sky", &kPositiveVector, "colour where nothing is seen"},
    {"ambient", &kNotNegative, "scales the light from everywhere"},
    {"center", &kVector, "of the lights that --lights makes up"},
    {"meshes", &kMeshes},
    {"instances", &kInstances},
    {"lights", &kLights},
    {"light_count", &kLightCount, "how many of `lights` are used"},
    {"camera", &kCamera},
    {"base", &kText, "another scene file, relative to this one; keys given here replace its"}};
inline constexpr Shape kScene = yaml::map(kSceneKeys);

} // namespace gnomon::demo::shapes
