// The main tables of the theses on hybrid shadows, ours beside the printed numbers.
#include <cstdio>

#include "demo/program/commands.hpp"
#include "demo/program/moderno_tables.hpp"

namespace gnomon::demo {
namespace {

std::vector<PairTable> moderno(Device& device, const TablesOptions& options)
{
    const auto progress = [](const ChainView& view) {
        std::fprintf(stderr, "%s %s %u: map of %u texels, %.2f %% of the image wrong\n", view.scene, nameOf(view.look),
                     view.map, view.side, percentOf(view.whole.wrong(), view.image));
    };
    return modernoTables(measureChain(device, {.picture = options.picture,
                                               .fit = options.tight ? MapFit::tight : MapFit::square,
                                               .measured = progress}));
}

} // namespace

int tablesCommand(const TablesOptions& options)
{
    const std::unique_ptr<Device> device = Device::create({});
    const std::vector<PairTable> tables = moderno(*device, options);
    for (const PairTable& table : tables)
        std::printf("%s\n", markdownOf(table).c_str());
    if (!options.csv.empty()) expect(csvOf(tables).save(options.csv));
    return 0;
}

} // namespace gnomon::demo
