#include "demo/scene/yaml_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <sstream>

namespace gnomon::demo {
namespace {

// A scene needs five levels. The library recurses per level, so this bounds the stack, too.
constexpr size_t kDeepest = 32;
constexpr const char* kTooDeep = "nested too deeply";

struct TreeError {
    YAML::Mark mark;
    std::string message;
};

class TreeBuilder final : public YAML::EventHandler {
public:
    YamlNode takeRoot() { return std::move(root_); }

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override
    {
        add(mark, "", anchor, YamlNode::Kind::Null, {});
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { throw TreeError{mark, "aliases are not allowed"}; }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override
    {
        // The library marks quoted scalars with the tag "!" and plain ones with "?".
        YamlNode& node = add(mark, tag == "!" ? "" : tag, anchor, YamlNode::Kind::Scalar, value);
        node.quoted = tag == "!";
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override
    {
        open(mark, tag, anchor, YamlNode::Kind::Sequence);
    }
    void OnSequenceEnd() override { path_.pop_back(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override
    {
        open(mark, tag, anchor, YamlNode::Kind::Map);
    }
    void OnMapEnd() override { path_.pop_back(); }

private:
    YamlNode& add(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Kind kind,
                  const std::string& text)
    {
        if (anchor != 0) throw TreeError{mark, "anchors are not allowed"};
        if (!tag.empty() && tag != "?") throw TreeError{mark, "tags are not allowed, got '" + tag + "'"};
        YamlNode node;
        node.kind = kind;
        node.text = text;
        node.line = static_cast<uint32_t>(mark.line) + 1;
        node.column = static_cast<uint32_t>(mark.column) + 1;
        if (path_.empty()) {
            root_ = std::move(node);
            return root_;
        }
        YamlNode& parent = *path_.back();
        const bool isKey = parent.kind == YamlNode::Kind::Map && parent.children.size() % 2 == 0;
        if (isKey) checkKey(parent, node, mark);
        if (kind == YamlNode::Kind::Null && parent.kind == YamlNode::Kind::Map && !isKey) {
            // The library places a missing value where the next thing stands; its key is what the reader looks for.
            node.line = parent.children.back().line;
            node.column = parent.children.back().column;
        }
        return parent.children.emplace_back(std::move(node));
    }

    static void checkKey(const YamlNode& map, const YamlNode& key, const YAML::Mark& mark)
    {
        if (key.kind != YamlNode::Kind::Scalar) throw TreeError{mark, "a key must be a word"};
        for (size_t i = 0; i < map.children.size(); i += 2)
            if (map.children[i].text == key.text)
                throw TreeError{mark, "duplicate key '" + key.text + "', first given in line " +
                                          std::to_string(map.children[i].line)};
    }

    void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Kind kind)
    {
        if (path_.size() >= kDeepest) throw TreeError{mark, kTooDeep};
        // Pointers into children stay valid: a vector grows only while none of its elements is open.
        path_.push_back(&add(mark, tag, anchor, kind, {}));
    }

    YamlNode root_;
    std::vector<YamlNode*> path_;
};

std::string atMark(const std::string& file, const YAML::Mark& mark, const std::string& message)
{
    // The library knows no place for some errors and says -1.
    const int line = mark.line < 0 ? 0 : mark.line, column = mark.column < 0 ? 0 : mark.column;
    return positioned(file, static_cast<uint32_t>(line) + 1, static_cast<uint32_t>(column) + 1, message);
}

/// The text up to a bracket that may open one level too many, and then closed; empty where there is none. Brackets in
/// quotes and comments count here as well.
std::string untilTooDeep(std::string_view text)
{
    std::string open;
    for (size_t i = 0; i < text.size(); ++i) {
        if ((text[i] == ']' || text[i] == '}') && !open.empty()) open.pop_back();
        if (text[i] != '[' && text[i] != '{') continue;
        open += text[i] == '[' ? ']' : '}';
        if (open.size() > kDeepest) return std::string(text.substr(0, i + 1)).append(open.rbegin(), open.rend());
    }
    return {};
}

Outcome<YamlNode> parsed(std::string_view text, const std::string& file)
{
    TreeBuilder builder;
    try {
        std::istringstream stream{std::string(text)};
        YAML::Parser parser(stream);
        if (!parser.HandleNextDocument(builder))
            return Outcome<YamlNode>::failure(positioned(file, 1, 1, "the file is empty"));
        YamlNode root = builder.takeRoot();
        TreeBuilder second;
        if (parser.HandleNextDocument(second)) {
            const YamlNode other = second.takeRoot();
            return Outcome<YamlNode>::failure(
                positioned(file, other.line, other.column, "only one document is allowed in a file"));
        }
        return root;
    } catch (const TreeError& error) {
        return Outcome<YamlNode>::failure(atMark(file, error.mark, error.message));
    } catch (const YAML::Exception& error) {
        return Outcome<YamlNode>::failure(atMark(file, error.mark, error.msg));
    }
}

} // namespace

const char* YamlNode::kindName() const noexcept
{
    switch (kind) {
    case Kind::Null:
        return "nothing";
    case Kind::Scalar:
        return "a single value";
    case Kind::Sequence:
        return "a list";
    case Kind::Map:
        return "a map";
    }
    return "?";
}

std::string positioned(const std::string& file, uint32_t line, uint32_t column, const std::string& message)
{
    return file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + message;
}

Outcome<YamlNode> parseYaml(std::string_view text, const std::string& file)
{
    // The library reads a line of brackets to its end before it reports the first one.
    if (const std::string start = untilTooDeep(text); !start.empty()) {
        Outcome<YamlNode> refused = parsed(start, file);
        if (!refused && refused.error().ends_with(kTooDeep)) return refused;
    }
    return parsed(text, file);
}

} // namespace gnomon::demo
