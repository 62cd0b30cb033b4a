#include "demo/program/dump.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include <glm/gtc/matrix_inverse.hpp>

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/io/obj.hpp"
#include "demo/io/pfm.hpp"
#include "demo/io/png.hpp"
#include "demo/program/receivers.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {
namespace {

// Of a dump, beside those of its lights.
constexpr std::string_view kFixedNames[] = {"frame.json", "depth.pfm", "normals.pfm", "offset.pfm", "casters.obj"};

/// JSON, as much of it as frame.json needs.
class JsonWriter {
public:
    JsonWriter& key(std::string_view name)
    {
        separate();
        text_ += '"';
        text_ += name;
        text_ += "\": ";
        afterKey_ = true;
        return *this;
    }
    JsonWriter& open(char bracket)
    {
        separate();
        text_ += bracket;
        first_ = true;
        return *this;
    }
    JsonWriter& close(char bracket)
    {
        text_ += bracket;
        first_ = false;
        return *this;
    }
    JsonWriter& value(double number)
    {
        separate();
        appendNumber(text_, number);
        return *this;
    }
    JsonWriter& value(std::string_view string)
    {
        separate();
        text_ += '"';
        for (const char c : string)
            character(c);
        text_ += '"';
        return *this;
    }
    template <typename Range>
    JsonWriter& array(const Range& numbers)
    {
        open('[');
        for (const auto number : numbers)
            value(double(number));
        return close(']');
    }
    const std::string& text() const { return text_; }

private:
    void character(char c)
    {
        constexpr std::string_view hexadecimal = "0123456789abcdef";
        if (c == '"' || c == '\\') text_ += '\\';
        if (const auto code = static_cast<uint8_t>(c); code < 0x20)
            text_.append("\\u00").append({hexadecimal[code >> 4], hexadecimal[code & 15]});
        else
            text_ += c;
    }
    void separate()
    {
        if (!first_ && !afterKey_) text_ += ",\n";
        first_ = afterKey_ = false;
    }
    std::string text_;
    bool first_ = true;
    bool afterKey_ = false;
};

std::array<double, 3> toArray(const glm::dvec3& v)
{
    return {v.x, v.y, v.z};
}

std::array<double, 16> toArray(const glm::dmat4& m)
{
    std::array<double, 16> out{};
    for (int i = 0; i < 16; ++i)
        out[i] = m[i / 4][i % 4];
    return out;
}

/// Light names become parts of file names; two that would collide are told apart by their layer.
std::vector<std::string> fileNames(const Scene& scene, const SceneState& state)
{
    std::vector<std::string> names;
    std::set<std::string> used{""};
    for (size_t layer = 0; layer < state.present.size(); ++layer) {
        std::string name = scene.lights[state.present[layer]].name;
        for (char& c : name)
            if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-')) c = '_';
        while (!used.insert(name).second)
            name.append("_").append(std::to_string(layer));
        names.push_back(name);
    }
    return names;
}

/// As gnomon takes it: 0 means all bits.
double maskOf(uint32_t mask)
{
    return mask == 0 ? double(UINT32_MAX) : double(mask);
}

std::string frameJson(const Scene& scene, Renderer& renderer, const std::vector<FrameLog::LightLine>& lines,
                      const std::vector<std::string>& names)
{
    const CameraMatrices& camera = renderer.camera();
    const SceneState& state = renderer.state();
    glm::dmat4 toEye(1.0);
    toEye[3] = glm::dvec4(-camera.eye, 1.0);
    const glm::dmat4 viewProjection = glm::dmat4(camera.clipFromEye) * toEye;
    JsonWriter json;
    json.open('{');
    json.key("width").value(renderer.extent().width).key("height").value(renderer.extent().height);
    // Of the PNG files; PFM has the bottom row first.
    json.key("first_row").value("top");
    json.key("eye").array(toArray(camera.eye));
    json.key("view_projection").array(toArray(viewProjection));
    json.key("inverse_view_projection").array(toArray(glm::inverse(viewProjection)));
    // Relative to the eye, as the rasteriser used it: exact where the two above lose digits far from the origin.
    json.key("clip_from_eye").array(toArray(glm::dmat4(camera.clipFromEye)));
    json.key("matrix_order").value("column-major");
    json.key("depth_convention").value(nameOf(scene.depth.convention));
    json.key("near").value(scene.depth.nearPlane);
    if (scene.depth.convention == DepthConvention::Standard) json.key("far").value(scene.depth.farPlane);
    json.key("sky_depth").value(double(camera.skyDepth));
    json.key("lights").open('[');
    for (size_t layer = 0; layer < state.present.size(); ++layer) {
        const Light& light = scene.lights[state.present[layer]];
        const LightState& at = state.lights[state.present[layer]];
        json.open('{');
        json.key("name").value(light.name).key("kind").value(nameOf(light.kind));
        json.key("position").array(toArray(at.position)).key("direction").array(toArray(at.direction));
        json.key("caster_mask").value(maskOf(light.casterMask));
        // Half angle; 0 where there is no cone. Range 0: unlimited.
        json.key("cone_radians").value(light.kind == LightKind::Spot ? double(light.outerAngle) : 0.0);
        json.key("range").value(double(light.range));
        json.key("method").value(layer < lines.size() ? lines[layer].method : std::string("none"));
        json.key("visibility").value("visibility_" + names[layer] + ".png");
        json.key("offset").value("offset_" + names[layer] + ".pfm");
        json.close('}');
    }
    // In the order of the groups of casters.obj. One casts for a light if their masks have a bit in common.
    json.close(']').key("casters").open('[');
    for (const Instance& instance : scene.instances) {
        json.open('{').key("name").value(instance.name).key("caster_mask").value(maskOf(instance.casterMask));
        json.close('}');
    }
    json.close(']').close('}');
    return json.text() + "\n";
}

/// The offset of definition "Offset", metres, towards the light along the normal; 0 where there is no receiver.
ImageF offsets(const gpu::ViewConstants& view, const gpu::LightConstants& light, const ImageF& depth,
               const ImageF& normals)
{
    ImageF out(depth.width, depth.height, 1);
    for (uint32_t y = 0; y < depth.height; ++y) {
        for (uint32_t x = 0; x < depth.width; ++x) {
            const float d = *depth.at(x, y);
            if (d == view.skyDepth) continue;
            const float* n = normals.at(x, y);
            const glm::vec3 ray = gpu::viewRayWs(view, glm::vec2(float(x) + 0.5f, float(y) + 0.5f));
            const glm::vec3 receiver = ray * gpu::linearDepth(view, d);
            *out.at(x, y) = gpu::receiverOffset(view, light, d, ray, receiver, glm::vec3(n[0], n[1], n[2]));
        }
    }
    return out;
}

} // namespace

