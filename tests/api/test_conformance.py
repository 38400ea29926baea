# SPDX-License-Identifier: GPL-3.0-or-later
"""The abstract tests of OGC 18-062r2, one method each, named as they are: 82 in eight classes. Those of class core are
in conformance_core.py. Methods with `extra` in their names are tests that the published annex leaves out."""
import datetime
import sys
import time
import unittest

import conformance_core
from ogc_client import ASYNC, ECHO, Conformance, Listener, Shared, report
from ogc_rules import leaves, openapi_30_faults, operations, resolve


def setUpModule():
    Shared.start()


def tearDownModule():
    code = Shared.stop()
    print(report(), file=sys.stderr)
    assert code == 0, f"exit code {code} after SIGTERM"


def moment(text):
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))


class Core(conformance_core.CoreTests):
    """Here, so that unittest finds them in this module."""


class ProcessDescription(Conformance):
    name = "ogc-process-description"

    def schemas(self, side):
        for name, description in self.descriptions().items():
            self.assertIsInstance(description[side], dict, name)
            for item, value in description[side].items():
                yield f"{name}, {item}", value

    def test_json_encoding(self):
        for description in self.descriptions().values():
            self.assert_valid(description, "process")

    def test_inputs_def(self):
        for _, value in self.schemas("inputs"):
            self.assert_valid(value, "inputDescription")

    def test_input_def(self):
        for _, value in self.schemas("inputs"):
            self.assert_valid(value["schema"], "schema")

    def test_input_mixed_type(self):
        self.assert_mixed("inputs")

    def assert_mixed(self, side):
        mixed = [value["schema"]["oneOf"] for _, value in self.schemas(side) if "oneOf" in value["schema"]]
        self.assertTrue(mixed)
        for kinds in mixed:
            self.assertGreater(len(kinds), 1)
            for kind in kinds:
                self.assert_valid(kind, "schema")

    def test_outputs_def(self):
        for _, value in self.schemas("outputs"):
            self.assert_valid(value, "outputDescription")

    def test_output_def(self):
        for _, value in self.schemas("outputs"):
            self.assert_valid(value["schema"], "schema")

    def test_output_mixed_type(self):
        self.assert_mixed("outputs")


class Json(Conformance):
    name = "json"

    def test_definition(self):
        job = self.done(self.echo(**ASYNC))
        for path in "/", "/conformance", "/processes", "/processes/echo", "/jobs", "/jobs/" + job:
            self.assertEqual(self.get(path, Accept="application/json").media_type, "application/json", path)
        self.assertEqual(self.echo(response="document", Accept="application/json").media_type, "application/json")
        self.assertEqual(self.echo(**ASYNC, Accept="application/json").media_type, "application/json")


class Html(Conformance):
    name = "html"

    def pages(self):
        job = self.done(self.echo(**ASYNC))
        return ["/", "/conformance", "/processes", "/processes/echo", "/processes/merge", "/jobs", "/jobs/" + job]

    def test_definition(self):
        for path in self.pages() + ["/api", "/openapi.json", "/docs", "/health", "/ready"]:
            self.page(path)
            self.assertTrue(self.get(path + "?f=html").media_type.startswith("text/html"), path)
        job = self.accepted(self.echo(inputs={"pause": 30}, **ASYNC))
        answer = self.service.request("DELETE", f"/jobs/{job}?f=html")
        self.assertEqual((answer.status, answer.media_type.split(";")[0]), (200, "text/html"))

    def test_content(self):
        for path in self.pages():
            value, page = self.get(path).json(), self.page(path)
            for leaf in leaves(value):
                self.assertTrue(leaf in page.text or leaf in page.links, (path, leaf))
            lists = [value.get("links", [])] + [p["links"] for p in value.get("processes", value.get("jobs", []))]
            for link in sum(lists, []):
                if link["rel"] not in ("self", "alternate"):  # those change places
                    self.assertIn(link["href"], page.links, path)
            self.assertIn("self", page.text)
            self.assertIn("alternate", page.text)


