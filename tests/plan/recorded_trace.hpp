#pragma once
// Traces of a real device: tests/traces.
#include <doctest/doctest.h>
#include <fstream>
#include <sstream>
#include <string>

#include "demo/replay/trace.hpp"

namespace gnomon::test {

/// One of tests/traces, whole; fails the test where it is not.
inline demo::Trace recordedTrace(const std::string& name)
{
    std::ifstream file(std::string(GNOMON_TRACES) + "/" + name + ".gntrace", std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    demo::Outcome<demo::Trace> trace = demo::readTrace(bytes.str());
    REQUIRE_MESSAGE(trace, name, ": ", trace.error());
    return std::move(*trace);
}

} // namespace gnomon::test
