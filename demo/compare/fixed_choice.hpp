#pragma once
// Fixed choices: one method for each kind of light, whatever the frame. Formed from what each method did in a few
// frames of its own. No device needed.
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "demo/compare/verdict.hpp"
#include "demo/scene/scene.hpp"

namespace gnomon::demo {

inline constexpr size_t kLightKinds = 3;

/// A method whose shadows take more than so many times those of the best one of equal quality is not run any further.
inline constexpr double kCut = 4.0;

/// What a method did for the lights of one kind.
struct KindTrial {
    bool served = false;
    double ms = 0.0; ///< A frame of all of them, by the times of their passes.
    NearFar errors;
};

struct MethodTrial {
    std::string method;
    std::array<KindTrial, kLightKinds> kinds; ///< By LightKind.
    double overBest = 0.0;                    ///< Over 0: it was cut, and took so many times the best so far.
};

/// Its time over the least time of the methods of equal quality, at the kind where that is the least. 0 where there is
/// no such method yet for a kind that it serves. Over kCut, no choice is worth a run with it.
double overBest(const MethodTrial& trial, const std::vector<MethodTrial>& earlier, const EqualQuality& quality);

struct FixedChoice {
    std::string name;                             ///< "ray_traced", or "ray_traced (spot) + cube_map (point)".
    std::array<std::string, kLightKinds> methods; ///< By LightKind; empty: the scene has none.
    double overBest = 0.0; ///< Over 0: it is not run, its shadows take so many times those of the cheapest.
};

/** \brief Every choice that is worth a run, without repetition.

Each method that serves all kinds of the scene's lights; each other one, with the cheapest method of equal quality for
the kinds that it does not serve (none, where there is no such method); and the cheapest of equal quality for each kind.
A choice that takes over kCut times that last one is not run. Methods that were cut come last, alone.
\param present by LightKind: the scene has such lights
*/
std::vector<FixedChoice> fixedChoices(const std::vector<MethodTrial>& trials,
                                      const std::array<bool, kLightKinds>& present, const EqualQuality& quality);

} // namespace gnomon::demo
