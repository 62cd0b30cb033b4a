#include "rules/yaml/document.hpp"

#include <algorithm>
#include <istream>
#include <limits>
#include <streambuf>
#include <unordered_set>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "rules/engine/number_text.hpp"

namespace gnomon::yaml {
namespace {

SourceSpot spotOf(const YAML::Mark& mark)
{
    if (mark.is_null()) return {};
    return {static_cast<uint32_t>(mark.line + 1), static_cast<uint32_t>(mark.column + 1)};
}

/// Ends parsing from inside an event; never leaves parse().
struct Refusal {
    std::string_view id;
    SourceSpot at;
    std::string message;
};

/// Builds the tree from yaml-cpp's events. Events, not its own nodes, because those resolve aliases, merge repeated
/// keys silently and forget where things stood.
class TreeBuilder : public YAML::EventHandler {
public:
    explicit TreeBuilder(Limits limits) : limits_(limits) {}

    Node root;

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override
    {
        throw Refusal{"R02", spotOf(mark), "aliases are not accepted"};
    }
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(mark, "", anchor, Node::Kind::Null); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override
    {
        if (expectsKey()) {
            refuse(mark, tag, anchor);
            addKey(mark, value);
            return;
        }
        Node& made = add(mark, tag, anchor, Node::Kind::Scalar);
        made.plain = tag != "!"; // yaml-cpp's mark for "not plain"
        made.text = value;
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override
    {
        open(add(mark, tag, anchor, Node::Kind::Sequence));
    }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override
    {
        open(add(mark, tag, anchor, Node::Kind::Map));
        levels_.back().awaitsKey = true;
    }
    void OnSequenceEnd() override { levels_.pop_back(); }
    void OnMapEnd() override { levels_.pop_back(); }

private:
    struct Level {
        Node* node = nullptr;
        bool awaitsKey = false;
        std::unordered_set<std::string> keys;
    };

    bool expectsKey() const { return !levels_.empty() && levels_.back().awaitsKey; }

    void refuse(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor)
    {
        if (anchor != 0) throw Refusal{"R02", spotOf(mark), "anchors are not accepted"};
        if (!tag.empty() && tag != "?" && tag != "!") throw Refusal{"R02", spotOf(mark), "tags are not accepted"};
        if (++nodes_ > limits_.nodes)
            throw Refusal{"R07", spotOf(mark), "more than " + std::to_string(limits_.nodes) + " values"};
    }

    void addKey(const YAML::Mark& mark, const std::string& key)
    {
        Level& level = levels_.back();
        if (!level.keys.insert(key).second)
            throw Refusal{"R03", spotOf(mark), "key '" + key + "' stands twice in one map"};
        level.node->entries.push_back({key, spotOf(mark), {}});
        level.awaitsKey = false;
    }

    Node& add(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Node::Kind kind)
    {
        refuse(mark, tag, anchor);
        if (expectsKey()) throw Refusal{"R01", spotOf(mark), "a key must be a word"};
        Node& made = place();
        made.kind = kind;
        made.at = spotOf(mark);
        return made;
    }

    /// The slot for the next value. Pointers to open levels stay valid: only the innermost container grows, and its
    /// elements are never open while it does.
    Node& place()
    {
        if (levels_.empty()) return root;
        Level& level = levels_.back();
        if (level.node->kind == Node::Kind::Sequence) return level.node->items.emplace_back();
        level.awaitsKey = true;
        return level.node->entries.back().value;
    }

    void open(Node& node)
    {
        if (levels_.size() == limits_.depth)
            throw Refusal{"R07", node.at, "nested deeper than " + std::to_string(limits_.depth)};
        levels_.push_back({&node, false, {}});
    }

    Limits limits_;
    std::vector<Level> levels_;
    std::size_t nodes_ = 0;
};

/// Reads a text in place.
class TextBuffer : public std::streambuf {
public:
    explicit TextBuffer(std::string& text) { setg(text.data(), text.data(), text.data() + text.size()); }
};

/// Bytes that UTF-8 text cannot hold, or that yaml-cpp would take for the end of the input or for UTF-16.
const char* findForeignByte(const std::string& text)
{
    const auto found = std::find_if(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < 0x20 && c != '\t' && c != '\n' && c != '\r') || byte == 0x7f || byte >= 0xf8;
    });
    return found == text.end() ? nullptr : &*found;
}

SourceSpot spotAt(std::string_view text, std::size_t offset)
{
    const std::string_view before = text.substr(0, offset);
    const std::size_t lineStart = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    return {static_cast<uint32_t>(1 + std::count(before.begin(), before.end(), '\n')),
            static_cast<uint32_t>(offset - lineStart + 1)};
}

std::size_t offsetAt(std::string_view text, SourceSpot spot)
{
    std::size_t offset = 0;
    for (uint32_t line = 1; line < spot.line; ++line) {
        const std::size_t end = text.find('\n', offset);
        if (end == std::string_view::npos) return text.size();
        offset = end + 1;
    }
    return std::min(text.size(), offset + spot.column - 1);
}

bool parseEvents(std::string& source, TreeBuilder& builder, DiagnosticSink& sink)
{
    try {
        TextBuffer buffer(source);
        std::istream stream(&buffer);
        YAML::Parser parser(stream);
        if (!parser.HandleNextDocument(builder)) {
            sink.error("R01", {1, 1}, "the text is empty");
            return false;
        }
        TreeBuilder rest({});
        if (parser.HandleNextDocument(rest)) {
            sink.error("R01", rest.root.at, "a second document follows");
            return false;
        }
        return true;
    } catch (const Refusal& refusal) {
        sink.error(refusal.id, refusal.at, refusal.message);
    } catch (const YAML::Exception& failure) {
        sink.error("R01", spotOf(failure.mark), failure.msg);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) { // yaml-cpp lets a few standard ones through
        sink.error("R01", {}, std::string("the YAML parser failed: ") + failure.what());
    }
    return false;
}

} // namespace

