#!/usr/bin/env bash
# What takes too long for every push: both compilers with warnings as errors, the sanitizers, the smallest build,
# clang-tidy over the sources, the reference of the API. Names as arguments select rows: tests/matrix.sh clang tsan.
# Compilers and sanitizers run the unit tests and `core`, which draws every method's passes: tests/run.sh has run the
# others, and a sanitizer takes three to eight times as long. The row `full` runs every test under the validation layer,
# and exactness in pictures of 1280x720, not 640x360. MATRIX_LABELS=. runs all tests in all rows (a day on two
# cores); another expression runs what bears a label that it matches. The row `fuzz` searches ten minutes per reader;
# YAML_CPP_SOURCES may name an unpacked source of yaml-cpp, to count coverage inside it too.
set -uo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"
install_packages tests || exit 1
cd "$root"

# Drivers and layers are not instrumented; what they keep to themselves is no finding about gnomon.
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
export TSAN_OPTIONS="suppressions=$root/tests/tsan.supp:ignore_noninstrumented_modules=1:history_size=4"
export UBSAN_OPTIONS="print_stacktrace=1"

show_log() {
    tail -40 "$1"
    return 1
}
build_target() { cmake --build "$build" "$@" -- -j"$(nproc)" >"$build/build.log" 2>&1 || show_log "$build/build.log"; }

# The step of most rows, and those of `tidy` and `docs`. Each prints what went wrong.
# `labels` is the row's.
build_and_test() {
    build_target && ctest --test-dir "$build" --output-on-failure --no-tests=error --parallel 2 \
        -L "${MATRIX_LABELS:-$labels}"
}
test_fully() { GNOMON_TEST_FULL=1 build_and_test; }
build_docs() { build_target --target docs; }
# Every source of the library and the programs that is compiled here. The build makes the headers of the shaders.
check_sources() {
    build_target --target gnomon gnomon_cli || return 1
    local file sources=()
    while read -r file; do
        grep -qF "\"$root/$file\"" "$build/compile_commands.json" && sources+=("$file")
    done < <(git ls-files 'runtime/*.cpp' 'algorithms/*.cpp' 'rules/*.cpp' 'demo/*.cpp')
    [ ${#sources[@]} -gt 0 ] && printf '%s\0' "${sources[@]}" |
        xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build"
}

# name | preset | further cmake arguments | step | labels of the tests
rows=(
    "full|release||test_fully|."
    "gcc|dev|-DCMAKE_C_COMPILER=gcc -DCMAKE_CXX_COMPILER=g++|build_and_test|^(unit|core)$"
    "clang|dev|-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++|build_and_test|^(unit|core)$"
    "asan|asan||build_and_test|^(unit|core)$"
    "tsan|tsan||build_and_test|^(unit|threads)$"
    "minimum|minimum||build_and_test|."
    "fuzz|fuzz|-DGNOMON_FUZZ_YAML_CPP=${YAML_CPP_SOURCES:-}|build_and_test|."
    "tidy|dev|-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++|check_sources|"
    "docs|minimum||build_docs|"
)
failed=0
report=()
for row in "${rows[@]}"; do
    IFS='|' read -r name preset arguments step labels <<<"$row"
    if [ $# -gt 0 ] && [[ " $* " != *" $name "* ]]; then continue; fi
    use_build "matrix-$name"
    say "$name"
    result=ok
    # shellcheck disable=SC2086 # the arguments are words
    if ! cmake --preset "$preset" -B "$build" -DGNOMON_BUILD_TESTS=ON $arguments >"$build/configure.log" 2>&1; then
        show_log "$build/configure.log"
        result="configuring failed"
    elif ! "$step"; then
        result=failed
    fi
    [ "$result" = ok ] || failed=1
    report+=("$(printf '%-10s %s' "$name" "$result")")
done
say "matrix"
printf '%s\n' "${report[@]}"
exit $failed
