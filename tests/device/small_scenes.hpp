#pragma once
#include <vector>

#include "demo/scene/scene.hpp"

namespace gnomon::test {

/// The shipped scenes that a software device draws with any method in about a second: at most 16 lights and 150 000
/// triangles.
std::vector<demo::Scene> smallShippedScenes();

} // namespace gnomon::test
