#!/usr/bin/env bash
# Follows the walk-through of a page as a reader would: walkthrough.sh PAGE PROGRAM
#
# A fenced `yaml` block whose first line is `# NAME.yaml` is written to that file. In a fenced `console` block the lines
# behind `$ ` are run, and what they print, on either stream, must be the lines that follow; `...` stands for any number
# of lines. Exit code 77: no Vulkan device to run a scene on.
set -uo pipefail
page="$(realpath "$1")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin"
ln -s "$(realpath "$2")" "$folder/bin/gnomon"
PATH="$folder/bin:$PATH"
cd "$folder" || exit 1
if ! gnomon methods >/dev/null 2>&1; then
    echo "no Vulkan device"
    exit 77
fi

commands=0
failed=0
# Compares `expected` with the output of `command`, line by line.
check() {
    [ -n "$command" ] || return
    commands=$((commands + 1))
    local printed=() at=0 skip=0 line status
    mapfile -t printed < <(bash -c "$command" 2>&1)
    for line in "${expected[@]}"; do
        line="${line%"${line##*[![:space:]]}"}"
        if [ "$line" = "..." ]; then
            skip=1
            continue
        fi
        status=1
        while [ "$at" -lt "${#printed[@]}" ]; do
            [ "${printed[$at]%"${printed[$at]##*[![:space:]]}"}" = "$line" ] && status=0
            at=$((at + 1))
            [ "$status" = 0 ] || [ "$skip" = 0 ] && break
        done
        skip=0
        [ "$status" = 0 ] || break
    done
    if [ "${status:-0}" != 0 ] || { [ "$skip" = 0 ] && [ "$at" -lt "${#printed[@]}" ]; }; then
        failed=$((failed + 1))
        echo "FAILED: $command"
        [ "${status:-0}" = 0 ] || echo "  expected: $line"
        echo "  printed:"
        printf '    %s\n' "${printed[@]}"
    else
        echo "ok: $command"
    fi
}

block=""
file=""
command=""
expected=()
while IFS= read -r line; do
    if [[ "$line" == '```'* ]]; then
        [ "$block" = console ] && check
        command=""
        file=""
        expected=()
        if [ -n "$block" ]; then block=""; else block="${line#\`\`\`}" first=1; fi
        [ -n "$block" ] || continue
        continue
    fi
    case "$block" in
    yaml)
        if [ "$first" = 1 ] && [[ "$line" =~ ^'# '([a-z_]+\.yaml)$ ]]; then
            file="${BASH_REMATCH[1]}"
            : >"$file"
        fi
        first=0
        [ -z "$file" ] || printf '%s\n' "$line" >>"$file"
        ;;
    console)
        if [[ "$line" == '$ '* ]]; then
            check
            command="${line#\$ }"
            expected=()
        else
            expected+=("$line")
        fi
        ;;
    esac
done <"$page"
echo "$commands commands, $failed failed"
[ "$commands" -gt 0 ] && [ "$failed" = 0 ]
