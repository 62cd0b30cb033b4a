#!/usr/bin/env bash
# Holds every #include against the table of floors: floors.sh SOURCE_FOLDER [MODULES]
#
# A file includes files of its own folder and of those that its folder's row names, which stand on lower floors. Among
# the files of a folder nobody includes in a circle. Whatever stands in demo/ and tests/ is above all of this.
#
# MODULES lists the algorithms' files, one module to a line: "algorithm family file..." or, for pieces that a family
# shares, "- family file...". Nobody but the list of algorithms (algorithms/ itself) includes an algorithm's files.
# A header belongs to the module that has its .cpp.
set -uo pipefail
cd "$1" || exit 1
modules="${2:-}"

# floor  folder                     includes files of
table='
0  runtime/include/gnomon
0  shaders/shared
1  runtime/base             runtime/include/gnomon
2  runtime/cost             runtime/base
1  shaders/runtime          shaders/shared
1  shaders/maps             shaders/shared
1  shaders/omni             shaders/shared
1  shaders/volumes          shaders/shared
1  shaders/hybrid           shaders/shared
1  shaders/revectorized     shaders/shared
1  shaders/warped           shaders/shared
1  shaders/filtered         shaders/shared
2  shaders/area             shaders/shared shaders/revectorized
2  shaders/host             shaders/shared shaders/maps shaders/omni shaders/revectorized shaders/filtered
1  shaders/demo             shaders/shared runtime/include/gnomon
2  rules/engine             runtime/base
2  runtime/vk               runtime/base runtime/include/gnomon
2  runtime/scene            runtime/include/gnomon shaders/shared
3  rules/yaml               rules/engine runtime/base
3  runtime/plan             rules/engine runtime/base
3  runtime/rays             runtime/scene runtime/base
4  runtime/store            runtime/rays runtime/scene runtime/vk runtime/base runtime/include/gnomon shaders/runtime
5  runtime/passes           runtime/store runtime/scene runtime/vk runtime/base runtime/include/gnomon
6  runtime                  runtime/passes shaders/shared
6  runtime/accel            runtime/passes runtime/scene runtime/vk runtime/base shaders/shared
7  runtime/select           runtime runtime/passes runtime/plan runtime/cost runtime/rays runtime/scene runtime/vk runtime/base
7  runtime/select           rules/engine rules/yaml shaders/shared shaders/runtime
8  runtime/frame            runtime/accel runtime/select runtime/passes runtime/plan runtime/cost runtime/store runtime/rays
8  runtime/frame            runtime/scene runtime/vk runtime/base runtime/include/gnomon rules/engine shaders/shared shaders/runtime
9  runtime/api              runtime/accel runtime/frame runtime/select runtime runtime/passes runtime/scene runtime/cost runtime/vk
9  runtime/api              runtime/base runtime/include/gnomon rules/yaml
7  algorithms/shared        runtime runtime/passes runtime/rays runtime/scene runtime/vk runtime/base shaders/shared
8  algorithms/maps          algorithms/shared runtime runtime/scene shaders/maps shaders/shared
8  algorithms/omni          algorithms/shared runtime runtime/passes runtime/scene shaders/omni shaders/shared
8  algorithms/volumes       algorithms/shared runtime runtime/passes runtime/scene runtime/base shaders/volumes shaders/shared
8  algorithms/hybrid        algorithms/shared runtime runtime/passes runtime/rays runtime/scene runtime/base
8  algorithms/hybrid        shaders/hybrid shaders/shared
8  algorithms/revectorized  algorithms/shared runtime runtime/scene shaders/revectorized shaders/shared
8  algorithms/warped        algorithms/shared runtime runtime/scene shaders/warped shaders/shared
8  algorithms/filtered      algorithms/shared runtime runtime/scene shaders/filtered shaders/shared
8  algorithms/area          algorithms/shared runtime runtime/scene shaders/area shaders/shared
9  algorithms               algorithms/maps algorithms/omni algorithms/volumes algorithms/hybrid algorithms/revectorized
9  algorithms               algorithms/warped algorithms/filtered algorithms/area runtime
'

mapfile -t files < <(find runtime rules algorithms shaders -name '*.[ch]pp' -o -name '*.[ch]' -o -name '*.in[cl]' \
    -o -name '*.glsl' -o -name '*.vert' -o -name '*.frag' -o -name '*.comp' | sort)

