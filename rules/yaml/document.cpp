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

#include "runtime/base/number_text.hpp"

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

/// How many bytes the character at the start of `text` has; 0 where it is none (Unicode 15, table 3-7), or a control
/// character, which yaml-cpp would take for the end of the input or for UTF-16.
std::size_t characterLength(std::string_view text)
{
    const auto byteAt = [text](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = byteAt(0);
    if (first < 0x80) {
        const bool isSpace = first == '\t' || first == '\n' || first == '\r';
        return (first >= 0x20 || isSpace) && first != 0x7f ? 1 : 0;
    }
    const std::size_t length = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
    // Of the second byte: nothing that fits fewer bytes, no surrogate, nothing above U+10FFFF.
    const unsigned low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
    const unsigned high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
    for (std::size_t i = 1; i < length; ++i) {
        if (byteAt(i) < (i == 1 ? low : 0x80) || byteAt(i) > (i == 1 ? high : 0xbf)) return 0;
    }
    return length;
}

/// Offset of the first byte that belongs to no character, or the size of the text.
std::size_t findForeignByte(std::string_view text)
{
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t length = characterLength(text.substr(at));
        if (length == 0) break;
        at += length;
    }
    return at;
}

std::vector<std::size_t> lineStartsOf(std::string_view text)
{
    std::vector<std::size_t> starts = {0};
    for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n', end + 1))
        starts.push_back(end + 1);
    return starts;
}

SourceSpot spotAt(const Document& document, std::size_t offset)
{
    const auto& starts = document.lineStarts;
    const auto line = std::upper_bound(starts.begin(), starts.end(), offset) - starts.begin();
    return {static_cast<uint32_t>(line),
            static_cast<uint32_t>(offset - starts[static_cast<std::size_t>(line - 1)] + 1)};
}

std::size_t offsetAt(const Document& document, SourceSpot spot)
{
    const std::size_t size = document.source.size();
    if (spot.line == 0 || spot.line > document.lineStarts.size()) return size;
    return std::min(size, document.lineStarts[spot.line - 1] + spot.column - 1);
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
    document.lineStarts = lineStartsOf(document.source);
    if (const std::size_t foreign = findForeignByte(document.source); foreign != document.source.size()) {
        sink.error("R01", spotAt(document, foreign), "not UTF-8 text: a control character or a foreign byte");
        return std::nullopt;
    }
    TreeBuilder builder(limits);
    if (!parseEvents(document.source, builder, sink)) return std::nullopt;
    document.root = std::move(builder.root);
    return document;
}

SourceSpot Document::spotInside(const Node& scalar, std::size_t offset) const
{
    return SpotFinder(*this, scalar).spotOf(offset);
}

SpotFinder::SpotFinder(const Document& document, const Node& scalar)
    : document_(document), scalar_(scalar), start_(offsetAt(document, scalar.at))
{
    const std::string_view text = document.source;
    const bool isBlock = start_ < text.size() && (text[start_] == '>' || text[start_] == '|') && !scalar.plain;
    if (isBlock) start_ = std::min(text.size(), text.find('\n', start_)); // it starts on the next line
    at_ = start_;
}

SourceSpot SpotFinder::spotOf(std::size_t offset)
{
    if (offset < next_) next_ = 0, at_ = start_;
    return advanceTo(offset) ? spotAt(document_, at_) : scalar_.at;
}

/// False at an escape that cannot be followed, such as \x41.
bool SpotFinder::advanceTo(std::size_t offset)
{
    const std::string_view text = document_.source;
    // What may stand in the file between two characters of the value: quotes, escapes, line folding and indentation.
    const auto mayBeLeftOut = [](char c) { return std::string_view("\"'\\ \t\r\n").find(c) != std::string_view::npos; };
    for (;; ++next_, ++at_) {
        const char wanted = next_ < scalar_.text.size() ? scalar_.text[next_] : '\0';
        const auto matches = [wanted](char c) { return c == wanted || (wanted == ' ' && c == '\n'); };
        while (at_ < text.size() && !matches(text[at_]) && mayBeLeftOut(text[at_]) && wanted != '\0')
            ++at_;
        if (at_ == text.size() || (wanted != '\0' && !matches(text[at_]))) return false;
        if (next_ == offset) return true;
    }
}

