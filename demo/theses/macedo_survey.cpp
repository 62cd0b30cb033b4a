#include "demo/theses/macedo_survey.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <glm/geometric.hpp>

#include "demo/program/measure.hpp"
#include "demo/program/setting_choices.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo::macedo {
namespace {

struct Method {
    const char* name;
    const char* method;
    const char* kernel; ///< Its setting; null: it has none.
    std::vector<SettingChoice> settings;
    bool soft = false;
};

const Method& methodOf(Row row)
{
    static const std::array<Method, 16> all = {{
        {"map", "shadow_map", "filter", {{"filter", 1}, {"kernel", 0}}},
        {"conservative lines", "rbsm", nullptr, {{"mode", 0}}},
        {"lines", "rbsm", nullptr, {{"mode", 1}}},
        {"volumes", "all_edges_volume", nullptr, {}},
        {"moments", "moments", "filter", {{"kind", 4}, {"filter", 15}}},
        {"PCF", "shadow_map", "filter", {{"filter", 15}, {"kernel", 1}}},
        {"distances", "edt", nullptr, {{"mean", 0.5}}},
        {"RPCF", "rpcf", "filter", {{"filter", 7}}},
        {"uniform", "area_light", nullptr, {{"side", 17}}, true},
        {"adaptive", "area_adaptive", nullptr, {{"least", 0}, {"reasons", 0}}, true},
        {"revectorized", "area_revectorized", nullptr, {{"least", 0}, {"reasons", 0}}, true},
        {"PCSS", "pcss", nullptr, {}, true},
        {"EDTSSM", "edt_soft", nullptr, {}, true},
        {"RBSSM", "rbssm", nullptr, {}, true},
        {"SSRBSSM", "ssrbssm", nullptr, {}, true},
        {"VSSM", "moments_soft", nullptr, {}, true},
    }};
    return all[size_t(row)];
}

constexpr const char* kFiles[] = {"views/primitives", "views/bench", "views/flowers", "views/foliage"};

/// With its sun alone, which is five degrees wide where the method shows that. It moves a little, so that maps are
/// drawn in every frame.
Scene sceneOf(Scenery scenery, bool soft)
{
    Scene scene = valueOf(loadScene(kFiles[size_t(scenery)]));
    keepLights(scene, {"sun"});
    setSourceSizes(scene, {.radiusDegrees = soft ? 2.5 : 0.0});
    Light& sun = scene.lights[0];
    sun.isStatic = false;
    const glm::dvec3 later = glm::normalize(sun.direction + glm::dvec3(0.02, 0.0, 0.0));
    sun.keys = {{0.0, {}, sun.direction}, {10.0, {}, later}};
    return scene;
}

uint32_t scaled(uint32_t side, double share, uint32_t least)
{
    return std::max(least, static_cast<uint32_t>(std::lround(share * side)));
}

/// The share of the 289 points whose maps are drawn, which the method shows instead of shadows.
double pointsOf(Session& session, const char* method)
{
    expect(session.shadows.set(method, "reasons", 1.0));
    settle(session, method, frameTime(session.scene, 0), false);
    const double shown = session.renderer.readVisibility().front().texels.front();
    expect(session.shadows.set(method, "reasons", 0.0));
    return std::round(shown * 289.0 / 255.0);
}

Measured measureCell(Session& session, const Cell& cell, const Options& options)
{
    const Method& method = methodOf(cell.row);
    for (const SettingChoice& setting : method.settings)
        expect(session.shadows.set(method.method, setting.name, setting.value));
    if (cell.kernel != 0 && !session.shadows.set(method.method, method.kernel, cell.kernel)) return {};
    if (cell.row != Row::volume &&
        !session.shadows.set(method.method, kResolutionSetting, scaled(cell.map, options.share, 64)))
        return {};
    expect(session.shadows.pinAll(method.method));
    expect(session.shadows.warmUp(method.method));
    const PairTimes times = timePairs(session, options.frames, false, nullptr);
    Measured result{.served = times.unpinned == 0, .frameMs = median(times.withMs), .points = 0.0, .steps = {}};
    if (!result.served) return result;
    if (cell.row == Row::adaptive || cell.row == Row::revectorized) result.points = pointsOf(session, method.method);
    if (cell.row == Row::distances || cell.row == Row::revectorized || cell.row == Row::tables)
        for (const PassTime& pass : timePasses(session, 2))
            result.steps[pass.name.substr(0, pass.name.find('.', pass.name.find('.') + 1))] += pass.gpuMs + pass.cpuMs;
    return result;
}

} // namespace

const char* nameOf(Row row) noexcept
{
    return methodOf(row).name;
}

const char* nameOf(Scenery scenery) noexcept
{
    return kFiles[size_t(scenery)];
}

Times measure(Device& device, Times cells, const Options& options)
{
    for (const Scenery scenery : {Scenery::figure, Scenery::lattice, Scenery::fine, Scenery::trees})
        for (const bool soft : {false, true}) {
            const auto wanted = [&](const Cell& cell) {
                return cell.scenery == scenery && methodOf(cell.row).soft == soft;
            };
            if (std::ranges::none_of(cells, wanted, [](const auto& entry) { return entry.first; })) continue;
            const Scene scene = sceneOf(scenery, soft);
            std::unique_ptr<Session> session;
            const Cell* last = nullptr;
            for (auto& [cell, measured] : cells) { // by scenery, then by picture
                if (!wanted(cell)) continue;
                const VkExtent2D full = kPictures[size_t(cell.picture)];
                if (!session || last->picture != cell.picture) {
                    session.reset();
                    session = std::make_unique<Session>(device, scene,
                                                        SessionOptions{.scene = {},
                                                                       .size = {scaled(full.width, options.share, 32),
                                                                                scaled(full.height, options.share, 18)},
                                                                       .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT,
                                                                       .pinnedThreads = true});
                }
                last = &cell;
                measured = measureCell(*session, cell, options);
                if (options.measured) options.measured(cell, measured);
            }
        }
    return cells;
}

} // namespace gnomon::demo::macedo
