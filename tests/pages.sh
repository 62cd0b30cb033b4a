#!/usr/bin/env bash
# Holds pages and header comments against what they speak of: pages.sh SOURCE_FOLDER
#
# Functions of the C API that are named have to be declared, links have to lead to a file, tables need a header row,
# tests have to be there, and their paths have to be those of a preset.
set -uo pipefail
cd "$1" || exit 1
folders=(algorithms demo rules runtime tests)
mapfile -t pages < <(find "${folders[@]}" -name '*.md' | sort)
pages+=(README.md CHANGELOG.md)
headers=(runtime/include/gnomon/*.h)
failed=0
complain() {
    echo "$1"
    failed=1
}

declared="$(grep -hoE 'GN_CALL\*? ?(PFN_)?gn[A-Z][A-Za-z]*' "${headers[@]}" | grep -oE 'gn[A-Z][A-Za-z]*' | sort -u)"
while IFS=: read -r file line name; do
    grep -qx "${name%(}" <<<"$declared" || complain "$file:$line: ${name%(}() is not declared"
done < <(grep -noE '\bgn[A-Z][A-Za-z]*\(' "${headers[@]}" "${pages[@]}")

while IFS=: read -r file line link; do
    target="${link#](}"
    target="${target%%[)#]*}"
    [ -z "$target" ] || [ -e "$(dirname "$file")/$target" ] || complain "$file:$line: no file $target"
done < <(grep -noE '\]\([^)]*' "${pages[@]}" | grep -v '](https\?:')

while read -r where; do
    complain "$where: a table without a header row"
done < <(awk '/^```/ { code = !code }
              { row = !code && /^\|/ }
              begun { if (!/^\| *:?-/) print FILENAME ":" FNR; begun = 0; before = row; next }
              row && !before { begun = 1 }
              { before = row }' "${pages[@]}")

tests="$(awk '/^ *foreach\(name / { sub(/.*foreach\(name /, ""); sub(/\).*/, ""); each = $0; next }
              match($0, /gnomon_add_test\([a-z_${}]+/) {
                  count = split(index($0, "${name}") ? each : "-", names, " ")
                  for (i = 1; i <= count; ++i) {
                      test = substr($0, RSTART + 16, RLENGTH - 16)
                      sub(/\$\{name\}/, names[i], test)
                      print test
                  }
              }' tests/*/CMakeLists.txt)"
while IFS=: read -r file line name; do
    grep -qx "${name//\`/}" <<<"$tests" || complain "$file:$line: no test ${name//\`/}"
done < <(grep -noE '`[a-z_]+_tests?`' "${pages[@]}")

while IFS=: read -r file line path; do
    preset="${path#build/}"
    preset="${preset%%/*}"
    grep -q "\"name\": \"$preset\"" CMakePresets.json || complain "$file:$line: no preset builds $path"
done < <(grep -noE 'build/([a-z]+/)?tests\b' "${pages[@]}")

[ "$failed" = 0 ] && echo "${#pages[@]} pages and ${#headers[@]} headers name what there is"
exit "$failed"
