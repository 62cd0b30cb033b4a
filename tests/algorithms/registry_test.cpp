// What every module owes: a place in the registry, its files, a page that names its settings, and traits that make
// sense.
#include <bit>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/registry.hpp"

using namespace gnomon;

namespace {

const std::filesystem::path kFolder = GNOMON_ALGORITHMS;

std::string textOf(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    REQUIRE_MESSAGE(file.good(), path.string());
    return {std::istreambuf_iterator<char>(file), {}};
}

/// shadow_map -> kShadowMap
std::string symbolOf(std::string_view name)
{
    std::string symbol = "k";
    bool upper = true;
    for (const char c : name) {
        if (c != '_') symbol += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        upper = c == '_';
    }
    return symbol;
}

} // namespace

TEST_CASE("every algorithm in the tree is in the registry, or known to be absent, and nothing is there twice")
{
    std::set<std::string> known;
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        CHECK(known.insert(symbolOf(algorithm.entry->name)).second);
    for (const AbsentAlgorithm& algorithm : builtinRegistry().absent) {
        CHECK(std::string(algorithm.needs).starts_with("GNOMON_WITH_"));
        CHECK(known.insert(symbolOf(algorithm.name)).second);
    }
    const std::regex definition("const AlgorithmEntry (k[A-Za-z0-9]+)\\{");
    std::size_t found = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(kFolder)) {
        if (file.path().extension() != ".cpp") continue;
        std::smatch match;
        const std::string text = textOf(file.path());
        if (!std::regex_search(text, match, definition)) continue;
        CAPTURE(file.path().string());
        CHECK(known.contains(match[1]));
        ++found;
    }
    CHECK(found == known.size());
}

TEST_CASE("every algorithm has its files, a source, sound traits, and a page that names its settings")
{
    for (const auto& [entry, family] : builtinRegistry().algorithms) {
        const std::string name = entry->name;
        CAPTURE(name);
        const std::filesystem::path stem = kFolder / family / name;
        CHECK(std::filesystem::exists(stem.string() + ".cpp"));
        const std::string page = textOf(stem.string() + ".md");
        CHECK(std::string_view(entry->source).size() > 3);
        CHECK((entry->traits & (GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT)) != 0);
        CHECK((entry->traits & (GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT)) != 0);
        CHECK((entry->create || entry->createPlugin));
        CHECK((entry->memoryPerLight || entry->bytesPerPixel > 0));
        CHECK((entry->maxRounds == 0 || entry->roundTrips > 0)); // further passes come after host passes
        CHECK(entry->typicalWrongPercent >= 0.0f);
        std::vector<double> defaults;
        for (const SettingSpec& setting : entry->settings)
            defaults.push_back(setting.standard);
        for (std::size_t i = 0; i < defaults.size(); ++i) {
            const SettingSpec& setting = entry->settings[i];
            CAPTURE(std::string(setting.name));
            if (entry->countsAs) CHECK(entry->countsAs(defaults, i) == setting.standard);
            CHECK(page.find("`" + std::string(setting.name) + "`") != std::string::npos);
            CHECK(std::string_view(setting.description).size() > 10);
            CHECK(setting.minimum <= setting.standard);
            CHECK(setting.standard <= setting.maximum);
        }
    }
}

namespace {

/// Device bytes of a light whose maps have 1024 texels a side, all else by default but for one setting.
VkDeviceSize bytesAt1024(std::string_view method, GnLightType type, std::string_view setting = {}, double value = 0.0)
{
    for (const auto& [entry, family] : builtinRegistry().algorithms) {
        if (entry->name != method) continue;
        std::vector<double> settings;
        for (const SettingSpec& spec : entry->settings)
            settings.push_back(spec.name == std::string_view("resolution") ? 1024.0
                               : spec.name == setting                      ? value
                                                                           : spec.standard);
        return entry->memoryFor(settings, {1280, 720}, type);
    }
    FAIL("no such method");
    return 0;
}

} // namespace

// Navratil 2015, 3.3.3 (24 and 8 MB) and 5.4.2 (20 MB, which are the map and four images of its size).
TEST_CASE(
    "a cube is six images, two paraboloids a third of that, and a warp takes less than four images beside its map")
{
    constexpr VkDeviceSize kMap = 4 * 1024 * 1024, kStatics = 2; // a copy of what stands still
    CHECK(bytesAt1024("shadow_map", GN_LIGHT_TYPE_SPOT) == kStatics * kMap);
    CHECK(bytesAt1024("cube_map", GN_LIGHT_TYPE_POINT) == kStatics * 6 * kMap);
    CHECK(bytesAt1024("dual_paraboloid", GN_LIGHT_TYPE_POINT) == kStatics * 2 * kMap);
    for (const char* warp : {"rectilinear_warp", "nonorthogonal_warp"}) {
        CAPTURE(std::string(warp));
        const VkDeviceSize spot = bytesAt1024(warp, GN_LIGHT_TYPE_SPOT);
        CHECK(spot > kMap);
        CHECK(spot <= 5 * kMap);
        const VkDeviceSize cube = bytesAt1024(warp, GN_LIGHT_TYPE_POINT, "paraboloids", 0.0),
                           discs = bytesAt1024(warp, GN_LIGHT_TYPE_POINT, "paraboloids", 1.0);
        CHECK(cube <= 6 * spot);
        CHECK(discs <= 2 * spot);
        CHECK(2 * discs <= cube); // what is pooled is rounded up
    }
}

TEST_CASE("the table of the theses' systems names every method with a thesis as its source, and none that there is not")
{
    const std::string page = textOf(kFolder.parent_path() / "docs" / "theses.md");
    std::set<std::string> known;
    for (const auto& [entry, family] : builtinRegistry().algorithms) {
        known.insert(entry->name);
        const std::string source = entry->source;
        for (const std::string thesis : {"Rautenbach", "Moderno", "Morais", "Navratil", "Macedo"}) {
            if (source.find(thesis) == std::string::npos) continue;
            CAPTURE(source);
            const std::size_t begin = page.find("\n## " + thesis);
            REQUIRE(begin != std::string::npos);
            const std::string part = page.substr(begin, page.find("\n## ", begin + 1) - begin);
            const std::string link = "[`" + std::string(entry->name) + "`](../algorithms/" + family + "/";
            CHECK_MESSAGE(part.find(link) != std::string::npos, link);
        }
    }
    for (const AbsentAlgorithm& algorithm : builtinRegistry().absent)
        known.insert(std::string(algorithm.name));
    const std::regex module(R"(\[`([a-z_]+)`\]\(\.\./algorithms/([a-z]+)/([a-z_]+)\.md\))");
    std::size_t links = 0;
    for (std::sregex_iterator at(page.begin(), page.end(), module); at != std::sregex_iterator(); ++at, ++links) {
        CHECK_MESSAGE(known.contains((*at)[1]), (*at)[1]);
        CHECK((*at)[1] == (*at)[3]);
    }
    CHECK(links > known.size());
    // A row is a system, a module, a test and a figure; none is empty.
    const std::regex row(
        R"(\n\|[^|\n]*[^|\s][^|\n]*\|[^|\n]*\]\([^|\n]*\|[^|\n]*`[a-z_]+`[^|\n]*\|[^|\n]*[^|\s][^|\n]*\|)");
    const std::regex any(R"(\n\|(?! (system|---) ))");
    const auto count = [&](const std::regex& what) {
        return std::distance(std::sregex_iterator(page.begin(), page.end(), what), std::sregex_iterator());
    };
    CHECK(count(row) == count(any));
}
