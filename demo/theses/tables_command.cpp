// The main tables of theses on shadows, ours beside the printed numbers.
#include <algorithm>
#include <cstdio>
#include <iterator>

#include "demo/program/checks.hpp"
#include "demo/theses/commands.hpp"
#include "demo/theses/macedo_tables.hpp"
#include "demo/theses/moderno_tables.hpp"
#include "demo/theses/morais_tables.hpp"
#include "demo/theses/navratil_tables.hpp"

namespace gnomon::demo {
namespace {

std::vector<PairTable> moderno(Device& device, const TablesOptions& options)
{
    const auto progress = [](const ChainView& view) {
        std::fprintf(stderr, "%s %s %u: map of %u texels, %.2f %% of the image wrong\n", view.scene, nameOf(view.look),
                     view.map, view.side, percentOf(view.whole.wrong(), view.image));
    };
    return modernoTables(measureChain(
        device,
        {.picture = options.picture, .fit = options.tight ? MapFit::tight : MapFit::square, .measured = progress}));
}

std::vector<PairTable> morais(Device& device, const TablesOptions& options)
{
    MapCensusOptions census{.picture = options.picture, .lambdas = true};
    census.measured = [](const MapView& view) {
        std::fprintf(stderr, "%s %s %u:", view.scene, nameOf(view.look), view.map);
        for (size_t i = 0; i < kMapMethods; ++i)
            std::fprintf(stderr, " %s %.1f %%", nameOf(MapMethod(i)), tracedPercent(view, MapMethod(i)));
        std::fprintf(stderr, " traced\n");
    };
    return moraisTables(measureMaps(device, census));
}

std::vector<PairTable> navratil(Device& device, const TablesOptions& options)
{
    const SurveyOptions survey{.picture = options.picture,
                               .pairs = options.repeat,
                               .share = options.share,
                               .measured = [](const char* what, uint32_t map, const SurveyTime& time) {
                                   std::fprintf(
                                       stderr, "%s, maps of %u: frame %.1f ms, shadows %.1f ms, %.2f parts%s\n", what,
                                       map, time.frameMs, time.shadowsMs, time.parts, time.served ? "" : ", no memory");
                               }};
    const Survey walk = measureSurvey(device, survey);
    std::vector<PairTable> tables = navratilTables(walk, measureHemisphere(device, survey));
    const auto progress = [](const char* scene, const char* what, const WarpTime& time) {
        std::fprintf(stderr, "%s, %s: frame %.1f ms, shadows %.1f ms, maps %.1f ms, look-up %.1f ms\n", scene, what,
                     time.frameMs, time.shadowsMs, time.mapMs, time.lookupMs);
    };
    const WarpSurvey warps = measureWarps(device, {.picture = options.picture,
                                                   .map = std::max(64u, options.picture / 2),
                                                   .pairs = options.repeat,
                                                   .measured = progress});
    std::ranges::move(navratilWarpTables(warps), std::back_inserter(tables));
    return tables;
}

std::vector<PairTable> macedoOf(Device& device, const TablesOptions& options)
{
    const auto progress = [](const macedo::Cell& cell, const macedo::Measured& measured) {
        std::fprintf(stderr, "%s, %s, %u rows, map of %u, kernel %u: %.1f ms, %.0f points%s\n", nameOf(cell.scenery),
                     nameOf(cell.row), macedo::kPictures[size_t(cell.picture)].height, cell.map, cell.kernel,
                     measured.frameMs, measured.points, measured.served ? "" : ", not served");
    };
    return macedoTables(macedo::measure(device, macedoCells(),
                                        {.share = options.share, .frames = options.repeat, .measured = progress}));
}

std::vector<PairTable> tablesOf(Device& device, const TablesOptions& options)
{
    if (options.thesis == "macedo") return macedoOf(device, options);
    if (options.thesis == "morais") return morais(device, options);
    return options.thesis == "navratil" ? navratil(device, options) : moderno(device, options);
}

} // namespace

int tablesCommand(const TablesOptions& options)
{
    requireWritable(options.csv);
    const std::unique_ptr<Device> device = Device::create({});
    const std::vector<PairTable> tables = tablesOf(*device, options);
    for (const PairTable& table : tables)
        std::printf("%s\n", markdownOf(table).c_str());
    if (!options.csv.empty()) expect(csvOf(tables).save(options.csv));
    return 0;
}

} // namespace gnomon::demo
