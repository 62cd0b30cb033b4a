#pragma once

#include "demo/scene/yaml_tree.hpp"

#include <glm/vec3.hpp>

#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::demo {

/// Thrown inside the loader only; loadScene() turns it into an Outcome.
struct SceneError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Closed or half-open numbers a key accepts.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool lowOpen = false; ///< low itself is not allowed.
    bool highOpen = false;
};

inline constexpr Range kAny{};
inline constexpr Range kPositive{.low = 0.0, .lowOpen = true};
inline constexpr Range kNotNegative{.low = 0.0};

/// What is being read, for messages: "torus_grid.yaml", "light 'sun'".
struct ReadContext {
    std::string file;
    std::string subject;
};

/// Ends reading with "file:line:column: subject: message".
[[noreturn]] void raise(const ReadContext& context, const YamlNode& at, const std::string& message);

double readNumber(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range);
float readFloat(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range);
uint32_t readInteger(const ReadContext& context, const YamlNode& node, const std::string& name, uint32_t low,
                     uint32_t high);
bool readBool(const ReadContext& context, const YamlNode& node, const std::string& name);
std::string readText(const ReadContext& context, const YamlNode& node, const std::string& name);
std::vector<double> readNumbers(const ReadContext& context, const YamlNode& node, const std::string& name, size_t count,
                                const Range& range);
glm::dvec3 readVector(const ReadContext& context, const YamlNode& node, const std::string& name,
                      const Range& range = kAny);
/// The index of the node's word in `choices`.
size_t readChoice(const ReadContext& context, const YamlNode& node, const std::string& name,
                  std::span<const std::string_view> choices);

/// Reads the keys of one map. Every key must be asked for once; finish() names those nobody asked for.
class MapReader {
public:
    MapReader(const ReadContext& context, const YamlNode& map, const std::string& what);

    const YamlNode* find(std::string_view key);
    const YamlNode& need(std::string_view key);
    bool has(std::string_view key) { return find(key) != nullptr; }

    double number(std::string_view key, double fallback, const Range& range = kAny);
    float numberF(std::string_view key, float fallback, const Range& range = kAny);
    uint32_t integer(std::string_view key, uint32_t fallback, uint32_t low, uint32_t high);
    bool boolean(std::string_view key, bool fallback);
    std::string text(std::string_view key, const std::string& fallback);
    glm::dvec3 vector(std::string_view key, const glm::dvec3& fallback, const Range& range = kAny);

    /// Fails where a key was not asked for.
    void finish() const;

    const ReadContext& context() const noexcept { return context_; }
    const YamlNode& node() const noexcept { return map_; }

private:
    const ReadContext& context_;
    const YamlNode& map_;
    std::vector<std::string> known_;
};

} // namespace gnomon::demo
