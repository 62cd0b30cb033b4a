// The rules of a window: exchanged while the scene runs, and what is refused changes nothing.
#include "host_fixture.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "demo/program/window_rules.hpp"
#include "rules/yaml/rule_base_reader.hpp"
#include "rules/yaml/shipped.hpp"

namespace gnomon::demo {
namespace {

constexpr const char* kRules = "version: 1\n"
                               "name: mine\n"
                               "variables:\n"
                               "  viewerDistance:\n"
                               "    universe: [0, 90]\n"
                               "    unit: m\n"
                               "    terms: {near: [-.inf, -.inf, 30, 60], far: [30, 60, .inf, .inf]}\n"
                               "rules:\n"
                               "  - {id: r1, rule: if viewerDistance is near then shadow_map is favoured}\n"
                               "  - {id: r2, rule: if viewerDistance is far then shadow_map is favoured}\n";

std::filesystem::path file()
{
    return std::filesystem::temp_directory_path() / "gnomon_window_rules.yaml";
}

void write(const std::string& text)
{
    std::ofstream(file()) << text;
}

} // namespace

TEST_CASE("the floor's quality changes in the text, in presets too, and nothing else does")
{
    const std::string text(rules::shippedRuleBase("default"));
    const Outcome<RuleText> changed = withFloorQuality({text, "default", {}}, 0.625);
    REQUIRE_MESSAGE(changed, changed.error());
    CHECK(rules::parseRuleBase(text, "default").base->policy.floor.minimumQuality != doctest::Approx(0.625));
    for (const char* preset : {"", "low", "ultra"})
        CHECK(rules::parseRuleBase(changed->text, "default", preset).base->policy.floor.minimumQuality ==
              doctest::Approx(0.625));
    std::istringstream before(text), after(changed->text);
    size_t different = 0, lines = 0;
    for (std::string was, is; std::getline(before, was) && std::getline(after, is); ++lines)
        if (was != is) {
            ++different;
            CHECK_MESSAGE(was.find("minimumQuality") != std::string::npos, was);
        }
    CHECK(different >= 2);
    CHECK(lines == size_t(std::count(text.begin(), text.end(), '\n')));

    const Outcome<RuleText> none = withFloorQuality({kRules, "mine.yaml", {}}, 0.5);
    CHECK(!none);
    CHECK_MESSAGE(none.error().find("mine.yaml") != std::string::npos, none.error());
}

TEST_CASE("a window's rules are exchanged, and those that cannot be used leave the last good ones in force")
{
    Session session(testDevice(), boxOnFloor(), {});
    write(kRules);
    uint32_t collected = 0;
    WindowRules rules(session.shadows, file().string(), [&] { ++collected; });
    REQUIRE(rules.base());
    CHECK(rules.inForce() == file().string());
    CHECK(rules.names().front() == file().string());
    CHECK(std::find(rules.names().begin(), rules.names().end(), "default:low") != rules.names().end());
    CHECK(rules.base()->policy.floor.when.empty());
    rules.setFloorQuality(0.5); // there is no floor
    CHECK_MESSAGE(rules.fault().find("minimumQuality") != std::string::npos, rules.fault());
    CHECK(rules.version() == 1);
    CHECK(collected == 0);

    rules.choose("quality");
    CHECK(rules.inForce() == "quality");
    CHECK(rules.fault().empty());
    CHECK(rules.version() == 2);
    CHECK(collected == 1);
    rules.setFloorQuality(0.25);
    CHECK(rules.fault().empty());
    CHECK(rules.base()->policy.floor.minimumQuality == doctest::Approx(0.25));
    rules.choose("no such base");
    CHECK_MESSAGE(rules.fault().find("no such base") != std::string::npos, rules.fault());
    CHECK(rules.inForce() == "quality");
    CHECK(rules.base()->policy.floor.minimumQuality == doctest::Approx(0.25));

    write(std::string(kRules) + "  - {id: r3, rule: if viewerDistance is nearr then shadow_map is avoided}\n");
    rules.choose(file().string());
    CHECK_MESSAGE(rules.fault().find("nearr") != std::string::npos, rules.fault());
    CHECK(rules.inForce() == "quality");
    // Superfluous: r1 says as much already.
    write(std::string(kRules) + "  - {id: r3, rule: if viewerDistance is near then shadow_map is favoured}\n");
    rules.choose(file().string());
    CHECK(rules.inForce() == file().string());
    CHECK(std::any_of(rules.findings().begin(), rules.findings().end(), [](const std::string& finding) {
        return finding.find("gnomon_window_rules.yaml:11") != std::string::npos; // the line of r3
    }));
    CHECK(rules.base()->rules.size() == 3);
    std::filesystem::remove(file());
    checkSilence();
}

} // namespace gnomon::demo
