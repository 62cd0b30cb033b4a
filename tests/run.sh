#!/usr/bin/env bash
# Builds everything and runs every test. The last lines are CTest's; the exit code is its exit code. Arguments go to
# ctest, such as `-R stencil`.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"

install_packages tests
build_release ON
say "testing"
# Two at a time: the device uses every core, but half of a test is one thread's work. About 40 minutes on two
# cores.
exec ctest --preset release --no-tests=error --parallel 2 "$@"
