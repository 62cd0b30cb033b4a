// Edits of `default` as a technical artist makes them by mistake: each is one finding, and that says how to correct it.
#include "yaml_support.hpp"

#include "rules/engine/lint.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

struct Edit {
    const char* what;
    const char* from; ///< Stands in default.yaml.
    const char* to;
    const char* id;
    const char* says; ///< Part of the message.
};

constexpr const char* kSpeck = "if viewerDistance is near and screenShare is speck\n";
constexpr const char* kFavours = "ray_traced is favoured and stencil_volume is acceptable and pcf_hybrid is acceptable";
constexpr const char* kBehindN4 = "  - id: N5\n";

const Edit kEdits[] = {
    {"a typo in a variable", kSpeck, "if viewerDistanec is near and screenShare is speck\n", "L01",
     "unknown variable 'viewerDistanec'; did you mean 'viewerDistance'?"},
    {"a typo in a term", kSpeck, "if viewerDistance is nera and screenShare is speck\n", "L01",
     "'viewerDistance' has no term 'nera'; did you mean 'near'? Known: near, far"},
    {"another unit", "    unit: m\n    terms:\n      near", "    unit: km\n    terms:\n      near", "L01",
     "'viewerDistance' is in 'm', not in 'km'"},
    {"per cent", "speck: [-.inf, -.inf, 0.01, 0.05]", "speck: [-.inf, -.inf, 1, 5]", "L06",
     "a share goes from 0 to 1: for 5 % write 0.05"},
    {"a contradiction", kBehindN4,
     "  - id: N4b\n    rule: \"if viewerDistance is near and screenShare is speck then ray_traced is avoided\"\n"
     "  - id: N5\n",
     "L04", "rules 'N4' and 'N4b' favour and avoid ray_traced at once, with strength 1.00; give the exception a"},
    {"a hole", "far: [30, 60, .inf, .inf]", "far: [70, 80, .inf, .inf]", "L06",
     "hole at 60: the best membership there is 0.00; let 'far' rise where 'near' falls, from 30 to 60"},
    {"a missing term", "      far: [30, 60, .inf, .inf]\n", "", "L01", "'viewerDistance' has no term 'far'"},
    {"a typo in a key", "\npolicy:\n", "\npolcy:\n", "R04", "has no key 'polcy'; did you mean 'policy'?"},
    {"a comparison", kSpeck, "if viewerDistance < 30 and screenShare is speck\n", "R06",
     "rules compare no numbers: write 'viewerDistance is TERM'"},
    {"an unknown method", kFavours,
     "ray_traced is favoured and stencil_volumes is acceptable and pcf_hybrid is acceptable", "L01",
     "unknown output 'stencil_volumes'; did you mean 'stencil_volume'?"},
    {"a rule twice", kBehindN4,
     "  - id: N4b\n    rule: \"if viewerDistance is near and screenShare is speck then ray_traced is favoured and "
     "stencil_volume is acceptable and pcf_hybrid is acceptable\"\n  - id: N5\n",
     "L05", "rule 'N4b' says the same as rule 'N4'; remove one of them"},
    {"a concept that hangs on itself", "\nsuitability:\n", "\nconcepts:\n  work: [light]\n\nsuitability:\n", "R08",
     "closed by rule 'CY1'; take 'work' out of that rule's condition"},
};

std::string edited(const Edit& edit)
{
    std::string text(shippedRuleBase("default"));
    const std::size_t at = text.find(edit.from);
    REQUIRE_MESSAGE(at != std::string::npos, edit.what);
    text.replace(at, std::string_view(edit.from).size(), edit.to);
    if (std::string_view(edit.id) == "R08")
        text.insert(text.find(kBehindN4), "  - {id: CY1, rule: \"if work is light then work is light\"}\n");
    return text;
}

/// All that `gnomon lint` prints.
std::vector<Diagnostic> findingsOf(const std::string& text)
{
    ParseResult parsed = parseRuleBase(text, "edited.yaml");
    std::vector<Diagnostic> all = std::move(parsed.diagnostics);
    const std::vector<Diagnostic> more = parsed.base      ? lint(*parsed.base, vocabulary())
                                         : parsed.remains ? Engine::bind(*parsed.remains, vocabulary()).diagnostics
                                                          : std::vector<Diagnostic>();
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

} // namespace

TEST_CASE("each mistake of an artist is one finding that says how to correct it")
{
    CHECK(findingsOf(std::string(shippedRuleBase("default"))).empty());
    for (const Edit& edit : kEdits) {
        CAPTURE(edit.what);
        const std::vector<Diagnostic> found = findingsOf(edited(edit));
        for (const Diagnostic& finding : found)
            CAPTURE(toText(finding));
        REQUIRE(found.size() == 1);
        CAPTURE(toText(found[0]));
        CHECK(found[0].id == edit.id);
        CHECK(found[0].message.find(edit.says) != std::string::npos);
    }
}

TEST_CASE("a malformed sentence does not hide what is wrong elsewhere")
{
    std::string text(shippedRuleBase("default"));
    text.replace(text.find(kSpeck), std::string_view(kSpeck).size(), "if viewerDistance near\n");
    text.replace(text.find("then pcf_hybrid is favoured"), 27, "then pcf_hybrit is favoured");
    const std::vector<Diagnostic> found = findingsOf(text);
    REQUIRE(found.size() == 2);
    CHECK(found[0].id == "R06");
    CHECK(found[1].message.find("'pcf_hybrit'; did you mean 'pcf_hybrid'?") != std::string::npos);
}

TEST_CASE("suggestions are a slip away, in long names two, and never another word")
{
    const std::vector<std::string_view> known = {"near", "far", "shadow_map", "cube_map"};
    CHECK(suggestion("nera", known).starts_with("; did you mean 'near'?"));
    CHECK(suggestion("shadow_maps", known).starts_with("; did you mean 'shadow_map'?"));
    CHECK(suggestion("shdaow_mapp", known).starts_with("; did you mean 'shadow_map'?"));
    CHECK(suggestion("middle", known) == "; known: near, far, shadow_map, cube_map");
    CHECK(suggestion("", known).find("did you mean") == std::string::npos);
    CHECK(suggestion("x", {}).empty());
    const std::vector<std::string_view> many = {"near", "b01", "b02", "b03", "b04", "b05", "b06",
                                                "b07",  "b08", "b09", "b10", "b11", "b12"};
    CHECK(suggestion("nera", many) == "; did you mean 'near'?"); // no list to look through
    CHECK(suggestion("middle", many).starts_with("; known: near, b01, "));
    CHECK(suggestion("middle", many).ends_with(", b12"));
}
