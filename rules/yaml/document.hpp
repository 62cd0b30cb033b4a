#pragma once

/// A YAML text as a tree in which everything knows where it stands, read strictly: one document, UTF-8, no anchors,
/// aliases or tags, no key twice. Nothing is converted; scalars stay text until somebody asks for a number, and numbers
/// are read the same way in every locale. document.cpp is the only file that sees yaml-cpp.
///
/// The rule reader is built on it, and any other file format of ours may be.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rules/engine/diagnostic.hpp"
#include "rules/yaml/shape.hpp"

namespace gnomon::yaml {

using rules::DiagnosticSink;
using rules::SourceSpot;

/// What a text from an untrusted place may cost us.
struct Limits {
    std::size_t bytes = std::size_t(1) << 20;
    std::size_t depth = 32;
    std::size_t nodes = 200'000;
};

struct Entry;

struct Node {
    enum class Kind : uint8_t { Null, Scalar, Sequence, Map };

    Kind kind = Kind::Null;
    bool plain = true;          ///< Scalar without quotes; only such a one may be a number.
    SourceSpot at;              ///< First character; of a quoted scalar its quote.
    std::string text;           ///< Kind::Scalar.
    std::vector<Node> items;    ///< Kind::Sequence.
    std::vector<Entry> entries; ///< Kind::Map, in file order.

    /// The value of a key, or null where this is no map or has no such key.
    const Node* find(std::string_view key) const noexcept;
};

struct Entry {
    std::string key;
    SourceSpot keyAt;
    Node value;
};

struct Document {
    Node root;
    std::string source;
    std::vector<std::size_t> lineStarts; ///< Offsets in `source`; the first is 0.

    /// Where the byte `offset` of a scalar's text stands in the file, through quotes, escapes and folded lines.
    SourceSpot spotInside(const Node& scalar, std::size_t offset) const;
};

/// Document::spotInside() for many places of one scalar: ascending offsets go through its text once. Both must outlive
/// it.
class SpotFinder {
public:
    SpotFinder(const Document& document, const Node& scalar);
    SourceSpot spotOf(std::size_t offset);

private:
    bool advanceTo(std::size_t offset);

    const Document& document_;
    const Node& scalar_;
    std::size_t start_ = 0;         ///< Where the text of the scalar begins in the file.
    std::size_t next_ = 0, at_ = 0; ///< What comes next: a byte of the text, and a place that is not before it.
};

/// Reads a text. On an error reports R01 (not YAML, not UTF-8), R02 (anchor, alias, tag), R03 (key twice) or R07
/// (limit) and returns nothing. No exception but std::bad_alloc leaves it.
std::optional<Document> parse(std::string_view text, const Limits& limits, DiagnosticSink& sink);

/// A plain scalar as a number; `.inf`, `+.inf` and `-.inf` are the infinities.
std::optional<double> numberOf(const Node& node) noexcept;

/// "a number", "a list", ...: what a node is, for messages.
std::string_view kindText(const Node& node) noexcept;
/// ", found 'foo'": what was written where something else belongs, shortened where it is long; of what is no scalar its
/// kind.
std::string foundText(const Node& node);

/// Reads a map of a shape key by key. Error ids: R04 for shape, R05 for values.
class MapReader {
public:
    /// Reports every key that the shape does not have, or that it needs and the node has not. A node that is not a map
    /// is reported and read as an empty one.
    MapReader(const Node& node, const Shape& shape, std::string_view what, DiagnosticSink& sink);

    /// Null where the key is missing.
    const Node* find(std::string_view key) const;

    /// Each leaves `out` alone where the key is missing, and reports a value of the wrong kind or out of range.
    void text(std::string_view key, std::string& out);
    void number(std::string_view key, double& out);
    void count(std::string_view key, uint32_t& out);
    /// \return the position among the shape's words; `unchanged` where the key is missing or reported.
    std::size_t word(std::string_view key, std::size_t unchanged);

private:
    const Node& node_;
    const Shape& shape_;
    DiagnosticSink& sink_;
};

} // namespace gnomon::yaml