# Lines "arrow FILE TARGET" and "wrong WHAT".
read_includes='
function folder(path) { sub("/[^/]*$", "", path); return path }
function plain(path) { # without "x/../"
    while (match(path, "[^/]+/[.][.]/")) path = substr(path, 1, RSTART - 1) substr(path, RSTART + RLENGTH)
    return path
}
function found(from, name,    i, at) {
    if (name == "algorithms/entries.hpp") return "runtime/algorithm.hpp" # made by CMake: includes that, and no more
    split(folder(from) "/ /runtime/include/ /shaders/", roots, " ")
    for (i = 1; i <= 4; ++i) {
        at = plain((i == 1 ? folder(from) "/" : i == 3 ? "runtime/include/" : i == 4 ? "shaders/" : "") name)
        if (at in known) return at
    }
    if (match(name, "^shaders/[a-z]+_[a-z0-9_]+[.]h$")) { # SPIR-V, made from shaders/FAMILY/...
        sub("^shaders/", "", name)
        return "shaders/" substr(name, 1, index(name, "_") - 1) "/" name
    }
    return ""
}
FILENAME == "-" && $1 == "floor" {
    if ($3 in floorOf && floorOf[$3] != $2) print "wrong the table has two floors for " $3
    floorOf[$3] = $2
    for (i = 4; i <= NF; ++i) {
        allowed[$3, $i]
        below[++arrows] = $3 " " $i
    }
    next
}
FILENAME == "-" { known[$1]; next }
FNR == 1 && !checked++ {
    for (i = 1; i <= arrows; ++i) {
        split(below[i], ends, " ")
        if (!(ends[2] in floorOf)) print "wrong the table has no row for " ends[2]
        else if (floorOf[ends[2]] >= floorOf[ends[1]]) print "wrong the table leads up: " below[i]
    }
}
{
    colon = index($0, ":"); file = substr($0, 1, colon - 1); rest = substr($0, colon + 1)
    colon = index(rest, ":"); line = substr(rest, 1, colon - 1); text = substr(rest, colon + 1)
    if (!match(text, "[\"<][^\">]+[\">]")) next
    name = substr(text, RSTART + 1, RLENGTH - 2)
    if (substr(text, RSTART, 1) == "<" && name !~ "^gnomon/") next
    ++read
    target = found(file, name)
    here = folder(file); there = folder(target)
    if (target == "") print "wrong " file ":" line ": no file " name
    else if (!(here in floorOf)) print "wrong " file ": the table has no row for " here
    else if (here != there && !((here, there) in allowed)) print "wrong " file ":" line ": " here " does not include " there
    if (target in known && target != file) print "arrow " file " " target
}
END { print "read " read + 0 }'
arrows="$({ sed -n 's/^[0-9]/floor &/p' <<<"$table"; printf '%s\n' "${files[@]}"; } |
    awk "$read_includes" - <(grep -nHE '^ *# *include' "${files[@]}"))"
wrong="$(sed -n 's/^wrong //p' <<<"$arrows")"
circle="$(sed -n 's/^arrow //p' <<<"$arrows" | tsort 2>&1 >/dev/null | sed -n 's/^tsort: \([^-].*\)/in a circle: \1/p')"

if [ -n "$modules" ] && [ -f "$modules" ]; then
    wrong+="$(awk '
        function stem(path, family) {
            sub(".*algorithms/", "", path)
            if (path !~ "/") path = family "/" path
            sub("[.][a-z]+$", "", path)
            return path
        }
        FNR == NR { for (i = 3; i <= NF; ++i) if ($1 != "-") owner[stem($i, $2)] = $1; next }
        $1 == "arrow" && $3 ~ "^algorithms/" && $2 ~ "^algorithms/.*/" {
            from = stem($2); to = stem($3); mine = from in owner ? owner[from] : "-"
            if (to in owner && mine != owner[to]) print "\n" $2 ": includes " $3 ", of the algorithm " owner[to]
        }' "$modules" <(printf '%s\n' "$arrows"))"
fi

read="$(sed -n 's/^read //p' <<<"$arrows")"
[ "${read:-0}" -gt 0 ] || wrong+=$'\nno includes found'
if [ -n "$wrong$circle" ]; then
    printf '%s\n' "$wrong" "$circle" | sed '/^$/d'
    exit 1
fi
echo "$read includes of ${#files[@]} files lead down"
