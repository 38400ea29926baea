#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The whole benchmark on tiny meshes: that its document is complete and says what it could not run; never a time.
# The baselines are stand-ins that say known times, then none. Usage: benchmarks.sh ROOT BUILD
set -euo pipefail
root=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; cat "$work/log" "$work/out/benchmarks.md"; exit 1; }
has() { grep -qF -- "$1" "$work/out/benchmarks.md" || fail "the document lacks: $1"; }
run() {  # run BASELINES OPTION...
  local baselines=$1
  shift
  TERRANE_BASELINES=$baselines python3 "$root/tests/bench/benchmarks.py" --points 500 --build "$build" \
    --output "$work/out" "$@" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
}

run "$work/no-such-folder"
for section in Overlay Growth Merge Rasters Files 'What was not run'; do has "## $section"; done
for row in 'Terrane, 1 thread' 'shuffled / ordered' 'exponent in memory' 'exponent in the number of tiles' \
  'DEM to TIN, points' 'TIN to raster' 'read ply' 'its share outside the overlay'; do has "| $row"; done
has 'Overlay, Terrane / R: edge_walk.cpp is not in the folder of baselines'
others=$(sed '1,/^## What was not run/d' "$work/out/benchmarks.md" |
  grep -vE '^$|edge_walk\.cpp is not|cgal_cdt\.cpp is not|gdal_calc\.py is not installed|two processors' || true)
[ -z "$others" ] || fail "these did not run: $others"
awk -F'|' '!/^\|/ { columns = 0; next } columns && NF != columns { print; exit 1 } { columns = NF }' \
  "$work/out/benchmarks.md" || fail "a table is torn"
for plot in overlay growth; do
  has "](benchmarks-$plot.svg)"
  python3 -c 'import sys, xml.etree.ElementTree as xml
sys.exit(not xml.parse(sys.argv[1]).getroot().tag.endswith("svg"))' "$work/out/benchmarks-$plot.svg" ||
    fail "benchmarks-$plot.svg is no SVG"
done

mkdir "$work/baselines"
cat >"$work/baselines/edge_walk.cpp" <<'CPP'
#include <cstdio>
int main(int words, char** word) {
  std::FILE* mesh = words == 4 ? std::fopen(word[1], "rb") : nullptr;
  int counts[2];
  if (!mesh || std::fread(counts, 4, 2, mesh) != 2 || counts[0] < 500) return 1;
  std::printf("rounding 0\nproto3,500,it0,faces=1 wall=1.5 cpu=1 (walk 1) prep=0.5 peak=1MB\n");
}
CPP
echo 'int main() { return 3; }' >"$work/baselines/cgal_cdt.cpp"
mkdir "$work/build"
ln -s "$build/terrane" "$build/terrane-bench" "$work/build"
build=$work/build
run "$work/baselines" --only overlay
has '| edge-walk reference (R) | 2.000 s (median 2.000) |'
has 'Overlay, CGAL CDT / Terrane: `cgal_cdt'
has '/ R | 0.0'
