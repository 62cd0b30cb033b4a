#pragma once

#include "demo/scene/yaml_tree.hpp"
#include "rules/yaml/shape.hpp"

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

using yaml::Range;
using yaml::Shape;

/// What is being read, for messages: "torus_grid.yaml", "light 'sun'".
struct ReadContext {
    std::string file;
    std::string subject;
};

/// Ends reading with "file:line:column: subject: message".
[[noreturn]] void raise(const ReadContext& context, const YamlNode& at, const std::string& message);

double readNumber(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range);
float readFloat(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range);
uint32_t readInteger(const ReadContext& context, const YamlNode& node, const std::string& name, const Range& range);
bool readBool(const ReadContext& context, const YamlNode& node, const std::string& name);
std::string readText(const ReadContext& context, const YamlNode& node, const std::string& name);
/// A list of numbers. \param shape a list of so many.
std::vector<double> readNumbers(const ReadContext& context, const YamlNode& node, const std::string& name,
                                const Shape& shape);
/// The same of whole numbers.
std::vector<uint32_t> readIntegers(const ReadContext& context, const YamlNode& node, const std::string& name,
                                   const Shape& shape);
/// \param shape a list of three numbers.
glm::dvec3 readVector(const ReadContext& context, const YamlNode& node, const std::string& name, const Shape& shape);
/// The index of the node's word among the shape's.
size_t readWord(const ReadContext& context, const YamlNode& node, const std::string& name, const Shape& shape);

/// Reads the keys of one map of a shape, which has the bounds of each. Every key must be asked for once, since what one
/// may hold can depend on another; finish() names those nobody asked for.
class MapReader {
public:
    MapReader(const ReadContext& context, const YamlNode& map, const Shape& shape, const std::string& what);

    const YamlNode* find(std::string_view key);
    const YamlNode& need(std::string_view key);
    bool has(std::string_view key) { return find(key) != nullptr; }

    /// \param within narrows the shape's range by what other keys say.
    double number(std::string_view key, double fallback, const Range& within = {});
    float numberF(std::string_view key, float fallback, const Range& within = {});
    uint32_t integer(std::string_view key, uint32_t fallback, const Range& within = {});
    bool boolean(std::string_view key, bool fallback);
    std::string text(std::string_view key, const std::string& fallback);
    glm::dvec3 vector(std::string_view key, const glm::dvec3& fallback);
    size_t word(std::string_view key, size_t fallback);
    std::optional<std::vector<double>> numbers(std::string_view key);
    std::optional<std::vector<uint32_t>> integers(std::string_view key);

    /// The same of what may not be missing.
    double needNumber(std::string_view key);
    float needFloat(std::string_view key);
    glm::dvec3 needVector(std::string_view key);

    /// Fails where a key was not asked for, or one that the shape needs is missing.
    void finish() const;

    const ReadContext& context() const noexcept { return context_; }
    const YamlNode& node() const noexcept { return map_; }

private:
    const Shape& shapeOf(std::string_view key) const { return *shape_.at(key).shape; }

    const ReadContext& context_;
    const YamlNode& map_;
    const Shape& shape_;
    std::vector<std::string> known_;
};

} // namespace gnomon::demo
