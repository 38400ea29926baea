# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs: submitted, followed, dismissed, kept over a kill, chained; workers that die; results in every wrapping."""
import json
import os
import re
import signal
import subprocess
import time
import unittest

from jobs import ASYNC, LONG, PAIR, SUBTRACT, obj, submit, wait_for, workers_of
from one_service import OneService
from service import File, Service, form, in_background
from terrains import hills


class JobsOfOneService(OneService):
    arguments = "--threads", "2"

    def test_a_job_from_end_to_end(self):
        answer = submit(self.service)
        self.assertEqual(answer.status, 201, answer.body)
        self.assertEqual(answer.headers["Preference-Applied"], "respond-async")
        info = answer.json()
        self.assertTrue(answer.headers["Location"].endswith("/jobs/" + info["jobID"]))
        self.assertIn(info["status"], ("accepted", "running", "successful"))
        done = wait_for(self.service, info["jobID"])
        self.assertEqual((done["status"], done["progress"], done["processID"]), ("successful", 100, "subtract"))
        self.assertTrue(done["created"] <= done["started"] <= done["finished"] <= done["expires"])
        self.assertIn("http://www.opengis.net/def/rel/ogc/1.0/results", [link["rel"] for link in done["links"]])
        result = self.service.get(f"/jobs/{info['jobID']}/results")
        now = self.service.post_form("subtract", PAIR, SUBTRACT)
        self.assertEqual((result.status, result.body), (200, now.body))
        self.assertEqual(result.media_type, now.media_type)
        surface = self.service.get(f"/jobs/{info['jobID']}/results/surface")
        self.assertEqual((surface.status, surface.body), (200, now.body))
        certificate = self.service.get(f"/jobs/{info['jobID']}/results/certificate")
        self.assertEqual(certificate.json()["type"], "Certificate")
        ply = self.service.get(f"/jobs/{info['jobID']}/results/surface?f=ply&crs=local:m")
        self.assertEqual((ply.status, ply.body[:3]), (200, b"ply"))

    def test_what_is_wrong_with_an_order_is_said_at_once(self):
        for query, status in (("?overlap=no", 400), ("?f=nothing", 400), ("?grid=-1", 400)):
            self.assertEqual(submit(self.service, query=query).status, status, query)
        self.assertEqual(submit(self.service, parts=PAIR[:1]).status, 400)
        self.assertEqual(submit(self.service, operation="nothing").status, 404)

    def test_what_is_wrong_with_an_input_fails_the_job(self):
        job = submit(self.service, [("minuend", File("a.obj", "v 0 0\n")), PAIR[1]]).json()["jobID"]
        status = wait_for(self.service, job)
        self.assertEqual(status["status"], "failed")
        self.assertIn("a.obj", status["message"])
        results = self.service.get(f"/jobs/{job}/results")
        self.assert_problem(results, 422)

    def test_an_output_comes_as_it_is_or_as_it_is_asked_for(self):
        job = submit(self.service).json()["jobID"]
        wait_for(self.service, job)
        path = f"/jobs/{job}/results/surface"
        stored = self.service.get(path)
        as_it_is = self.service.get(path + "?f=obj", Accept="image/png")
        self.assertEqual((as_it_is.body, as_it_is.headers["ETag"]), (stored.body, stored.headers["ETag"]))
        report = self.service.get(f"/jobs/{job}/results/certificate?f=json")
        self.assertEqual((report.status, report.json()["type"]), (200, "Certificate"))
        self.assertIn(b"EPSG:25831", self.service.get(path + "?crs=EPSG:25831").body, "other parameters count too")
        self.assert_problem(self.service.get(path + "?colour=red"), 400, "colour")
        for other in f"/jobs/{job}/results?f=ply", f"/jobs/{job}/events?colour=red":
            self.assert_problem(self.service.get(other), 400, "no parameter")
        self.assert_problem(self.service.request("POST", "/uploads?colour=red", b"x"), 400, "name")

    def test_preferences_have_no_case(self):
        for text in "Respond-Async", "wait=1, respond-async;x=1", 'x="a, b", RESPOND-ASYNC':
            self.assertEqual(submit(self.service, Prefer=text).status, 201, text)
        for text in "respond-async=1", 'x="a, respond-async"', "return=minimal":
            self.assertEqual(submit(self.service, Prefer=text).status, 200, text)

    def test_a_dismissal_that_is_refused_leaves_the_job(self):
        job = self.service.post_json("echo", {"inputs": {"pause": 30}}, headers=ASYNC).json()["jobID"]
        self.assert_problem(self.service.request("DELETE", f"/jobs/{job}?f=pdf"), 400)
        self.assert_problem(self.service.request("DELETE", "/jobs/" + job, headers={"Accept": "image/png"}), 406)
        self.assertIn(self.service.get("/jobs/" + job).json()["status"], ("accepted", "running"))
        self.assertEqual(self.service.request("DELETE", "/jobs/" + job).status, 200)

    def test_results_that_go_while_they_are_asked_for(self):
        for _ in range(20):
            job = submit(self.service).json()["jobID"]
            wait_for(self.service, job)
            ask = f"GET /jobs/{job}/results/certificate HTTP/1.1\r\nHost: x\r\n".encode()
            answers = in_background(lambda ask=ask: self.service.raw((ask + b"\r\n") * 1000 + ask +
                                                                     b"Connection: close\r\n\r\n"))
            self.service.request("DELETE", "/jobs/" + job)
            statuses = re.findall(rb"HTTP/1.1 (\d+)", answers())
            self.assertEqual(len(statuses), 1001)
            self.assertLessEqual(set(statuses), {b"200", b"404"})

    def test_unknown_jobs_and_outputs(self):
        for path in ("/jobs/nothing", "/jobs/" + 32 * "0", f"/jobs/{32 * '0'}/results", "/jobs/..%2f..%2fetc"):
            answer = self.service.get(path)
            self.assertEqual(answer.status, 404)
            self.assertIn(answer.json()["type"].rsplit("/", 1)[1], ("no-such-job", "no-such-page"))
        job = submit(self.service).json()["jobID"]
        wait_for(self.service, job)
        self.assertEqual(self.service.get(f"/jobs/{job}/results/nothing").status, 404)
        self.assertEqual(self.service.get(f"/jobs/{job}/results/..%2fbody").status, 404)

    def test_results_are_not_there_before_the_end(self):
        job = submit(self.service, [("dem", File("h.asc", hills(900)))], "triangulate", LONG).json()["jobID"]
        wait_for(self.service, job, ("running",))
        early = self.service.get(f"/jobs/{job}/results")
        self.assertEqual(early.status, 404)
        self.assertTrue(early.json()["type"].endswith("/result-not-ready"))
        started = time.monotonic()
        dismissed = self.service.request("DELETE", "/jobs/" + job)
        self.assertEqual((dismissed.status, dismissed.json()["status"]), (200, "dismissed"))
        while workers_of(self.service)[1] and time.monotonic() - started < 5:
            time.sleep(0.02)
        self.assertLess(time.monotonic() - started, 1.5, "the work goes on")
        self.assertEqual(self.service.get("/jobs/" + job).json()["status"], "dismissed")
        self.assertEqual(self.service.get(f"/jobs/{job}/results").status, 410)
        self.assertEqual(self.service.request("DELETE", "/jobs/" + job).status, 200)
        self.assertEqual(self.service.get("/jobs/" + job).status, 404)

    def test_the_list_is_filtered_and_paged(self):
        ids = [submit(self.service).json()["jobID"] for _ in range(5)]
        for job in ids:
            wait_for(self.service, job)
        page = self.service.get("/jobs?limit=2").json()
        self.assertEqual((len(page["jobs"]), page["numberReturned"]), (2, 2))
        seen, path = [], "/jobs?limit=2&processID=subtract&status=successful"
        while path:
            page = self.service.get(path).json()
            seen += [job["jobID"] for job in page["jobs"]]
            following = [link["href"] for link in page["links"] if link["rel"] == "next"]
            path = following[0][following[0].index("/jobs"):] if following else None
        self.assertEqual(len(seen), len(set(seen)))
        self.assertLessEqual(set(ids), set(seen))
        self.assertEqual(self.service.get("/jobs?processID=merge,add").json()["jobs"], [])
        self.assertEqual(self.service.get("/jobs?minDuration=1000").json()["jobs"], [])
        self.assertEqual(self.service.get("/jobs?datetime=../2001-01-01T00:00:00Z").json()["jobs"], [])
        self.assertTrue(self.service.get("/jobs?datetime=2001-01-01T00:00:00Z/..").json()["jobs"])
        for query in ("limit=0", "limit=x", "status=gone", "datetime=yesterday", "minDuration=-1", "colour=red"):
            self.assertEqual(self.service.get("/jobs?" + query).status, 400, query)

    def test_an_idempotency_key_stands_for_one_request(self):
        key = {"Idempotency-Key": "k-" + os.urandom(4).hex()}
        first, again = submit(self.service, **key), None
        # The boundary is part of a form: the same request is the same bytes.
        content_type, body = form(PAIR)
        headers = {"Content-Type": content_type, **ASYNC, "Idempotency-Key": "x" + key["Idempotency-Key"]}
        path = "/processes/subtract/execution" + SUBTRACT
        first = self.service.request("POST", path, body, headers)
        again = self.service.request("POST", path, body, headers)
        self.assertEqual((first.status, again.status), (201, 201))
        self.assertEqual(first.json()["jobID"], again.json()["jobID"])
        other = self.service.request("POST", path + "&grid=0.1", body, headers)
        self.assertEqual(other.status, 422)
        self.assertTrue(other.json()["type"].endswith("idempotency-key-reused"))

    def test_uploads_and_results_are_inputs(self):
        uploaded = self.service.request("POST", "/uploads?name=a.obj", obj(1), {"Content-Type": "model/obj"})
        self.assertEqual(uploaded.status, 201, uploaded.body)
        href = uploaded.json()["href"]
        job = submit(self.service).json()["jobID"]
        wait_for(self.service, job)
        request = {"inputs": {"minuend": {"href": href}, "subtrahend": {"href": f"/jobs/{job}/results/surface"},
                              "crs": "local:m"}}
        answer = self.service.post_json("subtract", request, "?f=obj")
        self.assertEqual(answer.status, 200, answer.body)
        later = self.service.post_json("subtract", request, "?f=obj", ASYNC)
        self.assertEqual(later.status, 201, later.body)
        self.service.request("DELETE", "/jobs/" + job)  # what was ordered keeps its inputs
        done = later.json()["jobID"]
        self.assertEqual(wait_for(self.service, done)["status"], "successful")
        self.assertEqual(self.service.get(f"/jobs/{done}/results").body, answer.body)
        for bad in ("/uploads/" + 32 * "0", "/jobs/x", "/etc/passwd", "file:///etc/passwd", "http://127.0.0.1:1/x",
                    "/jobs/../../etc/passwd", "//example.org/x", "ftp://example.org/x", ""):
            request["inputs"]["minuend"] = {"href": bad}
            answer = self.service.post_json("subtract", request, "?f=obj")
            self.assertIn(answer.status, (400, 422), bad)

    def test_results_in_every_wrapping(self):
        inputs = {"minuend": {"value": obj(1), "mediaType": "model/obj"},
                  "subtrahend": {"value": obj(4), "mediaType": "model/obj"}, "crs": "local:m"}

        def ask(response, **modes):
            return self.service.post_json("subtract", {
                "inputs": inputs, "response": response,
                "outputs": {name: {"transmissionMode": mode} for name, mode in modes.items()}})
        one = ask("raw", surface="value")
        self.assertEqual(one.status, 200)
        several = ask("raw", surface="value", certificate="value")
        self.assertEqual(several.status, 200)
        self.assertTrue(several.media_type.startswith("multipart/related; boundary="))
        boundary = several.media_type.split("=")[1].encode()
        parts = several.body.split(b"--" + boundary)
        self.assertEqual((len(parts), parts[0], parts[-1]), (4, b"", b"--\r\n"))
        self.assertIn(one.body, parts[1])
        mixed = ask("raw", surface="reference", certificate="value")
        place = [line for line in mixed.body.split(b"\r\n") if line.startswith(b"Content-Location: ")][0].decode()
        path = place[place.index("/jobs"):]
        self.assertEqual(self.service.get(path).body, one.body)
        by_reference = ask("raw", surface="reference")
        self.assertEqual((by_reference.status, by_reference.body), (204, b""))
        link = by_reference.headers["Link"]
        path = link[link.index("/jobs"):link.index(">")]
        self.assertEqual(self.service.get(path).body, one.body)
        document = ask("document", surface="reference", certificate="value").json()
        href = document["surface"]["href"]
        self.assertEqual(self.service.get(href[href.index("/jobs"):]).body, one.body)
        self.assertEqual(document["certificate"]["value"]["type"], "Certificate")

    def test_events_tell_every_step(self):
        job = self.service.post_json("echo", {"inputs": {"pause": 4, "answer": "x"}}, headers=ASYNC).json()["jobID"]
        events = self.service.get(f"/jobs/{job}/events")
        self.assertEqual((events.status, events.media_type), (200, "text/event-stream"))
        told = [json.loads(line[6:]) for line in events.body.decode().splitlines() if line.startswith("data: ")]
        self.assertEqual(told[-1]["status"], "successful")
        progress = [event["progress"] for event in told]
        self.assertEqual(progress, sorted(progress))
        self.assertTrue([done for done in progress if 0 < done < 100], "on its way too")
        stages = {event["message"] for event in told if event["status"] == "running"}
        self.assertLessEqual({"pause"}, stages)
        self.assertNotIn("", stages)
        self.assertNotIn("waiting", stages)

    def test_a_worker_that_dies_is_a_failed_job(self):
        job = submit(self.service, [("dem", File("h.asc", hills(900)))], "triangulate", LONG).json()["jobID"]
        wait_for(self.service, job, ("running",))
        deadline = time.monotonic() + 10
        while not (workers := workers_of(self.service)[1]) and time.monotonic() < deadline:
            time.sleep(0.02)
        os.kill(workers[0], signal.SIGSEGV)
        self.assertEqual(wait_for(self.service, job)["status"], "failed")
        self.assertEqual(self.service.get(f"/jobs/{job}/results").status, 500)
        makers, _ = workers_of(self.service)
        os.kill(makers[0], signal.SIGKILL)
        time.sleep(0.2)
        self.assertEqual(self.service.post_form("subtract", PAIR, SUBTRACT).status, 200, "another maker is started")

    def test_workers_are_confined(self):
        in_background(lambda: self.service.post_form("triangulate", [("dem", File("h.asc", hills(900)))], LONG))
        deadline = time.monotonic() + 10
        while not (workers := workers_of(self.service)[1]) and time.monotonic() < deadline:
            time.sleep(0.01)
        with open(f"/proc/{workers[0]}/status", encoding="ascii") as status:
            fields = dict(line.rstrip("\n").split(":\t", 1) for line in status if ":\t" in line)
        self.assertNotEqual(fields["Uid"].split("\t")[1], "0")
        self.assertEqual((fields["NoNewPrivs"], fields["Seccomp"]), ("1", "2"))
        with open(f"/proc/{workers[0]}/limits", encoding="ascii") as limits:
            self.assertNotIn("unlimited", [line.split()[3] for line in limits if line.startswith("Max address space")])


