#pragma once
// A scene set up once on a validated device, asked for the visibility of one method after another, with the truth
// beside it. Methods and settings change from frame to frame within one context, as they do under the rules.
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "demo/program/error_count.hpp"
#include "demo/program/session.hpp"
#include "device/fixture.hpp"

namespace gnomon::exact {

using demo::ErrorCount;
using demo::Image8;
using demo::LightKind;
using demo::Scene;

struct Setting {
    const char* name;
    double value;
};
using Settings = std::vector<Setting>;

/// One picture per present light; a light that the method does not serve has an empty one.
using Pictures = std::vector<Image8>;

/// What is seen of a scene at one time, and the truth, per present light in layer order.
struct Seen {
    Pictures truth;
    std::vector<std::vector<uint8_t>> counted; ///< countedPixels(): 1 counted, 2 grazing.
    demo::FrameSurfaces surfaces;
    demo::CameraMatrices camera;
    demo::SceneState state;
};

class Stage : public Seen {
public:
    explicit Stage(Scene scene, VkExtent2D extent, double time = 0.0);

    /// Another time of the scene; the truth and what goes with it are of that time from then on.
    void goTo(double time);

    /// One frame with the method pinned wherever it serves; settings not named have their defaults.
    Pictures draw(const std::string& method, const Settings& settings = {});
    std::vector<GnMethodInfo> methods() const;
    const Scene& scene() const { return scene_; }
    demo::Session& session() { return session_; }

    std::vector<uint32_t> present; ///< Lights, in layer order.

private:
    bool served(const std::string& method); ///< By the newest frame, every light that it can serve.
    void apply(const std::string& method, const Settings& settings);
    void pin(const std::string& method);

    Scene scene_;
    double time_ = 0.0;
    demo::Session session_;
    std::map<std::string, std::vector<std::pair<std::string, double>>> defaults_;
    std::map<std::string, GnTraits> traits_;
    std::set<std::string> warm_;
};

/// 640x360; 1280x720, for which the bounds are meant, where $GNOMON_TEST_FULL is set (tests/matrix.sh full).
VkExtent2D testSize();
/// What a bound on wrong pixels along edges comes to in such pictures: half the width has twice the share of them.
double edgePercent(double at1280);

/// Shipped by name; fails the test where it cannot be loaded.
Scene shippedScene(const std::string& name);
/// All but those that are another one's lights in another order.
const std::vector<std::string>& sceneNames();

bool serves(GnTraits traits, LightKind kind);

/// A setting's default, map sides as they are at 1024; `otherwise` where the method has no such setting.
double defaultOf(const std::string& method, std::string_view setting, double otherwise);

/// Whether the newest frame's light is served by the method that it is pinned to.
bool servedByPin(const demo::Session& session, uint32_t light, const std::string& method);

/// \param onlyKinds Lights of these kinds; traits as in GnMethodInfo.
ErrorCount pooled(const Stage& stage, const Pictures& pictures, GnTraits onlyKinds = ~GnTraits(0));

/// Wrong pixels of a layer that have a clear answer: neither ambiguous (ambiguity.hpp) nor grazing.
uint64_t clearlyWrong(const Scene& scene, const Seen& seen, const Image8& picture, size_t layer);

/// "0.0123 % of 45678 (lit 3, shadow 2)".
std::string inWords(const ErrorCount& error);
std::string percentText(double percent);

/// Kinds as traits, and their names.
struct KindOfLight {
    LightKind kind;
    GnTraits trait;
};
inline constexpr KindOfLight kKinds[] = {{LightKind::Directional, GN_TRAIT_DIRECTIONAL_BIT},
                                         {LightKind::Spot, GN_TRAIT_SPOT_BIT},
                                         {LightKind::Point, GN_TRAIT_POINT_BIT}};

} // namespace gnomon::exact
