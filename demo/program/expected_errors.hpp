#pragma once
// How well the runtime knows on how much of what a light falls on a method is wrong.

#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

/// For each of CalibrateOptions::errors, at its time 0: percent that are expected of every light and method, percent
/// that differ from the truth, and by how much the two differ over all lights. Printed.
int expectedErrors(const CalibrateOptions& options, Device& device);

} // namespace gnomon::demo
