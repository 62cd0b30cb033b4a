#!/usr/bin/env bash
# Draws the pictures of artists.md: artists_pictures.sh PROGRAM [--check]
#
# Types the commands of the page, and after each edit that changes what `gnomon plot` draws of my.yaml leaves a picture
# EDIT.svg in pictures/artists, 0.svg being the file that the page starts with. --check draws elsewhere and compares:
# the page shows each picture, and they differ in colours at most, which follow the order of the methods.
set -euo pipefail
docs="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$(realpath "$1")"
work="$(mktemp -d)"
out="$docs/pictures/artists"
[ "${2:-}" = --check ] && out="$work/pictures"
trap 'rm -rf "$work"' EXIT
mkdir -p "$out" "$work/bin"
ln -s "$program" "$work/bin/gnomon"
PATH="$work/bin:$PATH"
cd "$work"

# draw NUMBER RULES
draw() {
    gnomon plot "$2" --over viewerDistance,lightRadius --only viewerDistance,spot --out "$1.svg" >/dev/null
    [ -e last.svg ] && cmp -s "$1.svg" last.svg && return
    cp "$1.svg" last.svg
    mv "$1.svg" "$out/"
}

awk '/^```yaml/ { inside = 1; next } /^```/ { inside = 0 } inside' "$docs/artists.md" >my.yaml
edit=0
while IFS= read -r line; do
    case "$line" in
    '**'[0-9]*)
        draw "$edit" my.yaml
        edit="${line#\*\*}" edit="${edit%%.*}"
        ;;
    # What lint refuses is put right by the next command.
    '$ '*) bash -c "${line#\$ }" >/dev/null 2>&1 || [[ "$line" == *" lint "* ]] ;;
    esac
done <"$docs/artists.md"
draw "$edit" my.yaml:low # the last edit adds this preset

[ "${2:-}" = --check ] || exit 0
shapes() { sed 's/"#[0-9a-f]*"/""/g' "$1"; }
shown="$(grep -o 'pictures/artists/[0-9]*\.svg' "$docs/artists.md" | sort)"
drawn="$(cd "$out" && printf 'pictures/artists/%s\n' *.svg | sort)"
[ "$shown" = "$drawn" ] || {
    diff <(echo "$shown") <(echo "$drawn") || true
    echo "artists.md does not show the pictures that its edits make"
    exit 1
}
for picture in $drawn; do
    cmp <(shapes "$docs/$picture") <(shapes "$out/${picture##*/}") || {
        echo "bring it up to date: docs/artists_pictures.sh PROGRAM"
        exit 1
    }
done
echo "$(wc -w <<<"$drawn") pictures are what the edits make"
