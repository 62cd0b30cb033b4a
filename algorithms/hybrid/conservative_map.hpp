#pragma once
// Two depth layers that cannot be wrong: triangles grown by half a texel and shrunk by half a texel. What lies before
// all grown ones is lit, what lies behind a shrunk one is dark, and the rest is traced on the CPU. Source:    E.
// Hertel, K. Hormann, R. Westermann, "A hybrid GPU rendering pipeline for alias-free hard shadows", Eurographics
//            2009, areas papers; F. Morais 2015, 3.4.2 and 4 (CRSM).
// Reads:     casters' triangles, receiver depth and normals (also read back).     Writes: visibility.
// Strong at: exact, whatever the map's resolution; large triangles, little of the picture in shadow.
// Weak at:   every edge between triangles tears the shadow: inside it, finely divided casters leave all pixels to the
// rays.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kConservativeMap;

} // namespace gnomon
