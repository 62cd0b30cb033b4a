#include "demo/program/pictures.hpp"

#include <array>
#include <utility>

#include "demo/io/number.hpp"
#include "demo/io/text.hpp"

namespace gnomon::demo {
namespace {

constexpr Rgb8 kInk{16, 16, 16};

// Okabe and Ito's eight colours, told apart by most colour-blind people as well; yellow-green added for a ninth.
constexpr std::array<std::pair<std::string_view, Rgb8>, 21> kNamed = {
    {{"ray_traced", {240, 228, 66}},
     {"shadow_map", {86, 180, 233}},
     {"stencil_volume", {230, 159, 0}},
     {"pcf_hybrid", {0, 158, 115}},
     {"cube_map", {204, 121, 167}},
     {"dual_paraboloid", {213, 94, 0}},
     {"chan_durand", {0, 114, 178}},
     {"octree_volume", {148, 103, 189}},
     {"all_edges_volume", {140, 86, 75}},
     {"projected_planar", {160, 160, 160}},
     {"mccool", {188, 189, 34}},
     {"angular_spans", {154, 205, 50}},
     {"contour_chain", {0, 139, 139}},
     {"penumbra_wedges", {255, 152, 150}},
     {"tile_shafts", {255, 187, 120}},
     {"conservative_map", {0, 168, 168}},
     {"conservative_map_adjacency", {120, 220, 220}},
     {"coherence_sampling", {255, 105, 180}},
     {"eight_point_hybrid", {219, 161, 203}},
     {"rbsm", {0, 60, 200}},
     {"cascades", {64, 200, 255}}}};

} // namespace

Rgb8 methodColour(std::string_view method) noexcept
{
    for (const auto& [name, colour] : kNamed)
        if (name == method) return colour;
    uint32_t hash = 2166136261u; // FNV-1a
    for (char c : method)
        hash = (hash ^ static_cast<uint8_t>(c)) * 16777619u;
    const auto bright = [hash](uint32_t shift) { return static_cast<uint8_t>(128 + (hash >> shift & 127u)); };
    return {bright(0), bright(8), bright(16)};
}

bool projectToPixel(const CameraMatrices& camera, VkExtent2D extent, const glm::dvec3& world, int32_t& x, int32_t& y)
{
    const glm::dvec4 clip = glm::dmat4(camera.clipFromEye) * glm::dvec4(world - camera.eye, 1.0);
    if (clip.w <= 0.0) return false;
    const double px = (clip.x / clip.w * 0.5 + 0.5) * extent.width, py = (clip.y / clip.w * 0.5 + 0.5) * extent.height;
    if (px < 0.0 || py < 0.0 || px >= extent.width || py >= extent.height) return false;
    x = static_cast<int32_t>(px);
    y = static_cast<int32_t>(py);
    return true;
}

Image8 captioned(const Image8& picture, const Scene& scene, const SceneState& state, const CameraMatrices& camera,
                 const std::vector<FrameLog::LightLine>& lines, std::string_view title)
{
    Image8 out = picture;
    const uint32_t scale = std::max(1u, picture.width / 640u);
    const auto lineHeight = static_cast<int32_t>(measureText("X", scale).height + 5 * scale);
    int32_t y = static_cast<int32_t>(4 * scale);
    const auto x = y;
    drawLabel(out, x, y, title, {255, 255, 255}, kInk, scale);
    for (const FrameLog::LightLine& line : lines) {
        y += lineHeight;
        std::string text = line.light + ": " + line.method + "  ";
        appendFixed(text, double(line.suitability), 2);
        drawLabel(out, x, y, text, kInk, methodColour(line.method), scale);
    }
    for (size_t i = 0; i < state.present.size() && i < lines.size(); ++i) {
        const Light& light = scene.lights[state.present[i]];
        int32_t px = 0, py = 0;
        if (light.kind != LightKind::Directional &&
            projectToPixel(camera, {picture.width, picture.height}, state.lights[state.present[i]].position, px, py))
            drawLabel(out, px, py, light.name, kInk, methodColour(lines[i].method), scale);
    }
    return out;
}

} // namespace gnomon::demo
