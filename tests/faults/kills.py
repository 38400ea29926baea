#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Kills `terrane serve` with SIGKILL at random moments while clients order jobs, N times, and then looks: no acknowledged
job is lost, none is stuck, no result is half there.

  kills.py N [--servers S] [--postgresql] [--seed SEED]

With several servers they share one store (a PostgreSQL that the script starts) and one folder, and one of them is killed
at a time.
"""
import argparse
import hashlib
import os
import random
import sys
import tempfile
import threading
import time

sys.path[:0] = [os.path.dirname(__file__), os.path.join(os.path.dirname(__file__), "..", "api")]
import postgresql  # noqa: E402
from service import File, Service, form  # noqa: E402
from terrains import ascii_grid  # noqa: E402


def orders():
    """A few requests that take from a millisecond to half a second, and what they must give."""
    tin = "v 0 0 1\nv 10 0 2\nv 0 10 3\nf 1 2 3\n"
    yield "subtract", "?f=obj&crs=local:m", [("minuend", File("a.obj", tin)), ("subtrahend", File("b.obj", tin))]
    for count, step in ((20, 7919), (120, 104729)):
        grid = ascii_grid(count, count, lambda c, r, s=step: (c * s + r * 31 + c * r) % 1009)
        yield "triangulate", "?f=obj&crs=local:m&max-error=0.5", [("dem", File("g.asc", grid))]


class Client(threading.Thread):
    """Orders jobs one after another from whichever server answers; remembers what was acknowledged."""

    def __init__(self, services, seed):
        super().__init__(daemon=True)
        self.services, self.random = services, random.Random(seed)
        self.requests = [(operation, query, *form(parts)) for operation, query, parts in orders()]
        self.acknowledged, self.stopping = [], False

    def run(self):
        while not self.stopping:
            kind = self.random.randrange(len(self.requests))
            operation, query, content_type, body = self.requests[kind]
            key = f"{self.random.getrandbits(64):x}"
            for _ in range(1000):  # the same order until somebody takes it
                if self.stopping:
                    return
                try:
                    service = self.random.choice(self.services)
                    answer = service.request("POST", f"/processes/{operation}/execution{query}", body, {
                        "Content-Type": content_type, "Prefer": "respond-async", "Idempotency-Key": key}, timeout=10)
                except OSError:
                    time.sleep(0.005)
                    continue
                except Exception:  # half an answer: http.client has many names for it
                    continue
                if answer.status == 201:
                    self.acknowledged.append((answer.json()["jobID"], kind))
                    break
                if answer.status not in (503, 500):
                    raise AssertionError(f"{answer.status} {answer.body}")
                time.sleep(0.05)
            time.sleep(self.random.random() * 0.05)


def settled(services, jobs, seconds):
    """Waits until every job is over; {id: status}."""
    end, left, states = time.monotonic() + seconds, dict(jobs), {}
    while left and time.monotonic() < end:
        for job in list(left):
            answer = services[0].get("/jobs/" + job)
            if answer.status != 200:
                states[job] = f"lost ({answer.status})"
                del left[job]
                continue
            info = answer.json()
            if info["status"] in ("successful", "failed", "dismissed"):
                states[job] = info["status"] + (": " + info["message"] if info["status"] == "failed" else "")
                del left[job]
        time.sleep(0.1)
    states.update({job: "stuck" for job in left})
    return states


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kills", type=int)
    parser.add_argument("--servers", type=int, default=1)
    parser.add_argument("--postgresql", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    dice = random.Random(options.seed)
    begun = time.monotonic()
    if options.postgresql and not postgresql.programs():
        print("SKIPPED: PostgreSQL is not installed")
        return 77
    database = postgresql.Postgresql() if options.postgresql else None
    with tempfile.TemporaryDirectory() as data:
        arguments = ["--store", database.uri if database else "sqlite", "--threads", "2"]
        services = [Service(*arguments, data=data) for _ in range(options.servers)]
        clients = [Client(services, options.seed + 1 + i) for i in range(2)]
        for client in clients:
            client.start()
        for done in range(options.kills):
            victim = dice.choice(services)
            time.sleep(dice.choice((0.01, 0.05, 0.2)) * dice.random())
            victim.kill()
            victim.start()
            if done % 100 == 99:
                print(f"{done + 1} kills, {sum(len(c.acknowledged) for c in clients)} jobs acknowledged, "
                      f"{time.monotonic() - begun:.0f} s", flush=True)
        for client in clients:
            client.stopping = True
        for client in clients:
            client.join()
        jobs = dict(pair for client in clients for pair in client.acknowledged)
        states = settled(services, jobs, 120 + options.kills * 0.5)
        bad = {job: state for job, state in states.items() if state != "successful"}
        bodies = {}
        for job, kind in jobs.items():
            if job not in bad:
                answer = services[0].get(f"/jobs/{job}/results")
                if answer.status != 200:
                    bad[job] = f"results: {answer.status}"
                bodies.setdefault(kind, set()).add(hashlib.sha256(answer.body).hexdigest())
        # The first of each kind is also asked for while one waits.
        for kind, (operation, query, content_type, body) in enumerate(clients[0].requests):
            answer = services[0].request("POST", f"/processes/{operation}/execution{query}", body,
                                         {"Content-Type": content_type})
            if bodies.get(kind, set()) - {hashlib.sha256(answer.body).hexdigest()}:
                bad[f"kind {kind}"] = "a result is not the whole one"
        known = set(os.listdir(os.path.join(data, "jobs")))
        for service in services:
            if service.stop() != 0:
                bad["stop"] = "no clean stop"
    if database:
        database.close()
    print(f"{options.kills} kills in {time.monotonic() - begun:.0f} s: {len(jobs)} jobs acknowledged, {len(bad)} of them "
          f"lost, stuck, failed or half there; {len(known - set(jobs))} folders beside them")
    for job, state in list(bad.items())[:20]:
        print(" ", job, state)
    return 1 if bad or not jobs else 0  # kills that nobody met show nothing


if __name__ == "__main__":
    sys.exit(main())
