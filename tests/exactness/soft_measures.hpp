#pragma once
// What methods with penumbrae have in common: how wide these are, and what gets into the umbra.
#include <span>
#include <string>

#include "exactness/soft_reference.hpp"

namespace gnomon::exact {

/// Under the lamp of halfPlane(): metres along x on the floor from where a tenth of the lamp is seen to where nine
/// tenths are, from all pixels of the ramp: the slope of the line that fits them best.
double widthOnFloor(const Stage& stage, const Image8& picture);

/// Checks that penumbrae under a sheet at several heights are as wide as traced ones, and grow in proportion to the
/// height over its distance from the lamp. \param lowest height, metres, that the methods' penumbrae are compared at
void checkLinear(std::span<const char* const> methods, LightKind kind, float radius, double lowest = 0.2);

/// A crate, and a lid that keeps all light from a part of the floor.
Scene umbraScene(LightKind kind, float radius);

/// Pixels of the umbra and of the light with nothing else within two pixels; of these leaks, that have any light, and
/// specks, that lack more than 2 % of it.
struct UmbraCount {
    uint64_t umbra = 0, leaks = 0, light = 0, specks = 0;
};
UmbraCount countUmbra(const Image8& picture, const SoftTruth& truth);
std::string inWords(const UmbraCount& count);

} // namespace gnomon::exact
