#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The image and the service in real containers: build, run without rights, out of memory, clean stop, and the
# integration test from a second container. Starts an engine of its own and removes it; skips where none can run.
#   docker/containers.sh            KEEP_LOGS=FOLDER keeps the logs of engine and build
set -u
here=$(cd "$(dirname "$0")" && pwd)
root=$(dirname "$here")
work=$(mktemp -d "${TMPDIR:-/var/tmp}/terrane-containers-XXXXXX")
. "$here/engine.sh"

failures=0
begin=$SECONDS
say() { printf '%4ds  %s\n' $((SECONDS - begin)) "$*"; }
pass() { say "ok    $*"; }
fail() { say "FAIL  $*"; failures=$((failures + 1)); }
expect() { # expect WHAT WANTED GOT
  if [ "$2" = "$3" ]; then pass "$1: $3"; else fail "$1: wanted $2, got $3"; fi
}
cleanup() {
  [ -n "${KEEP_LOGS:-}" ] && mkdir -p "$KEEP_LOGS" && cp "$work"/*.log "$KEEP_LOGS/" 2>/dev/null
  engine_stop
}
trap cleanup EXIT
trap 'exit 130' INT TERM

inspect() { "$docker" inspect -f "$2" "$1" 2>/dev/null; }
wait_until() { # wait_until SECONDS CONTAINER FORMAT WANTED
  for _ in $(seq $(($1 * 5))); do
    [ "$(inspect "$2" "$3")" = "$4" ] && return 0
    sleep 0.2
  done
  return 1
}
hardened=(--read-only --tmpfs /tmp --cap-drop=ALL --security-opt no-new-privileges --pids-limit 512)

if ! engine_start "$work"; then
  echo "SKIPPED: no container engine can run here ($engine_reason)."
  exit 0
fi
say "engine $("$docker" version -f '{{.Server.Version}}'), storage $("$docker" info -f '{{.Driver}}')"

engine_base_image || { fail "the base image cannot be made"; exit 1; }
say "base image debian:bookworm-slim, $(($(inspect debian:bookworm-slim '{{.Size}}') / 1000000)) MB"

build_begin=$SECONDS
build=("$docker" build --progress plain -f "$here/Dockerfile" --build-arg "JOBS=${JOBS:-2}" -t terrane "$root")
if ! nice "${build[@]}" > "$work/build.log" 2>&1; then
  tail -40 "$work/build.log"
  fail "the image does not build"
  exit 1
fi
say "image built in $((SECONDS - build_begin)) s: $(($(inspect terrane '{{.Size}}') / 1000000)) MB"
expect "user of the image" terrane "$(inspect terrane '{{.Config.User}}')"
compilers=$("$docker" run --rm --entrypoint sh terrane -c 'command -v g++ gcc cmake ld || echo none')
expect "compilers in the image" none "$compilers"

# Without rights, with a root that cannot be written.
"$docker" run -d --name hard "${hardened[@]}" --memory 1g -p 127.0.0.1::8080 terrane >/dev/null
if wait_until 30 hard '{{.State.Health.Status}}' healthy; then
  pass "healthy with a read-only root, no capabilities, not root"
else
  fail "not healthy: $(inspect hard '{{.State.Status}}'), $("$docker" logs hard 2>&1 | tail -3)"
fi
expect "uid in the container" 10001 "$("$docker" exec hard id -u)"
writable() { "$docker" exec hard sh -c "touch $1/x 2>/dev/null && echo yes || echo no"; }
expect "the root can be written" no "$(writable /usr)"
expect "the data volume can be written" yes "$(writable /var/lib/terrane)"
address=http://$("$docker" port hard 8080/tcp | head -1)
expect "health from outside" 200 "$(curl -s -o /dev/null -w '%{http_code}' "$address/health")"
stop_begin=$(date +%s%N)
"$docker" stop -t 30 hard >/dev/null
stop_ms=$((($(date +%s%N) - stop_begin) / 1000000))
expect "exit code after SIGTERM" 0 "$(inspect hard '{{.State.ExitCode}}')"
[ $stop_ms -lt 10000 ] && pass "stopped in $stop_ms ms" || fail "stopping took $stop_ms ms"
"$docker" rm -v hard >/dev/null

# More than it may have: the kernel ends the worker, its client is told, and the service lives.
"$docker" run -d --name small "${hardened[@]}" --memory 96m --memory-swap 96m -p 127.0.0.1::8080 terrane >/dev/null
wait_until 30 small '{{.State.Health.Status}}' healthy || fail "not healthy within 96 MB"
address=http://$("$docker" port small 8080/tcp | head -1)
told=$(head -c 200000000 /dev/zero |
  curl -s -m 60 -F 'tiles=@-;filename=big.obj' "$address/processes/merge/execution" | grep -o '/problems/[a-z-]*')
expect "more memory than allowed: its client is told" /problems/out-of-memory "$told"
expect "and the service lives" 200 "$(curl -s -o /dev/null -w '%{http_code}' "$address/health")"
"$docker" rm -vf small >/dev/null

compose_files=(-f "$here/compose.yaml" -f "$here/compose.test.yaml")
"$compose" "${compose_files[@]}" --profile postgresql config --quiet
expect "the compose files with every profile are understood" 0 $?

# Two containers: the service, and one that merges tiles through it.
compose_begin=$SECONDS
export TERRANE_PORT=$((20000 + RANDOM % 20000))
together=("$compose" --ansi never -p terrane-test "${compose_files[@]}")
"${together[@]}" up --no-build --exit-code-from test --abort-on-container-exit > "$work/compose.log" 2>&1
code=$?
grep -aE 'test_1.*(ok|FAIL|passed)' "$work/compose.log" | sed 's/^test_1 *| */       /'
if [ $code = 0 ]; then pass "integration test from a second container, $((SECONDS - compose_begin)) s"; else
  tail -20 "$work/compose.log"
  fail "integration test: exit code $code"
fi
"${together[@]}" down -v >/dev/null 2>&1

[ $failures = 0 ] && say "containers: all passed" || say "containers: $failures failed"
exit $((failures > 0))
