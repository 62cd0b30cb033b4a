#!/usr/bin/env bash
# Builds everything and runs every test. The last lines are CTest's; the exit code is its exit code. Arguments go to
# ctest, such as `-R stencil`.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"

install_packages
use_build release
say "configuring"
cd "$root"
cmake --preset release -DGNOMON_BUILD_TESTS=ON >"$build/configure.log" 2>&1 || {
    cat "$build/configure.log" >&2
    exit 1
}
say "building"
cmake --build --preset release -- -j"$(nproc)"
say "testing"
# Two at a time: the device uses every core, but half of a test is one thread's work: ten minutes on two
# cores.
exec ctest --preset release --no-tests=error --parallel 2 "$@"
