#!/usr/bin/env bash
# Builds gnomon and runs its main job: a street at night with 64 lights, headless, by the default rules, on the software
# Vulkan device or whichever GNOMON_DEVICE names. Leaves tables and pictures in out/run. Then it runs parts of the path
# once more beside each method that served most, for every light, says in three sentences who took what, measures these
# methods one by one, and ends with a page about it all and the seconds that each step took.
# Arguments go to `gnomon run` after the scene; those that the comparison knows go to it as well.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"

times=()
since=$SECONDS
# took STEP: it ends here.
took() {
    times+=("$1 $((SECONDS - since)) s")
    since=$SECONDS
}

install_packages demo
build_release OFF gnomon_cli
took build
say "running city_night"
case " $* " in *" --size"*) ;; *) set -- --size 640x360 "$@" ;; esac
case " $* " in *" --out"* | *" --window"*) ;; *) set -- --out "$root/out/run" "$@" ;; esac
"$build/gnomon" run city_night "$@"
took run

case " $* " in *" --window"*) exit 0 ;; esac # it leaves no tables
# What of the run's options the comparison has, too.
out="" pinned="" size="" shared=()
while [ $# -gt 0 ]; do
    case "$1" in
    --*=*) option="${1%%=*}" value="${1#*=}" && shift ;;
    --recorded | --validate) option="$1" value="" && shift ;;
    *) option="$1" value="${2:-}" && shift $(($# > 1 ? 2 : 1)) ;;
    esac
    case "$option" in
    --out) out="$value" ;;
    --method | --plugin) pinned=1 ;;
    --size) size="$value" ;;
    --rules | --lights | --knowledge | --budget | --budget-ms) shared+=("$option" "$value") ;;
    --recorded) shared+=(--entry recorded) ;;
    esac
done
# Those that served in a fiftieth of all rows at least: a row is a light in a frame.
favoured="$(awk -F , 'NR > 1 && $3 != "none" { ++rows[$3]; ++all }
    END { for (method in rows) if (rows[method] >= all / 50) print method }' "$out/lights.csv" | sort | paste -s -d ,)"
# For each of them the nearest light that it served in the first frames, which are those that `bench` draws.
lights="$(awk -F , -v favoured="$favoured" '
    BEGIN { split(favoured, names, ","); for (i in names) least[names[i]] = 1e9 }
    $1 ~ /^[0-7]$/ && ($3 in least) && $7 != "" && $7 < least[$3] { least[$3] = $7; nearest[$3] = $2 }
    END { for (method in nearest) print nearest[method] }' "$out/lights.csv" | sort -u | paste -s -d ,)"
tables=()
if [ -n "$pinned" ]; then
    say "methods of one's own are not held against others"
elif [ -z "$favoured" ]; then
    say "no light had a shadow: nothing to hold it against"
else
    say "holding it against $favoured"
    if "$build/gnomon" compare city_night --methods "$favoured" --size "$size" --stride 20 --alternations 1 \
        "${shared[@]}" --csv "$out/compare.csv" | tail -n 4; then
        tables=(--compare "$out/compare.csv")
    else
        say "the comparison failed: the page is made without it"
    fi
    took compare
    if [ -n "$lights" ]; then
        say "each of them alone, for $lights"
        "$build/gnomon" bench city_night --methods "$favoured" --light "$lights" --size 320x180 --repeat 3 \
            --csv "$out/bench.csv"
        took bench
        tables+=(--bench "$out/bench.csv")
    fi
fi
say "the whole run as a page"
"$build/gnomon" report "$out" "${tables[@]}"
took report
printf '%s, ' "${times[@]}" | sed 's/, $/\n/'
