#!/usr/bin/env bash
# What other machines have, on this one. Rows as arguments; without any: isa mesa25 debian13.
#   isa          the tests labelled `isa`, once for each instruction set that the processor has
#   mesa25       every device test on Mesa 25, unpacked in the build folder where the system's is older
#   mesa25-core  the same of the tests labelled `core`: each method's passes, a few minutes
#   mesa25-driver  of those labelled `driver`: frames, rays of the device, and the truth; what CI runs
#   debian13     demo/run.sh and tests/run.sh in a chroot with Debian 13, on a fresh clone of HEAD; needs root
#   debian13-core  there, unit tests and those labelled `core` alone
# A row that cannot be run here is SKIPPED. Downloads stay in build/machines until that folder is removed.
set -uo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"
machines="$root/build/machines"
# Where this system's own packages come from.
mirror="$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 2>/dev/null |
    awk '$2 !~ /security/ { print $1; exit }')"
result="$(mktemp)"
trap 'rm -f "$result"' EXIT

# A row runs in a subshell and ends it with one of these. The text stands in the table.
verdict() {
    echo "$*" >"$result"
    exit 0
}
passed() { verdict "passed   $*"; }
skipped() { verdict "SKIPPED  $*"; }
failed() { verdict "FAILED   $*"; }

build_tests() {
    { install_packages tests && build_release ON; } || failed "the build failed"
}

# run_tests NAME ARGUMENTS: ctest, and its closing counts for the table.
run_tests() {
    local log="$machines/$1.log" status
    mkdir -p "$machines"
    ctest --preset release --no-tests=error --parallel 2 "${@:2}" | tee "$log"
    status=${PIPESTATUS[0]}
    counts="$(grep 'tests passed' "$log")"
    return "$status"
}