void removeOldDump(const std::filesystem::path& folder)
{
    const Outcome<std::string> json = readText(folder / "frame.json");
    if (!json) return;
    std::vector<std::filesystem::path> old;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        const bool isFixed = std::find(std::begin(kFixedNames), std::end(kFixedNames), name) != std::end(kFixedNames);
        const bool isLights = name.starts_with("visibility_") || name.starts_with("offset_");
        if (isFixed || (isLights && json->find('"' + name + '"') != std::string::npos)) old.push_back(entry.path());
    }
    for (const std::filesystem::path& file : old)
        std::filesystem::remove(file);
}

void dumpFrame(const std::filesystem::path& folder, const Scene& scene, Renderer& renderer,
               const std::vector<FrameLog::LightLine>& lines)
{
    std::filesystem::create_directories(folder);
    const SceneState& state = renderer.state();
    const std::vector<std::string> names = fileNames(scene, state);
    const ImageF depth = renderer.readDepth();
    const ImageF normals = renderer.readNormals();
    const std::vector<Image8> visibility = renderer.readVisibility();

    expect(writeFile(folder / "frame.json", frameJson(scene, renderer, lines, names)));
    expect(writePfm(folder / "depth.pfm", depth));
    expect(writePfm(folder / "normals.pfm", normals));
    const gpu::ViewConstants view = viewConstants(scene, renderer.camera(), renderer.extent());
    for (size_t layer = 0; layer < state.present.size(); ++layer) {
        const Light& light = scene.lights[state.present[layer]];
        const gpu::LightConstants constants =
            lightConstants(light, state.lights[state.present[layer]], renderer.camera().eye);
        const ImageF offset = offsets(view, constants, depth, normals);
        if (layer == 0) expect(writePfm(folder / "offset.pfm", offset));
        expect(writePfm(folder / ("offset_" + names[layer] + ".pfm"), offset));
        expect(writePng(folder / ("visibility_" + names[layer] + ".png"), visibility[layer]));
    }
    ObjWriter casters;
    for (size_t i = 0; i < scene.instances.size(); ++i)
        casters.add(scene.instances[i].name, scene.meshes[scene.instances[i].mesh], state.instances[i]);
    expect(casters.save(folder / "casters.obj"));
}

} // namespace gnomon::demo
