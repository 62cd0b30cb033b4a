#pragma once
// Soft shadows of lights with a radius from their depth map, filtered on the screen: the blockers around a receiver say
// how wide the penumbra is, and the hard shadow is blurred as widely on the receiver's plane.
// Source:    Z. Zheng, S. Saito, "Screen space anisotropic blurred soft shadows", SIGGRAPH 2011 posters;
//            M. MohammadBagher, J. Kautz, N. Holzschuch, C. Soler, "Screen-space percentage-closer soft shadows",
//            SIGGRAPH 2010 posters.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: wide penumbrae without grain, at a price that grows with their width and not with its square.
// Weak at:   shadows whose edge is not on the screen; several casters; edges as fine as texels are.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kScreenSoft;

} // namespace gnomon
