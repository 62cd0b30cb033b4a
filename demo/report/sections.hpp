#pragma once
// The parts of the page of `gnomon report`, each a <section>, or empty where there is nothing to show.
#include <span>
#include <string>

#include "demo/report/measured.hpp"
#include "demo/report/run_data.hpp"

namespace gnomon::demo {

std::string headlineSection(const RunData& run);
std::string frameSection(const RunData& run);
std::string laneSection(const RunData& run);
std::string distanceSection(const RunData& run);
std::string savedSection(const Compared& compared);
std::string errorSection(const Benched& benched);
/// The charts of errorSection() as an SVG file.
std::string errorPicture(const Benched& benched);
std::string pictureSection(const RunData& run);
std::string worstSection(const RunData& run);
std::string reproduceSection(std::span<const std::string> commands, std::span<const std::string> notes);

} // namespace gnomon::demo
