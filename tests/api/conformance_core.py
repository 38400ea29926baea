# SPDX-License-Identifier: GPL-3.0-or-later
"""The abstract tests of class core, one method each; run by test_conformance.py."""
import http.client

from ogc_client import ASYNC, BINARY, CLASSES, ECHO, RELATIONS, Conformance
from ogc_rules import openapi_30_faults

VALUES = {name: "value" for name in ECHO}


class CoreTests(Conformance):
    name = "core"

    # --- landing page, interface, conformance -------------------------------------------------------------------------

    def test_landingpage_op(self):
        self.get("/")

    def test_landingpage_success(self):
        landing = self.valid("/", "landingPage")
        self.page("/")
        self.assertTrue(self.links(landing, "service-desc") and self.links(landing, "service-doc"))
        for word in "conformance", "processes", "job-list":
            self.assertTrue(self.links(landing, RELATIONS + word), word)

    def test_api_definition_op(self):
        landing = self.get("/").json()
        for link in self.links(landing, "service-desc") + self.links(landing, "service-doc") + [{"href": "/api"}]:
            self.get(link["href"])

    def test_api_definition_success(self):
        self.assertEqual(openapi_30_faults(self.api()), [])

    def test_conformance_op(self):
        for link in self.links(self.get("/").json(), RELATIONS + "conformance") + [{"href": "/conformance"}]:
            self.get(link["href"])

    def test_conformance_success(self):
        classes = self.valid("/conformance", "confClasses")["conformsTo"]
        self.assertEqual(sorted(c.removeprefix(CLASSES) for c in classes), sorted((
            "core", "ogc-process-description", "json", "html", "oas30", "job-list", "callback", "dismiss")))

    def test_http(self):
        for path in "/", "/processes", "/jobs":
            connection = http.client.HTTPConnection(self.service.host, self.service.port, timeout=20)
            connection.request("GET", path)
            response = connection.getresponse()
            self.assertEqual((response.version, response.status), (11, 200), path)
            connection.close()

    # --- processes ----------------------------------------------------------------------------------------------------

    def test_process_list(self):
        self.get("/processes")

    def test_process_list_success(self):
        listed = self.valid("/processes", "processList")
        page = self.page("/processes")
        for process in listed["processes"]:
            self.assertIn(process["description"].split(".")[0], page.text)

    def test_pl_limit_definition(self):
        self.assert_limit("/processes")

    def assert_limit(self, path):
        parameters = {p["name"]: p for p in self.api()["paths"][path]["get"]["parameters"]}
        limit = parameters["limit"]
        self.assertEqual((limit["in"], limit.get("required", False)), ("query", False))
        self.assertEqual(limit["schema"]["type"], "integer")
        self.assertEqual(limit.get("style", "form"), "form")
        schema = limit["schema"]
        self.assertTrue(1 <= schema["minimum"] <= schema["default"] <= schema["maximum"] <= 10000)

    def test_pl_limit_response(self):
        for limit in 1, 3, 10000:
            self.assertLessEqual(len(self.valid(f"/processes?limit={limit}", "processList")["processes"]), limit)
        seen, path = [], "/processes?limit=7"
        while path:
            listed = self.get(path).json()
            seen += [p["id"] for p in listed["processes"]]
            path = next((link["href"] for link in self.links(listed, "next")), None)
        self.assertEqual(seen, self.processes())
        for wrong in "0", "-1", "x", "":
            self.exception(self.service.get("/processes?limit=" + wrong), 400)

    def test_pl_links(self):
        listed = self.get("/processes").json()
        self.assertEqual(len(self.links(listed, "self")), 1)
        self.assertEqual([link["type"] for link in self.links(listed, "alternate")], ["text/html"])
        for link in listed["links"]:
            self.assertTrue(self.get(link["href"]).media_type.startswith(link["type"]))

    def test_process(self):
        for name in self.processes():
            self.get("/processes/" + name)

    def test_process_success(self):
        for name in self.processes():
            self.assertEqual(self.valid("/processes/" + name, "process")["id"], name)

    def test_process_exception_no_such_process(self):
        self.exception(self.service.get("/processes/nothing"), 404, "no-such-process")
        self.exception(self.service.post_json("nothing", {"inputs": {}}), 404, "no-such-process")

    # --- executions ---------------------------------------------------------------------------------------------------

    def test_job_creation_op(self):
        self.assert_value(self.echo({"answer": "value"}))
        self.accepted(self.echo(**ASYNC))

    def test_job_creation_auto_execution_mode(self):
        for name, request in self.requests().items():
            self.assertIn("async-execute", self.get("/processes/" + name).json()["jobControlOptions"])
            answer = self.execute(name, request, **ASYNC)
            self.assertIn(answer.status, (200, 201), (name, answer.body))
            if answer.status == 201:
                self.done(answer)

    def test_job_creation_default_execution_mode(self):
        for name, request in self.requests().items():
            self.assertEqual(self.execute(name, request).status, 200, name)

    def test_job_creation_request(self):
        for name, request in self.requests().items():
            self.assert_valid(request, "execute")
        for wrong in ({"inputs": 5}, {"inputs": {}, "response": "both"}, {"inputs": {}, "outputs": {"nothing": {}}},
                      {"inputs": {"nothing": 5}}, [], {"inputs": {}, "outputs": {"answer": {"transmissionMode": "x"}}}):
            self.exception(self.service.post_json("echo", wrong), 400)

    def test_job_creation_inputs(self):
        self.test_job_creation_input_inline()
        self.test_job_creation_input_ref()

    def test_job_creation_input_inline(self):
        for name, value in ECHO.items():
            self.assert_value(self.echo({name: "value"}, inputs={name: value}), name)

    def uploaded(self):
        answer = self.service.request("POST", "/uploads", BINARY, {"Content-Type": "image/tiff"})
        self.assertEqual(answer.status, 201, answer.body)
        return answer.headers["Location"]

    def test_job_creation_input_ref(self):
        self.assert_value(self.echo(inputs={"file": {"href": self.uploaded(), "type": "image/tiff"}}), "file")
        subtract = self.requests()["subtract"]["inputs"]
        job = self.done(self.execute("subtract", {"inputs": subtract}, **ASYNC))
        chained = {"minuend": {"href": f"/jobs/{job}/results/surface"}, "subtrahend": subtract["subtrahend"]}
        self.assertEqual(self.execute("subtract", {"inputs": chained}).status, 200)

    def test_job_creation_input_array(self):
        requests, found = self.requests(), 0
        for name, description in self.descriptions().items():
            for slot, value in description["inputs"].items():
                if value.get("maxOccurs", 1) == "unbounded" or value.get("maxOccurs", 1) > 1:
                    found += 1
                    one = requests[name]["inputs"][slot]
                    self.assertIsInstance(one, list)
                    self.assertEqual(self.execute(name, requests[name]).status, 200, name)
        self.assertGreater(found, 0)
        self.assert_value(self.echo({"array": "value"}), "array")

    def test_job_creation_input_inline_object(self):
        for value in ECHO["object"], ECHO["object"]["value"]:
            answer = self.service.post_json("echo", {"inputs": {"object": value}})
            self.assert_value(answer, "object")

    def test_job_creation_input_inline_mixed(self):
        mixed = self.get("/processes/info").json()["inputs"]["surface"]["schema"]["oneOf"]
        self.assertGreater(len(mixed), 1)
        text = "v 0 0 1\nv 10 0 2\nv 0 10 3\nf 1 2 3\n"
        tin = {"type": "TIN", "vertices": [[0, 0, 1], [10, 0, 2], [0, 10, 3]], "triangles": [[0, 1, 2]]}
        for value, media_type in (text, "model/obj"), (tin, "application/json"):
            for qualified in ({"value": value, "mediaType": media_type},
                              {"value": value, "format": {"mediaType": media_type}}):
                answer = self.execute("info", {"inputs": {"surface": qualified, "assume-crs": "local:m"}})
                self.assertEqual((answer.status, answer.json()["faces"]), (200, 1))

    def test_job_creation_input_inline_binary(self):
        self.assert_value(self.echo(inputs={"file": ECHO["file"]}), "file")
        self.assertEqual(self.echo(inputs={"file": ECHO["file"]["value"]}).body, BINARY)
        flat = {"value": ECHO["file"]["value"], "encoding": "base64", "mediaType": "image/tiff"}
        self.assert_value(self.echo(inputs={"file": flat}), "file")

    def test_job_creation_input_inline_bbox(self):
        self.assert_value(self.echo(inputs={"bbox": ECHO["bbox"]}), "bbox")

    def test_job_creation_input_validation(self):
        self.assertEqual(self.echo().status, 200)
        for name, wrong in {"number": "five", "flag": 5, "array": "teststring", "bbox": {"bbox": [1, 2, 3]},
                            "pause": 1000, "object": [1], "file": {"type": "wrong/type"}}.items():
            problem = self.exception(self.service.post_json("echo", {"inputs": {**ECHO, name: wrong}}), 400)
            self.assertIn(name, problem["detail"])
        for name, request in self.requests().items():
            problem = self.exception(self.service.post_json(
                name, {"inputs": {**request["inputs"], "max-error": "wide", "pause": "long"}}), 400)
            self.assertTrue("max-error" in problem["detail"] or "pause" in problem["detail"], problem)

    def test_extra_job_creation_default_outputs(self):
        for name, description in self.descriptions().items():
            if name != "echo":
                answer = self.execute(name, {**self.requests()[name], "response": "document"})
                self.assert_document(answer, description["outputs"])
        described = self.get("/processes/echo").json()["outputs"]
        self.assertEqual(set(described), set(ECHO))
        self.assert_parts(self.echo(), VALUES)

    def test_job_creation_sync_raw_value_one(self):
        for name in ECHO:
            self.assert_value(self.echo({name: "value"}, "raw"), name)

    def test_job_creation_sync_raw_value_multi(self):
        self.assert_parts(self.echo(VALUES, "raw"), VALUES)

    def test_job_creation_sync_raw_ref(self):
        self.assert_references(self.echo({"answer": "reference"}, "raw"), ["answer"])
        self.assert_references(self.echo({"answer": "reference", "file": "reference"}, "raw"), ["answer", "file"])

    def test_job_creation_sync_raw_mixed_multi(self):
        modes = {"answer": "value", "file": "reference", "bbox": "reference", "object": "value"}
        self.assert_parts(self.echo(modes, "raw"), modes)

    def test_job_creation_sync_document(self):
        for name, request in self.requests().items():
            answer = self.execute(name, {**request, "response": "document"})
            self.assertEqual((answer.status, answer.media_type), (200, "application/json"), (name, answer.body[:300]))
            self.assert_valid(answer.json(), "results")
        document = self.assert_document(self.echo({"answer": "reference", "number": "value"}, "document"),
                                        ["answer", "number"])
        self.assert_value(self.get(document["answer"]["href"]))

    def test_job_creation_success_async(self):
        self.accepted(self.echo(**ASYNC))

    # --- jobs ---------------------------------------------------------------------------------------------------------

    def test_job_op(self):
        self.get("/jobs/" + self.accepted(self.echo(**ASYNC)))

    def test_job_success(self):
        job = self.done(self.echo(**ASYNC))
        info = self.valid("/jobs/" + job, "statusInfo")
        page = self.page("/jobs/" + job)
        for name in "jobID", "status", "type", "processID", "created":
            self.assertIn(info[name], page.text)

    def test_job_exception_no_such_job(self):
        for job in "nothing", 32 * "0":
            self.exception(self.service.get("/jobs/" + job), 404, "no-such-job")

    def test_job_results(self):
        self.assertEqual(self.results(self.echo(**ASYNC)).status, 200)

    def test_job_results_exception_no_such_job(self):
        for job in "nothing", 32 * "0":
            self.exception(self.service.get(f"/jobs/{job}/results"), 404, "no-such-job")

    def test_job_results_exception_results_not_ready(self):
        job = self.accepted(self.echo(inputs={"answer": "late", "pause": 20}, **ASYNC))
        self.exception(self.service.get(f"/jobs/{job}/results"), 404, "result-not-ready")
        self.service.request("DELETE", "/jobs/" + job)

    def test_job_results_failed(self):
        surface = {"value": "v 0 0\n", "mediaType": "model/obj"}
        job = self.accepted(self.execute("info", {"inputs": {"surface": surface}}, **ASYNC))
        self.assertEqual(self.wait(job)["status"], "failed")
        answer = self.service.get(f"/jobs/{job}/results")
        self.assertTrue(self.exception(answer, answer.status)["type"].startswith("/problems/"))
        self.assertTrue(400 <= answer.status < 600 and answer.status != 404)

    def test_job_results_sync(self):
        answer = self.echo({"answer": "value"})
        for link in answer.headers.get_all("Link") or []:
            if "monitor" in link:
                info = self.valid(link[link.index("<") + 1:link.index(">")], "statusInfo")
                self.assertEqual(info["status"], "successful")

    def test_job_results_async_raw_value_one(self):
        for name in "answer", "file":
            self.assert_value(self.results(self.echo({name: "value"}, "raw", **ASYNC)), name)

    def test_job_results_async_raw_value_multi(self):
        self.assert_parts(self.results(self.echo(VALUES, "raw", **ASYNC)), VALUES)

    def test_job_results_async_raw_ref(self):
        asked = {"answer": "reference", "bbox": "reference"}
        self.assert_references(self.results(self.echo(asked, "raw", **ASYNC)), list(asked))

    def test_job_results_async_raw_mixed_multi(self):
        modes = {"answer": "reference", "file": "value", "array": "value"}
        self.assert_parts(self.results(self.echo(modes, "raw", **ASYNC)), modes)

    def test_job_results_async_document(self):
        document = self.assert_document(self.results(self.echo(
            {"answer": "value", "file": "reference"}, "document", **ASYNC)), ["answer", "file"])
        self.assert_value(self.get(document["file"]["href"]), "file")
