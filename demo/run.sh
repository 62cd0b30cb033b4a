#!/usr/bin/env bash
# Builds gnomon and runs its main job: a street at night with 64 lights, headless, by the default rules, on the software
# Vulkan device or whichever GNOMON_DEVICE names. Leaves tables and pictures in out/run. Then it runs parts of the path
# once more beside each method that served most, for every light, says in three sentences who took what, and ends with
# a page about it all.
# Arguments go to `gnomon run` after the scene.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"

install_packages demo
build_release OFF gnomon_cli
say "running city_night"
case " $* " in *" --size"*) ;; *) set -- --size 640x360 "$@" ;; esac
case " $* " in *" --out"* | *" --window"*) ;; *) set -- --out "$root/out/run" "$@" ;; esac
"$build/gnomon" run city_night "$@"

# Pinned methods choose nothing, and a window leaves no tables.
case " $* " in *" --method"* | *" --window"*) exit 0 ;; esac
for ((i = 1; i <= $#; i++)); do
    case "${!i}" in
    --out) next=$((i + 1)) && out="${!next}" ;;
    --out=*) out="${!i#--out=}" ;;
    esac
done
# Those that served in a fiftieth of all rows at least: a row is a light in a frame.
favoured="$(awk -F , 'NR > 1 && $3 != "none" { ++rows[$3]; ++all }
    END { for (method in rows) if (rows[method] >= all / 50) print method }' "$out/lights.csv" | sort | paste -s -d ,)"
say "holding it against $favoured"
"$build/gnomon" compare city_night --methods "$favoured" --size 640x360 --stride 12 --alternations 1 \
    --csv "$out/compare.csv" | tail -n 4
say "the whole run as a page"
"$build/gnomon" report "$out" --compare "$out/compare.csv"
