#include "demo/program/bench_scene.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>

#include "demo/io/png.hpp"
#include "demo/program/aliasing.hpp"
#include "demo/program/ambiguity.hpp"
#include "demo/program/bench_bare.hpp"

namespace gnomon::demo {
namespace {

uint64_t softPixels(const BenchRow& row)
{
    return row.soft.penumbra.pixels + row.soft.outside.pixels;
}

double penumbraPercent(const BenchRow& row)
{
    return 100.0 * double(row.soft.penumbra.pixels) / double(softPixels(row));
}

void print(const char* where, const SoftError::Part& part)
{
    std::printf("; %s RMSE %.4f, mean %.4f, off by > 0.1 %.3f %%", where, part.rmse(), part.mean(), part.farPercent());
}

} // namespace

const std::vector<std::string>& benchColumns()
{
    static const std::vector<std::string> columns = parseNames(
        "scene,method,lights,width,height,map,triangles,gpu_ms_p50,cpu_ms_p50,wall_ms_min,wall_ms_p50,"
        "increment_ms_min,wrong_pct,rays,memory_mib,device,driver,false_lit_pct,false_shadow_pct,ambiguous_pct,"
        "mean_abs_error,penumbra_pct,penumbra_rmse,penumbra_mean_abs,penumbra_off_pct,outside_rmse,"
        "outside_mean_abs,outside_off_pct,aliasing_p50,aliasing_p95");
    return columns;
}

const GnSettingInfo* sizeSetting(const GnMethodInfo& method)
{
    for (uint32_t i = 0; i < method.settingCount; ++i) {
        const std::string_view name = method.pSettings[i].pName;
        if (name == kResolutionSetting || name == kRowsSetting) return &method.pSettings[i];
    }
    return nullptr;
}

const char* reasonAgainst(const GnMethodInfo& method, const Scene& scene, bool recorded)
{
    if (method.pUnavailable) return method.pUnavailable;
    if (recorded && method.roundTrips > 0) return "it cannot be recorded";
    return servesOne(scene, method.traits) ? nullptr : "it serves none of the lights";
}

SceneBench::SceneBench(Device& device, const Scene& scene, const BenchOptions& options,
                       const std::vector<SettingChoice>& choices)
    : device_(device), scene_(scene), options_(options), choices_(choices)
{
    size_ = options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
    // The error is judged in this frame, near the last measured one, where whatever moves has moved.
    truthTime_ = frameTime(scene, options.repeat);
}

BenchRow SceneBench::base() const
{
    Session session(device_, scene_, sessionOptions());
    BenchRow row = rowFor(session, kNoneMethod, 0);
    row.times = timePairs(session, options_.repeat, false, &nothing_);
    row.times.withMs = row.times.withoutMs;
    return row;
}

BenchRow SceneBench::bare(uint32_t map)
{
    Scene one = scene_;
    one.lights.resize(1);
    Session session(device_, one, sessionOptions());
    BareShadowMap shadows(device_, one, session.geometry, session.renderer, map);
    BenchRow row = rowFor(session, kBareMethod, map);
    row.times = timePairs(session, options_.repeat, false, &shadows);
    return row;
}

BenchRow SceneBench::method(const std::string& name, GnTraits traits, std::optional<uint32_t> map)
{
    const Scene served = onlyServed(scene_, traits);
    Session session(device_, served, sessionOptions());
    const GnMethodInfo info = infoOf(session.shadows, name);
    if (map) expect(session.shadows.set(name, sizeSetting(info)->pName, *map));
    setChoices(session.shadows, name, choices_);
    expect(session.shadows.pinAll(name));
    settle(session, name, frameTime(served, 0), options_.recorded);
    const GnMethodInfo inForce = infoOf(session.shadows, name);
    const GnSettingInfo* size = sizeSetting(inForce);
    BenchRow row = rowFor(session, name, size ? static_cast<uint32_t>(size->value) : 0);
    row.times = timePairs(session, options_.repeat, options_.recorded, nullptr);
    if (row.times.unpinned > 0)
        std::fprintf(stderr,
                     "note: %s: in %u of %u frames %s did not serve all of its lights: the row is not its own\n%s",
                     scene_.name.c_str(), row.times.unpinned, options_.repeat, name.c_str(),
                     session.shadows.whyNot(row.times.unpinnedLight, name, row.times.unpinnedFrame).c_str());
    const GnFrameStats stats = session.shadows.stats();
    row.rays = stats.rays;
    row.memoryMib = double(stats.memory) / (1024.0 * 1024.0);
    if (options_.passes && !options_.recorded) row.passes = timePasses(session, options_.repeat);
    settle(session, name, truthTime_, options_.recorded);
    addErrors(session, row);
    return row;
}

SessionOptions SceneBench::sessionOptions() const
{
    return {.scene = {},
            .size = size_,
            .memoryLimit = VkDeviceSize{options_.memory} << 20,
            .pinnedThreads = true,
            .plugins = options_.plugins};
}

BenchRow SceneBench::rowFor(const Session& session, const std::string& method, uint32_t map) const
{
    BenchRow row;
    row.scene = scene_.name;
    row.method = method;
    row.lights = session.scene.lights.size();
    row.size = session.renderer.extent();
    row.map = map;
    row.triangles = triangleCount(scene_);
    return row;
}

void SceneBench::addErrors(Session& session, BenchRow& row)
{
    if (!truthTried_) {
        truth_ = measureTruth(device_, scene_, size_, truthTime_);
        truthTried_ = true;
        if (truth_) findAmbiguous();
    }
    if (!truth_) return;
    const std::vector<Image8> visibility = session.renderer.readVisibility();
    const SceneState& state = session.renderer.state();
    for (size_t layer = 0; layer < state.present.size(); ++layer) {
        const std::string& light = session.scene.lights[state.present[layer]].name;
        const std::vector<uint8_t>* counted = nullptr;
        const Image8* truth = truth_->find(light, &counted);
        if (!truth) continue;
        const auto index = static_cast<size_t>(counted - truth_->counted.data());
        const ErrorCount errors = compare(visibility[layer], *truth, *counted, ambiguous_[index]);
        row.errors += errors;
        row.hasErrors = true;
        if (const Image8& soft = truth_->soft[index]; soft.width > 0)
            row.soft += compareSoft(visibility[layer], soft, *counted);
        addAliasing(session, state.present[layer], *counted, row);
        if (errors.percent(errors.wrong()) >= row.worstLightPercent) {
            row.worstLightPercent = errors.percent(errors.wrong());
            row.worstLight = light;
        }
    }
}

void SceneBench::addAliasing(Session& session, uint32_t light, const std::vector<uint8_t>& counted, BenchRow& row) const
{
    GnLightMap map{GN_INIT(GnLightMap)};
    if (gnGetLightMap(session.shadows.context(), session.shadows.light(light), &map) < 0) {
        (void)session.shadows.takeMessages(); // it hands out none
        return;
    }
    const Light& is = session.scene.lights[light];
    const std::optional<ImageF> aliasing = measureAliasing(map, is.kind, truth_->camera, truth_->surfaces, counted);
    if (!aliasing) return;
    std::ranges::copy_if(aliasing->texels, std::back_inserter(row.aliasing), [](float m) { return m > 0.0f; });
    if (options_.aliasing.empty()) return;
    const std::string file = row.scene + '_' + row.method + '_' + std::to_string(row.map) + '_' + is.name + ".png";
    expect(writePng(std::filesystem::path(options_.aliasing) / file, pictureOf(*aliasing)));
}

/// A property of scene, camera and light, the same for every method.
void SceneBench::findAmbiguous()
{
    for (size_t layer = 0; layer < truth_->lights.size(); ++layer) {
        const uint32_t light = truth_->state.present[layer];
        ambiguous_.push_back(ambiguousPixels(scene_, truth_->state, truth_->camera, truth_->surfaces,
                                             scene_.lights[light], truth_->state.lights[light],
                                             truth_->counted[layer]));
    }
}

void addCells(CsvWriter& csv, const BenchRow& row, const Device& device)
{
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN(); // an empty cell
    csv.cell(row.scene).cell(row.method).cell(row.lights).cell(row.size.width).cell(row.size.height);
    if (row.map > 0)
        csv.cell(row.map);
    else
        csv.empty();
    csv.cell(row.triangles).cell(median(row.times.gpuMs), 3).cell(median(row.times.cpuMs), 3);
    csv.cell(minimum(row.times.withMs), 3).cell(median(row.times.withMs), 3);
    csv.cell(incrementMs(row), 3);
    const ErrorCount& e = row.errors;
    const auto error = [&](double value, int decimals) { csv.cell(row.hasErrors ? value : nothing, decimals); };
    error(e.percent(e.wrong()), 4);
    csv.cell(row.rays).cell(row.memoryMib, 2).cell(device.properties.deviceName).cell(device.driver);
    error(e.percent(e.falseLit), 4);
    error(e.percent(e.falseShadow), 4);
    error(e.percent(e.ambiguous), 4);
    error(e.meanAbsolute(), 6);
    const auto soft = [&](double value, int decimals) { csv.cell(softPixels(row) > 0 ? value : nothing, decimals); };
    soft(penumbraPercent(row), 4);
    for (const SoftError::Part& part : {row.soft.penumbra, row.soft.outside}) {
        soft(part.rmse(), 6);
        soft(part.mean(), 6);
        soft(part.farPercent(), 4);
    }
    for (const double share : {0.5, 0.95})
        csv.cell(row.aliasing.empty() ? nothing : quantile(row.aliasing, share), 4);
}

double incrementMs(const BenchRow& row)
{
    return row.method == kNoneMethod ? 0.0 : minimum(row.times.withMs) - minimum(row.times.withoutMs);
}

void printRow(const BenchRow& row)
{
    std::printf("%-12s %-16s %2zu lights %ux%u map %4u  increment %8.3f ms  frame %8.3f ms", row.scene.c_str(),
                row.method.c_str(), row.lights, row.size.width, row.size.height, row.map, incrementMs(row),
                minimum(row.times.withMs));
    if (row.hasErrors)
        std::printf("  wrong %.4f %% (worst %s %.4f %%; %llu px clearly, %.3f %% ambiguous)",
                    row.errors.percent(row.errors.wrong()), row.worstLight.c_str(), row.worstLightPercent,
                    static_cast<unsigned long long>(row.errors.wrongClear), row.errors.percent(row.errors.ambiguous));
    std::printf("\n");
    if (softPixels(row) > 0) {
        std::printf("    soft: penumbra %.2f %% of the pixels", penumbraPercent(row));
        print("in it", row.soft.penumbra);
        print("outside", row.soft.outside);
        std::printf("\n");
    }
    if (!row.aliasing.empty())
        std::printf("    aliasing: a texel is %.3f pixels wide in the median, 95 %% are below %.3f\n",
                    quantile(row.aliasing, 0.5), quantile(row.aliasing, 0.95));
    if (const PairTimes& t = row.times; t.pagesEvicted + t.pagesWithoutRoom > 0) {
        const double frames = double(t.withMs.size());
        std::printf("    pages: %.1f evicted a frame, %.1f without room\n", double(t.pagesEvicted) / frames,
                    double(t.pagesWithoutRoom) / frames);
    }
    for (const PassTime& pass : row.passes)
        std::printf("    %-32s x%-3u GPU %8.3f ms  CPU %8.3f ms\n", pass.name.c_str(), pass.count, pass.gpuMs,
                    pass.cpuMs);
    std::fflush(stdout);
}

} // namespace gnomon::demo
