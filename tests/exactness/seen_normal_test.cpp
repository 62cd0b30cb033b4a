// Hosts without normals where the plane of a pixel's neighbours is not its surface's: rays must not start on the other
// side of it. Held against the same host with normals, and methods against each other.
#include "device/fixture.hpp"
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

using demo::DepthConvention;
using test::Host;

constexpr VkExtent2D kImage{320, 180};
constexpr const char* kExact[] = {"tile_shafts", "conservative_map", "conservative_map_adjacency"};

struct Apart {
    int lit = 0, dark = 0, counted = 0;
    Apart& operator+=(const Apart& other)
    {
        lit += other.lit;
        dark += other.dark;
        counted += other.counted;
        return *this;
    }
};

/// Pixels that one picture has lit or dark alone. @param area of no extent: everywhere. @param mask 1: a pixel that
/// counts; or empty
Apart apart(const Image8& picture, const Image8& from, const VkRect2D& area = {}, const std::vector<uint8_t>& mask = {})
{
    Apart sum;
    const bool all = area.extent.width == 0;
    for (uint32_t y = 0; y < (all ? from.height : area.extent.height); ++y) {
        for (uint32_t x = 0; x < (all ? from.width : area.extent.width); ++x) {
            const uint32_t column = x + static_cast<uint32_t>(area.offset.x),
                           row = y + static_cast<uint32_t>(area.offset.y);
            if (!mask.empty() && mask[size_t{row} * from.width + column] != 1) continue;
            const bool lit = *picture.at(column, row) > 127, wanted = *from.at(column, row) > 127;
            ++sum.counted;
            sum.lit += lit && !wanted;
            sum.dark += !lit && wanted;
        }
    }
    return sum;
}

/// The view's projection, of a part of its image.
void crop(GnViewFrame& view, const VkRect2D& area)
{
    const double width = view.imageExtent.width, height = view.imageExtent.height;
    const double scaleX = width / area.extent.width, scaleY = height / area.extent.height;
    const double centreX = 2.0 * (area.offset.x + 0.5 * area.extent.width) / width - 1.0;
    const double centreY = 2.0 * (area.offset.y + 0.5 * area.extent.height) / height - 1.0;
    for (int column = 0; column < 4; ++column) {
        float* entry = view.projection + 4 * column;
        const double w = entry[3];
        entry[0] = static_cast<float>((entry[0] - centreX * w) * scaleX);
        entry[1] = static_cast<float>((entry[1] - centreY * w) * scaleY);
    }
    view.renderArea = area;
}

Image8 shown(Host& host, const char* method, bool normals, const VkRect2D& area = {})
{
    host.pinAll(method);
    host.require(host.draw({.adjust = [=](GnFrameInfo&, std::vector<GnViewFrame>& views) {
        if (area.extent.width != 0) crop(views[0], area);
        if (normals) return;
        views[0].normalImage = VK_NULL_HANDLE;
        views[0].normalView = VK_NULL_HANDLE;
        views[0].normalFormat = VK_FORMAT_UNDEFINED;
    }}));
    REQUIRE(std::string(host.decision(0).pMethod) == method);
    return host.pictures()[0];
}

Scene sceneOf(DepthConvention convention)
{
    Scene scene = test::smallScene();
    scene.depth = {.convention = convention, .nearPlane = 0.1, .farPlane = 200.0};
    return scene;
}

demo::Light sun(const glm::dvec3& direction)
{
    return {.name = "sun", .kind = LightKind::Directional, .direction = glm::normalize(direction)};
}

} // namespace