row_isa() {
    local level flag levels=() absent=()
    for level in sse2:sse2 sse4.2:sse4_2 avx2:avx2 avx512:avx512vl; do
        flag="${level#*:}"
        if grep -qw "$flag" /proc/cpuinfo; then levels+=("${level%:*}"); else absent+=("${level%:*}"); fi
    done
    [ ${#levels[@]} -gt 0 ] || skipped "no x86-64 processor"
    build_tests
    for level in "${levels[@]}"; do
        say "instruction set $level"
        GNOMON_MAX_ISA="$level" run_tests "isa-$level" -L '^isa$' || failed "$level: $counts"
    done
    passed "${levels[*]}: $counts each${absent:+; this processor lacks ${absent[*]}}"
}

# The driver that the program finds, such as "Mesa 25.0.7-2 (LLVM 19.1.7)".
driver_in_use() { timeout 60 "$build/gnomon" methods 2>/dev/null | sed -n '1s/^on .*), //p'; }

is_new() { [[ "$1" =~ ^Mesa\ (2[5-9]|[3-9][0-9])\. ]]; }

# The second name is for loaders before 1.3.207.
use_driver() { export VK_DRIVER_FILES="$1" VK_ICD_FILENAMES="$1"; }

# Unpacks the newest Mesa for Debian 12, and what it needs that the system has not, below $1. Nothing is installed: apt
# has a source list, lists and a cache of its own there, and any user may do it.
unpack_mesa() {
    local at="$1" suite=bookworm-backports line packages
    [ -e "$at/complete" ] && return
    rm -rf "$at"
    mkdir -p "$at"/{lists/partial,cache/archives/partial,packages,root}
    for line in bookworm "$suite"; do
        echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $line main"
    done >"$at/sources.list"
    local apt=(apt-get -qq -o APT::Sandbox::User= -o APT::Update::Error-Mode=any -o Dir::State::Lists="$at/lists"
        -o Dir::Etc::SourceList="$at/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::Cache="$at/cache")
    "${apt[@]}" update || return 1
    # Lines such as: Inst libdrm2 [2.4.114-1+b1] (2.4.123-1~bpo12+1 Debian Backports:oldstable-backports [amd64])
    packages="$("${apt[@]}" --simulate install "mesa-vulkan-drivers/$suite" |
        sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p')"
    [ -n "$packages" ] || return 1
    # shellcheck disable=SC2086 # one word for each package
    (cd "$at/packages" && "${apt[@]}" download $packages) || return 1
    for line in "$at"/packages/*.deb; do
        dpkg -x "$line" "$at/root" || return 1
    done
    (cd "$at" && ln -s root/usr/lib/*-linux-gnu lib) || return 1
    sed -E "s|(\"library_path\": *\")(.*/)?|\1$at/lib/|" "$at"/root/usr/share/vulkan/icd.d/lvp_icd*.json \
        >"$at/driver.json" || return 1
    dpkg-deb -f "$at"/packages/mesa-vulkan-drivers_*.deb Version >"$at/version" && touch "$at/complete"
}

row_mesa25() {
    local tests="${1:-gpu}" at="$machines/mesa25" wanted driver
    build_tests
    use_driver "$(echo /usr/share/vulkan/icd.d/lvp_icd*.json)"
    wanted="$(driver_in_use)"
    if ! is_new "$wanted"; then
        [ "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" = bookworm ] ||
            skipped "the system has $wanted, and a newer one is packaged for Debian 12 only"
        unpack_mesa "$at" || skipped "Mesa 25 cannot be downloaded"
        export LD_LIBRARY_PATH="$at/lib"
        use_driver "$at/driver.json"
        wanted="Mesa $(<"$at/version")"
    fi
    # What was asked for might be passed over in favour of the system's.
    driver="$(driver_in_use)"
    { is_new "$driver" && [[ "$driver" == "$wanted"* ]]; } ||
        failed "the driver in use is '$driver' instead of '$wanted'"
    say "device tests on $driver"
    run_tests mesa25 -L "^$tests\$" || failed "$driver: $counts"
    passed "$driver: $counts"
}

row_mesa25-core() { row_mesa25 core; }
row_mesa25-driver() { row_mesa25 driver; }

# All that is mounted below $1, the innermost first.
unmount_below() {
    local place
    while read -r place; do
        umount "$place" || umount --lazy "$place"
    done < <(awk -v below="$1/" 'index($2, below) == 1 { print $2 }' /proc/mounts | tac)
}

row_debian13() {
    local at="$machines/debian13" script scripts=("${@:-demo/run.sh}")
    [ $# -gt 0 ] || scripts+=(tests/run.sh)
    [ "$(id -u)" -eq 0 ] || skipped "a chroot can only be made by root"
    [ -n "$mirror" ] || skipped "apt knows no archive"
    command -v git >/dev/null || skipped "git is not installed"
    if ! command -v debootstrap >/dev/null; then
        apt_get update
        apt_get install -y --no-install-recommends debootstrap || skipped "debootstrap cannot be installed"
    fi
    trap 'unmount_below "$at"' EXIT
    unmount_below "$at" # of a run that was killed
    if [ ! -e "$at/complete" ]; then
        say "unpacking Debian 13"
        rm -rf --one-file-system "$at"
        mkdir -p "$at"
        debootstrap --variant=minbase trixie "$at" "$mirror" >"$machines/debootstrap.log" 2>&1 || {
            tail -5 "$machines/debootstrap.log"
            skipped "debootstrap failed, see build/machines/debootstrap.log"
        }
        touch "$at/complete"
    fi
    { mount -t proc proc "$at/proc" && mount -t tmpfs tmpfs "$at/dev/shm"; } || skipped "mounting is not permitted"
    cp /etc/resolv.conf /etc/hosts "$at/etc/"
    chroot "$at" apt-get -qq -o APT::Update::Error-Mode=any update || skipped "no packages can be downloaded"
    rm -rf "$at/root/gnomon"
    git clone --quiet "$root" "$at/root/gnomon" || failed "git clone"
    # Without this shell's variables, the driver's among them.
    local inside=(chroot "$at" /usr/bin/env -i http_proxy="${http_proxy:-}" HOME=/root
        PATH=/usr/sbin:/usr/bin:/sbin:/bin)
    for script in "${scripts[@]}"; do
        say "Debian 13: $script"
        # shellcheck disable=SC2086 # the script and its arguments
        "${inside[@]}" /root/gnomon/$script 2>&1 | tee "$machines/debian13.log" || failed "$script"
    done
    passed "${scripts[*]}: $(grep 'tests passed' "$machines/debian13.log")"
}

row_debian13-core() { row_debian13 "tests/run.sh -L ^(unit|core)$"; }

rows=("$@")
[ $# -gt 0 ] || rows=(isa mesa25 debian13)
for row in "${rows[@]}"; do
    declare -F "row_$row" >/dev/null || {
        echo "no row '$row': isa, mesa25, mesa25-core, mesa25-driver, debian13, debian13-core" >&2
        exit 2
    }
done
status=0
report=()
for row in "${rows[@]}"; do
    say "row $row"
    echo "FAILED   ended early" >"$result"
    ("row_$row")
    grep -q '^FAILED' "$result" && status=1
    report+=("$(printf '%-12s %s' "$row" "$(<"$result")")")
done
say "machines"
printf '%s\n' "${report[@]}"
exit $status
