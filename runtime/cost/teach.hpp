#pragma once
// What a knowledge base says, told to a cost model.
#include <span>
#include <string_view>

#include "runtime/cost/cost_model.hpp"

namespace gnomon::cost {

/// A method of the cost model, by its index.
struct TaughtMethod {
    std::string_view algorithm;
    uint64_t kind = 0; ///< What it works with: methods of one kind cost alike.
};

/// Tells `model` what `device` says of every method from `firstMethod` on. A method that was not measured is expected
/// to be as costly as the costliest of its kind, term by term, and half an octave off that; one that was not measured
/// under a light with a radius, to take eight times as long for a pixel there. A GPU's numbers are in no relation to
/// what the cores of a software device take for both: its one factor becomes two.
/// @return how many of them were measured
uint32_t teach(CostModel& model, const DeviceKnowledge& device, std::span<const TaughtMethod> methods,
               uint32_t firstMethod = 0);

} // namespace gnomon::cost
