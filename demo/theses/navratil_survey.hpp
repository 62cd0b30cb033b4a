#pragma once
// The survey of maps around point lights of Navratil's thesis (3.3.3), repeated: frames of a walk under a moving lamp,
// and lamps that have everything in one hemisphere.

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "demo/program/session.hpp"

namespace gnomon::demo {

/// A row of his tables: a method and what it leaves out.
struct SurveyMethod {
    const char* printed; ///< His name.
    const char* method;
    double culling; ///< The method's setting.
};
inline constexpr size_t kSurveyMethods = 6;
inline constexpr std::array<SurveyMethod, kSurveyMethods> kSurvey = {{{"Cube6", "cube_map", 0.0},
                                                                      {"Cube6Optim", "cube_map", 1.0},
                                                                      {"Cube6Opt+EFC", "cube_map", 3.0},
                                                                      {"DP", "dual_paraboloid", 0.0},
                                                                      {"DPOptim", "dual_paraboloid", 1.0},
                                                                      {"DPOptim+PC", "dual_paraboloid", 2.0}}};
inline constexpr std::array<uint32_t, 3> kSurveyMaps = {1024, 2048, 4096};
inline constexpr std::array<uint32_t, 2> kSurveyVertices = {600'000, 3'000'000};

/// Of the frames of one row and map.
struct SurveyTime {
    double frameMs = 0.0;   ///< Median, the picture without shadows included.
    double shadowsMs = 0.0; ///< Least frame, less the least without shadows.
    double parts = 0.0;     ///< Faces or paraboloids drawn, mean.
    bool served = false;    ///< There was memory for it.
};

struct SurveyOptions {
    uint32_t picture = 1024;                                     ///< Pixels a side.
    uint32_t pairs = 6;                                          ///< Frames that count.
    double share = 1.0;                                          ///< Of the vertices and of the lamps, in (0, 1].
    std::array<uint32_t, kSurveyMaps.size()> maps = kSurveyMaps; ///< Texels a side.
    std::function<void(const char* what, uint32_t map, const SurveyTime&)> measured;
};

/// By scene, method and map.
using Survey =
    std::array<std::array<std::array<SurveyTime, kSurveyMaps.size()>, kSurveyMethods>, kSurveyVertices.size()>;
Survey measureSurvey(Device& device, const SurveyOptions& options);

/// Lamps over a scene, everything in the lower hemisphere of each: Cube6Opt+EFC, and DPOptim+PC.
struct HemisphereTimes {
    uint32_t lamps = 0, vertices = 0;
    SurveyTime cube, paraboloid;
};
HemisphereTimes measureHemisphere(Device& device, const SurveyOptions& options);

/// In the names of passes that draw casters into a map.
inline constexpr std::string_view kCasterPasses = ".casters";
/// So many the newest frame had.
uint32_t casterPasses(const Session& session);

} // namespace gnomon::demo
