#!/usr/bin/env bash
# Walks the ways of somebody who has not seen gnomon before, with a stopwatch: newcomer.sh [FOLDER]
#
#   clone to first report                a fresh clone of HEAD, demo/run.sh, its page
#   README to first embedded frame       installing gnomon, demo/embed beside it, a picture without a window
#   template to first measured plug-in   a copy of demo/plugin beside the installed gnomon, its row and page of `bench`
#
# Each begins where the one before it ended. Nothing is taken from an earlier build or from ccache, so it takes as long
# as a whole build; FOLDER (default: build/newcomer) is emptied first, and keeps what came of it. Prints seconds.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
folder="$(realpath -m "${1:-$root/build/newcomer}")"
case "$folder" in "$root" | "$HOME" | /) echo "$folder is not emptied" >&2 && exit 1 ;; esac
if [ -d "$folder" ] && [ ! -e "$folder/.newcomer" ] && [ -n "$(ls -A "$folder")" ]; then
    echo "$folder holds something else" >&2
    exit 1
fi
rm -rf "$folder"
mkdir -p "$folder"
touch "$folder/.newcomer"
export CCACHE_DISABLE=1
unset GNOMON_DATA_DIR MESA_SHADER_CACHE_DIR CMAKE_CXX_COMPILER_LAUNCHER CMAKE_C_COMPILER_LAUNCHER

since=$SECONDS
# took WAY FILE: it ends here, with this file.
took() {
    [ -s "$2" ] || {
        echo "$1: no $2" >&2
        exit 1
    }
    times+=("$(printf '%-36s %5d s   %s, %d bytes' "$1" $((SECONDS - since)) "${2#"$folder/"}" "$(stat -c %s "$2")")")
    since=$SECONDS
}
times=()

cd "$folder"
git clone --quiet "$root" gnomon
gnomon/demo/run.sh
took "clone to first report" "$folder/gnomon/out/run/report.html"

cmake --build gnomon/build/release
cmake --install gnomon/build/release --prefix "$folder/prefix" >/dev/null
cmake -S gnomon/demo/embed -B embed -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$folder/prefix"
cmake --build embed
embed/gnomon_embed --headless 8 --out "$folder/embed.png"
took "README to first embedded frame" "$folder/embed.png"

cp -r gnomon/demo/plugin my_shadow
cmake -S my_shadow -B my_shadow/build -DCMAKE_PREFIX_PATH="$folder/prefix"
cmake --build my_shadow/build
prefix/bin/gnomon bench room --plugin my_shadow/build/box_shadow.so --methods shadow_map,ray_traced --size 320x180 \
    --repeat 5 --csv bench.csv
prefix/bin/gnomon report --bench bench.csv
grep -q '^room,box' bench.csv || {
    echo "bench.csv has no row of the plug-in" >&2
    exit 1
}
took "template to first measured plug-in" "$folder/report.html"
printf '%s\n' "${times[@]}"
