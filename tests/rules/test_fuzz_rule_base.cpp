#include "yaml_support.hpp"

#include <cstdint>

#include "rules/yaml/shipped.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

namespace {

void feed(const std::string& text)
{
    LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(text.data()), text.size());
}

/// One of the small injuries that text files suffer.
std::string injured(std::string text, Random& random)
{
    constexpr std::string_view kPieces[] = {
        "[",    "]",    "{",      "}",  ": ",    "\n",   "- ",       "'",   "\"",     "&a ",  "*a",    "!!int",
        ".inf", "not",  "(",      ")",  "1e308", "-",    "never",    "any", "with",   "0.5",  "\t",    "#",
        "|\n",  ">-\n", "1e-320", "? ", "---\n", "%TAG", "\xf0\x9f", "\r",  "others", "<<: ", "\\x41", "~"};
    const std::size_t at = text.empty() ? 0 : random.below(static_cast<uint32_t>(text.size()));
    const std::size_t length = 1 + random.below(12);
    switch (random.below(5)) {
    case 0:
        return text.erase(at, length);
    case 1:
        return text.insert(at, kPieces[random.below(static_cast<uint32_t>(std::size(kPieces)))]);
    case 2:
        return text.insert(at, text.substr(random.below(static_cast<uint32_t>(text.size() + 1)), 4 * length));
    case 3:
        text.resize(at);
        return text;
    default:
        if (!text.empty()) text[at] = static_cast<char>(random.below(256));
        return text;
    }
}

} // namespace

TEST_CASE("thousands of injured rule bases are read or refused, and what is read is evaluated sanely")
{
    Random random(51);
    for (const ShippedRuleBase& shipped : shippedRuleBases()) {
        feed(std::string(shipped.text));
        for (int i = 0; i < 3000; ++i) {
            std::string text(shipped.text);
            for (uint32_t wounds = 1 + random.below(4); wounds > 0; --wounds)
                text = injured(std::move(text), random);
            feed(text);
        }
    }
}

TEST_CASE("texts that hurt parsers before are refused quickly")
{
    for (const std::string& text :
         {std::string(), std::string(1000, '{'), std::string(100'000, '['), std::string(100'000, '-') + " ",
          std::string(1000, '\0'), std::string("\xef\xbb\xbf"), std::string("version: 1\nrules: [{rule: ''}]"),
          "version: 1\nvariables: {x: {universe: [0, 1], terms: {}}}\nrules: [{rule: '" + std::string(4000, '(') +
              "'}]",
          std::string("{? : }"), std::string("? ? ? ? a"), std::string("--- |\n"), std::string("%YAML 9.9\n---\na: 1")})
        feed(text);
}