class Limits(unittest.TestCase):
    def test_memory_and_time_of_one_execution(self):
        service = Service("--job-memory", "200M", "--sync-time", "3", "--sync-limit", "4M")
        large, small = [("dem", File("h.asc", hills(900)))], [("dem", File("h.asc", hills(250)))]
        job = submit(service, large, "triangulate", LONG).json()["jobID"]
        status = wait_for(service, job)
        self.assertEqual(status["status"], "failed")
        self.assertIn("200 MB", status["message"])
        self.assertEqual(service.get(f"/jobs/{job}/results").status, 413)
        slow = service.post_json("echo", {"inputs": {"pause": 20, "answer": "x"}})
        self.assertEqual((slow.status, slow.json()["type"]), (413, "/problems/too-slow"))
        too_large = service.post_form("triangulate", [("dem", File("h.asc", hills(1100)))], LONG)
        self.assertEqual(too_large.status, 413)
        self.assertIn("respond-async", too_large.json()["detail"])
        self.assertEqual(service.post_form("triangulate", small, LONG).status, 200)
        self.assertEqual(service.close(), 0)


class Expiry(unittest.TestCase):
    def test_jobs_and_uploads_are_kept_for_a_while(self):
        service = Service("--job-expiry", "2")
        href = service.request("POST", "/uploads", obj(1), {"Content-Type": "model/obj"}).json()["href"]
        job = submit(service).json()["jobID"]
        self.assertEqual(wait_for(service, job)["status"], "successful")
        self.assertEqual(service.get(f"/jobs/{job}/results").status, 200)
        end = time.monotonic() + 20
        while service.get("/jobs/" + job).status == 200 and time.monotonic() < end:
            time.sleep(0.2)
        self.assertEqual(service.get("/jobs/" + job).status, 404)
        self.assertEqual(service.get(f"/jobs/{job}/results/surface").status, 404)
        self.assertEqual(service.get("/jobs").json()["numberMatched"], 0)
        request = {"inputs": {"surface": {"href": href}, "crs": "local:m"}}
        while service.post_json("info", request).status == 200 and time.monotonic() < end:
            time.sleep(0.2)
        self.assertEqual(service.post_json("info", request).status, 422)
        for folder in "jobs", "uploads":
            self.assertEqual(os.listdir(os.path.join(service.data.name, folder)), [])
        self.assertEqual(service.close(), 0)


