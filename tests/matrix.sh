#!/usr/bin/env bash
# What takes too long for every push: both compilers with warnings as errors, the sanitizers, the smallest build. Names
# as arguments select rows: tests/matrix.sh clang tsan. The row `fuzz` searches ten minutes per reader; YAML_CPP_SOURCES
# may name an unpacked source of yaml-cpp, to count coverage inside it too.
set -uo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"
install_packages tests || exit 1
cd "$root"

# Drivers and layers are not instrumented; what they keep to themselves is no finding about gnomon.
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
export TSAN_OPTIONS="suppressions=$root/tests/tsan.supp:ignore_noninstrumented_modules=1:history_size=4"
export UBSAN_OPTIONS="print_stacktrace=1"

# name | preset | further cmake arguments
rows=(
    "gcc|dev|-DCMAKE_C_COMPILER=gcc -DCMAKE_CXX_COMPILER=g++"
    "clang|dev|-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++"
    "asan|asan|"
    "tsan|tsan|"
    "minimum|minimum|"
    "fuzz|fuzz|-DGNOMON_FUZZ_YAML_CPP=${YAML_CPP_SOURCES:-}"
)
failed=0
report=()
for row in "${rows[@]}"; do
    IFS='|' read -r name preset arguments <<<"$row"
    if [ $# -gt 0 ] && [[ " $* " != *" $name "* ]]; then continue; fi
    use_build "matrix-$name"
    say "$name"
    result=ok
    # shellcheck disable=SC2086 # the arguments are words
    cmake --preset "$preset" -B "$build" -DGNOMON_BUILD_TESTS=ON $arguments >"$build/configure.log" 2>&1 &&
        cmake --build "$build" -- -j"$(nproc)" >"$build/build.log" 2>&1 || {
        tail -40 "$build/build.log" "$build/configure.log" 2>/dev/null
        result="build failed"
    }
    if [ "$result" = ok ]; then
        ctest --test-dir "$build" --output-on-failure --no-tests=error || result="tests failed"
    fi
    [ "$result" = ok ] || failed=1
    report+=("$(printf '%-10s %s' "$name" "$result")")
done
say "matrix"
printf '%s\n' "${report[@]}"
exit $failed
