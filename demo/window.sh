#!/usr/bin/env bash
# Makes the picture of the window in demo/README.md, under a virtual X server: a flight through city_night with lights
# in the colours of their methods. window.sh [FILE]; default: demo/pictures/window.png. Installs Debian's packages xvfb,
# xauth and xdotool where they are missing.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"
file="$(realpath "${1:-$root/demo/pictures/window.png}")"

install_packages demo
for program in xvfb-run xauth xdotool; do
    command -v "$program" >/dev/null || apt_get install -y --no-install-recommends xvfb xauth xdotool
done
build_release OFF gnomon_cli
say "running city_night in a window"
export build file
xvfb-run -a -s '-screen 0 1280x720x24' bash -euc '
    "$build/gnomon" window city_night --size 1280x720 --frames 100 --screenshot "$file" &
    window="$(xdotool search --sync --onlyvisible --name "^gnomon  city_night")"
    xdotool windowmove --sync "$window" 0 0 windowfocus --sync "$window" key t
    wait $!'
echo "$file: $(stat -c %s "$file") bytes"
