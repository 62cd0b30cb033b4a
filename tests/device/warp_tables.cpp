#include "device/warp_tables.hpp"

#include <algorithm>
#include <cmath>

#include "shaders/warp_probe_comp.h"
#include "shaders/warp_probe_rectilinear_comp.h"
#include "shaders/warped_bounds_comp.h"
#include "shaders/warped_functions_columns_comp.h"
#include "shaders/warped_functions_comp.h"
#include "shaders/warped_places_comp.h"
#include "shaders/warped_recount_comp.h"
#include "shaders/warped_rectilinear_edges_comp.h"
#include "shaders/warped_rectilinear_places_comp.h"
#include "shaders/warped_smooth_columns_comp.h"
#include "shaders/warped_smooth_comp.h"

namespace gnomon::test {

namespace {

demo::Buffer constantsOf(const WarpMade& made)
{
    demo::Buffer buffer =
        demo::makeBuffer(device(), sizeof(gpu::WarpConstants), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, true);
    gpu::WarpConstants& constants = buffer.as<gpu::WarpConstants>()[0];
    constants = {};
    constants.base.map.side = made.side;
    constants.blur = made.blur;
    constants.evenShare = made.even;
    constants.power = made.power;
    constants.mostWeight = made.mostWeight;
    constants.maps = 1u << made.map;
    return buffer;
}

/// `of` behind `map` others that hold something else.
std::vector<uint32_t> behind(uint32_t map, const std::vector<uint32_t>& of)
{
    std::vector<uint32_t> all(map * of.size(), 7u);
    all.insert(all.end(), of.begin(), of.end());
    return all;
}

demo::Buffer unwritten(size_t floats)
{
    return bufferOf(std::vector<float>(floats, NAN));
}

/// Of the last map; nothing may have touched those before it.
std::vector<float> lastOf(const demo::Buffer& tables, uint32_t map, size_t size)
{
    const std::span<const float> all = tables.as<float>();
    REQUIRE(all.size() == (map + 1) * size);
    CHECK(std::ranges::all_of(all.first(map * size), [](float value) { return std::isnan(value); }));
    return {all.begin() + ptrdiff_t(map * size), all.end()};
}

std::vector<glm::vec4> held(const demo::Buffer& answers)
{
    const std::span<const glm::vec4> all = answers.as<glm::vec4>();
    return {all.begin(), all.end()};
}

uint32_t groupsOf(size_t count)
{
    return static_cast<uint32_t>((count + 63) / 64);
}

} // namespace

Grid NonorthogonalTables::functions(uint32_t kind) const
{
    Grid all;
    for (uint32_t f = 0; f < is.cells; ++f)
        all.emplace_back(function(kind, f).begin(), function(kind, f).end());
    return all;
}

NonorthogonalTables nonorthogonalOf(const WarpMade& made, const std::vector<uint32_t>& counts,
                                    const std::vector<glm::vec2>& asked)
{
    const gpu::WarpTable is = gpu::warpTable(0, made.side);
    const uint32_t maps = made.map + 1;
    const demo::Buffer constants = constantsOf(made), given = bufferOf(behind(made.map, counts));
    const demo::Buffer functions = unwritten(maps * gpu::warpFunctions(is.cells));
    const demo::Buffer recount = unwritten(maps * is.cells * is.cells), tables = unwritten(maps * is.size);
    const demo::Buffer places = bufferOf(asked), answers = bufferOf(std::vector<glm::vec4>(2 * asked.size()));
    const uint32_t rows = is.cells / 16, edges = groupsOf(is.edges);
    run({{k_warped_functions_comp, {{0, &constants}, {1, &given}, {2, &functions}}, rows, 1, maps},
         {k_warped_smooth_comp, {{0, &constants}, {1, &functions}, {2, &tables}}, edges, is.cells, maps},
         {k_warped_recount_comp, {{0, &constants}, {1, &given}, {2, &recount}, {5, &tables}}, rows, 1, maps},
         {k_warped_functions_columns_comp, {{0, &constants}, {1, &recount}, {2, &functions}}, rows, 1, maps},
         {k_warped_smooth_columns_comp, {{0, &constants}, {1, &functions}, {2, &tables}}, edges, is.cells, maps},
         {k_warped_bounds_comp, {{0, &constants}, {2, &tables}}, edges, 2 * is.blocks, maps},
         {k_warped_places_comp, {{0, &constants}, {2, &tables}}, groupsOf(size_t{is.cells} * is.texels), 2, maps},
         {k_warp_probe_comp, {{0, &constants}, {1, &places}, {2, &answers}, {5, &tables}}, groupsOf(asked.size())}});
    return {is, lastOf(tables, made.map, is.size), held(answers)};
}

RectilinearTables rectilinearOf(const WarpMade& made, const std::vector<uint32_t>& importance,
                                const std::vector<glm::vec2>& asked)
{
    const size_t size = gpu::rectilinearTable(made.side);
    const uint32_t maps = made.map + 1;
    const demo::Buffer constants = constantsOf(made), given = bufferOf(behind(made.map, importance));
    const demo::Buffer tables = unwritten(maps * size);
    const demo::Buffer places = bufferOf(asked), answers = bufferOf(std::vector<glm::vec4>(asked.size()));
    const uint32_t texels = groupsOf(2 * static_cast<size_t>(made.side));
    run({{k_warped_rectilinear_edges_comp, {{0, &constants}, {1, &given}, {2, &tables}}, 2, 1, maps},
         {k_warped_rectilinear_places_comp, {{0, &constants}, {2, &tables}}, texels, 1, maps},
         {k_warp_probe_rectilinear_comp,
          {{0, &constants}, {1, &places}, {2, &answers}, {5, &tables}},
          groupsOf(asked.size())}});
    return {lastOf(tables, made.map, size), held(answers)};
}

} // namespace gnomon::test
