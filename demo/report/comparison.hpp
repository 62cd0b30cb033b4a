#pragma once
// The page of `gnomon publish`: every method by scene and kind of light.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "demo/io/outcome.hpp"
#include "demo/report/measured.hpp"

namespace gnomon::demo {

/// Columns of the command's table behind those of `bench`.
inline constexpr std::string_view kLightKindColumn = "light_kind", kDateColumn = "date";

struct Compilation {
    struct Row {
        Benched::Row measured;   ///< NaN in what is not known.
        std::string kind, where; ///< Of the light; device, driver, date and size of the picture.
        double memoryMib = 0.0;
    };
    std::vector<Row> rows; ///< One a method, scene, kind and place.
    std::vector<std::string> notes;
};
/// Appends the rows of a table of `gnomon publish`.
Status readCompilation(const std::filesystem::path& file, Compilation& into);

/// In Markdown, for a folder beside algorithms/. \param command that made it. \param tables Paths from the page.
std::string comparisonPage(const Compilation& all, std::string_view command, const std::vector<std::string>& tables);

} // namespace gnomon::demo
