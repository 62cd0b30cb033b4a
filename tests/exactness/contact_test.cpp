// Contact shadows from the depth image: what maps of few texels lose where a caster stands on its receiver, and that
// nothing else is darkened.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/brute_stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{240, 180};
constexpr double kContactWs = 0.1;
constexpr double kSide = 1.0; // of the crate, metres

/// A crate on a floor, seen from the side of its shadow. \param aside it stands half beyond the picture's border
Scene crateScene(LightKind kind, bool aside)
{
    Scene scene = softScene(Caster::sphere, kind, 1.9, 0.0f);
    place(scene, "crate", demo::makeBox({.size = glm::vec3(kSide)}), {0.3, 0.5 * kSide, 0.4});
    scene.camera = {{.eye = {2.4, 1.3, 0.6}, .target = {0.8, 0.2, aside ? -1.0 : 0.2}}};
    return scene;
}

/// Of all methods that have the setting.
std::vector<std::string> contactMethods(const Stage& stage)
{
    std::vector<std::string> names;
    for (const GnMethodInfo& method : stage.methods())
        for (const GnSettingInfo& setting : std::span(method.pSettings, method.settingCount))
            if (std::string_view(setting.pName) == "contact") names.emplace_back(method.pName);
    return names;
}

struct Count {
    uint64_t near = 0;     ///< Pixels of the floor whose ray meets the crate within kContactWs.
    uint64_t wrong = 0;    ///< Of these.
    uint64_t darkened = 0; ///< Pixels anywhere that are dark where the truth and the map are lit.
    uint64_t lit = 0;      ///< Of so many.
};

Count count(const Stage& stage, const Image8& picture, const Image8& map)
{
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, 0);
    const brute::Scene casters(bruteTriangles(stage));
    const Image8& truth = stage.truth[0];
    Count count;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const auto at = static_cast<size_t>(y * view.width + x);
            const auto ux = static_cast<uint32_t>(x), uy = static_cast<uint32_t>(y);
            if (stage.counted[0][at] != 1) continue;
            count.lit += truth.texels[at] == 255;
            count.darkened += truth.texels[at] == 255 && map.texels[at] == 255 && picture.texels[at] == 0;
            if (truth.texels[at] != 0) continue;
            const brute::Answer answer = brute::answerAt(view, light, casters, x, y, *stage.surfaces.depth.at(ux, uy),
                                                         drawnNormal(stage, ux, uy));
            const glm::dvec3 p = answer.receiver;
            const double dx = std::abs(p.x - 0.3) - 0.5 * kSide, dz = std::abs(p.z - 0.4) - 0.5 * kSide;
            if (std::abs(p.y) > 0.01 || std::max(dx, dz) > kContactWs || std::max(dx, dz) < 0.0) continue;
            ++count.near;
            count.wrong += picture.texels[at] != 0;
        }
    }
    return count;
}

} // namespace

TEST_CASE("contact shadows halve the error of coarse maps where casters stand, and darken nothing that is lit")
{
    const test::DeviceTest silence;
    for (const KindOfLight& kind : kKinds) {
        for (const bool aside : {false, true}) {
            if (aside && kind.kind == LightKind::Spot) continue; // the same methods as of the sun
            Stage stage(crateScene(kind.kind, aside), kSize);
            const std::vector<std::string> methods = contactMethods(stage);
            CHECK(methods.size() >= 15); // all with maps of depths or of moments
            for (const std::string& method : methods) {
                const double side =
                    kind.kind == LightKind::Directional ? 512.0 : 64.0; // the sun's covers all of the floor
                const Image8 map = stage.draw(method, {{"resolution", side}})[0];
                if (map.width == 0) continue;
                const Image8 both = stage.draw(method, {{"resolution", side}, {"contact", 0.2}})[0];
                const Count before = count(stage, map, map), after = count(stage, both, map);
                MESSAGE(method << " " << std::string(demo::nameOf(kind.kind)) << ": wrong " << before.wrong << " of "
                               << before.near << ", with contact " << after.wrong << "; darkened " << after.darkened
                               << " of " << after.lit);
                CHECK(after.darkened * 1000 <= after.lit);
                if (aside) continue; // what is not seen hides nothing
                CHECK(before.near > 200);
                // Half, or hardly any: maps of dense texels have few wrong ones themselves.
                CHECK(after.wrong <= std::max(before.wrong / 2, before.near / 200));
            }
        }
    }
}

} // namespace gnomon::exact
