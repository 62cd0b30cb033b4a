// The main tables of the theses on hybrid shadows, ours beside the printed numbers.
#include <cstdio>

#include "demo/program/checks.hpp"
#include "demo/theses/commands.hpp"
#include "demo/theses/moderno_tables.hpp"
#include "demo/theses/morais_tables.hpp"

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

} // namespace

int tablesCommand(const TablesOptions& options)
{
    requireWritable(options.csv);
    const std::unique_ptr<Device> device = Device::create({});
    const std::vector<PairTable> tables =
        options.thesis == "morais" ? morais(*device, options) : moderno(*device, options);
    for (const PairTable& table : tables)
        std::printf("%s\n", markdownOf(table).c_str());
    if (!options.csv.empty()) expect(csvOf(tables).save(options.csv));
    return 0;
}

} // namespace gnomon::demo