const Node* Node::find(std::string_view key) const noexcept
{
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.key == key; });
    return found == entries.end() ? nullptr : &found->value;
}

std::optional<Document> parse(std::string_view text, const Limits& limits, DiagnosticSink& sink)
{
    if (text.size() > limits.bytes) {
        sink.error("R07", {}, "the text is longer than " + std::to_string(limits.bytes) + " bytes");
        return std::nullopt;
    }
    if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
    Document document;
    document.source = std::string(text);
    if (const char* foreign = findForeignByte(document.source)) {
        const auto offset = static_cast<std::size_t>(foreign - document.source.data());
        sink.error("R01", spotAt(text, offset), "not UTF-8 text: a control character or a foreign byte");
        return std::nullopt;
    }
    TreeBuilder builder(limits);
    if (!parseEvents(document.source, builder, sink)) return std::nullopt;
    document.root = std::move(builder.root);
    return document;
}

SourceSpot Document::spotInside(const Node& scalar, std::size_t offset) const
{
    const std::string_view text = source;
    std::size_t at = offsetAt(text, scalar.at);
    if (at < text.size() && (text[at] == '>' || text[at] == '|') && !scalar.plain)
        at = std::min(text.size(), text.find('\n', at)); // a block scalar starts on the next line
    // What may stand in the file between two characters of the value: quotes, escapes, line folding and indentation.
    const auto mayBeLeftOut = [](char c) { return std::string_view("\"'\\ \t\r\n").find(c) != std::string_view::npos; };
    for (std::size_t i = 0; i <= offset; ++i) {
        const char wanted = i < scalar.text.size() ? scalar.text[i] : '\0';
        const auto matches = [wanted](char c) { return c == wanted || (wanted == ' ' && c == '\n'); };
        while (at < text.size() && !matches(text[at]) && mayBeLeftOut(text[at]) && wanted != '\0')
            ++at;
        if (at == text.size() || (wanted != '\0' && !matches(text[at])))
            return scalar.at; // an escape we cannot follow, such as \x41
        if (i < offset) ++at;
    }
    return spotAt(text, at);
}

std::optional<double> numberOf(const Node& node) noexcept
{
    if (node.kind != Node::Kind::Scalar || !node.plain) return std::nullopt;
    if (node.text == ".inf" || node.text == "+.inf") return std::numeric_limits<double>::infinity();
    if (node.text == "-.inf") return -std::numeric_limits<double>::infinity();
    return rules::parseNumber(node.text);
}

std::string_view kindText(const Node& node) noexcept
{
    switch (node.kind) {
    case Node::Kind::Null:
        return "nothing";
    case Node::Kind::Scalar:
        return numberOf(node) ? "a number" : "a text";
    case Node::Kind::Sequence:
        return "a list";
    case Node::Kind::Map:
        return "a map";
    }
    return "";
}

std::string foundText(const Node& node)
{
    constexpr std::size_t kMost = 40; // bytes; a line of a message shows them
    if (node.kind != Node::Kind::Scalar) return ", found " + std::string(kindText(node));
    if (node.text.size() <= kMost) return ", found " + rules::quoted(node.text);
    std::size_t end = kMost;
    while (end > 0 && (static_cast<unsigned char>(node.text[end]) & 0xc0u) == 0x80u) // within a character
        --end;
    return ", found " + rules::quoted(node.text.substr(0, end) + "...");
}

MapReader::MapReader(const Node& node, std::string_view what, DiagnosticSink& sink)
    : node_(node), what_(what), sink_(sink)
{
    if (node.kind != Node::Kind::Map)
        sink.error("R04", node.at, what_ + " must be a map, found " + std::string(kindText(node)));
}

const Node* MapReader::optional(std::string_view key)
{
    asked_.push_back(key);
    return node_.find(key);
}

const Node* MapReader::required(std::string_view key)
{
    const Node* found = optional(key);
    if (!found && node_.kind == Node::Kind::Map)
        sink_.error("R04", node_.at, what_ + " needs a key '" + std::string(key) + "'");
    return found;
}

void MapReader::text(std::string_view key, std::string& out)
{
    const Node* found = optional(key);
    if (found && found->kind == Node::Kind::Scalar)
        out = found->text;
    else if (found)
        sink_.error("R04", found->at, rules::quoted(key) + " must be a text, found " + std::string(kindText(*found)));
}

void MapReader::number(std::string_view key, double low, double high, double& out)
{
    const Node* found = optional(key);
    if (!found) return;
    const std::optional<double> value = numberOf(*found);
    if (value && *value >= low && *value <= high)
        out = *value;
    else
        sink_.error("R05", found->at,
                    rules::quoted(key) + " must be a number from " + rules::shortestText(low) + " to " +
                        rules::shortestText(high) + foundText(*found));
}

void MapReader::count(std::string_view key, uint32_t high, uint32_t& out)
{
    double value = out;
    const uint32_t before = sink_.errorCount();
    number(key, 0.0, high, value);
    if (sink_.errorCount() != before) return;
    if (value == static_cast<double>(static_cast<uint32_t>(value)))
        out = static_cast<uint32_t>(value);
    else
        sink_.error("R05", node_.find(key)->at,
                    rules::quoted(key) + " must be a whole number" + foundText(*node_.find(key)));
}

void MapReader::finish()
{
    for (const Entry& entry : node_.entries) {
        if (std::find(asked_.begin(), asked_.end(), entry.key) == asked_.end())
            sink_.error("R04", entry.keyAt, what_ + " has no key '" + entry.key + "'");
    }
}

} // namespace gnomon::yaml
