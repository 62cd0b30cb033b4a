# Sourced by demo/run.sh and the scripts of tests/: installs what is missing of cmake/packages.txt, and says what is
# going on. Needs $root.

say() { printf '\n== %s\n' "$*"; }

# "install ok installed", not "deinstall ok config-files"
installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }

apt_get() {
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || {
            echo "packages are missing, and neither root nor sudo is available to install them" >&2
            return 1
        }
        as_root=(sudo)
    fi
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq "$@"
}

# install_packages demo|tests: what the demo needs, or what it and the tests need.
install_packages() {
    command -v dpkg-query >/dev/null || {
        say "no Debian system: install by hand what cmake/packages.txt lists"
        return 0
    }
    local package need lost i missing=() optional=() losses=()
    while read -r package need lost; do
        case "$package" in '' | '#'*) continue ;; esac
        [ "$1" = demo ] && [ -n "$need" ] && continue
        installed "$package" && continue
        if [ "$need" = optional ]; then
            optional+=("$package")
            losses+=("$lost")
        else
            missing+=("$package")
        fi
    done <"$root/cmake/packages.txt"
    [ $((${#missing[@]} + ${#optional[@]})) -eq 0 ] && return 0
    say installing "${missing[@]}" "${optional[@]}"
    # Without the lists' newest state the installation may still succeed, or says itself why not.
    apt_get update || true
    if [ ${#missing[@]} -gt 0 ]; then
        apt_get install -y --no-install-recommends "${missing[@]}" || return 1
    fi
    for i in "${!optional[@]}"; do
        apt_get install -y --no-install-recommends "${optional[i]}" ||
            say "${optional[i]} cannot be installed: ${losses[i]}"
    done
}

# Mesa's compiled shaders stay with the build: the second run finds them, and nothing outside the folder is written.
use_build() {
    build="$root/build/$1"
    mkdir -p "$build/shader_cache"
    export MESA_SHADER_CACHE_DIR="$build/shader_cache"
    export GNOMON_DATA_DIR="$root"
}

# build_release ON|OFF [TARGET]: configures and builds the release preset, with or without tests.
build_release() {
    use_build release
    cd "$root" || return 1
    say "configuring"
    cmake --preset release -DGNOMON_BUILD_TESTS="$1" >"$build/configure.log" 2>&1 || {
        cat "$build/configure.log" >&2
        return 1
    }
    say "building"
    cmake --build --preset release ${2:+--target "$2"} -- -j"$(nproc)"
}
