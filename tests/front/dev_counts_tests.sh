#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `./dev test` must count what ctest says: run, failed, skipped, and tests whose program is missing. Usage: ROOT
set -euo pipefail
source <(sed -n '/^count_tests()/,/^}/p' "$1/dev")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/CTestTestfile.cmake" <<'CMAKE'
add_test(passes true)
add_test(passes_too true)
add_test(fails false)
add_test(skips sh -c "exit 77")
set_tests_properties(skips PROPERTIES SKIP_RETURN_CODE 77)
add_test(skips_by_word sh -c "echo SKIPPED HERE")
set_tests_properties(skips_by_word PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED HERE")
add_test(disabled true)
set_tests_properties(disabled PROPERTIES DISABLED TRUE)
add_test(missing "./no-such-program")
add_test(hangs sleep 60)
set_tests_properties(hangs PROPERTIES TIMEOUT 1)
CMAKE
(cd "$work" && ctest --output-junit results.xml >log 2>&1) && { echo "ctest did not fail"; exit 1; }
counts=$(count_tests "$work/results.xml")
[ "$counts" = "2 3 3" ] || { echo "passed failed skipped: $counts, wanted 2 3 3"; cat "$work/results.xml"; exit 1; }
