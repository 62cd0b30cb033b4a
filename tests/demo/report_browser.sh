#!/usr/bin/env bash
# Opens the page of `gnomon report` in Chromium: report_browser.sh PROGRAM FOLDER
# The page says nothing on the browser's console, asks for nothing but itself, prints to a PDF, and its slider moves.
# Exits with 77 where there is no Chromium.
set -euo pipefail
program="$1" folder="$2"
command -v chromium >/dev/null || {
    echo "no chromium here"
    exit 77
}
rm -rf "$folder" && mkdir -p "$folder"
"$program" run room --frames 6 --size 96x54 --out "$folder/run" >/dev/null
"$program" bench room --methods ray_traced,shadow_map,cube_map --size 96x54 --repeat 3 --csv "$folder/bench.csv" >/dev/null
"$program" report "$folder/run" --bench "$folder/bench.csv"
page="$folder/run/report.html"

fail() {
    echo "$*" >&2
    exit 1
}

# browse ARGUMENTS...: a fresh profile each time, no network. What the page logs stands in $folder/log as "CONSOLE".
browse() {
    timeout 120 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$folder/profile" \
        --host-resolver-rules="MAP * ~NOTFOUND" --enable-logging=stderr --window-size=1200,900 "$@" 2>>"$folder/log"
}

# The same page with a script behind it that does what a visitor does and notes what came of it.
acted="$folder/acted.html"
sed 's|</body>|<script>addEventListener("load",()=>{const i=document.querySelector(".slide input");i.value=80;i.oninput();\
const c=getComputedStyle(i.parentNode).getPropertyValue("--cut").trim();\
const n=performance.getEntriesByType("resource").filter(e=>!e.name.startsWith("data:")).length;\
const w=document.documentElement.scrollWidth>innerWidth?"wide":"fits";\
document.title="cut "+c+" fetched "+n+" "+w+" tips "+document.querySelectorAll("svg title").length})</script></body>|' \
    "$page" >"$acted"
browse --dump-dom "file://$acted" >"$folder/dom.html"
title="$(sed -n 's|.*<title>\(cut [^<]*\)</title>.*|\1|p' "$folder/dom.html" | head -n 1)"
echo "browser: $title"
[[ "$title" =~ ^"cut 80% fetched 0 fits tips "([0-9]+)$ ]] || fail "the page did not do what was asked of it"
((BASH_REMATCH[1] > 10)) || fail "hardly anything to point at"
browse --print-to-pdf="$folder/report.pdf" "file://$page"
[ "$(head -c 5 "$folder/report.pdf")" = "%PDF-" ] || fail "no PDF"
! grep CONSOLE "$folder/log" || fail "the console is not silent"
size="$(stat -c %s "$page")"
((size < 2000000)) || fail "$size bytes"
echo "$size bytes, PDF of $(stat -c %s "$folder/report.pdf") bytes, console silent"