class Kills(unittest.TestCase):
    def test_jobs_survive_a_kill(self):
        service = Service()
        jobs = [submit(service, [("dem", File("h.asc", hills(300)))], "triangulate", LONG).json()["jobID"]
                for _ in range(4)]
        wait_for(service, jobs[0], ("running", "successful"))
        service.kill()
        service.start()
        done = [wait_for(service, job) for job in jobs]
        self.assertEqual([status["status"] for status in done], 4 * ["successful"])
        bodies = {service.get(f"/jobs/{job}/results").body for job in jobs}
        self.assertEqual(len(bodies), 1)
        self.assertEqual(service.close(), 0)

    def test_a_folder_has_one_service(self):
        service = Service()
        second = subprocess.run([*service.command[:2], "--port", "0", "--data", service.data.name],
                                capture_output=True, timeout=20, check=False)
        self.assertEqual(second.returncode, 2)
        self.assertIn(b"Another service works in", second.stderr)
        self.assertEqual(service.post_form("subtract", PAIR, SUBTRACT).status, 200, "it was left alone")
        self.assertEqual(service.close(), 0)

    def test_a_stop_hands_running_jobs_back(self):
        service = Service()
        job = submit(service, [("dem", File("h.asc", hills(900)))], "triangulate", LONG).json()["jobID"]
        wait_for(service, job, ("running",))
        self.assertEqual(service.stop(), 0)
        service.start()
        self.assertEqual(wait_for(service, job)["status"], "successful")
        self.assertEqual(service.close(), 0)


if __name__ == "__main__":
    unittest.main()
