#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The check must fail on each kind of include it is there to find, and pass without them.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{core/overlay,io,ops,server,cli}
failed=0
try() { # try WANTED_CODE FILE INCLUDE
  echo "#include $3" >"$tree/$2"
  code=0
  "$here/includes_point_one_way.sh" "$tree" >/dev/null || code=$?
  [ "$code" = "$1" ] || { echo "$2 with #include $3: exit $code, wanted $1"; failed=1; }
  rm "$tree/$2"
}
try 0 core/a.cpp '"core/tin.hpp"'
try 0 core/a.cpp '<CGAL/Epeck.h>'
try 0 ops/a.cpp '"io/format.hpp"'
try 0 cli/a.cpp '"server/serve.hpp"'
try 1 core/a.cpp '"io/format.hpp"'
try 1 io/a.hpp '"ops/plan.hpp"'
try 1 ops/a.cpp '"server/serve.hpp"'
try 1 server/a.cpp '"cli/main.hpp"'
try 1 core/a.cpp '"tin.hpp"'
try 0 core/a.cpp '"core/overlay/arrangement.hpp"'
try 1 io/a.cpp '"core/overlay/arrangement.hpp"'
try 0 core/overlay/a.hpp '"core/plan/noding.hpp"'
try 1 core/overlay/a.hpp '"core/surface/walls.hpp"'
echo '#include <CGAL/Epeck.h>' >"$tree/core/heavy.hpp"
try 0 core/a.cpp '"core/heavy.hpp"'
try 1 core/a.hpp '"core/heavy.hpp"'
try 1 io/a.cpp '"core/heavy.hpp"'
try 1 core/a.cpp '<gdal.h>'
try 1 core/a.cpp '<nlohmann/json.hpp>'
try 1 ops/a.cpp '<httplib.h>'
exit $failed
