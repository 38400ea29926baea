#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fails on an include that points back, between rooms (server, cli -> ops -> io -> core) or between folders of a room.
# Usage: includes_point_one_way.sh ROOT
set -euo pipefail
cd "$1"
declare -A sees=([core]="core" [io]="io core" [ops]="ops io core" [server]="server ops io core" [cli]="cli server ops io core")
declare -A only=([CGAL]=core [gdal]=io [ogr]=io [cpl_]=io [GeographicLib]=io [proj]=io [nlohmann]="io ops server cli" [httplib]=server)
# Folders of a room that see only those before them.
rows=("core/mesh core/plan core/rounding core/overlay core/surface core/merge" "server/http server/pages server/requests server/worker server/jobs")
faults=0
fault() { echo "$1:$2: includes $3: $4"; faults=$((faults + 1)); }
has() { [[ " $1 " == *" $2 "* ]]; }

for room in core io ops server cli; do
  [ -d "$room" ] || continue
  while IFS=: read -r file line text; do
    path=$(sed -E 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]([^">]+)[">].*/\1/' <<<"$text")
    first=${path%%/*}
    if [[ $text == *\"* ]]; then
      [[ $path == */* ]] || fault "$file" "$line" "$path" "write includes from the root"
      # A door of core's is a header of its own; what lies in its folders is behind them.
      [[ $room == core || $path != core/*/* ]] || fault "$file" "$line" "$path" "what lies in folders of core is its own"
      has "${sees[$room]}" "$first" || fault "$file" "$line" "$path" "$room sees only: ${sees[$room]}"
      from=${file%/*} to=${path%/*}
      for row in "${rows[@]}"; do
        before="${row%%"$from"*}$from"
        has "$row" "$from" && has "$row" "$to" && ! has "$before" "$to" && fault "$file" "$line" "$path" "$from sees only: $before"
      done
    else
      for library in "${!only[@]}"; do
        [[ $path == $library* ]] && ! has "${only[$library]}" "$room" && fault "$file" "$line" "$path" "$library belongs to: ${only[$library]}"
      done
    fi
  done < <(grep -rnE '^[[:space:]]*#[[:space:]]*include' --include='*.hpp' --include='*.cpp' "$room" || true)
done
# CGAL's headers take seconds to compile: a header that needs them serves source files of core, and headers that say so
# themselves.
heavy=$(grep -rlE '#[[:space:]]*include[[:space:]]*<CGAL/' --include='*.hpp' core || true)
for header in $heavy; do
  while IFS=: read -r file line _; do
    [[ $file == core/*.cpp ]] || has "${heavy//$'\n'/ }" "$file" ||
      fault "$file" "$line" "$header" "it brings in CGAL, so only source files of core may"
  done < <(grep -rnF "#include \"$header\"" --include='*.hpp' --include='*.cpp' core io ops server cli || true)
done
[ $faults = 0 ] && echo "every include points one way"
exit $((faults > 0))
