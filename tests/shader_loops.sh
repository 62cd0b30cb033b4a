#!/usr/bin/env bash
# Holds every loop of the shaders against one rule: shader_loops.sh SOURCE_FOLDER
#
# A loop that an input can lengthen without end hangs the device of whoever embeds gnomon. So each `for` runs from a
# number, or with an unsigned counter, up to a constant (a number or an upper-case name) in steps of a constant; or its
# line ends with the comment
#     // bound: NAME
# where NAME is the constant, or the array by whose length(), that its count is clamped to: by min(), clamp() or ?: on
# another line of the file. `while` and `do` always need the comment.
set -uo pipefail
cd "$1" || exit 1
mapfile -t files < <(find shaders runtime/include tests -name '*.frag' -o -name '*.vert' -o -name '*.comp' -o -name '*.geom' \
    -o -name '*.glsl' -o -path 'shaders/*.h' | sort)
constant='(u?int\()?([0-9]+u?|[A-Z][A-Z0-9_]*)\)?'
counted="for \((int [a-z]+ = [0-9]+|uint [a-z]+ = [^;]+); [a-z]+ < $constant( && [^;]+)?; (\+\+[a-z]+|[a-z]+ \+= $constant)\)"
failed=0 loops=0
for file in "${files[@]}"; do
    while IFS=: read -r line text; do
        code="${text%%//*}"
        [[ "$code" =~ (^|[^A-Za-z_])(for|while|do)( *\(| *\{) ]] || continue
        ((++loops))
        [[ "$code" =~ $counted ]] && continue
        if [[ "$text" =~ //\ bound:.*[^A-Za-z_]([A-Za-z][A-Za-z0-9_]*) ]]; then
            name="${BASH_REMATCH[1]}"
            [[ "$name" =~ ^[A-Z] ]] || name="$name\.length\(\)"
            grep -qE "((min|clamp)\(|\?).*\b$name" <<<"$(sed 's|//.*||' "$file")" && continue
            echo "$file:$line: nothing is clamped to '$name' in this file"
        else
            echo "$file:$line: a loop without a bound: ${code#"${code%%[![:space:]]*}"}"
        fi
        failed=1
    done < <(grep -nE '\b(for|while|do)\b' "$file")
done
[ "$loops" -gt 0 ] || { echo "no loops found"; failed=1; }
[ "$failed" = 0 ] && echo "$loops loops of ${#files[@]} shader files are bounded"
exit "$failed"
