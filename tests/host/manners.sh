#!/usr/bin/env bash
# What a guest's manners cost: memory through the host's hooks, and the shared library. manners.sh [ROUNDS [FRAMES]]
#
# Runs three programs in turn, ROUNDS times: static library, the same with --hooks 1, shared library. Of each run the
# median frame counts, of each program the smallest of these. Prints the ratios to the first program, and fails where
# one is above 1.02. For a machine without other work; MANNERS_METHOD (cube_map) is pinned, MANNERS_SIZE is 640x360.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
source "$root/cmake/setup.sh"
rounds="${1:-9}" frames="${2:-60}" bound=1.02
method="${MANNERS_METHOD:-cube_map}" size="${MANNERS_SIZE:-640x360}"

cd "$root"
for kind in OFF ON; do # each in a folder of its own, with the same flags
    cmake --preset release -B "build/manners_$kind" -DGNOMON_BUILD_TESTS=ON -DBUILD_SHARED_LIBS=$kind >/dev/null
    cmake --build "build/manners_$kind" --target gnomon_host_bench
done
ldd build/manners_ON/gnomon_host_bench | grep -q libgnomon.so || {
    echo "build/manners_ON/gnomon_host_bench does not use libgnomon.so" >&2
    exit 1
}
export MESA_SHADER_CACHE_DIR="$root/build/manners_OFF/shader_cache" GNOMON_DATA_DIR="$root"
results="$(mktemp -d)"
trap 'rm -rf "$results"' EXIT

# measure NAME FOLDER HOOKS: appends the run's medians of call and wall, milliseconds. The first 8 frames warm up.
measure() {
    "build/$2/gnomon_host_bench" --entry recorded --method "$method" --size "$size" --frames "$((frames + 8))" \
        --hooks "$3" --csv "$results/frames.csv" >"$results/said" 2>&1 || {
        cat "$results/said" >&2
        return 1
    }
    for column in 5 6; do
        tail -n +10 "$results/frames.csv" | cut -d, -f$column | sort -g | sed -n "$(((frames + 1) / 2))p"
    done | paste -sd' ' >>"$results/$1"
}
for ((round = 0; round < rounds; ++round)); do
    measure static manners_OFF 0
    measure hooks manners_OFF 1
    measure shared manners_ON 0
done

printf '%-8s %10s %10s %8s %8s   (%d rounds of %d frames, %s, %s)\n' program 'call ms' 'wall ms' call wall \
    "$rounds" "$frames" "$method" "$size"
for name in static hooks shared; do
    smallest=()
    for column in 1 2; do
        smallest+=("$(cut -d' ' -f$column "$results/$name" | sort -g | sed -n 1p)")
    done
    [ "$name" != static ] || first=("${smallest[@]}")
    awk -v name="$name" -v call="${smallest[0]}" -v wall="${smallest[1]}" \
        -v call0="${first[0]}" -v wall0="${first[1]}" -v bound=$bound 'BEGIN {
            printf "%-8s %10.3f %10.3f %8.3f %8.3f\n", name, call, wall, call / call0, wall / wall0
            exit wall / wall0 > bound
        }' || status=1
done
exit "${status:-0}"
