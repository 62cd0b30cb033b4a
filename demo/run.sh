#!/usr/bin/env bash
# Builds gnomon and runs its main job: the scripted scenario, headless, on the software Vulkan device or whichever
# GNOMON_DEVICE names. Leaves tables and pictures in out/run. Arguments go to `gnomon run` after the scene.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
source "$root/cmake/setup.sh"

install_packages demo
build_release OFF gnomon_cli
say "running the scripted scenario"
# The rule base of the thesis: its scenario visits every one of its methods. Another --rules among the arguments wins.
case " $* " in *" --rules"* | *" --method"*) ;; *) set -- --rules thesis "$@" ;; esac
case " $* " in *" --out"*) ;; *) set -- --out "$root/out/run" "$@" ;; esac
exec "$build/gnomon" run scenario "$@"
