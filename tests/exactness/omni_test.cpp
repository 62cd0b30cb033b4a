// Paraboloids that are cut or skewed to the view, beside plain ones of the same size.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{384, 384};
constexpr double kSide = 512.0; // texels

/// A lamp by where it is from the eye: right, up, back, metres.
struct Lamp {
    glm::dvec3 fromEye;
    float range;
};

glm::dmat3 axesOf(const demo::CameraKey& key)
{
    const glm::dvec3 back = glm::normalize(key.eye - key.target);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), back));
    return {right, glm::cross(back, right), back};
}

/// The scene with one lamp, and the camera at the beginning.
Scene underLamp(const std::string& name, const Lamp& lamp)
{
    Scene scene = shippedScene(name);
    scene.lights = {
        *std::ranges::find_if(scene.lights, [](const auto& light) { return light.kind == LightKind::Point; })};
    scene.camera.resize(1);
    demo::Light& light = scene.lights[0];
    light.keys.clear();
    light.orbit = {};
    light.position = scene.camera[0].eye + axesOf(scene.camera[0]) * lamp.fromEye;
    light.range = lamp.range;
    light.isStatic = true;
    return scene;
}

/// Half angle, degrees, of a cone from the lamp around the part of the view frustum whose depth its range reaches:
/// around the mean of the directions to its corners, which is no narrower than the narrowest.
double coneDegrees(const Scene& scene)
{
    const demo::CameraKey& key = scene.camera[0];
    const glm::dmat3 axes = axesOf(key);
    const glm::dvec3 lamp = scene.lights[0].position;
    const double half = std::tan(0.5 * double{key.verticalFov}), range = double{scene.lights[0].range};
    const double middle = glm::dot(key.eye - lamp, axes[2]);
    std::vector<glm::dvec3> directions;
    for (const double depth : {std::max(scene.depth.nearPlane, middle - range), middle + range})
        for (const double x : {-half, half})
            for (const double y : {-half, half})
                directions.push_back(glm::normalize(key.eye + axes * (depth * glm::dvec3(x, y, -1.0)) - lamp));
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& direction : directions)
        sum += direction;
    double cosine = 1.0;
    for (const glm::dvec3& direction : directions)
        cosine = std::min(cosine, glm::dot(direction, glm::normalize(sum)));
    return glm::degrees(std::acos(cosine));
}

/// Passes of the newest frame whose names have that: those that drew casters into maps.
size_t casterPasses(Stage& stage, std::string_view part = ".casters.")
{
    const GnContext context = stage.session().shadows.context();
    uint32_t count = 0;
    REQUIRE(gnGetFramePasses(context, &count, nullptr) == GN_SUCCESS);
    std::vector<GnPassTiming> passes(count);
    REQUIRE(gnGetFramePasses(context, &count, passes.data()) == GN_SUCCESS);
    return static_cast<size_t>(std::ranges::count_if(passes, [&](const GnPassTiming& pass) {
        return std::string_view(pass.pName).find(part) != std::string_view::npos;
    }));
}

struct Drawn {
    Pictures pictures;
    size_t passes = 0;
};

Drawn draw(Stage& stage, const std::string& method, Settings settings = {})
{
    settings.push_back({"resolution", kSide});
    Drawn drawn{.pictures = stage.draw(method, settings)};
    drawn.passes = casterPasses(stage);
    return drawn;
}

} // namespace

