#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What the command line says of outputs: where two of them meet, flags given twice, a disk that is full.
# Usage: command_line_outputs.sh TERRANE
set -u
terrane=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > a.obj
failed=0
expect() {  # CODE WORDS... : the exit code of terrane WORDS
  local code=$1 got
  shift
  "$terrane" "$@" > out 2> err
  got=$?
  [ $got = "$code" ] || { echo "terrane $*: exit code $got, not $code"; cat err; failed=1; }
}
expect 0 convert a.obj -o b.obj --report b.json
expect 2 convert a.obj -o c.obj --report c.obj
expect 2 convert a.obj -o c.obj --report ./c.obj
expect 2 convert a.obj -o - --format obj --report -
expect 2 info a.obj --report -
expect 2 convert a.obj -o c.obj -o d.obj
expect 2 convert a.obj -o c.obj --output=d.obj
expect 2 convert a.obj -o c.obj --report c.json --report d.json
expect 2 convert a.obj -o c.obj --format obj -f ply
expect 2 convert a.obj -o missing/c.obj
expect 0 rasterize a.obj --cell-size 0.25 -o a.asc
expect 0 rasterize a.obj --like a.asc -o like.asc
expect 0 rasterize a.obj a.asc -o second.asc
cmp a.asc like.asc && cmp a.asc second.asc || failed=1
expect 2 rasterize a.obj a.asc --like a.asc -o c.asc
expect 2 rasterize a.obj --like a.asc --cell-size 1 -o c.asc
expect 0 profile a.obj --line 0,0,1,1 -o a.csv
expect 0 profile a.obj a.obj --line -1,0.25,1,0.25 -o a.png
expect 2 profile a.obj -o c.csv
expect 0 sample a.obj --points '0.1,0.1;5,5' -o points.geojson
printf 'POINT (0.1 0.1)' > point.wkt
expect 0 sample a.obj --points point.wkt
[ "$(tail -n 1 out)" = 0.1,0.1,0 ] || { echo "sample says $(cat out)"; failed=1; }
# A truth value needs no word after it, whether it is of one operation or of all.
expect 0 convert a.obj --provenance -o faces.json
grep -q '"decided":\[0\]' faces.json || { cat faces.json; failed=1; }
expect 0 convert a.obj --provenance false -o faces.json --force
# A warning names the file and the element.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n' > turned.obj
expect 0 convert turned.obj -o turned.ply
grep -q '^warning: turned.obj: 1 clockwise faces were turned (face 0); correct' err || { cat err; failed=1; }
[ ! -e c.obj ] || { echo "a refused command left c.obj"; failed=1; }
[ ! -c /dev/full ] || expect 4 convert a.obj --format obj -o /dev/full

# A file that is not held whole is read alike by its name, as standard input and through a pipe, and may be replaced.
for ((i = 1; i <= 4000; i++)); do printf 'v %d %d %d\nv %d %d %d\n' $i 0 $((i % 7)) $i 1 $((i % 5)); done > large.obj
for ((i = 1; i < 8000; i += 2)); do printf 'f %d %d %d\nf %d %d %d\n' $i $((i + 2)) $((i + 3)) $i $((i + 3)) $((i + 1)); done |
  head -n 7998 >> large.obj
"$terrane" convert large.obj -o named.ply 2> err || { cat err; failed=1; }
"$terrane" convert - -o - --format ply < large.obj > redirected.ply 2> err || { cat err; failed=1; }
cat large.obj | "$terrane" convert - -o piped.ply 2> err || { cat err; failed=1; }
cmp named.ply redirected.ply && cmp named.ply piped.ply || failed=1
expect 0 convert large.obj -o large.obj --force
expect 0 convert large.obj -o again.ply
cmp named.ply again.ply || failed=1
[ -z "$(find . -name '.*.obj.*' -o -name '.*.ply.*')" ] || { echo "temporary files are left"; failed=1; }

# True and false: what is not binary is an input error, what cannot be meant a usage error.
printf 'ncols 3\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 10\n1 2 3\n2 4 4\n3 3 5\n' > dem.asc
expect 0 threshold dem.asc --level 2.5 -o true.obj
expect 0 and true.obj true.obj -o and.obj
expect 0 not and.obj -o not.obj
expect 0 nor and.obj not.obj --extent box -o nor.obj
expect 0 quantize dem.asc --interval 2 -o terraces.obj
expect 3 or true.obj dem.asc -o or.obj
expect 2 threshold dem.asc -o none.obj
expect 2 quantize dem.asc --interval 1 --levels 1,2 -o none.obj
expect 2 xor true.obj true.obj --z-true 0 -o none.obj

# Names of files may be in any encoding; JSON is in UTF-8.
latin=$(printf 'h\366he.asc')
cp dem.asc "$latin"
expect 0 info "$latin" -o info.json
expect 0 threshold "$latin" --level 2.5 -o true.json --report report.json
for document in info.json true.json report.json; do
  iconv -f UTF-8 -t UTF-16 "$document" > /dev/null || { echo "$document is not UTF-8"; failed=1; }
done
exit $failed