class OpenApi(Conformance):
    name = "oas30"
    ALWAYS = {"400", "401", "406", "500", "503"}

    def test_oas_definition_1(self):
        landing = self.get("/").json()
        json_type = "application/vnd.oai.openapi+json;version=3.0"
        described = [link for link in self.links(landing, "service-desc") if link["type"] == json_type]
        self.assertEqual(len(described), 1)
        self.assertEqual(self.get(described[0]["href"], Accept=json_type).media_type, json_type)
        documented = self.links(landing, "service-doc")
        self.assertEqual([link["type"] for link in documented], ["text/html"])
        self.page(documented[0]["href"])

    def test_oas_definition_2(self):
        self.assertEqual(openapi_30_faults(self.api()), [])

    def test_oas_impl(self):
        document, job = self.api(), self.done(self.echo(**ASYNC))
        report_link = self.execute("subtract", self.requests()["subtract"]).headers["Link"]
        report_id = report_link.split(">")[0].rsplit("/", 1)[1]
        for path, method, operation in operations(document):
            if method != "get":
                continue
            concrete = (path.replace("{jobId}", job).replace("{output}", "answer").replace("{reportId}", report_id)
                        .replace("{processId}", "merge"))
            answer = self.get(concrete)
            content = resolve(document, operation["responses"]["200"])["content"]
            self.assertTrue(answer.media_type in content or answer.media_type.split(";")[0] in content
                            or answer.media_type.startswith("multipart/related"), (path, answer.media_type))
            if "json" in answer.media_type and "application/json" in content:
                schema = content["application/json"]["schema"].get("$ref", "").rsplit("/", 1)[-1]
                if schema and schema != "results":
                    self.assert_valid(answer.json(), schema)
        surface = self.done(self.execute("subtract", self.requests()["subtract"], **ASYNC))
        self.assertEqual(self.get(f"/jobs/{surface}/results/surface?f=obj").media_type, "model/obj")
        described = document["paths"]["/jobs/{jobId}/results/{output}"]["get"]["responses"]["200"]
        self.assertIn("*/*", described["content"])
        for process, request in self.requests().items():
            self.assertEqual(self.execute(process, request).status, 200, process)

    def test_completeness(self):
        document = self.api()
        for path, method, operation in operations(document):
            success = [status for status in operation["responses"] if status < "300"]
            self.assertTrue(success, path)
            for status in success:
                response = resolve(document, operation["responses"][status])
                self.assertTrue(status == "204" or response["content"], (path, status))
                for kind, described in response.get("content", {}).items():
                    if "json" in kind:
                        self.assertNotEqual(described["schema"].get("type"), "string", (path, kind))
            if path.endswith("/execution"):
                self.assertLessEqual({"200", "201", "204"}, set(success))

    def test_exceptions_codes(self):
        document = self.api()
        for path, method, operation in operations(document):
            codes = set(operation["responses"])
            self.assertLessEqual(self.ALWAYS, codes, path)
            if "{" in path:
                self.assertIn("404", codes, path)
            if "requestBody" in operation:
                self.assertLessEqual({"411", "413", "415"}, codes, path)
        for path, status in ("/processes/nothing", "404"), ("/jobs/nothing", "404"), ("/jobs?limit=0", "400"):
            described = path.split("?")[0].replace("/processes/nothing", "/processes/{processId}").replace(
                "/jobs/nothing", "/jobs/{jobId}")
            self.assertEqual(str(self.service.get(path).status), status)
            self.assertIn(status, document["paths"][described]["get"]["responses"])
        answer = self.service.get("/", Accept="image/png")
        self.assertIn(str(answer.status), document["paths"]["/"]["get"]["responses"])

    def test_security(self):
        document = self.api()
        schemes = document["components"]["securitySchemes"]
        self.assertEqual([(s["type"], s["scheme"]) for s in schemes.values()], [("http", "bearer")])
        for requirement in document["security"]:
            self.assertLessEqual(set(requirement), set(schemes))


