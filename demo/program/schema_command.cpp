// `gnomon schema`: the tables that the readers read by, as JSON Schemas for editors and validators.
#include <cmath>
#include <cstdio>

#include "demo/io/number.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/json.hpp"
#include "demo/scene/scene_shape.hpp"
#include "rules/yaml/rule_base_shape.hpp"
#include "runtime/cost/knowledge_base.hpp"

namespace gnomon::demo {
namespace {

using yaml::Key;
using yaml::Shape;

std::string numberText(double value)
{
    std::string text;
    appendNumber(text, value);
    return text;
}

/// JSON of a shape: members of one object, each on a line of its own where it is a map.
class SchemaWriter {
public:
    /// \param isChange of a map that is there already: no key is needed.
    std::string write(const Shape& shape, std::string_view about, uint32_t depth, bool isChange) const
    {
        std::string out = about.empty() ? "{" : "{\"description\": " + jsonString(about) + ", ";
        switch (shape.kind) {
        case Shape::Kind::Text:
            return out + "\"type\": \"string\"}";
        case Shape::Kind::Flag:
            return out + "\"type\": \"boolean\"}";
        case Shape::Kind::Word:
            return out + "\"enum\": [" + words(shape.words) + "]}";
        case Shape::Kind::Number:
        case Shape::Kind::Whole:
            return out + "\"type\": \"" + (shape.kind == Shape::Kind::Whole ? "integer" : "number") + '"' +
                   bounds(shape.range) + "}";
        case Shape::Kind::Either:
            return out + "\"anyOf\": [" + choices(shape, depth, isChange) + "]}";
        case Shape::Kind::List:
            return out + "\"type\": \"array\"" + count("minItems", shape.least, 0) +
                   count("maxItems", shape.most, UINT32_MAX) + ", \"items\": " + write(*shape.item, {}, depth, false) +
                   "}";
        case Shape::Kind::Named:
            return out + "\"type\": \"object\"" + count("maxProperties", shape.most, UINT32_MAX) +
                   ", \"additionalProperties\": " + write(*shape.item, {}, depth, isChange || shape.isChange) + "}";
        case Shape::Kind::Map:
            return out + "\"type\": " + (shape.mayBeEmpty ? "[\"object\", \"null\"]" : "\"object\"") +
                   members(shape, depth, isChange || shape.isChange) + "}";
        }
        return {};
    }

private:
    static std::string words(std::span<const std::string_view> list)
    {
        std::string out;
        for (const std::string_view each : list)
            out += (out.empty() ? "" : ", ") + jsonString(each);
        return out;
    }

    static std::string bounds(const yaml::Range& range)
    {
        std::string out;
        if (std::isfinite(range.low))
            out += std::string(range.lowOpen ? ", \"exclusiveMinimum\": " : ", \"minimum\": ") + numberText(range.low);
        if (std::isfinite(range.high))
            out +=
                std::string(range.highOpen ? ", \"exclusiveMaximum\": " : ", \"maximum\": ") + numberText(range.high);
        return out;
    }

    static std::string count(const char* name, uint32_t value, uint32_t none)
    {
        return value == none ? "" : std::string(", \"") + name + "\": " + std::to_string(value);
    }

    std::string choices(const Shape& shape, uint32_t depth, bool isChange) const
    {
        std::string out;
        for (const Shape* choice : shape.choices)
            out += (out.empty() ? "" : ", ") + write(*choice, {}, depth, isChange);
        return out;
    }

    std::string members(const Shape& shape, uint32_t depth, bool isChange) const
    {
        std::string required, properties;
        const std::string indent(2 * depth + 2, ' ');
        for (const Key& key : shape.allKeys()) {
            if (key.isRequired && !isChange) required += (required.empty() ? "" : ", ") + jsonString(key.name);
            properties += (properties.empty() ? "\n" : ",\n") + indent + jsonString(key.name) + ": " +
                          write(*key.shape, key.about, depth + 1, isChange);
        }
        return (required.empty() ? "" : ", \"required\": [" + required + "]") +
               ", \"additionalProperties\": false, \"properties\": {" + properties + "}";
    }
};

/// With the head of a file of its own.
std::string fileOf(const std::string& title, std::string schema)
{
    schema.replace(0, 1,
                   "{\n\"$schema\": \"http://json-schema.org/draft-07/schema#\",\n\"title\": " + jsonString(title) +
                       ",\n\"$comment\": \"made by gnomon schema\",\n");
    return schema + "\n";
}

/// Of the table's rows, each an object of its cells by column; an empty cell is left out.
std::string knowledgeSchema()
{
    const Shape measure = yaml::number({.low = 0.0, .high = cost::kMostKnowledge});
    const std::vector<cost::KnowledgeColumn> columns = cost::knowledgeColumns();
    std::vector<Key> keys;
    for (const cost::KnowledgeColumn& column : columns)
        keys.push_back({column.name, column.isNumber ? &measure : &yaml::kText, {}, column.isRequired});
    const Shape row{.kind = Shape::Kind::Map, .keys = keys.data(), .keyCount = static_cast<uint32_t>(keys.size())};
    return SchemaWriter().write(yaml::list(row, 0, cost::kMaxKnowledgeRows), {}, 0, false);
}

} // namespace

int schemaCommand(const std::string& file)
{
    const SchemaWriter writer;
    std::string text;
    if (file == "rules") text = fileOf("gnomon rule base", writer.write(rules::shapes::kRuleBase, {}, 0, false));
    if (file == "scene") text = fileOf("gnomon scene", writer.write(shapes::kScene, {}, 0, false));
    if (file == "knowledge") text = fileOf("rows of a gnomon knowledge base", knowledgeSchema());
    std::printf("%s", text.c_str());
    return 0;
}

} // namespace gnomon::demo
