#include "demo/scene/scene_parts.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <numbers>

namespace gnomon::demo {
namespace {

/// Direction from `direction`, or towards the point `aim`; exactly one of them.
glm::dvec3 readAim(MapReader& map, const glm::dvec3& position, bool mayAim)
{
    const YamlNode* direction = map.find("direction");
    const YamlNode* aim = mayAim ? map.find("aim") : nullptr;
    if ((direction != nullptr) == (aim != nullptr))
        raise(map.context(), map.node(),
              mayAim ? "exactly one of 'direction' and 'aim' must be given" : "'direction' is missing");
    if (direction != nullptr) return readDirection(map.context(), *direction, "direction");
    const glm::dvec3 way = map.needVector("aim") - position;
    if (!(glm::length(way) > 0.0)) raise(map.context(), *aim, "aim must differ from the light's position");
    return glm::normalize(way);
}

void readPlace(MapReader& map, LightKind kind, glm::dvec3& position, glm::dvec3& direction)
{
    if (kind != LightKind::Directional) position = map.needVector("at");
    if (kind != LightKind::Point) direction = readAim(map, position, kind == LightKind::Spot);
}

void readCone(MapReader& map, Light& light)
{
    const YamlNode& node = map.need("cone");
    MapReader cone(map.context(), node, shapes::kCone, "cone");
    const double outer = cone.needNumber("outer");
    const double inner = cone.number("inner", outer * 0.9, {.high = outer});
    cone.finish();
    light.outerAngle = static_cast<float>(toRadians(outer));
    light.innerAngle = static_cast<float>(toRadians(inner));
}

void readDisc(MapReader& map, Light& light)
{
    const YamlNode* node = map.find("disc");
    if (node == nullptr) return;
    for (const char* other : {"rectangle", "radius"})
        if (map.find(other) != nullptr)
            raise(map.context(), *node, std::string("a light has a disc or a ") + other + ", not both");
    light.radius = map.needFloat("disc");
    light.disc = true;
}

void readRectangle(MapReader& map, Light& light)
{
    const YamlNode* node = map.find("rectangle");
    if (node == nullptr) return;
    if (map.find("radius") != nullptr) raise(map.context(), *node, "a light has a rectangle or a radius, not both");
    MapReader rectangle(map.context(), *node, shapes::kRectangle, "rectangle");
    for (const auto& [key, half] : {std::pair{"width", &light.rectangle.x}, std::pair{"height", &light.rectangle.y}})
        *half = 0.5f * rectangle.needFloat(key);
    if (const YamlNode* axis = rectangle.find("axis"))
        light.rectangleAxis = readDirection(map.context(), *axis, "axis");
    rectangle.finish();
    light.radius = 2.0f * std::sqrt(light.rectangle.x * light.rectangle.y / std::numbers::pi_v<float>);
    if (glm::length(glm::cross(light.direction, light.rectangleAxis)) < 1e-5)
        raise(map.context(), *node, "the rectangle's axis must not lie along the light's direction");
}

void readLightKeys(MapReader& map, Light& light)
{
    const YamlNode* list = map.find("keys");
    if (list == nullptr) return;
    if (list->kind != YamlNode::Kind::Sequence || list->children.empty())
        raise(map.context(), *list, "keys must be a list of at least one key");
    for (const YamlNode& node : list->children) {
        MapReader key(map.context(), node, shapes::kLightKey, "a key");
        LightKey value;
        value.time = key.needNumber("time");
        requireLater(map.context(), node, light.keys, value.time);
        readPlace(key, light.kind, value.position, value.direction);
        key.finish();
        light.keys.push_back(value);
    }
    light.position = light.keys.front().position;
    light.direction = light.keys.front().direction;
}

void readLifetime(MapReader& map, Light& light)
{
    light.appear = map.number("appear", light.appear);
    const YamlNode* end = map.find("disappear");
    if (end == nullptr) return;
    light.disappear = map.needNumber("disappear");
    if (light.disappear <= light.appear) raise(map.context(), *end, "disappear must come after appear");
}

/// Errors are counted and lights are asked for by name.
void requireNewName(const ReadContext& context, const YamlNode& at, const std::string& name,
                    const std::vector<Light>& before)
{
    const auto first = std::find_if(before.begin(), before.end(), [&](const Light& l) { return l.name == name; });
    if (first == before.end()) return;
    raise({context.file, "light " + std::to_string(before.size())}, at,
          "light " + std::to_string(first - before.begin()) + " is called '" + name + "' already");
}

/// The light and its copies. An orbit's centre is the same for all.
void addCopies(const ReadContext& context, const YamlNode& node, const Light& light, const std::vector<Copy>& copies,
               std::vector<Light>& lights)
{
    if (lights.size() + copies.size() > kMostLights)
        raise(context, node, "more than " + std::to_string(kMostLights) + " lights");
    for (const Copy& copy : copies) {
        Light placed = light;
        placed.name += copy.suffix;
        requireNewName(context, node, placed.name, lights);
        const auto move = [&copy](glm::dvec3& position, glm::dvec3& direction) {
            position = copy.place(position);
            direction = copy.turn * direction;
        };
        move(placed.position, placed.direction);
        placed.rectangleAxis = copy.turn * placed.rectangleAxis;
        for (LightKey& key : placed.keys)
            move(key.position, key.direction);
        lights.push_back(std::move(placed));
    }
}

/// Of the segment from a to b.
double distanceToOrigin(const glm::dvec3& a, const glm::dvec3& b)
{
    const glm::dvec3 along = b - a;
    const double squared = glm::dot(along, along);
    const double nearest = squared > 0.0 ? std::clamp(-glm::dot(a, along) / squared, 0.0, 1.0) : 0.0;
    return glm::length(a + along * nearest);
}

} // namespace

double toRadians(double degrees) noexcept
{
    return degrees * (std::numbers::pi / 180.0);
}

glm::dvec3 readDirection(const ReadContext& context, const YamlNode& node, const std::string& name)
{
    const glm::dvec3 vector = readVector(context, node, name, shapes::kVector);
    // Shorter vectors lose digits when squared; nobody writes one on purpose.
    if (!(glm::length(vector) > 1e-9)) raise(context, node, name + " must not be zero");
    return glm::normalize(vector);
}

void readLight(ReadContext context, const YamlNode& node, std::vector<Light>& lights, double framesPerSecond)
{
    context.subject = "light " + std::to_string(lights.size());
    MapReader map(context, node, shapes::kLight, "a light");
    Light light;
    light.name = map.text("name", "light" + std::to_string(lights.size()));
    context.subject = "light '" + light.name + "'"; // the reader sees the better name from here on
    light.kind = static_cast<LightKind>(readWord(context, map.need("kind"), "kind", shapes::kLightKind));

    readLightKeys(map, light);
    if (light.keys.empty()) readPlace(map, light.kind, light.position, light.direction);
    if (light.kind == LightKind::Spot) readCone(map, light);
    if (light.kind == LightKind::Spot) readDisc(map, light);
    if (light.kind == LightKind::Spot) readRectangle(map, light);
    if (light.kind != LightKind::Directional) {
        light.range = map.needFloat("range");
        light.radius = map.numberF("radius", light.radius);
    } else {
        // The angle a distant disc's radius spans; the sun's is 0.27 degrees.
        light.radius = static_cast<float>(toRadians(map.number("radius_degrees", 0.0)));
    }
    light.colour = glm::vec3(map.vector("colour", glm::dvec3(1.0)));
    light.intensity = map.numberF("intensity", light.intensity);
    light.importance = map.numberF("importance", light.importance);
    light.casterMask = map.integer("mask", light.casterMask);
    readLifetime(map, light);
    light.orbit = readOrbit(map, framesPerSecond);
    light.isStatic = map.boolean("static", false);
    const std::vector<Copy> copies = readCopies(map, false);
    const YamlNode* name = map.find("name");
    map.finish();
    if (light.rectangle.x > 0.0f && moves(light))
        raise(context, node, "a light with a rectangle cannot have keys or an orbit");
    if (light.isStatic && moves(light)) raise(context, node, "a static light cannot have keys or an orbit");
    addCopies(context, name != nullptr ? *name : node, light, copies, lights);
}

std::vector<CameraKey> readCamera(const ReadContext& context, const YamlNode& node)
{
    if (node.kind != YamlNode::Kind::Sequence || node.children.empty())
        raise(context, node, "camera must be a list of at least one key");
    std::vector<CameraKey> keys;
    for (const YamlNode& child : node.children) {
        MapReader map(context, child, shapes::kCameraKey, "a camera key");
        CameraKey key;
        key.time = map.number("time", 0.0);
        requireLater(context, child, keys, key.time);
        key.eye = map.needVector("eye");
        key.target = map.needVector("target");
        const double fov =
            map.number("fov", keys.empty() ? 45.0 : double(keys.back().verticalFov) * 180.0 / std::numbers::pi);
        key.verticalFov = static_cast<float>(toRadians(fov));
        key.cut = map.boolean("cut", false);
        map.finish();
        const glm::dvec3 view = key.target - key.eye;
        const glm::dvec3 viewBefore = keys.empty() || key.cut ? view : keys.back().target - keys.back().eye;
        if (!(distanceToOrigin(viewBefore, view) > 1e-6))
            raise(context, child, "eye and target must differ, also on the way from the key before");
        keys.push_back(key);
    }
    return keys;
}

} // namespace gnomon::demo
