# SPDX-License-Identifier: GPL-3.0-or-later
"""Ordering jobs and waiting for them."""
import subprocess
import time

from service import File

ASYNC = {"Prefer": "respond-async"}
LONG = '?crs=local:m&f=obj&max-error=0.0001'  # of hills(700): some seconds


def obj(z):
    return f"v 0 0 {z}\nv 10 0 2\nv 0 10 3\nf 1 2 3\n"


PAIR = [("minuend", File("a.obj", obj(1))), ("subtrahend", File("b.obj", obj(4)))]
SUBTRACT = "?f=obj&crs=local:m"


def submit(service, parts=PAIR, operation="subtract", query=SUBTRACT, **headers):
    return service.post_form(operation, parts, query, {**ASYNC, **headers})


def wait_for(service, job, until=("successful", "failed", "dismissed"), timeout=60):
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        status = service.get("/jobs/" + job).json()
        if status["status"] in until:
            return status
        time.sleep(0.05)
    raise AssertionError(f"still {status}")


def workers_of(service):
    """Processes below the service: the maker of workers and the workers."""
    listing = subprocess.run(["ps", "-eo", "pid,ppid,comm"], capture_output=True, text=True, check=True).stdout
    rows = [line.split(None, 2) for line in listing.splitlines()[1:]]
    makers = [int(p) for p, parent, _ in rows if int(parent) == service.process.pid]
    return makers, [int(p) for p, parent, _ in rows if int(parent) in makers]
