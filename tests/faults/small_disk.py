#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole service on a real small disk, a tmpfs, that clients fill with uploads and jobs until nothing goes in any more:
they are told 507, what was acknowledged stays whole, nothing is stuck or half written; and with room again, first by
deleting jobs, then by as much as anybody wants, all is as it was. Needs root, for the mount.

  small_disk.py ROUNDS
"""
import os
import random
import subprocess
import sys
import tempfile
import time

sys.path[:0] = [os.path.dirname(__file__), os.path.join(os.path.dirname(__file__), "..", "api")]
from kills import orders, settled  # noqa: E402
from service import Service, form  # noqa: E402

ASYNC = {"Prefer": "respond-async"}
MEGABYTES = 8


class Client:
    """Orders, uploads, and remembers what was acknowledged and what was wrong."""

    def __init__(self, service, expected):
        self.service, self.expected = service, expected
        self.wrong, self.uploads, self.jobs, self.told = [], {}, {}, 0
        self.requests = [(operation, query, *form(parts)) for operation, query, parts in orders()]

    def expect(self, condition, *words):
        if not condition:
            self.wrong.append(" ".join(str(word) for word in words))

    def took(self, answer, what):
        """Whether it went in; an answer of another kind is wrong."""
        if answer.status in (200, 201):
            return True
        self.expect(answer.status == 507 and answer.media_type == "application/problem+json" and
                    answer.json()["status"] == 507, what, answer.status, answer.body[:300])
        self.told += 1
        return False

    def upload(self, content):
        answer = self.service.request("POST", "/uploads", content, {"Content-Type": "text/plain"})
        if self.took(answer, "upload"):
            self.uploads[answer.json()["href"]] = content
        return answer.status == 201

    def order(self, kind, later):
        operation, query, content_type, body = self.requests[kind]
        answer = self.service.request("POST", f"/processes/{operation}/execution{query}", body,
                                      {"Content-Type": content_type, **(ASYNC if later else {})})
        if self.took(answer, operation):
            if later:
                self.jobs[answer.json()["jobID"]] = kind
            else:
                self.expect(answer.body == self.expected[kind], "a waiting client got something else")
        return answer.status in (200, 201)

    def settle(self, when):
        """All jobs are over: done and whole, or failed for want of room."""
        states = settled([self.service], self.jobs, 60)
        for job, kind in self.jobs.items():
            if states[job] == "successful":
                body = self.service.get(f"/jobs/{job}/results").body
                self.expect(body == self.expected[kind], when, "a result is not whole")
            else:
                self.expect(states[job].startswith("failed") and "room" in states[job], when, "a job is", states[job])
        self.expect(self.service.get("/health").status == 200, when, "no health")

    def fill(self, dice):
        while True:
            done = [self.upload(dice.randbytes(dice.choice((1000, 50_000, 300_000)))),
                    self.order(dice.randrange(3), True), self.order(dice.randrange(3), False)]
            if not any(done):
                break
        for size in (30_000, 5_000, 1):  # the last bytes
            while self.upload(b"x" * size):
                pass

    def look_inside(self, data, when):
        """No folder that nobody knows of, nothing left of what was refused."""
        end = time.monotonic() + 10
        while os.listdir(os.path.join(data, "work", "server")) and time.monotonic() < end:
            time.sleep(0.1)
        for folder, known in (("work/server", ()), ("jobs", self.jobs),
                              ("uploads", [href.rsplit("/", 1)[1] for href in self.uploads])):
            found = set(os.listdir(os.path.join(data, folder)))
            self.expect(found == set(known), when, folder, "holds", len(found), "folders, not", len(known))


def one(dice, expected):
    with tempfile.TemporaryDirectory() as place:
        mount = ["mount", "-t", "tmpfs", "-o", f"size={MEGABYTES}m,mode=755", "tmpfs", place]
        if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
            print("SKIPPED: no tmpfs can be mounted here")
            sys.exit(77)
        try:
            service = Service("--threads", "1", data=place)
            client = Client(service, expected)
            client.fill(dice)
            client.settle("full:")
            client.look_inside(place, "full:")
            # Whoever deletes makes room, also now: the half with the largest results, since the records of all those jobs
            # took from the reserve, and that comes back first.
            sizes = {job: len(expected[kind]) for job, kind in client.jobs.items()}
            for job in sorted(sizes, key=sizes.get, reverse=True)[: (len(sizes) + 1) // 2]:
                answer = service.request("DELETE", "/jobs/" + job)
                client.expect(answer.status == 200, "DELETE", answer.status, answer.body[:300])
                del client.jobs[job]
            client.expect(client.order(0, True) and client.order(0, False), "deleting made no room")
            client.fill(dice)
            service.kill()
            service.start()
            client.settle("full, killed:")
            client.look_inside(place, "full, killed:")
            subprocess.run(["mount", "-o", "remount,size=64m", place], check=True)
            end = time.monotonic() + 10
            while not os.path.exists(os.path.join(place, "reserve")) and time.monotonic() < end:
                time.sleep(0.1)
            client.expect(os.path.exists(os.path.join(place, "reserve")), "no new reserve")
            for kind in range(3):
                client.expect(client.order(kind, True) and client.order(kind, False), "does not work with room again")
            client.settle("room again:")
            client.look_inside(place, "room again:")
            client.expect(service.stop() == 0, "no clean stop")
            if client.wrong:
                client.wrong.append(service.log_text()[-1500:])
            service.close()
        finally:
            subprocess.run(["umount", "-l", place], check=True)
    client.expect(client.told > 0, "nobody was told 507")
    return client


def main():
    if os.geteuid() != 0:
        print("SKIPPED: mounting takes root")
        return 77
    begun, bad, told = time.monotonic(), 0, 0
    calm = Service("--threads", "1")
    expected = [calm.post_form(operation, parts, query).body for operation, query, parts in orders()]
    calm.close()
    rounds = int(sys.argv[1])
    for seed in range(rounds):
        client = one(random.Random(seed), expected)
        told += client.told
        if client.wrong:
            bad += 1
            print(f"round {seed}:", *client.wrong, sep="\n  ", flush=True)
    print(f"{rounds} rounds on {MEGABYTES} MB in {time.monotonic() - begun:.0f} s: {bad} with something wrong; "
          f"507 was said {told} times")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
