// What the table of methods says when settings cannot be used as they are asked for.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/scene_fixture.hpp"
#include "runtime/select/methods.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::array kSettings = {SettingSpec{"strength", "Of what it does, up to the limit.", 0, 100, 40},
                                  SettingSpec{"limit", "Of the strength; 0: none.", 0, 100, 0}};

/// One method, and what is said of its settings.
struct Settings {
    SceneFixture scene;
    SamplerSet samplers{scene.stub.table};
    PipelineStore pipelines{scene.stub.table, *scene.memory, samplers};
    const AlgorithmEntry entry{.name = "limited",
                               .source = "this test",
                               .settings = kSettings,
                               .create = [](const AlgorithmServices&) { return std::unique_ptr<ShadowAlgorithm>(); },
                               .countsAs =
                                   [](std::span<const double> settings, std::size_t index) {
                                       const bool limited = index == 0 && settings[1] > 0.0;
                                       return limited ? std::min(settings[0], settings[1]) : settings[index];
                                   }};
    MethodTable methods{scene.stub.table, pipelines, *scene.jobs, scene.messages, false};

    Settings() { REQUIRE(methods.addEntry(entry)); }

    /// The texts that a call of set() leaves. All of them are warnings of one id.
    std::vector<std::string> afterSetting(const char* setting, double value)
    {
        REQUIRE(methods.set("limited", setting, value, 1));
        std::vector<std::string> texts;
        for (const auto& said : scene.said()) {
            CHECK(said.severity == GN_SEVERITY_WARNING);
            CHECK(said.id == "SettingClamped");
            texts.push_back(said.text);
        }
        return texts;
    }
};

using Texts = std::vector<std::string>;

} // namespace

TEST_CASE("a setting that counts as less is said once, with its name, what was asked for and what is in use")
{
    Settings of;
    CHECK(of.afterSetting("limit", 5.54f).empty()); // nobody has asked for the default strength
    const Texts clamped{"limited.strength is 12.5, which counts as 5.54 beside the other settings"};
    CHECK(of.afterSetting("strength", 12.5) == clamped);
    CHECK(of.afterSetting("strength", 12.5).empty());
    CHECK(of.afterSetting("strength", 5).empty());
    CHECK(of.afterSetting("strength", 12.5) == clamped);
    CHECK(of.methods[0].settings[0] == 12.5); // as asked for: another limit brings it back
    CHECK(of.afterSetting("limit", 0).empty());
}

TEST_CASE("a setting that was asked for is said when another one makes it count as less, and again as something else")
{
    Settings of;
    CHECK(of.afterSetting("strength", 40).empty()); // the default, but asked for
    CHECK(of.afterSetting("limit", 30) ==
          Texts{"limited.strength is 40, which counts as 30 beside the other settings"});
    CHECK(of.afterSetting("limit", 30).empty());
    CHECK(of.afterSetting("limit", 20) ==
          Texts{"limited.strength is 40, which counts as 20 beside the other settings"});
    CHECK(of.afterSetting("limit", 50).empty());
}

TEST_CASE("a refused value is an error alone")
{
    Settings of;
    CHECK(of.afterSetting("limit", 10).empty());
    const Result<void> refused = of.methods.set("limited", "strength", 200.0, 1);
    REQUIRE(!refused);
    CHECK(refused.error().id == std::string("SettingOutOfRange"));
    CHECK(of.scene.said().empty());
    CHECK(of.methods[0].settings[0] == 40.0);
}
