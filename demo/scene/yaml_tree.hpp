#pragma once

#include "demo/io/outcome.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::demo {

/// One node of a YAML document and where it stands. Built from parser events rather than from the YAML library's own
/// nodes, which forget duplicate keys and look through aliases.
struct YamlNode {
    enum class Kind : uint8_t { Null, Scalar, Sequence, Map };

    Kind kind = Kind::Null;
    bool quoted = false; ///< A scalar in quotes is text, whatever it looks like.
    uint32_t line = 1, column = 1;
    std::string text;               ///< Of a scalar.
    std::vector<YamlNode> children; ///< Of a sequence; of a map key, value, key, value...

    const char* kindName() const noexcept;
};

/// Exactly one document without aliases, anchors, tags and duplicate or compound keys; anything else is an error that
/// begins with "file:line:column: ".
Outcome<YamlNode> parseYaml(std::string_view text, const std::string& file);

std::string positioned(const std::string& file, uint32_t line, uint32_t column, const std::string& message);

} // namespace gnomon::demo
