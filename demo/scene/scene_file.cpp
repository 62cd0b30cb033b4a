#include "demo/scene/scene_file.hpp"

#include "demo/scene/scene_parts.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

namespace gnomon::demo {
namespace {

namespace fs = std::filesystem;

// A base of a base is already hard to read; this also ends files that name each other in a circle.
constexpr uint32_t kDeepestBase = 4;

/// The value of a top-level key and the file it came from: a derived scene replaces its base's sections one by one.
struct Section {
    YamlNode node;
    uint32_t keyLine = 1, keyColumn = 1;
    std::string file;
};
using Sections = std::map<std::string, Section, std::less<>>;

std::string readWholeFile(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    if (!in) throw SceneError(file.string() + ": cannot be opened");
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void collectSections(std::string_view text, const fs::path& file, uint32_t depth, Sections& sections)
{
    auto parsed = parseYaml(text, file.string());
    if (!parsed) throw SceneError(parsed.error());
    const ReadContext context{file.string(), ""};
    if (parsed->kind != YamlNode::Kind::Map)
        raise(context, *parsed, std::string("a scene must be a map of sections, got ") + parsed->kindName());
    for (size_t i = 0; i + 1 < parsed->children.size(); i += 2) {
        if (parsed->children[i].text != "base") continue;
        const YamlNode& node = parsed->children[i + 1];
        const fs::path baseFile = file.parent_path() / readText(context, node, "base");
        std::error_code ignored; // unreadable counts as absent
        if (fs::equivalent(baseFile, file, ignored)) raise(context, node, "the scene is based on itself");
        if (depth >= kDeepestBase) raise(context, node, "too many bases, one on the other");
        if (!fs::is_regular_file(baseFile, ignored)) raise(context, node, "base not found: " + baseFile.string());
        collectSections(readWholeFile(baseFile), baseFile, depth + 1, sections);
    }
    for (size_t i = 0; i + 1 < parsed->children.size(); i += 2) {
        const YamlNode& key = parsed->children[i];
        if (key.text != "base")
            sections.insert_or_assign(key.text,
                                      Section{std::move(parsed->children[i + 1]), key.line, key.column, file.string()});
    }
}

void place(Pose& pose, const Copy& copy)
{
    pose.position = copy.place(pose.position);
    pose.rotation = copy.turn * pose.rotation;
    pose.scale *= copy.scale;
}

void readInstanceKeys(MapReader& map, Instance& instance)
{
    const YamlNode* list = map.find("keys");
    if (list == nullptr) return;
    if (list->kind != YamlNode::Kind::Sequence || list->children.empty())
        raise(map.context(), *list, "keys must be a list of at least one key");
    for (const YamlNode& node : list->children) {
        MapReader key(map.context(), node, shapes::kInstanceKey, "a key");
        const double time = key.needNumber("time");
        requireLater(map.context(), node, instance.keys, time);
        instance.keys.push_back({time, readPose(key)});
        if (glm::sign(instance.keys.back().pose.scale) != glm::sign(instance.keys.front().pose.scale))
            raise(map.context(), node, "scale must have the same signs in all keys: between them it would be 0");
        key.finish();
    }
    instance.pose = instance.keys.front().pose;
}

uint32_t readMeshName(MapReader& map, const std::vector<Mesh>& meshes)
{
    const YamlNode& node = map.need("mesh");
    const std::string name = readText(map.context(), node, "mesh");
    for (uint32_t i = 0; i < meshes.size(); ++i)
        if (meshes[i].name == name) return i;
    raise(map.context(), node, "there is no mesh '" + name + "'");
}

void readInstance(ReadContext context, const YamlNode& node, Scene& scene)
{
    const size_t number = scene.instances.size();
    context.subject = "instance " + std::to_string(number);
    MapReader map(context, node, shapes::kInstance, "an instance");
    Instance instance;
    instance.name = map.text("name", "");
    if (!instance.name.empty()) context.subject = "instance '" + instance.name + "'";
    instance.mesh = readMeshName(map, scene.meshes);
    if (instance.name.empty()) instance.name = scene.meshes[instance.mesh].name;

    readInstanceKeys(map, instance);
    if (instance.keys.empty()) instance.pose = readPose(map);
    if (const YamlNode* spinNode = map.find("spin")) {
        MapReader spin(context, *spinNode, shapes::kSpin, "spin");
        if (const YamlNode* axis = spin.find("axis")) instance.spin.axis = readDirection(context, *axis, "axis");
        instance.spin.radiansPerSecond = readTurnRate(spin, scene.framesPerSecond);
        spin.finish();
    }
    instance.orbit = readOrbit(map, scene.framesPerSecond);
    instance.isStatic = map.boolean("static", false);
    instance.alphaTested = map.boolean("alpha_tested", false);
    instance.hostDrawn = map.boolean("host_drawn", false);
    instance.sides = static_cast<Sides>(map.word("sides", static_cast<size_t>(instance.sides)));
    instance.casterMask = map.integer("mask", instance.casterMask);
    instance.albedo = glm::vec3(map.vector("albedo", glm::dvec3(instance.albedo)));
    const std::vector<Copy> copies = readCopies(map, true);
    map.finish();
    if (instance.isStatic && moves(instance))
        raise(context, node, "a static instance cannot have keys, a spin or an orbit");
    if (scene.instances.size() + copies.size() > kMostInstances)
        raise(context, node, "more than " + std::to_string(kMostInstances) + " instances");

    for (const Copy& copy : copies) {
        Instance placed = instance;
        placed.name += copy.suffix;
        place(placed.pose, copy);
        for (PoseKey& key : placed.keys)
            place(key.pose, copy);
        scene.instances.push_back(std::move(placed));
    }
}

/// Reads the sections of one scene in the order they need each other.
class SceneReader {
public:
    SceneReader(Sections sections, fs::path file, const SceneFileOptions& options)
        : sections_(std::move(sections)), file_(std::move(file)), options_(options)
    {
    }

    Scene read()
    {
        refuseUnknownSections();
        readHead();
        readDepth();
        readMeshes();
        if (const Section* section = list("instances"))
            for (const YamlNode& node : section->node.children)
                readInstance({section->file, ""}, node, scene_);
        readLights();
        const Section& camera = need("camera");
        scene_.camera = readCamera({camera.file, "camera"}, camera.node);
        return std::move(scene_);
    }

private:
    void refuseUnknownSections() const
    {
        for (const auto& [key, section] : sections_) {
            const std::span<const yaml::Key> keys = shapes::kScene.allKeys();
            if (std::ranges::find(keys, key, &yaml::Key::name) != keys.end()) continue;
            std::string known;
            for (const yaml::Key& each : keys)
                known.append(known.empty() ? "" : ", ").append(each.name);
            throw SceneError(positioned(section.file, section.keyLine, section.keyColumn,
                                        "unknown key '" + key + "'; known here: " + known));
        }
    }

    const Section* find(std::string_view key) const
    {
        const auto found = sections_.find(key);
        return found == sections_.end() ? nullptr : &found->second;
    }

    const Section& need(std::string_view key) const
    {
        if (const Section* section = find(key)) return *section;
        throw SceneError(positioned(file_.string(), 1, 1, "'" + std::string(key) + "' is missing"));
    }

    const Section* list(std::string_view key) const
    {
        const Section* section = find(key);
        if (section != nullptr && section->node.kind != YamlNode::Kind::Sequence)
            raise({section->file, ""}, section->node, std::string(key) + " must be a list");
        return section;
    }

    void readHead()
    {
        scene_.file = file_.string();
        scene_.name = file_.stem().string();
        if (const Section* s = find("name")) scene_.name = readText({s->file, ""}, s->node, "name");
        if (const Section* s = find("description"))
            scene_.description = readText({s->file, ""}, s->node, "description");
        if (const Section* s = find("frames"))
            scene_.frames = readInteger({s->file, ""}, s->node, "frames", shapes::kFrames.range);
        if (const Section* s = find("fps"))
            scene_.framesPerSecond = readNumber({s->file, ""}, s->node, "fps", shapes::kRate.range);
        if (const Section* s = find("sky"))
            scene_.sky = glm::vec3(readVector({s->file, ""}, s->node, "sky", shapes::kPositiveVector));
        if (const Section* s = find("ambient"))
            scene_.ambient = readFloat({s->file, ""}, s->node, "ambient", shapes::kNotNegative.range);
        if (const Section* s = find("center"))
            scene_.center = readVector({s->file, ""}, s->node, "center", shapes::kVector);
        if (const Section* s = list("size")) {
            if (s->node.children.size() != 2) raise({s->file, ""}, s->node, "size must be a list of 2 whole numbers");
            scene_.width = readInteger({s->file, ""}, s->node.children[0], "width", shapes::kPixels.range);
            scene_.height = readInteger({s->file, ""}, s->node.children[1], "height", shapes::kPixels.range);
        }
    }

    void readDepth()
    {
        const Section* section = find("depth");
        if (section == nullptr) return;
        const ReadContext context{section->file, "depth"};
        MapReader map(context, section->node, shapes::kDepth, "depth");
        DepthSettings& depth = scene_.depth;
        depth.convention = static_cast<DepthConvention>(map.word("convention", static_cast<size_t>(depth.convention)));
        depth.nearPlane = map.number("near", depth.nearPlane);
        if (depth.convention == DepthConvention::Standard)
            depth.farPlane = map.number("far", std::max(depth.farPlane, 2.0 * depth.nearPlane),
                                        {.low = depth.nearPlane, .lowOpen = true});
        map.finish();
    }

    void readMeshes()
    {
        const Section* section = find("meshes");
        if (section == nullptr) return;
        if (section->node.kind != YamlNode::Kind::Map)
            raise({section->file, ""}, section->node, "meshes must be a map");
        const fs::path folder = fs::path(section->file).parent_path();
        const std::vector<YamlNode>& entries = section->node.children;
        for (size_t i = 0; i + 1 < entries.size(); i += 2) {
            const ReadContext context{section->file, "mesh '" + entries[i].text + "'"};
            scene_.meshes.push_back(readMesh(context, entries[i].text, entries[i + 1], folder, options_, scene_.notes));
        }
    }

    void readLights()
    {
        const Section* section = list("lights");
        if (section == nullptr) return;
        for (const YamlNode& node : section->node.children)
            readLight({section->file, ""}, node, scene_.lights, scene_.framesPerSecond);
        const Section* count = find("light_count");
        if (count == nullptr) return;
        const uint32_t used = readInteger({count->file, ""}, count->node, "light_count",
                                          {.low = 0.0, .high = double(scene_.lights.size())});
        scene_.spareLights.assign(scene_.lights.begin() + used, scene_.lights.end());
        scene_.lights.resize(used);
    }

    Sections sections_;
    fs::path file_;
    const SceneFileOptions& options_;
    Scene scene_;
};

} // namespace

Outcome<Scene> parseScene(std::string_view text, const fs::path& file, const SceneFileOptions& options)
{
    try {
        Sections sections;
        collectSections(text, file, 0, sections);
        return SceneReader(std::move(sections), file, options).read();
    } catch (const SceneError& error) {
        return Outcome<Scene>::failure(error.what());
    }
}

Outcome<Scene> loadScene(const std::string& nameOrPath, const SceneFileOptions& options)
{
    const auto file = findScene(nameOrPath);
    if (!file) return Outcome<Scene>::failure(file.error());
    try {
        return parseScene(readWholeFile(*file), *file, options);
    } catch (const SceneError& error) {
        return Outcome<Scene>::failure(error.what());
    }
}

} // namespace gnomon::demo
