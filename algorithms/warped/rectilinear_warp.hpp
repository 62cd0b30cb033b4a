#pragma once
// Shadow map whose columns and rows are as wide as what the view sees in them is near.
// Source:    P. Rosen, "Rectilinear texture warping for fast adaptive shadow mapping", I3D 2012; J. Navratil,
//            "High-quality shadow rendering from complex light sources", 2015, 3.2.3 and 4.2.2.
// Reads:     casters' triangles; receiver depth and normals.     Writes: visibility.
// Strong at: receivers that fill a part of the light's reach; near ones beside far ones.
// Weak at:   one near receiver widens its whole column and row; the map is drawn in every frame.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kRectilinearWarp;

} // namespace gnomon
