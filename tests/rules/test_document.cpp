#include "yaml_support.hpp"

#include "rules/yaml/document.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;
namespace yaml = gnomon::yaml;

namespace {

/// "R03 2:1" for a text that is refused, "" for one that is accepted.
std::string refusal(std::string_view text, const yaml::Limits& limits = {})
{
    DiagnosticSink sink("doc.yaml");
    const auto document = yaml::parse(text, limits, sink);
    CHECK(document.has_value() == sink.all().empty());
    if (document) return "";
    const Diagnostic& d = sink.all().front();
    return d.id + " " + std::to_string(d.line) + ":" + std::to_string(d.column);
}

} // namespace

TEST_CASE("a text that is not one plain YAML document is refused with a place")
{
    CHECK(refusal("a: 1\nb: [1, 2]\n") == "");
    CHECK(refusal("") == "R01 1:1");
    CHECK(refusal("a: [1, 2").substr(0, 3) == "R01");
    CHECK(refusal("a: 1\n\tb: 2\n").substr(0, 3) == "R01");
    CHECK(refusal("a: &x 1\nb: *x\n") == "R02 1:4");
    CHECK(refusal("a: 1\nb: *x\n").substr(0, 3) == "R01"); // no such anchor: yaml-cpp is first
    CHECK(refusal("a: !!float 1\n") == "R02 1:4");
    CHECK(refusal("a: 1\nb: 2\na: 3\n") == "R03 3:1");
    CHECK(refusal("x:\n  a: 1\n  a: 3\n") == "R03 3:3");
    CHECK(refusal("? [1]\n: 2\n") == "R01 1:3");
    CHECK(refusal("a: 1\n---\nb: 2\n").substr(0, 3) == "R01");
    CHECK(refusal(std::string_view("a: 1\0b", 6)) == "R01 1:5");
    CHECK(refusal("a: \x04") == "R01 1:4"); // yaml-cpp would take it for the end
    CHECK(refusal("\xff\xfe"
                  "a") == "R01 1:1"); // UTF-16
    CHECK(refusal("\xef\xbb\xbf"
                  "a: 1\n") == ""); // UTF-8 with a mark
}

TEST_CASE("what is not UTF-8 is refused at the byte: lone bytes, overlong forms, surrogates, beyond U+10FFFF")
{
    for (const char* good : {"\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80", "\xf0\x90\x80\x80",
                             "\xf4\x8f\xbf\xbf"})
        CHECK(refusal("a: \"" + std::string(good) + "\"\n") == "");
    for (const char* bad : {"\x80", "\xc3", "\xc0\xaf", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xe2\x82",
                            "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"}) {
        CHECK(refusal("a: 1\nb: \"x" + std::string(bad) + "\"\n") == "R01 2:6");
        CHECK(refusal("a: " + std::string(bad)) == "R01 1:4"); // cut off by the end, too
    }
}

