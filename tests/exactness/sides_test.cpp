// Casters that are mirrored, wound inside out, hollow or open, under hosts that draw the fronts of triangles or both
// sides, by every method there is. MESSAGE prints what is measured.
#include <algorithm>
#include <utility>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

using demo::Instance;
using demo::Light;
using demo::Mesh;
using demo::Sides;

constexpr VkExtent2D kSize{640, 360};

Mesh insideOut(Mesh mesh)
{
    for (size_t i = 0; i < mesh.indices.size(); i += 3)
        std::swap(mesh.indices[i], mesh.indices[i + 1]);
    return mesh;
}

Mesh ring()
{
    return demo::makeTorus({.radius = 0.7f, .tube = 0.3f, .ringSegments = 16, .tubeSegments = 8});
}

/// A box that lacks what faces +x.
Mesh openBox()
{
    Mesh box = demo::makeBox({.size = {1.2f, 1.4f, 1.0f}}), open = box;
    open.indices.clear();
    for (size_t i = 0; i < box.indices.size(); i += 3) {
        const auto right = [&](size_t corner) { return box.positions[box.indices[i + corner]].x > 0.0f; };
        if (right(0) && right(1) && right(2)) continue;
        open.indices.insert(open.indices.end(), &box.indices[i], &box.indices[i] + 3);
    }
    return open;
}

Mesh joined(Mesh mesh, const Mesh& other, const glm::vec3& at)
{
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : other.positions)
        mesh.positions.push_back(p + at);
    for (const uint32_t index : other.indices)
        mesh.indices.push_back(first + index);
    return mesh;
}

/// A floor with casters side by side, turned, under a sun, a spot and a lamp.
class Row {
public:
    Row()
    {
        place(scene, "floor", demo::makeBox({.size = {24.0f, 0.2f, 14.0f}}), {0.0, -0.1, 0.0});
        scene.name = "sides";
        scene.camera = {{.eye = {0.7, 4.0, 8.0}, .target = {0.0, 0.5, 0.0}}};
        scene.lights = {light("sun", LightKind::Directional), light("spot", LightKind::Spot),
                        light("lamp", LightKind::Point)};
    }

    Row& add(const char* name, Mesh mesh, Sides sides = Sides::ByMesh, const glm::dvec3& scale = glm::dvec3(1.0))
    {
        Instance& caster = place(scene, name, std::move(mesh), {-3.6 + 2.4 * count_, 1.0, 0.4 * (count_ % 2)});
        caster.pose.rotation = glm::angleAxis(0.5 + count_, glm::normalize(glm::dvec3(1.0, 2.0, 0.5)));
        caster.pose.scale = scale;
        caster.sides = sides;
        ++count_;
        return *this;
    }

    Scene scene;

private:
    static Light light(const char* name, LightKind kind)
    {
        Light out;
        out.name = name;
        out.kind = kind;
        out.position = kind == LightKind::Spot ? glm::dvec3(-5.0, 6.0, 3.0) : glm::dvec3(1.5, 3.8, 3.2);
        out.direction = kind == LightKind::Spot ? glm::normalize(glm::dvec3(0.0, 0.5, 0.0) - out.position)
                                                : glm::normalize(glm::dvec3(0.5, -1.0, -0.4));
        out.outerAngle = kind == LightKind::Spot ? 0.8f : 0.0f;
        out.range = kind == LightKind::Directional ? 0.0f : 40.0f;
        return out;
    }

    int count_ = 0;
};

/// Every method that serves such lights; planar ones are right on one plane only.
void checkAllMethods(const Scene& scene)
{
    Stage stage(scene, kSize);
    for (const GnMethodInfo& method : stage.methods()) {
        if ((method.traits & GN_TRAIT_PLANAR_BIT) != 0) continue;
        CAPTURE(std::string(method.pName));
        const ErrorCount error = pooled(stage, stage.draw(method.pName));
        MESSAGE(std::string(method.pName) << ": wrong " << inWords(error));
        const bool exact = (method.traits & GN_TRAIT_EXACT_BIT) != 0;
        const double texels = defaultOf(method.pName, "filter", 1.0); // averaged: edges are wrong by half as many
        const double coarser = 1024.0 / defaultOf(method.pName, "resolution", 1024.0);
        const double most = 0.8 * (1.0 + (texels - 1.0) / 2.5) * std::max(1.0, coarser);
        CHECK(error.percent(error.wrong()) <= (exact ? 0.01 : most));
    }
}

constexpr glm::dvec3 kMirror(-1.0, 1.0, 1.0), kMirrorTall(1.0, 1.3, -0.8);

} // namespace

TEST_CASE("mirrored casters are shown by every method as rays show them, closed or open")
{
    const test::DeviceTest silence;
    checkAllMethods(Row()
                        .add("ring", ring(), Sides::ByMesh, kMirror)
                        .add("box", demo::makeBox({.size = {1.2f, 1.4f, 1.0f}}), Sides::ByMesh, kMirrorTall)
                        .add("open", openBox(), Sides::ByMesh, kMirror)
                        .add("front", openBox(), Sides::Front, kMirrorTall)
                        .scene);
}

TEST_CASE("closed casters wound inside out are shown as rays show them, whether the host draws fronts or both sides")
{
    const test::DeviceTest silence;
    for (const Sides sides : {Sides::ByMesh, Sides::Both}) {
        CAPTURE(static_cast<int>(sides));
        checkAllMethods(Row()
                            .add("ring", insideOut(ring()), sides)
                            .add("box", insideOut(demo::makeBox({.size = {1.2f, 1.4f, 1.0f}})), sides)
                            .add("mirrored", insideOut(ring()), sides, kMirror)
                            .add("sphere", insideOut(demo::makeSphere({.radius = 0.8f})), sides)
                            .scene);
    }
}

TEST_CASE("open casters of which the host draws the fronts, and closed ones of which it draws both sides, are too")
{
    const test::DeviceTest silence;
    checkAllMethods(Row()
                        .add("front", openBox(), Sides::Front)
                        .add("inside out, front", insideOut(openBox()), Sides::Front)
                        .add("inside out, both", insideOut(openBox()), Sides::Both)
                        .add("closed, both", ring(), Sides::Both)
                        .scene);
}

TEST_CASE("hollow solids, and meshes of which some solids are inside out, are too")
{
    const test::DeviceTest silence;
    const Mesh large = demo::makeBox({.size = glm::vec3(1.4f)}), small = demo::makeBox({.size = glm::vec3(0.8f)});
    const glm::vec3 beside(0.0f, 1.3f, 0.0f);
    checkAllMethods(Row()
                        .add("hollow", joined(large, insideOut(small), glm::vec3(0.0f)))
                        .add("hollow inside out", joined(insideOut(large), small, glm::vec3(0.0f)))
                        .add("one of two", joined(small, insideOut(small), beside))
                        .add("one of two, both drawn", joined(small, insideOut(small), beside), Sides::Both)
                        .scene);
}

} // namespace gnomon::exact
