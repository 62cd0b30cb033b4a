#!/usr/bin/env bash
# Makes the moving picture that opens README.md: a flight through city_night, each light in the colour of the method
# that draws its shadows. film.sh [FILE]; default: demo/pictures/city_night.webp. Installs Debian's package webp where
# img2webp is missing. Frames are recorded, as most renderers call gnomon.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"
file="$(realpath "${1:-$root/demo/pictures/city_night.webp}")"

install_packages demo
command -v img2webp >/dev/null || apt_get install -y --no-install-recommends webp
build_release OFF gnomon_cli
out="$build/film"
say "running city_night"
"$build/gnomon" run city_night --recorded --size 640x360 --film 2 --out "$out"
say "packing"
# 119 frames, one in 80 ms: the scene a quarter faster than it is.
img2webp -loop 0 -lossy -q 50 -m 6 -d 80 "$out"/frame_*_film.png -o "$file"
bytes="$(stat -c %s "$file")"
echo "$file: $bytes bytes"
[ "$bytes" -lt 3000000 ] || {
    echo "$file is larger than 3 MB" >&2
    exit 1
}
