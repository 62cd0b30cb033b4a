#!/usr/bin/env bash
# isa_objects.sh FILE.o...: fails where an object compiled for a wider instruction set holds a function that the linker
# may share with other files (an inline function or a template): a processor without these instructions could meet it.
set -uo pipefail
[ $# -gt 0 ] || { echo "no objects are named"; exit 1; }
failed=0
for object in "$@"; do
    shared="$(nm -C "$object" | grep -E ' [VWu] ')" || continue
    printf '%s\n%s\n' "$object" "$shared"
    failed=1
done
exit $failed