TEST_CASE("a row or a column of pixels without normals is as lit as with them")
{
    const test::DeviceTest silence;
    std::vector<VkRect2D> strips;
    for (int32_t y = 0; y < 180; y += 17)
        strips.push_back({{0, y}, {320, 1}});
    for (int32_t x = 0; x < 320; x += 31)
        strips.push_back({{x, 0}, {1, 180}});
    for (const auto convention : {DepthConvention::ReversedInfinite, DepthConvention::Standard}) {
        Host host(sceneOf(convention), {.extent = kImage, .mapSide = 1024.0});
        // One method after the other: a light whose method changes makes its maps and buffers again.
        const auto eachShown = [&](const char* method, bool normals) {
            std::vector<Image8> pictures;
            for (const VkRect2D& strip : strips)
                pictures.push_back(shown(host, method, normals, strip));
            return pictures;
        };
        const std::vector<Image8> withNormals = eachShown("ray_traced", true), traced = eachShown("ray_traced", false);
        for (const char* method : {"ray_traced", kExact[0], kExact[1], kExact[2]}) {
            CAPTURE(std::string(method));
            const std::vector<Image8> pictures = eachShown(method, false);
            Apart fromNormals, fromTraced;
            for (size_t i = 0; i < strips.size(); ++i) {
                fromNormals += apart(pictures[i], withNormals[i], strips[i]);
                fromTraced += apart(pictures[i], traced[i], strips[i]);
            }
            CHECK(fromNormals.dark <= fromNormals.counted / 2000);
            CHECK(fromTraced.lit + fromTraced.dark == 0);
        }
    }
}

TEST_CASE("poles one pixel wide do not shadow themselves without normals, and exact methods agree on them")
{
    const test::DeviceTest silence;
    for (const auto convention : {DepthConvention::ReversedInfinite, DepthConvention::Standard}) {
        for (const bool directional : {false, true}) {
            CAPTURE(directional);
            Scene scene = sceneOf(convention);
            scene.meshes.push_back(demo::makeBox({.size = glm::vec3(0.03f, 2.0f, 0.03f)}));
            for (int i = 0; i < 40; ++i) {
                demo::Instance& pole = scene.instances.emplace_back();
                pole.name = "pole";
                pole.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
                pole.pose.position = {-4.0 + 0.2 * i, 1.0, -1.0 - 0.05 * (i % 7)};
                pole.pose.rotation = glm::normalize(glm::dquat(1.0, 0.0, 0.1 * i, 0.0));
                pole.isStatic = true;
            }
            if (directional) scene.lights = {sun({-0.6, -0.7, -0.4})};
            const Stage stage(scene, kImage);
            Host host(scene, {.extent = kImage, .mapSide = 1024.0});
            const Image8 traced = shown(host, "ray_traced", false);
            // Of what faces the light: of poles that turn their edge to it, either side of it may be seen.
            const std::vector<uint8_t>& facing = stage.counted[0];
            const Apart change = apart(traced, shown(host, "ray_traced", true), {}, facing);
            MESSAGE("false shadow " << change.dark << ", false lit " << change.lit << " of " << change.counted);
            CHECK(change.counted > 15000);
            CHECK(change.dark + change.lit <= change.counted / 2000);
            for (const char* method : kExact) {
                CAPTURE(std::string(method));
                const Apart others = apart(shown(host, method, false), traced, {}, facing);
                // Single pixels whose neighbours are of two other surfaces: only their rays start inside of the pole.
                CHECK(others.lit + others.dark <= change.dark);
            }
        }
    }
}

TEST_CASE("no light falls through an open sheet that is seen from its dark side without normals")
{
    const test::DeviceTest silence;
    for (const auto convention : {DepthConvention::ReversedInfinite, DepthConvention::Standard}) {
        for (const bool directional : {true, false}) {
            Scene scene = sceneOf(convention);
            scene.meshes = {demo::makePlane({.width = 20, .depth = 20})};
            scene.instances.resize(1);
            scene.instances[0] = {};
            scene.instances[0].name = "sheet";
            scene.instances[0].pose.position = {0.0, 3.0, 0.0};
            scene.instances[0].isStatic = true;
            scene.lights = {directional ? sun({0.3, -1.0, 0.2}) : test::pointLight("bulb", {0.3, 6.0, 0.2}, true)};
            scene.camera = {demo::CameraKey{.eye = {0.0, 1.0, 4.0}, .target = {0.0, 3.0, -1.0}}};
            Host host(scene, {.extent = {160, 90}, .mapSide = 1024.0});
            const Image8 given = shown(host, "ray_traced", true);
            CHECK(test::dark(given) > 10000);
            for (const char* method : {"ray_traced", kExact[0], kExact[1], kExact[2], "stencil_volume", "pcf_hybrid",
                                       "contour_chain", "coherence_sampling", "angular_spans"}) {
                CAPTURE(std::string(method));
                CHECK(apart(shown(host, method, false), given).lit == 0);
            }
        }
    }
}

} // namespace gnomon::exact
