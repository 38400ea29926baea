# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory of an execution: what is published, what is refused at once, what fails on its way, what fits."""
import os
import re
import signal
import time
import unittest

from jobs import LONG, submit, wait_for, workers_of
from service import File, Service
from terrains import hills, lattice_ply

MEGA = 2**20


def published(service, operation):
    """(least, most) bytes for a face."""
    described = service.get("/processes/" + operation).json()["additionalParameters"]["parameters"]
    (value,) = next(p["value"] for p in described if p["name"] == "bytes-per-face")
    return value["least"], value["most"]


class Memory(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        service = Service()
        wait_for(service, submit(service).json()["jobID"])  # by then the maker of workers has loaded all it will
        (maker,), _ = workers_of(service)
        with open(f"/proc/{maker}/status", encoding="ascii") as status:
            cls.program = int(re.search(r"VmSize:\s+(\d+)", status.read())[1]) * 1024
        cls.published = {name: published(service, name) for name in ("threshold", "subtract")}
        assert service.close() == 0

    def job(self, parts, operation, query, room):
        """The end of a job that has so many bytes beside the program and its request, and the megabytes of the limit."""
        limit = self.program + 2 * sum(len(file.content) for _, file in parts) + room
        service = Service("--job-memory", str(limit))
        job = submit(service, parts, operation, query).json()["jobID"]
        status, results = wait_for(service, job), service.get(f"/jobs/{job}/results")
        self.assertEqual(service.close(), 0)
        if status["status"] == "failed":
            self.assertEqual((results.status, results.json()["type"]), (413, "/problems/out-of-memory"))
            self.assertEqual(results.json()["detail"], status["message"])
            self.assertIn(f"{-(-limit // MEGA)} MB", status["message"])
        return status

    def test_what_cannot_fit_is_refused_with_what_it_needs(self):
        cells, (least, most) = 500, self.published["threshold"]
        faces, parts = 2 * cells**2, [("surface", File("a.ply", lattice_ply(cells, 10)))]
        status = self.job(parts, "threshold", "?f=ply&crs=local:m&level=1", 3 * least * faces // 4)
        self.assertEqual(status["status"], "failed")
        self.assertRegex(status["message"], rf"needs at least \d+ MB.* {faces} faces take {least} to {most} bytes each")
        need = int(re.search(r"at least (\d+) MB", status["message"])[1]) * MEGA
        self.assertGreaterEqual(need, self.program + least * faces)
        self.assertEqual(self.job(parts, "threshold", "?f=ply&crs=local:m&level=1", most * faces + 32 * MEGA)["status"],
                         "successful")

    def test_what_runs_out_says_what_it_had(self):
        cells, (least, most) = 200, self.published["subtract"]
        faces = 4 * cells**2
        parts = [("minuend", File("a.ply", lattice_ply(cells, 10))),
                 ("subtrahend", File("b.ply", lattice_ply(cells, 9.97)))]
        status = self.job(parts, "subtract", "?f=ply&crs=local:m", least * faces + 25 * MEGA)
        self.assertEqual(status["status"], "failed")
        self.assertIn(f"takes {least} to {most} bytes for a face of its inputs: with {faces} faces", status["message"])
        had = int(re.search(r"had taken up to (\d+) MB", status["message"])[1]) * MEGA
        self.assertGreater(had, self.program + least * faces)
        self.assertEqual(self.job(parts, "subtract", "?f=ply&crs=local:m", most * faces + 32 * MEGA)["status"],
                         "successful")

    def test_what_the_system_kills_says_what_it_held(self):
        service = Service("--job-memory", "3G")
        job = submit(service, [("dem", File("h.asc", hills(900)))], "triangulate", LONG).json()["jobID"]
        deadline = time.monotonic() + 20
        while not (workers := workers_of(service)[1]) and time.monotonic() < deadline:
            time.sleep(0.02)
        os.kill(workers[0], signal.SIGKILL)
        status = wait_for(service, job)
        self.assertEqual(status["status"], "failed")
        held = int(re.search(r"when it held (\d+) MB of the 3072", status["message"])[1])
        self.assertGreater(held, 10)
        self.assertEqual(service.close(), 0)