std::optional<double> numberOf(const Node& node) noexcept
{
    if (node.kind != Node::Kind::Scalar || !node.plain) return std::nullopt;
    if (node.text == ".inf" || node.text == "+.inf") return std::numeric_limits<double>::infinity();
    if (node.text == "-.inf") return -std::numeric_limits<double>::infinity();
    return parseNumber(node.text);
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
    if (node.text.size() <= kMost) return ", found " + rules::inQuotes(node.text);
    std::size_t end = kMost;
    while (end > 0 && (static_cast<unsigned char>(node.text[end]) & 0xc0u) == 0x80u) // within a character
        --end;
    return ", found " + rules::inQuotes(node.text.substr(0, end) + "...");
}

MapReader::MapReader(const Node& node, const Shape& shape, std::string_view what, DiagnosticSink& sink)
    : node_(node), shape_(shape), sink_(sink)
{
    const std::string name(what);
    if (node.kind != Node::Kind::Map) {
        sink.error("R04", node.at, name + " must be a map, found " + std::string(kindText(node)));
        return;
    }
    for (const Key& key : shape.allKeys())
        if (key.isRequired && !node.find(key.name))
            sink.error("R04", node.at, name + " needs a key " + rules::inQuotes(key.name));
    for (const Entry& entry : node.entries) {
        if (std::ranges::find(shape.allKeys(), entry.key, &Key::name) != shape.allKeys().end()) continue;
        std::vector<std::string_view> known;
        for (const Key& key : shape.allKeys())
            known.push_back(key.name);
        sink.error("R04", entry.keyAt, name + " has no key '" + entry.key + "'" + rules::suggestion(entry.key, known));
    }
}

const Node* MapReader::find(std::string_view key) const
{
    return node_.find(shape_.at(key).name);
}

void MapReader::text(std::string_view key, std::string& out)
{
    const Node* found = find(key);
    if (found && found->kind == Node::Kind::Scalar)
        out = found->text;
    else if (found)
        sink_.error("R04", found->at, rules::inQuotes(key) + " must be a text, found " + std::string(kindText(*found)));
}

void MapReader::number(std::string_view key, double& out)
{
    const Node* found = find(key);
    if (!found) return;
    const Range& range = shape_.at(key).shape->range;
    const std::optional<double> value = numberOf(*found);
    if (value && *value >= range.low && *value <= range.high)
        out = *value;
    else
        sink_.error("R05", found->at,
                    rules::inQuotes(key) + " must be a number from " + shortestText(range.low) + " to " +
                        shortestText(range.high) + foundText(*found));
}

void MapReader::count(std::string_view key, uint32_t& out)
{
    double value = out;
    const uint32_t before = sink_.errorCount();
    number(key, value);
    if (sink_.errorCount() != before) return;
    if (value == static_cast<double>(static_cast<uint32_t>(value)))
        out = static_cast<uint32_t>(value);
    else
        sink_.error("R05", node_.find(key)->at,
                    rules::inQuotes(key) + " must be a whole number" + foundText(*node_.find(key)));
}

std::size_t MapReader::word(std::string_view key, std::size_t unchanged)
{
    std::string written;
    text(key, written);
    const Node* node = find(key);
    if (!node || node->kind != Node::Kind::Scalar) return unchanged;
    const std::span<const std::string_view> words = shape_.at(key).shape->words;
    const auto found = std::ranges::find(words, written);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    std::string message = rules::inQuotes(key) + " must be one of";
    for (const std::string_view choice : words)
        message.append(" ").append(choice);
    sink_.error("R05", node->at, message + foundText(*node));
    return unchanged;
}

} // namespace gnomon::yaml