class JobList(Conformance):
    name = "job-list"

    def parameter(self, name):
        found = [p for p in self.api()["paths"]["/jobs"]["get"]["parameters"] if p["name"] == name]
        self.assertEqual(len(found), 1)
        self.assertEqual((found[0]["in"], found[0].get("required", False)), ("query", False))
        return found[0]["schema"]

    def jobs(self, query="", least=1):
        listed = self.valid("/jobs" + query, "jobList")["jobs"]
        self.assertGreaterEqual(len(listed), least, query)
        return listed

    def assert_list_of(self, name, kind):
        schema = resolve(self.api(), self.parameter(name))
        self.assertEqual((schema["type"], resolve(self.api(), schema["items"])["type"]), ("array", kind))

    def test_job_list_op(self):
        self.get("/jobs")

    def test_job_list_success(self):
        job = self.done(self.echo(**ASYNC))
        self.assertIn(job, [info["jobID"] for info in self.jobs()])
        self.assertIn(job, self.page("/jobs").text)

    def test_links(self):
        listed = self.get("/jobs?limit=3").json()
        self.assertEqual(len(self.links(listed, "self")), 1)
        self.assertEqual([link["type"] for link in self.links(listed, "alternate")], ["text/html"])
        for link in listed["links"]:
            self.assertTrue(self.get(link["href"]).media_type.startswith(link["type"]), link)

    def test_type_definition(self):
        self.assert_list_of("type", "string")

    def test_type_response(self):
        self.done(self.echo(**ASYNC))
        self.assertEqual({job["type"] for job in self.jobs("?type=process")}, {"process"})
        self.assertEqual(self.jobs("?type=other", 0), [])

    def test_processID_definition(self):
        self.assert_list_of("processID", "string")

    def test_processID_mandatory(self):
        self.done(self.echo(**ASYNC))
        self.assertTrue(all(job["processID"] in self.processes() for job in self.jobs("?limit=1000")))

    def test_processID_response(self):
        self.done(self.echo(**ASYNC))
        self.done(self.execute("subtract", self.requests()["subtract"], **ASYNC))
        self.assertEqual({job["processID"] for job in self.jobs("?processID=echo")}, {"echo"})
        for both in "?limit=1000&processID=echo&processID=subtract", "?limit=1000&processID=echo,subtract":
            self.assertEqual({job["processID"] for job in self.jobs(both)}, {"echo", "subtract"})

    def test_status_definition(self):
        self.assert_list_of("status", "string")

    def test_status_response(self):
        self.done(self.echo(**ASYNC))
        job = self.accepted(self.echo(inputs={"pause": 30}, **ASYNC))
        self.wait(job, ("running",))
        for query, statuses in (("?status=successful", {"successful"}), ("?status=running", {"running"}),
                                ("?limit=1000&status=running&status=successful", {"running", "successful"})):
            self.assertEqual({job["status"] for job in self.jobs(query)}, statuses)
        self.service.request("DELETE", "/jobs/" + job)
        self.exception(self.service.get("/jobs?status=gone"), 400)

    def test_datetime_definition(self):
        self.assertEqual(self.parameter("datetime")["type"], "string")
        for value in ("2020-01-01T00:00:00Z", "2020-01-01T00:00:00Z/2021-01-01T00:00:00Z", "../2021-01-01T00:00:00Z",
                      "/2021-01-01T00:00:00Z", "2020-01-01T00:00:00Z/..", "2020-01-01T00:00:00Z/",
                      "2020-01-01T00:00:00.5%2B02:00"):
            self.get("/jobs?datetime=" + value)
        for value in "yesterday", "2020-01-01", "../..", "2020-01-01T00:00:00.5e300Z", "2020-01-01T00:00:00.Z":
            self.exception(self.service.get("/jobs?datetime=" + value), 400)

    def test_datetime_response(self):
        job = self.done(self.echo(**ASYNC))
        created = self.get("/jobs/" + job).json()["created"]
        for interval in created + "/..", "../" + created, created, f"{created}/{created}":
            listed = self.jobs(f"?limit=1000&datetime={interval}")
            self.assertIn(job, [info["jobID"] for info in listed], interval)
            low, _, high = interval.partition("/")
            for info in listed:
                self.assertTrue(low == ".." or moment(low) <= moment(info["created"]), interval)
                self.assertTrue(high in ("", "..") or moment(info["created"]) <= moment(high), interval)
        self.assertEqual(self.jobs("?datetime=../2001-01-01T00:00:00Z", 0), [])

    def test_duration_definition(self):
        for name in "minDuration", "maxDuration":
            self.assert_list_of(name, "integer")

    def test_duration_response(self):
        self.done(self.echo(**ASYNC))
        self.done(self.echo(inputs={"pause": 1.2}, **ASYNC))

        def durations(query):
            return [(moment(job["finished"]) - moment(job["started"])).total_seconds()
                    for job in self.jobs("?limit=1000&status=successful&" + query)]
        self.assertTrue(all(d >= 1 for d in durations("minDuration=1")))
        self.assertTrue(all(d <= 1 for d in durations("maxDuration=1")))
        self.assertTrue(all(1 <= d <= 60 for d in durations("minDuration=1&maxDuration=60")))
        # They are lists: every bound holds.
        for several in "minDuration=0,1", "minDuration=1&minDuration=0":
            self.assertEqual(durations(several), durations("minDuration=1"))
        self.assertEqual(durations("maxDuration=1,60"), durations("maxDuration=1"))

    def test_limit_definition(self):
        schema = self.parameter("limit")
        self.assertEqual(schema["type"], "integer")
        self.assertTrue(1 <= schema["minimum"] <= schema["default"] <= schema["maximum"])

    def test_limit_response(self):
        for _ in range(3):
            self.done(self.echo(**ASYNC))
        self.assertEqual(len(self.jobs("?limit=2")), 2)
        most = self.parameter("limit")["maximum"]
        self.assertLessEqual(len(self.jobs(f"?limit={most}")), most)


