#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The disk is full, at every point: the N-th write of the service (or of a worker) and some after it fail with ENOSPC, for
N from 1 on. Afterwards, with room again: the service answers, what was acknowledged is whole, nothing is stuck.

  full_disk.py POINTS PRELOADED [--where serve|workers] [--calls K]
"""
import argparse
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "api"))
sys.path.insert(0, os.path.dirname(__file__))
from kills import orders, settled  # noqa: E402
from service import Service, form  # noqa: E402


def one(point, options, expected):
    """What went wrong with the fault at one point, as lines; and whether it was reached."""
    wrong, statuses = [], set()
    os.environ.update({"LD_PRELOAD": options.preloaded, "NO_SPACE_IN": options.where, "NO_SPACE_FROM": str(point),
                       "NO_SPACE_CALLS": str(options.calls)})
    try:
        service = Service("--threads", "1")
    except AssertionError as error:  # refused to start, which is as good as any answer to a full disk
        return ([] if "terrane: the " in str(error).lower() or "room" in str(error) else [f"start: {error}"]), {507}
    finally:
        for name in ("LD_PRELOAD", "NO_SPACE_IN", "NO_SPACE_FROM", "NO_SPACE_CALLS"):
            os.environ.pop(name, None)
    acknowledged = []
    for kind, (operation, query, parts) in enumerate(orders()):
        if kind == 2:
            break
        content_type, body = form(parts)
        path = f"/processes/{operation}/execution{query}"
        now = service.request("POST", path, body, {"Content-Type": content_type})
        statuses.add(now.status)
        if now.status == 200 and now.body != expected[kind]:
            wrong.append("a waiting client got something else")
        later = service.request("POST", path, body, {"Content-Type": content_type, "Prefer": "respond-async"})
        statuses.add(later.status)
        if later.status == 201:
            acknowledged.append((later.json()["jobID"], kind))
        for answer in (now, later):
            if answer.status not in (200, 201, 507, 503):
                wrong.append(f"answer {answer.status} {answer.body[:300]!r}")
    states = settled([service], acknowledged, 20 + 5 * options.calls)  # what fails is tried again every five seconds
    if "stuck" in states.values():
        wrong.append("a job is stuck")
    if service.get("/health").status != 200:
        wrong.append("no health")
    # Room again: after a restart everything acknowledged is what it was, or failed because of the disk.
    service.stop()
    service.start()
    after = settled([service], acknowledged, 20)
    for job, kind in acknowledged:
        if after[job] == "successful":
            if service.get(f"/jobs/{job}/results").body != expected[kind]:
                wrong.append("a result is not whole")
        elif not after[job].startswith("failed") or "room" not in after[job]:
            wrong.append(f"a job: {states[job]}, then {after[job]}")
    operation, query, parts = next(orders())
    if service.post_form(operation, parts, query).status != 200:
        wrong.append("does not work with room again")
    if service.stop() != 0:
        wrong.append("no clean stop")
    if wrong:
        wrong.append(service.log_text()[-1500:])
    service.close()
    return wrong, statuses


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("points", type=int)
    parser.add_argument("preloaded")
    parser.add_argument("--where", default="serve")
    parser.add_argument("--calls", type=int, default=3)
    parser.add_argument("--first", type=int, default=1)
    options = parser.parse_args()
    options.preloaded = os.path.abspath(options.preloaded)
    begun = time.monotonic()
    calm = Service("--threads", "1")
    expected = [calm.post_form(operation, parts, query).body for operation, query, parts in orders()]
    calm.close()
    bad, refused = 0, 0
    for point in range(options.first, options.first + options.points):
        wrong, statuses = one(point, options, expected)
        refused += 507 in statuses
        if wrong:
            bad += 1
            print(f"point {point}:", *wrong, sep="\n  ", flush=True)
    print(f"{options.points} points in {time.monotonic() - begun:.0f} s: {bad} with something wrong; "
          f"at {refused} somebody was told 507")
    return 1 if bad or not refused else 0  # a fault that nobody met shows nothing


if __name__ == "__main__":
    sys.exit(main())
