#include "demo/scene/gltf_indices.hpp"

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/scene/yaml_tree.hpp"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

// glTF 2.0 specification: 3.6.2 (accessors), 4.4 (binary files).

namespace gnomon::demo {
namespace {

struct Gltf {
    YamlNode json;
    std::string binary; ///< The chunk of a .glb file.
    std::filesystem::path folder;
    std::map<const YamlNode*, std::string> buffers; ///< Those read so far.
};

uint32_t littleEndian(std::string_view bytes, size_t at, size_t width)
{
    uint32_t value = 0;
    for (size_t i = 0; i < width; ++i)
        value |= uint32_t{static_cast<uint8_t>(bytes[at + i])} << (8 * i);
    return value;
}

const YamlNode* find(const YamlNode* map, std::string_view key)
{
    if (map == nullptr || map->kind != YamlNode::Kind::Map) return nullptr;
    for (size_t i = 0; i + 1 < map->children.size(); i += 2)
        if (map->children[i].text == key) return &map->children[i + 1];
    return nullptr;
}

std::optional<size_t> whole(const YamlNode* node)
{
    if (node == nullptr) return std::nullopt;
    const std::optional<double> value = parseNumber(node->text);
    if (!value || *value < 0.0 || *value > 4294967295.0) return std::nullopt;
    return static_cast<size_t>(*value);
}

/// Element of a list at the root, by the number that a node holds.
const YamlNode* element(const Gltf& gltf, std::string_view list, const YamlNode* number)
{
    const YamlNode* all = find(&gltf.json, list);
    const std::optional<size_t> at = whole(number);
    if (all == nullptr || all->kind != YamlNode::Kind::Sequence || !at || *at >= all->children.size()) return nullptr;
    return &all->children[*at];
}

std::string fromBase64(std::string_view text)
{
    std::string bytes;
    uint32_t bits = 0, count = 0;
    for (const char c : text) {
        constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        const size_t digit = kDigits.find(c);
        if (digit == std::string_view::npos) break; // padding
        bits = bits << 6 | static_cast<uint32_t>(digit);
        if ((count += 6) >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xffu);
    }
    return bytes;
}

std::string readBuffer(const Gltf& gltf, const YamlNode* buffer)
{
    const YamlNode* uri = find(buffer, "uri");
    if (uri == nullptr) return gltf.binary;
    constexpr std::string_view kBase64 = ";base64,";
    if (const size_t mark = uri->text.find(kBase64); uri->text.starts_with("data:") && mark != std::string::npos)
        return fromBase64(std::string_view(uri->text).substr(mark + kBase64.size()));
    Outcome<std::string> read = readText(gltf.folder / uri->text);
    return read ? std::move(*read) : std::string();
}

/// The first index of an accessor that is not below `bound`, and its place.
std::optional<std::array<size_t, 2>> firstBeyond(Gltf& gltf, const YamlNode* accessor, size_t bound)
{
    const YamlNode* view = element(gltf, "bufferViews", find(accessor, "bufferView"));
    const YamlNode* buffer = element(gltf, "buffers", find(view, "buffer"));
    const size_t count = whole(find(accessor, "count")).value_or(0);
    const size_t component = whole(find(accessor, "componentType")).value_or(0);
    const size_t width = component == 5121 ? 1 : component == 5123 ? 2 : component == 5125 ? 4 : 0;
    const size_t first = whole(find(view, "byteOffset")).value_or(0) + whole(find(accessor, "byteOffset")).value_or(0);
    if (buffer == nullptr || width == 0) return std::nullopt;
    const auto [entry, isNew] = gltf.buffers.try_emplace(buffer);
    std::string& bytes = entry->second;
    if (isNew) bytes = readBuffer(gltf, buffer);
    if (first + count * width > bytes.size()) return std::nullopt;
    for (size_t i = 0; i < count; ++i)
        if (const uint32_t index = littleEndian(bytes, first + i * width, width); index >= bound)
            return std::array<size_t, 2>{index, i};
    return std::nullopt;
}

Status checkPrimitive(Gltf& gltf, const YamlNode& primitive, const std::string& what)
{
    const YamlNode* positions = element(gltf, "accessors", find(find(&primitive, "attributes"), "POSITION"));
    const YamlNode* indices = element(gltf, "accessors", find(&primitive, "indices"));
    const std::optional<size_t> vertices = whole(find(positions, "count"));
    if (indices == nullptr || !vertices) return Done{};
    if (find(indices, "sparse") != nullptr) return Status::failure(what + ": sparse indices are not supported");
    if (const auto wrong = firstBeyond(gltf, indices, *vertices))
        return Status::failure(what + ": index " + std::to_string((*wrong)[1]) + " (of triangle " +
                               std::to_string((*wrong)[1] / 3) + ") names vertex " + std::to_string((*wrong)[0]) +
                               " of " + std::to_string(*vertices) + ", all counted from 0");
    return Done{};
}

/// The importer follows children from node to node by recursion: 10 000 levels fit into a stack of 8 MB, 20 000 do not.
constexpr size_t kDeepestNode = 1000;

/// Whether nodes are trees, as glTF wants them. Of a node with two parents the importer makes two, and so on below it.
Status checkNodes(const Gltf& gltf)
{
    const YamlNode* nodes = find(&gltf.json, "nodes");
    if (nodes == nullptr || nodes->kind != YamlNode::Kind::Sequence) return Done{};
    constexpr size_t kNone = SIZE_MAX;
    std::vector<size_t> parents(nodes->children.size(), kNone);
    for (size_t i = 0; i < parents.size(); ++i) {
        const YamlNode* children = find(&nodes->children[i], "children");
        if (children == nullptr) continue;
        for (const YamlNode& child : children->children) {
            const size_t at = whole(&child).value_or(kNone);
            if (at >= parents.size()) continue; // the importer says so
            if (parents[at] != kNone)
                return Status::failure("node " + std::to_string(at) + " is a child of nodes " +
                                       std::to_string(parents[at]) + " and " + std::to_string(i));
            parents[at] = i;
        }
    }
    for (size_t i = 0; i < parents.size(); ++i) {
        size_t depth = 0;
        for (size_t at = i; at != kNone; at = parents[at])
            if (++depth > kDeepestNode)
                return Status::failure("node " + std::to_string(i) + " is a child's child " +
                                       std::to_string(kDeepestNode) + " times or more");
    }
    return Done{};
}

/// Escapes of YAML and JSON differ in surrogate pairs. Only names have them, which are not looked at.
void blankUnicodeEscapes(std::string& json)
{
    for (size_t i = 0; i + 1 < json.size(); ++i) {
        if (json[i] != '\\') continue;
        if (json[i + 1] == 'u') json[i] = json[i + 1] = '_';
        ++i;
    }
}

} // namespace

Status checkGltf(const std::filesystem::path& file)
{
    Gltf gltf;
    gltf.folder = file.parent_path();
    if (file.extension() != ".gltf" && file.extension() != ".glb") return Done{};
    Outcome<std::string> text = readText(file);
    if (!text) return Done{};
    constexpr size_t kHeader = 12, kChunkHeader = 8;
    if (text->starts_with("glTF") && text->size() >= kHeader + kChunkHeader) {
        if (littleEndian(*text, 4, 4) != 2) return Done{}; // of another version
        const size_t jsonSize = littleEndian(*text, kHeader, 4), binary = kHeader + 2 * kChunkHeader + jsonSize;
        if (binary <= text->size()) gltf.binary = text->substr(binary);
        *text = text->substr(kHeader + kChunkHeader, jsonSize);
    }
    blankUnicodeEscapes(*text);
    Outcome<YamlNode> json = parseYaml(*text, file.string()); // JSON is YAML
    if (!json) return Status::failure("not valid JSON: " + json.error());
    gltf.json = std::move(*json);
    if (Status trees = checkNodes(gltf); !trees) return trees;
    const YamlNode* meshes = find(&gltf.json, "meshes");
    if (meshes == nullptr || meshes->kind != YamlNode::Kind::Sequence) return Done{};
    for (size_t m = 0; m < meshes->children.size(); ++m) {
        const YamlNode* name = find(&meshes->children[m], "name");
        const YamlNode* primitives = find(&meshes->children[m], "primitives");
        if (primitives == nullptr || primitives->kind != YamlNode::Kind::Sequence) continue;
        for (size_t p = 0; p < primitives->children.size(); ++p) {
            std::string what = "mesh " + std::to_string(m);
            if (name != nullptr) what += " '" + name->text + "'";
            if (Status checked =
                    checkPrimitive(gltf, primitives->children[p], what + ", primitive " + std::to_string(p));
                !checked)
                return checked;
        }
    }
    return Done{};
}

} // namespace gnomon::demo
