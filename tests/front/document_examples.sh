#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs every ```sh block of a document whose fence says "test", in order, in one folder that holds west.tif, east.tif, and
# the binary surfaces a.obj and b.obj, with the service running. Usage: document_examples.sh DOCUMENT TERRANE
set -euo pipefail
document=$1 terrane=$2
for tool in gdal_translate curl jq; do
  command -v $tool >/dev/null || { echo "SKIPPED: $tool is not installed"; exit 77; }
done
work=$(mktemp -d)
service=
cleanup() {
  [ -n "$service" ] && kill "$service" 2>/dev/null && wait "$service" 2>/dev/null
  rm -rf "$work"
}
trap cleanup EXIT
mkdir "$work/bin" "$work/here" "$work/data"
ln -s "$terrane" "$work/bin/terrane"
cd "$work/here"

tile() { # tile NAME EASTING BASE: 40 x 30 samples of 10 m with a hill; neighbours overlap by ten samples
  awk -v x0="$2" -v base="$3" 'BEGIN {
    printf "ncols 40\nnrows 30\nxllcenter %d\nyllcenter 4400000\ncellsize 10\nNODATA_value -9999\n", x0
    for (r = 29; r >= 0; --r) { for (c = 0; c < 40; ++c) {
      x = (x0 - 500000) / 10 + c; printf "%.3f ", base + 30 * exp(-((x - 35)^2 + (r - 15)^2) / 120) + 0.2 * x } print "" } }' >"$1.asc"
  gdal_translate -q -ot Float32 -a_srs EPSG:25831 "$1.asc" "$1.tif"
  rm -f "$1.asc" "$1".asc.aux.xml
}
tile west 500000 100
tile east 500300 100.5
"$terrane" threshold west.tif --level 110 -o a.obj --quiet
"$terrane" threshold west.tif --level 120 -o b.obj --quiet

: >"$work/address"  # the shell behind & may not have made it yet when it is first read
"$terrane" serve --port 0 --data "$work/data" >"$work/address" 2>"$work/log" &
service=$!
base=
for _ in $(seq 100); do
  base=$(sed -n 's/^listening on //p' "$work/address")
  [ -n "$base" ] && curl -fsS -o /dev/null "$base/health" 2>/dev/null && break
  kill -0 "$service" || { cat "$work/log"; exit 1; }
  sleep 0.1
done

awk '/^```sh test/ {inside = 1; ++n; next} /^```/ {inside = 0} inside {print > ("block-" n ".sh")}' "$document"
count=$(find . -name 'block-*.sh' | wc -l)
[ "$count" -ge 2 ] || { echo "$document has $count examples marked for the test"; exit 1; }
for i in $(seq "$count"); do
  sed -i "s#http://localhost:8080#$base#g" "block-$i.sh"
  echo "--- example $i"
  cat "block-$i.sh"
  PATH=$work/bin:$PATH bash -euo pipefail "block-$i.sh" || { echo "example $i failed"; exit 1; }
done
# What an example says it makes is there, and not empty.
for result in $(sed -n 's/.* -o \([^ ]*\).*/\1/p' block-*.sh); do
  [ -s "$result" ] || { echo "the examples made no $result"; exit 1; }
done
echo "$count examples of $document ran"
