# SPDX-License-Identifier: GPL-3.0-or-later
"""What the conformance tests share: one service, requests to it, jobs, and the count of what passed by class."""
import base64
import collections
import email
import http.server
import json
import threading
import time
import unittest

from ogc_rules import SCHEMAS, Page, faults
from service import Service

CLASSES = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"
RELATIONS = "http://www.opengis.net/def/rel/ogc/1.0/"
EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"
ASYNC = {"Prefer": "respond-async"}
BINARY = bytes(range(256))
ECHO = {"answer": "teststring", "array": [1, 2.5], "flag": True, "number": 4.25, "object": {"value": {"a": [1, None]}},
        "bbox": {"bbox": [7, 51.9, 7.1, 52], "crs": "http://www.opengis.net/def/crs/OGC/1.3/CRS84"},
        "file": {"value": base64.b64encode(BINARY).decode(),
                 "format": {"mediaType": "image/tiff", "encoding": "base64"}}}
OVER = ("successful", "failed", "dismissed")

tally = collections.defaultdict(lambda: [0, 0])


class Listener(http.server.BaseHTTPRequestHandler):
    told = {}

    def do_POST(self):
        Listener.told[self.path] = (self.headers["Content-Type"], self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_):
        pass


class Shared:
    """Started when the first test wants it."""
    service = listener = callbacks = None

    @classmethod
    def start(cls):
        cls.listener = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Listener)
        threading.Thread(target=cls.listener.serve_forever, daemon=True).start()
        cls.callbacks = f"127.0.0.1:{cls.listener.server_port}"
        cls.service = Service("--allow-hosts", cls.callbacks)

    @classmethod
    def stop(cls):
        cls.listener.shutdown()
        cls.listener.server_close()
        return cls.service.close()


class Conformance(unittest.TestCase):
    """Tests of one class; `name` is the last word of its address."""
    name = ""

    def run(self, result=None):
        before = len(result.failures) + len(result.errors)
        super().run(result)
        if "extra" not in self._testMethodName:
            tally[self.name][0] += len(result.failures) + len(result.errors) == before
            tally[self.name][1] += 1
        return result

    @property
    def service(self):
        return Shared.service

    def get(self, path, status=200, **headers):
        """A resource by its path or address."""
        answer = self.service.get(self.path_of(path), **headers)
        self.assertEqual(answer.status, status, (path, answer.body[:500]))
        return answer

    def path_of(self, address):
        return address.removeprefix(f"http://127.0.0.1:{self.service.port}")

    def assert_valid(self, value, schema):
        self.assertEqual(faults(value, SCHEMAS[schema]), [], schema)

    def valid(self, path, schema, status=200):
        answer = self.get(path, status, Accept="application/json")
        value = answer.json()
        self.assert_valid(value, schema)
        return value

    def page(self, path):
        answer = self.get(path, Accept="text/html")
        self.assertEqual(answer.media_type.split(";")[0], "text/html", path)
        page = Page(answer.body.decode())
        self.assertEqual(page.faults, [], path)
        return page

    def exception(self, answer, status, kind=None):
        self.assertEqual(answer.status, status, answer.body)
        self.assertEqual(answer.media_type, "application/problem+json")
        self.assert_valid(answer.json(), "exception")
        if kind:
            self.assertEqual(answer.json()["type"], EXCEPTIONS + kind)
        return answer.json()

    def links(self, value, relation):
        return [link for link in value["links"] if link["rel"] == relation]

    def processes(self):
        return [p["id"] for p in self.get("/processes?limit=10000").json()["processes"]]

    def descriptions(self):
        return {name: self.get("/processes/" + name).json() for name in self.processes()}

    def api(self):
        return self.get("/api").json()

    def requests(self):
        """A request of every process, as the interface's own examples have it."""
        paths = self.api()["paths"]
        return {path.split("/")[2]: item["post"]["requestBody"]["content"]["application/json"]["example"]
                for path, item in paths.items() if path.endswith("/execution")}

    def execute(self, process, request, **headers):
        self.assert_valid(request, "execute")
        return self.service.post_json(process, request, headers={k.replace("_", "-"): v for k, v in headers.items()})

    def echo(self, outputs=None, response=None, inputs=None, **headers):
        request = {"inputs": ECHO if inputs is None else inputs}
        if outputs is not None:
            request["outputs"] = {name: {"transmissionMode": mode} for name, mode in outputs.items()}
        if response:
            request["response"] = response
        return self.execute("echo", request, **headers)

    def accepted(self, answer):
        """The id of the job that was made."""
        self.assertEqual(answer.status, 201, answer.body)
        info = answer.json()
        self.assert_valid(info, "statusInfo")
        self.assertTrue(answer.headers["Location"].endswith("/jobs/" + info["jobID"]))
        return info["jobID"]

    def wait(self, job, until=OVER, timeout=60):
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            info = self.valid("/jobs/" + job, "statusInfo")
            if info["status"] in until:
                return info
            time.sleep(0.05)
        self.fail(f"still {info}")

    def done(self, answer):
        job = self.accepted(answer)
        self.assertEqual(self.wait(job)["status"], "successful")
        return job

    def results(self, answer):
        """Those of an accepted job, when it is done."""
        return self.service.get(f"/jobs/{self.done(answer)}/results")

    # --- what each kind of answer must look like ----------------------------------------------------------------------

    def assert_value(self, answer, output="answer"):
        self.assertEqual(answer.status, 200, answer.body)
        if output == "file":
            self.assertEqual((answer.media_type, answer.body), ("image/tiff", BINARY))
        else:
            self.assertEqual(answer.media_type, "application/json")
            self.assertEqual(answer.json(), ECHO["object"]["value"] if output == "object" else ECHO[output])

    def parts(self, answer):
        """Those of multipart/related by their Content-ID."""
        self.assertEqual(answer.status, 200, answer.body)
        self.assertTrue(answer.media_type.startswith("multipart/related"), answer.media_type)
        message = email.message_from_bytes(b"Content-Type: " + answer.media_type.encode() + b"\r\n\r\n" + answer.body)
        self.assertEqual(message.defects, [])
        return {part["Content-ID"].strip("<>"): part for part in message.get_payload()}

    def assert_parts(self, answer, modes):
        parts = self.parts(answer)
        self.assertEqual(set(parts), set(modes))
        for name, part in parts.items():
            content = part.get_payload(decode=True)
            if modes[name] == "reference":
                self.assertEqual(content.strip(), b"")
                self.assert_value(self.get(part["Content-Location"]), name)
            elif name == "file":
                self.assertEqual(content, BINARY)
            else:
                self.assertEqual(json.loads(content), ECHO["object"]["value"] if name == "object" else ECHO[name])

    def assert_references(self, answer, names):
        self.assertEqual((answer.status, answer.body), (204, b""))
        links = answer.headers.get_all("Link")
        hrefs = [link[link.index("<") + 1:link.index(">")] for link in links if "/results/" in link]
        self.assertEqual(len(hrefs), len(names), links)
        for name, href in zip(names, hrefs):
            self.assert_value(self.get(href), name)

    def assert_document(self, answer, names):
        self.assertEqual((answer.status, answer.media_type), (200, "application/json"), answer.body[:500])
        self.assert_valid(answer.json(), "results")
        self.assertLessEqual(set(names), set(answer.json()))
        return answer.json()


def report():
    lines = [f"  {name}: {passed}/{total}" for name, (passed, total) in sorted(tally.items())]
    passed, total = (sum(column) for column in zip(*tally.values()))
    return "\n".join(["OGC API - Processes 1.0, abstract tests passed by class:", *lines, f"  all: {passed}/{total}"])
