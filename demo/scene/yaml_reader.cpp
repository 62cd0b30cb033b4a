#include "demo/scene/yaml_reader.hpp"

#include "demo/io/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gnomon::demo {
namespace {

// No scene is larger than this (metres, or whatever the unit): sums and squares stay finite in single precision.
constexpr double kLargest = 1e12;

std::string numberText(double value)
{
    std::string text;
    appendNumber(text, value);
    return text;
}

std::string describe(const Range& range)
{
    const bool below = range.high < std::numeric_limits<double>::infinity();
    const bool above = range.low > -std::numeric_limits<double>::infinity();
    std::string text;
    if (above) text += (range.lowOpen ? "> " : ">= ") + numberText(range.low);
    if (above && below) text += " and ";
    if (below) text += (range.highOpen ? "< " : "<= ") + numberText(range.high);
    return text;
}

bool contains(const Range& range, double value)
{
    return (range.lowOpen ? value > range.low : value >= range.low) &&
           (range.highOpen ? value < range.high : value <= range.high);
}

const std::string& scalar(const ReadContext& context, const YamlNode& node, const std::string& name,
                          const char* expected)
{
    if (node.kind != YamlNode::Kind::Scalar)
        raise(context, node, name + " must be " + expected + ", got " + node.kindName());
    return node.text;
}

} // namespace

void raise(const ReadContext& context, const YamlNode& at, const std::string& message)
{
    const std::string subject = context.subject.empty() ? "" : context.subject + ": ";
    throw SceneError(positioned(context.file, at.line, at.column, subject + message));
}

double readNumber(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range)
{
    const std::string& text = scalar(context, node, name, "a number");
    const std::optional<double> value = node.quoted ? std::nullopt : parseNumber(text);
    if (!value) raise(context, node, name + " must be a finite number, got '" + text + "'");
    if (!contains(range, *value)) raise(context, node, name + " must be " + describe(range) + ", got " + text);
    if (std::abs(*value) > kLargest)
        raise(context, node, name + " must be at most " + numberText(kLargest) + " in size, got " + text);
    return *value;
}

float readFloat(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range)
{
    const auto value = static_cast<float>(readNumber(context, node, name, range));
    // A tiny number becomes 0, one just inside an open end becomes that end. Closed ends are rounded as the value was.
    const Range rounded{static_cast<float>(range.low), static_cast<float>(range.high), range.lowOpen, range.highOpen};
    if (!contains(rounded, value))
        raise(context, node, name + " must be " + describe(range) + " in single precision, got " + node.text);
    return value;
}

uint32_t readInteger(const ReadContext& context, const YamlNode& node, const std::string& name, uint32_t low,
                     uint32_t high)
{
    const std::string& text = scalar(context, node, name, "a whole number");
    const bool hexadecimal = text.starts_with("0x");
    const char* begin = text.data() + (hexadecimal ? 2 : 0);
    const char* end = text.data() + text.size();
    uint32_t value = 0;
    const std::from_chars_result parsed = std::from_chars(begin, end, value, hexadecimal ? 16 : 10);
    const bool whole = parsed.ec == std::errc() && parsed.ptr == end && !node.quoted;
    if (!whole || value < low || value > high)
        raise(context, node,
              name + " must be a whole number from " + std::to_string(low) + " to " + std::to_string(high) + ", got '" +
                  text + "'");
    return value;
}

bool readBool(const ReadContext& context, const YamlNode& node, const std::string& name)
{
    const std::string& text = scalar(context, node, name, "true or false");
    if (!node.quoted && text == "true") return true;
    if (!node.quoted && text == "false") return false;
    raise(context, node, name + " must be true or false, got '" + text + "'");
}

std::string readText(const ReadContext& context, const YamlNode& node, const std::string& name)
{
    const std::string& text = scalar(context, node, name, "a text");
    if (text.empty()) raise(context, node, name + " must not be empty");
    return text;
}

std::vector<double> readNumbers(const ReadContext& context, const YamlNode& node, const std::string& name, size_t count,
                                const Range& range)
{
    if (node.kind != YamlNode::Kind::Sequence || node.children.size() != count) {
        const std::string got = node.kind == YamlNode::Kind::Sequence
                                    ? std::to_string(node.children.size()) + " of them"
                                    : std::string(node.kindName());
        raise(context, node, name + " must be a list of " + std::to_string(count) + " numbers, got " + got);
    }
    std::vector<double> values;
    for (const YamlNode& child : node.children)
        values.push_back(readNumber(context, child, name, range));
    return values;
}

glm::dvec3 readVector(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range)
{
    const std::vector<double> values = readNumbers(context, node, name, 3, range);
    return {values[0], values[1], values[2]};
}

size_t readChoice(const ReadContext& context, const YamlNode& node, const std::string& name,
                  std::span<const std::string_view> choices)
{
    const std::string& text = scalar(context, node, name, "a word");
    const auto found = std::find(choices.begin(), choices.end(), text);
    if (found != choices.end()) return static_cast<size_t>(found - choices.begin());
    std::string list;
    for (const std::string_view choice : choices)
        list.append(list.empty() ? "" : ", ").append(choice);
    raise(context, node, name + " must be one of " + list + ", got '" + text + "'");
}

MapReader::MapReader(const ReadContext& context, const YamlNode& map, const std::string& what)
    : context_(context), map_(map)
{
    if (map.kind != YamlNode::Kind::Map) raise(context, map, what + " must be a map, got " + map.kindName());
}

const YamlNode* MapReader::find(std::string_view key)
{
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
    for (size_t i = 0; i + 1 < map_.children.size(); i += 2)
        if (map_.children[i].text == key) return &map_.children[i + 1];
    return nullptr;
}

const YamlNode& MapReader::need(std::string_view key)
{
    if (const YamlNode* node = find(key)) return *node;
    raise(context_, map_, "'" + std::string(key) + "' is missing");
}

double MapReader::number(std::string_view key, double fallback, const Range& range)
{
    const YamlNode* node = find(key);
    return node ? readNumber(context_, *node, std::string(key), range) : fallback;
}

float MapReader::numberF(std::string_view key, float fallback, const Range& range)
{
    const YamlNode* node = find(key);
    return node ? readFloat(context_, *node, std::string(key), range) : fallback;
}

uint32_t MapReader::integer(std::string_view key, uint32_t fallback, uint32_t low, uint32_t high)
{
    const YamlNode* node = find(key);
    return node ? readInteger(context_, *node, std::string(key), low, high) : fallback;
}

bool MapReader::boolean(std::string_view key, bool fallback)
{
    const YamlNode* node = find(key);
    return node ? readBool(context_, *node, std::string(key)) : fallback;
}

std::string MapReader::text(std::string_view key, const std::string& fallback)
{
    const YamlNode* node = find(key);
    return node ? readText(context_, *node, std::string(key)) : fallback;
}

glm::dvec3 MapReader::vector(std::string_view key, const glm::dvec3& fallback, const Range& range)
{
    const YamlNode* node = find(key);
    return node ? readVector(context_, *node, std::string(key), range) : fallback;
}

void MapReader::finish() const
{
    for (size_t i = 0; i + 1 < map_.children.size(); i += 2) {
        const YamlNode& key = map_.children[i];
        if (std::find(known_.begin(), known_.end(), key.text) != known_.end()) continue;
        std::string list;
        for (const std::string& known : known_)
            list += (list.empty() ? "" : ", ") + known;
        raise(context_, key, "unknown key '" + key.text + "'; known here: " + list);
    }
}

} // namespace gnomon::demo
