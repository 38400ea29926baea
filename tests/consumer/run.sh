#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the build into an empty folder, builds a project against it that knows nothing else, and runs it.
# Usage: run.sh CMAKE BUILD_FOLDER COMPILER
set -euo pipefail
cmake=$1 build=$2 compiler=$3
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work/installed" >"$work/install.log" || { cat "$work/install.log"; exit 1; }
# From elsewhere, moved after it was installed: nothing may point back into the checkout or at the first prefix.
mv "$work/installed" "$work/moved"
"$cmake" -G Ninja -S "$here" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$work/moved" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
"$cmake" --build "$work/build"
"$work/build/consumer"
"$work/moved/bin/terrane" --help >/dev/null
