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

/// What lies in both.
Range both(const Range& a, const Range& b)
{
    Range range = a;
    if (b.low > a.low || (b.low == a.low && b.lowOpen)) range.low = b.low, range.lowOpen = b.lowOpen;
    if (b.high < a.high || (b.high == a.high && b.highOpen)) range.high = b.high, range.highOpen = b.highOpen;
    return range;
}

const YamlNode* lookUp(const YamlNode& map, std::string_view key)
{
    for (size_t i = 0; i + 1 < map.children.size(); i += 2)
        if (map.children[i].text == key) return &map.children[i + 1];
    return nullptr;
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

uint32_t readInteger(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range)
{
    const std::string& text = scalar(context, node, name, "a whole number");
    const bool hexadecimal = text.starts_with("0x");
    const char* begin = text.data() + (hexadecimal ? 2 : 0);
    const char* end = text.data() + text.size();
    uint32_t value = 0;
    const std::from_chars_result parsed = std::from_chars(begin, end, value, hexadecimal ? 16 : 10);
    const bool whole = parsed.ec == std::errc() && parsed.ptr == end && !node.quoted;
    if (!whole || !contains(range, value))
        raise(context, node,
              name + " must be a whole number from " + std::to_string(static_cast<uint32_t>(range.low)) + " to " +
                  std::to_string(static_cast<uint32_t>(range.high)) + ", got '" + text + "'");
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

std::vector<double> readNumbers(const ReadContext& context, const YamlNode& node, const std::string& name,
                                const Shape& shape)
{
    if (node.kind != YamlNode::Kind::Sequence || node.children.size() != shape.least) {
        const std::string got = node.kind == YamlNode::Kind::Sequence
                                    ? std::to_string(node.children.size()) + " of them"
                                    : std::string(node.kindName());
        raise(context, node, name + " must be a list of " + std::to_string(shape.least) + " numbers, got " + got);
    }
    std::vector<double> values;
    for (const YamlNode& child : node.children)
        values.push_back(readNumber(context, child, name, shape.item->range));
    return values;
}

std::vector<uint32_t> readIntegers(const ReadContext& context, const YamlNode& node, const std::string& name,
                                   const Shape& shape)
{
    if (node.kind != YamlNode::Kind::Sequence || node.children.size() != shape.least)
        raise(context, node, name + " must be a list of " + std::to_string(shape.least) + " whole numbers");
    std::vector<uint32_t> values;
    for (const YamlNode& child : node.children)
        values.push_back(readInteger(context, child, name, shape.item->range));
    return values;
}

glm::dvec3 readVector(const ReadContext& context, const YamlNode& node, const std::string& name, const Shape& shape)
{
    const std::vector<double> values = readNumbers(context, node, name, shape);
    return {values[0], values[1], values[2]};
}

size_t readWord(const ReadContext& context, const YamlNode& node, const std::string& name, const Shape& shape)
{
    const std::string& text = scalar(context, node, name, "a word");
    const auto found = std::ranges::find(shape.words, text);
    if (found != shape.words.end()) return static_cast<size_t>(found - shape.words.begin());
    std::string known;
    for (const std::string_view choice : shape.words)
        known.append(known.empty() ? "" : ", ").append(choice);
    raise(context, node, name + " must be one of " + known + ", got '" + text + "'");
}

MapReader::MapReader(const ReadContext& context, const YamlNode& map, const Shape& shape, const std::string& what)
    : context_(context), map_(map), shape_(shape)
{
    if (map.kind != YamlNode::Kind::Map) raise(context, map, what + " must be a map, got " + map.kindName());
}

const YamlNode* MapReader::find(std::string_view key)
{
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
    return lookUp(map_, shape_.at(key).name);
}

const YamlNode& MapReader::need(std::string_view key)
{
    if (const YamlNode* node = find(key)) return *node;
    raise(context_, map_, "'" + std::string(key) + "' is missing");
}

double MapReader::number(std::string_view key, double fallback, const Range& within)
{
    const YamlNode* node = find(key);
    return node ? readNumber(context_, *node, std::string(key), both(shapeOf(key).range, within)) : fallback;
}

float MapReader::numberF(std::string_view key, float fallback, const Range& within)
{
    const YamlNode* node = find(key);
    return node ? readFloat(context_, *node, std::string(key), both(shapeOf(key).range, within)) : fallback;
}

uint32_t MapReader::integer(std::string_view key, uint32_t fallback, const Range& within)
{
    const YamlNode* node = find(key);
    return node ? readInteger(context_, *node, std::string(key), both(shapeOf(key).range, within)) : fallback;
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

glm::dvec3 MapReader::vector(std::string_view key, const glm::dvec3& fallback)
{
    return has(key) ? needVector(key) : fallback;
}

size_t MapReader::word(std::string_view key, size_t fallback)
{
    const YamlNode* node = find(key);
    return node ? readWord(context_, *node, std::string(key), shapeOf(key)) : fallback;
}

std::optional<std::vector<double>> MapReader::numbers(std::string_view key)
{
    const YamlNode* node = find(key);
    if (node == nullptr) return std::nullopt;
    return readNumbers(context_, *node, std::string(key), shapeOf(key));
}

std::optional<std::vector<uint32_t>> MapReader::integers(std::string_view key)
{
    const YamlNode* node = find(key);
    if (node == nullptr) return std::nullopt;
    return readIntegers(context_, *node, std::string(key), shapeOf(key));
}

double MapReader::needNumber(std::string_view key)
{
    return readNumber(context_, need(key), std::string(key), shapeOf(key).range);
}

float MapReader::needFloat(std::string_view key)
{
    return readFloat(context_, need(key), std::string(key), shapeOf(key).range);
}

glm::dvec3 MapReader::needVector(std::string_view key)
{
    return readVector(context_, need(key), std::string(key), shapeOf(key));
}

void MapReader::finish() const
{
    for (const yaml::Key& key : shape_.allKeys())
        if (key.isRequired && !lookUp(map_, key.name))
            raise(context_, map_, std::string("'").append(key.name).append("' is missing"));
    for (size_t i = 0; i + 1 < map_.children.size(); i += 2) {
        const YamlNode& key = map_.children[i];
        if (std::find(known_.begin(), known_.end(), key.text) != known_.end()) continue;
        std::string list;
        for (const std::string& known : known_)
            list.append(list.empty() ? "" : ", ").append(known);
        raise(context_, key, "unknown key '" + key.text + "'; known here: " + list);
    }
}

} // namespace gnomon::demo
