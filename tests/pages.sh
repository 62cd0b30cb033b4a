#!/usr/bin/env bash
# Holds pages and header comments against what they speak of: pages.sh SOURCE_FOLDER
#
# Functions of the C API that are named have to be declared, links have to lead to a file, tables need a header row,
# tests have to be there, and their paths have to be those of a preset. Prose keeps within 120 columns, the README within
# 160 lines, and the example in it has to compile.
set -uo pipefail
cd "$1" || exit 1
folders=(algorithms demo docs rules runtime tests)
mapfile -t pages < <(find "${folders[@]}" -name '*.md' | sort)
pages+=(README.md CHANGELOG.md CONTRIBUTING.md GLOSSARY.md)
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

# Bytes that continue a character of UTF-8 take no column.
while read -r where; do
    complain "$where: prose beyond 120 columns"
done < <(LC_ALL=C awk 'FNR == 1 { code = 0 }
                       /^ *```/ { code = !code }
                       !code && !/^\|/ { gsub(/[\200-\277]/, ""); if (length > 120) print FILENAME ":" FNR }' "${pages[@]}")

# The first page is read at a stretch.
lines="$(wc -l <README.md)"
[ "$lines" -le 160 ] || complain "README.md: $lines lines, more than 160"

# What the example leaves to the reader are parameters here.
example="$(awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' README.md)"
[ -n "$example" ] || complain "README.md: no example in C"
"${CC:-cc}" -std=c11 -Wall -Werror -fsyntax-only -I runtime/include -x c - <<EOF || complain "README.md: the example"
#include "gnomon/gnomon.h"
void example(GnContextCreateInfo contextInfo, GnMeshCreateInfo meshInfo, GnInstanceCreateInfo instanceInfo,
             GnLightInfo lightInfo, GnViewCreateInfo viewInfo, GnFrameInfo frame, VkCommandBuffer commands)
{
$example
}
EOF

[ "$failed" = 0 ] && echo "${#pages[@]} pages and ${#headers[@]} headers name what there is"
exit "$failed"