// Navratil 2015, 4.1: the lamps are outside the view frustum, over, beside and behind the eye.
TEST_CASE("one paraboloid cut to a cone of less than 60 degrees is wrong on 0.7 of what two are, in one pass")
{
    const test::DeviceTest silence;
    ErrorCount plain, cut;
    for (const std::string name : {"colonnade", "bunny"}) {
        for (const Lamp& lamp : {Lamp{{0.0, 1.5, 3.0}, 20.0f}, Lamp{{3.0, 2.0, 4.0}, 24.0f},
                                 Lamp{{-6.0, 4.0, 5.0}, 30.0f}, Lamp{{-2.0, 6.0, 7.0}, 30.0f}}) {
            Stage stage(underLamp(name, lamp), kSize);
            const double cone = coneDegrees(stage.scene());
            CHECK(cone < 60.0);
            const Drawn two = draw(stage, "dual_paraboloid", {{"culling", 1.0}}),
                        one = draw(stage, "improved_paraboloid");
            const ErrorCount wrongTwo = pooled(stage, two.pictures), wrongOne = pooled(stage, one.pictures);
            MESSAGE(name << ", cone of " << cone << " degrees: " << inWords(wrongTwo) << " by two, "
                         << inWords(wrongOne) << " by one");
            CHECK(two.passes == 2);
            CHECK(one.passes == 1);
            CHECK(wrongTwo.counted > 10'000);
            CHECK(wrongOne.wrong() < wrongTwo.wrong());
            plain += wrongTwo;
            cut += wrongOne;
        }
    }
    MESSAGE("together " << inWords(plain) << " by two, " << inWords(cut) << " by one");
    CHECK(double(cut.wrong()) <= 0.7 * double(plain.wrong()));
}

// Where texels are finer than pixels what is left of the error is casters that a map does not hold.
TEST_CASE("one paraboloid of 4096 texels holds every caster that two do")
{
    const test::DeviceTest silence;
    Stage stage(underLamp("colonnade", {{-6.0, 4.0, 5.0}, 30.0f}), {160, 160});
    const auto error = [&](const char* method) {
        const ErrorCount count = pooled(stage, stage.draw(method, {{"resolution", 4096.0}}));
        MESSAGE(std::string(method) << " of 4096 texels: " << inWords(count));
        return count;
    };
    const ErrorCount two = error("dual_paraboloid"), one = error("improved_paraboloid");
    CHECK(one.counted > 5'000);
    CHECK(casterPasses(stage) == 1);
    CHECK(one.percent(one.wrong()) <= two.percent(two.wrong()) + 0.05);
    CHECK(one.percent(one.falseLit) <= two.percent(two.falseLit) + 0.05);
}

TEST_CASE("a lamp in view takes two halves, and the picture is that of dual_paraboloid, bit for bit")
{
    const test::DeviceTest silence;
    Stage stage(underLamp("colonnade", {{0.0, 0.5, -6.0}, 14.0f}), kSize);
    const Drawn two = draw(stage, "dual_paraboloid"), own = draw(stage, "improved_paraboloid");
    CHECK(own.passes == 2);
    CHECK(test::differences(own.pictures, two.pictures) == 0);
    Stage behind(underLamp("colonnade", {{0.0, 1.5, 3.0}, 20.0f}), kSize);
    const Drawn plain = draw(behind, "dual_paraboloid"),
                never = draw(behind, "improved_paraboloid", {{"widest_cone", 0.0}});
    CHECK(test::differences(never.pictures, plain.pictures) == 0);
    CHECK(test::differences(draw(behind, "improved_paraboloid").pictures, plain.pictures) > 0);
}

TEST_CASE("six faces are less wrong than two paraboloids of their side, and these ever less as they grow")
{
    const test::DeviceTest silence;
    Stage stage(underLamp("colonnade", {{0.0, 1.0, -6.0}, 20.0f}), kSize);
    const auto wrong = [&](const char* method, double side) {
        const ErrorCount error = pooled(stage, stage.draw(method, {{"resolution", side}}));
        MESSAGE(std::string(method) << " of " << side << " texels: " << inWords(error));
        return error.wrong();
    };
    uint64_t before = UINT64_MAX;
    for (const double side : {512.0, 1024.0, 2048.0, 4096.0}) {
        const uint64_t discs = wrong("dual_paraboloid", side);
        CHECK(discs < before);
        if (side < 2048.0) CHECK(wrong("cube_map", side) <= discs); // larger ones take a second
        before = discs;
    }
}

// Navratil 2015, 4.1.4; what is nearer to the eye than the lamp is what the skew is for.
TEST_CASE("a skew of 30 degrees makes less wrong near the eye, and not 1.2 times as much altogether")
{
    const test::DeviceTest silence;
    ErrorCount plain, plainNear, skewed, skewedNear;
    for (const std::string name : {"colonnade", "bunny"}) {
        for (const Lamp& lamp :
             {Lamp{{0.0, 3.0, -6.0}, 20.0f}, Lamp{{4.0, 1.0, -7.0}, 20.0f}, Lamp{{-3.0, 0.5, -9.0}, 20.0f}}) {
            Stage stage(underLamp(name, lamp), kSize);
            const Drawn flat = draw(stage, "skewed_paraboloid", {{"skew", 0.0}}),
                        skew = draw(stage, "skewed_paraboloid");
            plain += pooled(stage, flat.pictures);
            skewed += pooled(stage, skew.pictures);
            const double lampDistance = glm::length(lamp.fromEye);
            std::vector<uint8_t> near = stage.counted[0];
            for (size_t i = 0; i < near.size(); ++i) {
                const double depth = stage.surfaces.depth.texels[i];
                const double distance = stage.scene().depth.nearPlane / depth; // reversed, infinite
                if (!(distance < lampDistance)) near[i] = 0;
            }
            plainNear += demo::compare(flat.pictures[0], stage.truth[0], near);
            skewedNear += demo::compare(skew.pictures[0], stage.truth[0], near);
            MESSAGE(name << ": " << inWords(pooled(stage, flat.pictures)) << " without, "
                         << inWords(pooled(stage, skew.pictures)) << " with");
        }
    }
    MESSAGE("near the eye " << inWords(plainNear) << " without, " << inWords(skewedNear) << " with; everywhere "
                            << inWords(plain) << " and " << inWords(skewed));
    CHECK(plainNear.counted > 50'000);
    CHECK(skewedNear.wrong() < plainNear.wrong());
    CHECK(double(skewed.wrong()) <= 1.2 * double(plain.wrong()));
}

namespace {

/// What a point light's maps are, warped or not.
struct Maps {
    const char* plain;  ///< The method whose maps they are, unwarped.
    double paraboloids; ///< The warps' setting.
    double mostShare;   ///< Of the plain maps' wrong pixels.
};

/// Whether a direction from the lamp comes within that share of a map's half side to its border.
bool isBeside(const glm::dvec3& away, double paraboloids, double share)
{
    const glm::dvec3 size = glm::abs(away);
    if (paraboloids != 0.0) return size.y <= share * glm::length(away);
    double sides[3] = {size.x, size.y, size.z};
    std::ranges::sort(sides);
    return sides[1] >= (1.0 - share) * sides[2];
}

/// Pixels whose receiver lies there, as seen from the lamp.
std::vector<uint8_t> besideBorders(const Stage& stage, double paraboloids, double share)
{
    std::vector<uint8_t> beside = stage.counted[0];
    const demo::CameraMatrices& camera = stage.camera;
    for (size_t i = 0; i < beside.size(); ++i) {
        const glm::dvec2 pixel(double(i % kSize.width) + 0.5, double(i / kSize.width) + 0.5);
        const double linear =
            double(camera.depthScale) / (double(stage.surfaces.depth.texels[i]) + double(camera.depthAdd));
        const glm::dvec3 ray =
            glm::dvec3(camera.rayCorner) + pixel.x * glm::dvec3(camera.rayDx) + pixel.y * glm::dvec3(camera.rayDy);
        const glm::dvec3 away = camera.eye + linear * ray - stage.scene().lights[0].position;
        if (!isBeside(away, paraboloids, share)) beside[i] = 0;
    }
    return beside;
}

} // namespace

// Navratil 2015, 4.2.6 and 5.3: a warp of its own for each face or paraboloid. Lamps in view, and beside and behind the
// eye.
TEST_CASE("maps of point lights that are warped are less wrong than plain ones, and nothing opens where they meet")
{
    const test::DeviceTest silence;
    constexpr const char* kWarps[] = {"rectilinear_warp", "nonorthogonal_warp"};
    for (const Maps& maps : {Maps{"cube_map", 0.0, 0.8}, Maps{"dual_paraboloid", 1.0, 0.5}}) {
        ErrorCount plain, plainBeside, warped[2], warpedBeside[2];
        for (const std::string name : {"colonnade", "bunny"}) {
            for (const Lamp& lamp : {Lamp{{0.0, 1.0, -6.0}, 20.0f}, Lamp{{-3.0, 2.0, 2.0}, 24.0f}}) {
                Stage stage(underLamp(name, lamp), kSize);
                const Settings coarse{{"resolution", 256.0}};
                const std::vector<uint8_t> beside = besideBorders(stage, maps.paraboloids, 0.05);
                const Pictures unwarped = stage.draw(maps.plain, coarse);
                const ErrorCount error = pooled(stage, unwarped);
                plain += error;
                plainBeside += demo::compare(unwarped[0], stage.truth[0], beside);
                std::string words = name + ": " + maps.plain + ' ' + inWords(error);
                for (size_t i = 0; i < 2; ++i) {
                    const Pictures pictures =
                        stage.draw(kWarps[i], {{"resolution", 256.0}, {"paraboloids", maps.paraboloids}});
                    const ErrorCount own = pooled(stage, pictures);
                    CHECK(own.wrong() < error.wrong());
                    warped[i] += own;
                    warpedBeside[i] += demo::compare(pictures[0], stage.truth[0], beside);
                    words += std::string(", ") + kWarps[i] + ' ' + inWords(own);
                }
                MESSAGE(words);
            }
        }
        CHECK(plainBeside.counted > 10'000);
        for (size_t i = 0; i < 2; ++i) {
            MESSAGE(std::string(kWarps[i])
                    << ": " << inWords(warped[i]) << " of " << std::string(maps.plain) << "'s " << inWords(plain)
                    << ", beside borders " << inWords(warpedBeside[i]) << " of " << inWords(plainBeside));
            CHECK(double(warped[i].wrong()) <= maps.mostShare * double(plain.wrong()));
            CHECK(warpedBeside[i].wrong() <= plainBeside.wrong());
        }
    }
}

// Pages end where faces meet; what filters read beyond is of the face's own projection.
TEST_CASE("a point light's pages are less wrong than six faces of the same memory, hardly more where faces meet")
{
    const test::DeviceTest silence;
    for (const double filter : {1.0, 5.0}) {
        CAPTURE(filter);
        ErrorCount faces, facesBeside, pages, pagesBeside;
        for (const std::string name : {"colonnade", "bunny"}) {
            for (const Lamp& lamp :
                 {Lamp{{0.0, 1.0, -6.0}, 20.0f}, Lamp{{-3.0, 2.0, 2.0}, 24.0f}, Lamp{{3.0, 0.5, -9.0}, 20.0f}}) {
                Stage stage(underLamp(name, lamp), kSize);
                const std::vector<uint8_t> beside = besideBorders(stage, 0.0, 0.05);
                const Pictures six = stage.draw("cube_map", {{"resolution", 418.0}, {"filter", filter}});
                const Pictures own = stage.draw("virtual_map", {{"resolution", 1024.0}, {"filter", filter}});
                MESSAGE(name << ", filter " << filter << ": cube_map " << inWords(pooled(stage, six))
                             << ", virtual_map " << inWords(pooled(stage, own)));
                faces += pooled(stage, six);
                pages += pooled(stage, own);
                facesBeside += demo::compare(six[0], stage.truth[0], beside);
                pagesBeside += demo::compare(own[0], stage.truth[0], beside);
            }
        }
        MESSAGE("filter " << filter << ": virtual_map " << inWords(pages) << " of cube_map's " << inWords(faces)
                          << ", beside borders " << inWords(pagesBeside) << " of " << inWords(facesBeside));
        CHECK(pages.counted == faces.counted);
        CHECK(pagesBeside.counted > 10'000);
        CHECK(pages.wrong() < faces.wrong());
        CHECK(pagesBeside.percent(pagesBeside.wrong()) <= 1.5 * facesBeside.percent(facesBeside.wrong()));
        CHECK(pages.meanAbsolute() < faces.meanAbsolute());
        CHECK(pagesBeside.meanAbsolute() <= 1.5 * facesBeside.meanAbsolute());
    }
}

TEST_CASE("a warped map is drawn once while view, light and casters stand still")
{
    const test::DeviceTest silence;
    Stage stage(underLamp("colonnade", {{0.0, 1.0, -6.0}, 20.0f}), {96, 64});
    for (const std::string warp : {"rectilinear_warp", "nonorthogonal_warp"}) {
        for (const double paraboloids : {0.0, 1.0}) {
            CAPTURE(warp);
            CAPTURE(paraboloids);
            const Settings settings{{"resolution", 128.0}, {"paraboloids", paraboloids}};
            Settings other = settings;
            other.push_back({"even", 0.5});
            (void)stage.draw(warp, other);
            const Pictures first = stage.draw(warp, settings);
            CHECK(casterPasses(stage, warp + ".casters") > 0);
            CHECK(casterPasses(stage, warp + ".importance") == 1);
            (void)stage.draw(warp, settings); // draws the maps in which the first saw no receiver
            CHECK(casterPasses(stage, warp + ".importance") == 0);
            const Pictures second = stage.draw(warp, settings);
            CHECK(casterPasses(stage, warp + ".casters") == 0);
            CHECK(casterPasses(stage, warp + ".importance") == 0);
            CHECK(casterPasses(stage, warp + ".resolve") == 1);
            CHECK(test::differences(first, second) == 0);
        }
    }
}

TEST_CASE("lamps in odd places and maps of 64 texels give pictures, not faults")
{
    const test::DeviceTest silence;
    const glm::dvec3 eye = shippedScene("colonnade").camera[0].eye;
    struct Place {
        std::string what;
        Lamp lamp;
        double mostWrong; // percent at 512 texels: twice the worst measured
    };
    const glm::dvec3 toOrigin = glm::transpose(axesOf(shippedScene("colonnade").camera[0])) * -eye;
    // All that a lamp a thousand kilometres away shadows is less than a texel, or one. A paraboloid may have that one
    // texel's answer everywhere.
    const double farBehind = 30.0, everything = 100.0;
    for (const Place& place :
         {Place{"at the eye", {{0.0, 0.0, 0.0}, 30.0f}, 1.1},
          Place{"on the near plane", {{0.0, 0.0, -0.1}, 30.0f}, 1.6},
          Place{"on its edge", {{0.05, 0.0, -0.1}, 30.0f}, 2.1}, Place{"ahead", {{0.0, 0.0, -5.0}, 30.0f}, 1.2},
          Place{"far behind", {{0.0, 0.0, 1e6}, 2e6f}, farBehind},
          Place{"in a caster", {toOrigin + axesOf(shippedScene("colonnade").camera[0])[1], 30.0f}, 2.9}}) {
        CAPTURE(place.what);
        Stage stage(underLamp("colonnade", place.lamp), {128, 128});
        for (const std::string method : {"cube_map", "dual_paraboloid", "improved_paraboloid", "skewed_paraboloid",
                                         "rectilinear_warp", "nonorthogonal_warp"}) {
            CAPTURE(method);
            const bool warps = method.ends_with("_warp");
            for (const auto& form : {std::pair{64.0, 0.0}, {512.0, 0.0}, {512.0, 1.0}}) {
                const double side = form.first, paraboloids = form.second;
                if (paraboloids != 0.0 && !warps) continue;
                Settings settings{{"resolution", side}};
                if (warps) settings.push_back({"paraboloids", paraboloids});
                const ErrorCount error = pooled(stage, stage.draw(method, settings));
                MESSAGE(place.what << ", " << method << " " << side << (paraboloids != 0.0 ? ", paraboloids: " : ": ")
                                   << inWords(error));
                const double most = place.mostWrong == farBehind && paraboloids != 0.0 ? everything : place.mostWrong;
                if (side > 64.0) CHECK(error.percent(error.wrong()) <= most);
            }
        }
    }
}

} // namespace gnomon::exact
