#pragma once
// The commands of gnomon-theses. Each returns its exit code; failures are HostErrors.

#include <cstdint>
#include <optional>
#include <string>

namespace gnomon::demo {

struct TablesOptions {
    std::string thesis;      ///< macedo, moderno, morais or navratil.
    std::string csv;         ///< Empty: no file.
    uint32_t picture = 1024; ///< Pixels a side.
    bool tight = false;      ///< moderno: the other of the fits that the thesis may mean.
    uint32_t repeat = 6;     ///< macedo, navratil: frames that are timed.
    double share = 1.0;      ///< navratil: of the vertices and lamps; macedo: of the sides of pictures and maps.
};
int tablesCommand(const TablesOptions& options);

struct FigureOptions {
    std::string figure; ///< The thesis's number.
    std::string size, csv, out;
    uint32_t repeat = 15;
    bool still = false; ///< The model does not turn.
};
int figureCommand(const FigureOptions& options);

struct ReasonsOptions {
    std::string scene, method, light, settings, size;
    std::optional<uint32_t> frame; ///< Default: the middle one.
    std::string out;               ///< Empty: no picture.
};
int reasonsCommand(const ReasonsOptions& options);

} // namespace gnomon::demo
