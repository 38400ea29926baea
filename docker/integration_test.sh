#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Run in a container beside the service: makes four overlapping tiles of one surface, merges them over HTTP, and
# compares with the command line of the same image and with what the surface must be.
#   integration_test.sh http://HOST:PORT
set -u
base=$1
cd "$(mktemp -d)" || exit 1
failures=0
check() { # check WHAT WANTED GOT
  if [ "$2" = "$3" ]; then echo "ok $1"; else echo "FAIL $1: wanted '$2', got '$3'"; failures=$((failures + 1)); fi
}

# z = x + 2y on a lattice of 10 m; windows of 13 x 13 samples that overlap by five: 21 x 21 samples, 200 m x 200 m.
tile() { # tile NAME COLUMN ROW, of the window's lower left sample
  awk -v c0="$2" -v r0="$3" 'BEGIN {
    printf "ncols 13\nnrows 13\nxllcenter %d\nyllcenter %d\ncellsize 10\nNODATA_value -9999\n", c0 * 10, r0 * 10
    for (r = 12; r >= 0; --r) {
      for (c = 0; c < 13; ++c) printf "%d ", (c0 + c) * 10 + 20 * (r0 + r)
      print ""
    } }' > "$1.asc"
}
tile sw 0 0; tile se 8 0; tile nw 0 8; tile ne 8 8

merge() { # merge POLICY OUTPUT TILE...
  policy=$1 output=$2; shift 2
  set -- $(for name in "$@"; do echo "-F tiles=@$name.asc"; done)
  curl -sS -D head -o "$output" -w '%{http_code}' "$@" \
    "$base/processes/merge/execution?f=obj&overlap=$policy&assume-crs=EPSG:25831"
}
check "merged over HTTP" 200 "$(merge mean http.obj sw se nw ne)"
check "merged in another order" 200 "$(merge mean other.obj ne sw nw se)"
cmp -s http.obj other.obj; check "the same bytes in any order" 0 $?
terrane merge sw.asc se.asc nw.asc ne.asc --overlap mean --assume-crs EPSG:25831 -o cli.obj --quiet --report cli.json
check "merged on the command line" 0 $?
cmp -s http.obj cli.obj; check "the same bytes as over HTTP" 0 $?

report=$(sed -n 's/^[Ll]ink: <\([^>]*\)>.*/\1/p' head)
curl -fsS "$base$report" -o report.json
check "the certificate can be fetched" 0 $?
for count in inverted degenerate t_junctions non_manifold_edges; do
  check "$count" 0 "$(sed -n "s/.*\"$count\": *\([0-9]*\).*/\1/p" report.json | head -1)"
done
# 200 m x 200 m; every vertex on the plane.
area=$(awk '/"output"/ {inside = 1} inside && /"area_2d"/ {gsub(/[^0-9.e+-]/, "", $2); printf "%.6g", $2; exit}' \
  report.json)
check "area of the result" 40000 "$area"
check "vertices off the surface" 0 "$(awk '$1 == "v" && $4 != $2 + 2 * $3 {++n} END {print n + 0}' http.obj)"
check "surface minus itself" 200 "$(curl -sS -o zero.obj -w '%{http_code}' -F minuend=@http.obj -F subtrahend=@sw.asc \
  "$base/processes/subtract/execution?f=obj&assume-crs=EPSG:25831")"
check "heights that are not zero" 0 "$(awk '$1 == "v" && $4 != 0 {++n} END {print n + 0}' zero.obj)"

printf 'v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n' > bad.obj
check "bad input" "422 application/problem+json" "$(curl -sS -o problem -w '%{http_code} %{content_type}' \
  -F tiles=@bad.obj "$base/processes/merge/execution")"
[ $failures = 0 ] && echo "passed" || echo "$failures failed"
exit $((failures > 0))