TEST_CASE("size, depth and number of values are bounded")
{
    CHECK(refusal(std::string(101, ' '), {.bytes = 100}).substr(0, 3) == "R07");
    CHECK(refusal("[[[1]]]", {.depth = 2}) == "R07 1:3");
    CHECK(refusal("[[[1]]]", {.depth = 3}) == "");
    CHECK(refusal("[1, 2, 3]", {.nodes = 3}) == "R07 1:8");
    CHECK(refusal(std::string(100'000, '[')) != ""); // not a stack overflow
}

TEST_CASE("numbers are plain scalars in one spelling, infinities included")
{
    DiagnosticSink sink("doc.yaml");
    const auto document = yaml::parse(
        "[1, -0.5, +2, 1e3, .inf, -.inf, '1', nan, inf, .nan, 0x10, +-5, ++5, -+5, 1_000, 1., ~, 1 2]", {}, sink);
    REQUIRE(document.has_value());
    const double expected[] = {1, -0.5, 2, 1000, kInf, -kInf};
    const auto& items = document->root.items;
    for (std::size_t i = 0; i < items.size(); ++i) {
        CAPTURE(items[i].text);
        const std::optional<double> value = yaml::numberOf(items[i]);
        if (i < std::size(expected))
            CHECK(value == expected[i]);
        else
            CHECK(value.has_value() == (items[i].text == "1."));
    }
}

TEST_CASE("a place inside a scalar is found through quotes, escapes, folding and blocks")
{
    const std::string_view text = "plain: one two\n"
                                  "single: 'it''s two'\n"
                                  "double: \"a \\\"b\\\" two\"\n"
                                  "folded: one\n"
                                  "  and two\n"
                                  "block: >-\n"
                                  "  one\n"
                                  "  and two\n"
                                  "literal: |\n"
                                  "  one\n"
                                  "  two\n";
    DiagnosticSink sink("doc.yaml");
    const auto document = yaml::parse(text, {}, sink);
    REQUIRE(document.has_value());
    const auto spotOfTwo = [&](std::string_view key) {
        const yaml::Node* node = document->root.find(key);
        REQUIRE(node);
        return document->spotInside(*node, node->text.find("two"));
    };
    CHECK(spotOfTwo("plain") == SourceSpot{1, 12});
    CHECK(spotOfTwo("single") == SourceSpot{2, 16});
    CHECK(spotOfTwo("double") == SourceSpot{3, 18});
    CHECK(spotOfTwo("folded") == SourceSpot{5, 7});
    CHECK(spotOfTwo("block") == SourceSpot{8, 7});
    CHECK(spotOfTwo("literal") == SourceSpot{11, 3});
    const yaml::Node& plain = *document->root.find("plain");
    CHECK(document->spotInside(plain, plain.text.size()) == SourceSpot{1, 15}); // just behind the end
}

TEST_CASE("a finder goes back where it must, and tells the same places as from the beginning")
{
    DiagnosticSink sink("doc.yaml");
    const auto document = yaml::parse("a: 1\nb: \"one \\x41 two\"\nc: 'it''s\n  two'\n", {}, sink);
    REQUIRE(document.has_value());
    for (const char* key : {"b", "c"}) {
        const yaml::Node& scalar = *document->root.find(key);
        yaml::SpotFinder finder(*document, scalar);
        for (const std::size_t offset : {0, 2, 2, 5, 8, 6, 1, 7})
            CHECK(finder.spotOf(offset) == document->spotInside(scalar, offset));
    }
    CHECK(document->spotInside(*document->root.find("b"), 2) == SourceSpot{2, 7});
    CHECK(document->spotInside(*document->root.find("b"), 6) == SourceSpot{2, 4}); // behind \x41: the scalar's own
}

TEST_CASE("a map reader reports unknown keys, missing ones and wrong kinds at their places")
{
    DiagnosticSink sink("doc.yaml");
    const auto document = yaml::parse("name: [1]\ncount: 2.5\nshare: 7\nodd: 1\n", {}, sink);
    REQUIRE(document.has_value());
    static constexpr yaml::Shape kCount = yaml::whole(0, 10), kShare = yaml::number({.low = 0, .high = 1});
    static constexpr yaml::Key kKeys[] = {
        {"name", &yaml::kText}, {"count", &kCount}, {"share", &kShare}, {"missing", &yaml::kText, {}, true}};
    constexpr yaml::Shape kThing = yaml::map(kKeys);
    yaml::MapReader map(document->root, kThing, "a thing", sink);
    std::string name = "unchanged";
    uint32_t count = 9;
    double share = 0.5;
    map.text("name", name);
    map.count("count", count);
    map.number("share", share);
    CHECK(map.find("missing") == nullptr);
    CHECK(name == "unchanged");
    CHECK(count == 9);
    CHECK(share == 0.5);
    std::string all;
    for (const Diagnostic& d : sink.all())
        all += toText(d) + "\n";
    CHECK(all == "doc.yaml:1:1: error: a thing needs a key 'missing' [R04]\n"
                 "doc.yaml:4:1: error: a thing has no key 'odd'; known: name, count, share, missing [R04]\n"
                 "doc.yaml:1:7: error: 'name' must be a text, found a list [R04]\n"
                 "doc.yaml:2:8: error: 'count' must be a whole number, found '2.5' [R05]\n"
                 "doc.yaml:3:8: error: 'share' must be a number from 0 to 1, found '7' [R05]\n");
}