class Callback(Conformance):
    name = "callback"

    def test_job_callback(self):
        Listener.told.clear()
        place = f"http://{Shared.callbacks}"
        request = {"inputs": {"answer": "teststring"}, "outputs": {"answer": {}}, "subscriber": {
            "successUri": place + "/done", "inProgressUri": place + "/running", "failedUri": place + "/failed"}}
        self.done(self.execute("echo", request, **ASYNC))
        end = time.monotonic() + 10
        while "/done" not in Listener.told and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(Listener.told["/done"][0], "application/json")
        self.assertIn(b"teststring", Listener.told["/done"][1])
        self.assertNotIn("/failed", Listener.told)


class Dismiss(Conformance):
    name = "dismiss"

    def dismissed(self):
        job = self.accepted(self.echo(inputs={**ECHO, "pause": 30}, **ASYNC))
        return job, self.service.request("DELETE", "/jobs/" + job)

    def test_job_dismiss_op(self):
        job, answer = self.dismissed()
        self.assertEqual(answer.status, 200, answer.body)
        self.assertNotIn(self.service.get("/jobs/" + job).json().get("status"), ("running", "accepted"))

    def test_job_dismiss_success(self):
        job, answer = self.dismissed()
        self.assertEqual(answer.status, 200)
        self.assert_valid(answer.json(), "statusInfo")
        self.assertEqual((answer.json()["status"], answer.json()["jobID"]), ("dismissed", job))


if __name__ == "__main__":
    unittest.main()
