# SPDX-License-Identifier: GPL-3.0-or-later
# A container engine of our own for the tests, sourced by containers.sh: its own folder, socket and bridge; nothing is
# left behind. engine_start WORK sets DOCKER_HOST, or returns 1 with the reason in engine_reason.

bridge=terrane0
engine_reason=
docker=/usr/bin/docker          # a newer client earlier on PATH may have neither buildx nor compose
compose=/usr/bin/docker-compose

engine_install() {
  local missing=()
  command -v dockerd >/dev/null && [ -x "$docker" ] || missing+=(docker.io)
  [ -x "$compose" ] || missing+=(docker-compose)
  command -v debootstrap >/dev/null || missing+=(debootstrap)
  command -v iptables >/dev/null || missing+=(iptables)
  command -v ip >/dev/null || missing+=(iproute2)
  command -v curl >/dev/null || missing+=(curl)
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "installing ${missing[*]}"
  local install=(env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}")
  "${install[@]}" >/dev/null 2>&1 || { apt-get update -q >/dev/null && "${install[@]}" >/dev/null; }
}

engine_start() {
  engine_work=$1
  [ "$(id -u)" = 0 ] || { engine_reason="an engine can only be started by root"; return 1; }
  [ -f /etc/debian_version ] || { engine_reason="the base image is made with debootstrap, on Debian"; return 1; }
  engine_install || { engine_reason="docker.io, docker-compose or debootstrap cannot be installed"; return 1; }
  mkdir -p "$engine_work/engine"
  engine_forward=$(cat /proc/sys/net/ipv4/ip_forward)
  iptables-save > "$engine_work/iptables" 2>/dev/null || { engine_reason="iptables is not usable here"; return 1; }
  if ! { ip link add "$bridge" type bridge 2>/dev/null && ip addr add 172.30.0.1/24 dev "$bridge" &&
    ip link set "$bridge" up; }; then
    engine_reason="no network bridge can be made here"
    return 1
  fi
  dockerd --data-root "$engine_work/engine/root" --exec-root "$engine_work/engine/exec" \
    -H "unix://$engine_work/engine/d.sock" -p "$engine_work/engine/d.pid" --bridge "$bridge" \
    > "$engine_work/engine.log" 2>&1 &
  engine_pid=$!
  export DOCKER_HOST="unix://$engine_work/engine/d.sock" DOCKER_BUILDKIT=1 COMPOSE_DOCKER_CLI_BUILD=1
  for _ in $(seq 60); do
    "$docker" version >/dev/null 2>&1 && return 0
    kill -0 "$engine_pid" 2>/dev/null || break
    sleep 0.5
  done
  engine_reason="dockerd does not run here: $(grep -m1 -iE 'failed|error' "$engine_work/engine.log" | cut -c1-300)"
  return 1
}

# The engine, its mounts, its bridge and its rules go; what was there before stays.
engine_stop() {
  if [ -n "${engine_pid:-}" ]; then
    "$docker" ps -aq 2>/dev/null | xargs -r "$docker" rm -f >/dev/null 2>&1
    "$docker" network prune -f >/dev/null 2>&1
    kill "$engine_pid" 2>/dev/null
    wait "$engine_pid" 2>/dev/null
  fi
  # The engine leaves its network namespace mounted.
  awk -v work="$engine_work/" 'index($2, work) == 1 {print $2}' /proc/mounts | sort -r | while read -r mounted; do
    umount "$mounted" 2>/dev/null || umount -l "$mounted"
  done
  ip link del "$bridge" 2>/dev/null
  if [ -s "$engine_work/iptables" ]; then
    iptables-restore < "$engine_work/iptables" 2>/dev/null
  elif [ -f "$engine_work/iptables" ]; then  # there was not one rule before: what is there is the engine's
    iptables -P FORWARD ACCEPT 2>/dev/null
    for table in filter nat; do
      iptables -t $table -F 2>/dev/null
      iptables -t $table -X 2>/dev/null
    done
  fi
  [ -n "${engine_forward:-}" ] && echo "$engine_forward" > /proc/sys/net/ipv4/ip_forward
  rm -rf --one-file-system "$engine_work"
}

# debian:bookworm-slim without a registry: Debian's own bootstrap, with the mirror and the apt settings of this machine.
engine_base_image() {
  local root=$engine_work/base mirror sources=/etc/apt/sources.list.d/debian.sources
  mirror=$(sed -n 's/^URIs: *//p' "$sources" 2>/dev/null | head -1)
  [ -n "$mirror" ] || mirror=$(grep -m1 -oE '^deb .*https?://[^ ]+' /etc/apt/sources.list | grep -oE 'http.*')
  debootstrap --variant=minbase --include=ca-certificates bookworm "$root" "${mirror:-http://deb.debian.org/debian}" \
    > "$engine_work/debootstrap.log" 2>&1 || { tail -5 "$engine_work/debootstrap.log"; return 1; }
  if [ -f "$sources" ]; then
    cp "$sources" "$root/etc/apt/sources.list.d/"
    : > "$root/etc/apt/sources.list"
  fi
  # Proxy and clock settings only; hooks of this machine's other programs have no place in an image.
  cat /etc/apt/apt.conf /etc/apt/apt.conf.d/* 2>/dev/null | grep -E '^Acquire::(http|https|Check|Retries)[^{]*;' \
    > "$root/etc/apt/apt.conf.d/50-build-machine" || true
  echo 'APT::Sandbox::User "root";' >> "$root/etc/apt/apt.conf.d/50-build-machine"
  rm -rf "$root/var/cache/apt/archives/"*.deb "$root/var/lib/apt/lists/"* \
    "$root/usr/share/doc/"* "$root/usr/share/man/"* "$root/usr/share/locale/"*
  tar -C "$root" -c . | "$docker" import - debian:bookworm-slim >/dev/null
  rm -rf --one-file-system "$root"
}
