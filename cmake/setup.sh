# Sourced by demo/run.sh, tests/run.sh and tests/matrix.sh: installs what is missing of cmake/packages.txt (Debian 12),
# and says what is going on. Needs $root.

say() { printf '\n== %s\n' "$*"; }

install_packages() {
    command -v dpkg-query >/dev/null || {
        say "no Debian system: install by hand what cmake/packages.txt lists"
        return 0
    }
    local package missing=()
    while read -r package; do
        case "$package" in '' | '#'*) continue ;; esac
        # "install ok installed", not "deinstall ok config-files"
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
    done <"$root/cmake/packages.txt"
    [ ${#missing[@]} -eq 0 ] && return 0
    say "installing ${missing[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || {
            echo "missing packages, and neither root nor sudo is at hand: ${missing[*]}" >&2
            return 1
        }
        as_root=(sudo)
    fi
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# Mesa's compiled shaders stay with the build: the second run finds them, and nothing outside the folder is written.
use_build() {
    build="$root/build/$1"
    mkdir -p "$build/shader_cache"
    export MESA_SHADER_CACHE_DIR="$build/shader_cache"
    export GNOMON_DATA_DIR="$root"
}
