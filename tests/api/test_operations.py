# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators and clients rely on beside the resources: conditions, ranges, codings, pages of other origins, tokens,
metrics, settings, logs."""
import gzip
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
import unittest

from one_service import Problems, close, for_module
from service import TERRANE, File, Service, form, free_port
from terrains import hills, square_obj

CRS = "?assume-crs=EPSG:25831"
ALL = "/processes"


setUpModule, tearDownModule = for_module(globals())


def unzstd(packed):
    if not shutil.which("zstd"):
        raise unittest.SkipTest("there is no zstd")
    return subprocess.run(["zstd", "-dc"], input=packed, capture_output=True, check=True).stdout


def refusal(arguments, environment=None):
    """What the program says when it does not start."""
    run = subprocess.run([TERRANE, "serve", *arguments], capture_output=True, timeout=20, check=False,
                         env={**os.environ, **(environment or {})})
    return run.returncode, run.stderr.decode()


class Conditions(Problems):
    def test_what_the_client_has_is_not_sent_again(self):
        whole = service.get(ALL)
        self.assertRegex(whole.headers["ETag"], '^"[0-9a-f]{32}"$')
        for method in "GET", "HEAD":
            known = service.request(method, ALL, headers={"If-None-Match": whole.headers["ETag"]})
            self.assertEqual((known.status, known.body), (304, b""))
            self.assertEqual(known.headers["ETag"], whole.headers["ETag"])
            self.assertIsNone(known.headers["Content-Type"])
            self.assertIsNone(known.headers["Content-Length"])
        self.assertEqual(service.get(ALL, If_None_Match='"other"').body, whole.body)
        self.assertEqual(service.get(ALL, If_Match='"other"').status, 412)

    def test_the_connection_goes_on_after_304(self):
        request = b"GET /health HTTP/1.1\r\nHost: x\r\nIf-None-Match: *\r\n\r\n"
        last = b"GET /health HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
        answers = service.raw(request + request + last)
        self.assertEqual(re.findall(rb"HTTP/1.1 (\d+)", answers), [b"304", b"304", b"200"])

    def test_a_part(self):
        whole = service.get(ALL)
        self.assertEqual(whole.headers["Accept-Ranges"], "bytes")
        size = len(whole.body)
        for text, first, end in ("0-99", 0, 100), ("100-", 100, size), ("-7", size - 7, size), ("5-5", 5, 6):
            part = service.get(ALL, Range="bytes=" + text, If_Range=whole.headers["ETag"])
            self.assertEqual((part.status, part.body), (206, whole.body[first:end]), text)
            self.assertEqual(part.headers["Content-Range"], f"bytes {first}-{end - 1}/{size}")
            self.assertEqual(part.headers["ETag"], whole.headers["ETag"])
        self.assertEqual(service.get(ALL, Range="bytes=0-9", If_Range='"other"').body, whole.body)

    def test_parts_that_are_not_there(self):
        size = len(service.get(ALL).body)
        for text in f"{size}-", "0-1,3-4", "-0", ",".join(["0-"] * 10):
            answer = service.get(ALL, Range="bytes=" + text)
            self.assert_problem(answer, 416)
            self.assertEqual(answer.headers["Content-Range"], f"bytes */{size}")


class Codings(unittest.TestCase):
    def test_resources(self):
        plain = service.get(ALL)
        self.assertIsNone(plain.headers["Content-Encoding"])
        self.assertIn("Accept-Encoding", plain.headers["Vary"])
        tags = {plain.headers["ETag"]}
        for accept, coding, unpack in (("gzip", "gzip", gzip.decompress), ("zstd;q=0.5, gzip", "gzip", gzip.decompress),
                                       ("gzip, deflate, br, zstd", "zstd", unzstd)):
            packed = service.get(ALL, Accept_Encoding=accept)
            self.assertEqual(packed.headers["Content-Encoding"], coding)
            self.assertEqual(int(packed.headers["Content-Length"]), len(packed.body))
            self.assertLess(len(packed.body), len(plain.body) / 2)
            self.assertEqual(unpack(packed.body), plain.body)
            tags.add(packed.headers["ETag"])
            known = service.get(ALL, Accept_Encoding=accept, If_None_Match=packed.headers["ETag"])
            self.assertEqual(known.status, 304)
        self.assertEqual(len(tags), 3)

    def test_what_is_not_packed(self):
        for accept in "br", "gzip;q=0", "identity, gzip;q=0.1":
            self.assertIsNone(service.get(ALL, Accept_Encoding=accept).headers["Content-Encoding"], accept)
        small = service.get("/health", Accept_Encoding="gzip, zstd")
        self.assertIsNone(small.headers["Content-Encoding"])
        part = service.get(ALL, Accept_Encoding="gzip", Range="bytes=0-5000")
        self.assertEqual((part.status, part.headers["Content-Encoding"]), (206, None))
        picture = service.post_form("render", [("surface", File("a.obj", square_obj(0, 0, 100, 10, 50)))],
                                    CRS + "&f=png", {"Accept-Encoding": "gzip"})
        self.assertEqual((picture.status, picture.media_type), (200, "image/png"))
        self.assertIsNone(picture.headers["Content-Encoding"])

    def test_a_large_result_is_packed_while_it_is_sent(self):
        parts = [("dem", File("hills.asc", hills(200)))]
        query = CRS + "&f=obj&max-error=0"
        plain = service.post_form("triangulate", parts, query)
        self.assertEqual(plain.status, 200, plain.body[:500])
        self.assertGreater(len(plain.body), 2**20)
        for coding, unpack in ("gzip", gzip.decompress), ("zstd", unzstd):
            packed = service.post_form("triangulate", parts, query, {"Accept-Encoding": coding})
            self.assertEqual(packed.headers["Content-Encoding"], coding)
            self.assertEqual(packed.headers["Transfer-Encoding"], "chunked")
            self.assertEqual(packed.headers["Content-Disposition"], plain.headers["Content-Disposition"])
            self.assertLess(len(packed.body), len(plain.body) / 2)
            self.assertEqual(unpack(packed.body), plain.body)


class Files(unittest.TestCase):
    """Results of jobs are sent from files."""

    @classmethod
    def setUpClass(cls):
        kind, body = form([("dem", File("hills.asc", hills(200)))])
        job = service.request("POST", f"/processes/triangulate/execution{CRS}&f=obj&max-error=0", body,
                              {"Content-Type": kind, "Prefer": "respond-async"}).json()["jobID"]
        for _ in range(600):
            if service.get("/jobs/" + job).json()["status"] not in ("accepted", "running"):
                break
            time.sleep(0.1)
        cls.path = f"/jobs/{job}/results/surface"
        cls.whole = service.get(cls.path)

    def test_the_whole(self):
        self.assertEqual(self.whole.status, 200, self.whole.body[:500])
        self.assertGreater(len(self.whole.body), 2**20)
        self.assertEqual(int(self.whole.headers["Content-Length"]), len(self.whole.body))
        self.assertEqual(self.whole.headers["Accept-Ranges"], "bytes")

    def test_a_download_goes_on_where_it_broke_off(self):
        tag = self.whole.headers["ETag"]
        rest = service.get(self.path, Range="bytes=1000000-", If_Range=tag, Accept_Encoding="gzip")
        self.assertEqual(rest.status, 206)
        self.assertEqual(rest.body, self.whole.body[1000000:])
        self.assertEqual(service.get(self.path, Range="bytes=99999999999-").status, 416)

    def test_it_is_packed_and_known_again(self):
        tags = {self.whole.headers["ETag"]}
        for coding, unpack in ("gzip", gzip.decompress), ("zstd", unzstd):
            packed = service.get(self.path, Accept_Encoding=coding)
            self.assertEqual(packed.headers["Content-Encoding"], coding)
            self.assertLess(len(packed.body), len(self.whole.body) / 2)
            self.assertEqual(unpack(packed.body), self.whole.body)
            tags.add(packed.headers["ETag"])
            known = service.get(self.path, Accept_Encoding=coding, If_None_Match=packed.headers["ETag"])
            self.assertEqual((known.status, known.body), (304, b""))
        self.assertEqual(len(tags), 3)
        self.assertEqual(service.get(self.path, If_None_Match=self.whole.headers["ETag"]).status, 304)

    def test_all_results_are_known_again_too(self):
        path = self.path.rsplit("/", 1)[0]
        whole = service.get(path)
        self.assertEqual((whole.body, whole.headers["ETag"]), (self.whole.body, self.whole.headers["ETag"]))
        self.assertEqual(service.get(path, If_None_Match=whole.headers["ETag"]).status, 304)
        converted = service.get(self.path + "?f=ply")
        self.assertGreater(len(converted.body), 2**18)
        self.assertEqual(service.get(self.path + "?f=ply", If_None_Match=converted.headers["ETag"]).status, 304)

    def test_old_clients_get_a_length(self):
        answer = service.raw(f"GET {self.path} HTTP/1.0\r\nAccept-Encoding: gzip\r\n\r\n".encode())
        head, body = answer.split(b"\r\n\r\n", 1)
        self.assertNotIn(b"chunked", head)
        self.assertEqual(body, self.whole.body)


class Origins(unittest.TestCase):
    PREFLIGHT = {"Origin": "https://maps.example.org", "Access-Control-Request-Method": "POST",
                 "Access-Control-Request-Headers": "content-type,prefer"}

    def test_every_origin_by_default_and_no_credentials(self):
        for path in "/", "/nothing", ALL:
            answer = service.get(path, Origin="https://maps.example.org")
            self.assertEqual(answer.headers["Access-Control-Allow-Origin"], "*")
            self.assertIsNone(answer.headers["Access-Control-Allow-Credentials"])
            exposed = set(answer.headers["Access-Control-Expose-Headers"].split(", "))
            self.assertLessEqual({"Location", "Link", "ETag", "Retry-After", "Content-Disposition", "X-Request-Id",
                                  "Terrane-Warnings"}, exposed)

    def test_preflight(self):
        answer = service.request("OPTIONS", "/processes/merge/execution", headers=self.PREFLIGHT)
        self.assertEqual((answer.status, answer.body), (204, b""))
        self.assertIsNone(answer.headers["Content-Length"])
        self.assertEqual(answer.headers["Access-Control-Allow-Origin"], "*")
        self.assertIn("POST", answer.headers["Access-Control-Allow-Methods"])
        self.assertIn("Prefer", answer.headers["Access-Control-Allow-Headers"])
        self.assertTrue(answer.headers["Access-Control-Max-Age"].isdigit())

    def test_listed_origins(self):
        listed = Service("--cors-origins", "https://maps.example.org,http://localhost:3000")
        try:
            answer = listed.get(ALL, Origin="https://maps.example.org")
            self.assertEqual(answer.headers["Access-Control-Allow-Origin"], "https://maps.example.org")
            self.assertIn("Origin", answer.headers["Vary"])
            self.assertIsNone(listed.get(ALL, Origin="https://other.org").headers["Access-Control-Allow-Origin"])
            other = listed.request("OPTIONS", ALL, headers={**self.PREFLIGHT, "Origin": "https://other.org"})
            self.assertEqual((other.status, other.headers["Access-Control-Allow-Methods"]), (204, None))
        finally:
            self.assertEqual(listed.close(), 0)


class Tokens(Problems):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = os.path.join(cls.folder.name, "tokens")
        with open(cls.file, "w", encoding="utf-8") as file:
            file.write("# who may come in\nfirst-token the mapping team\nsecond-token\n")
        cls.closed = Service("--token-file", cls.file)
        cls.addClassCleanup(cls.folder.cleanup)
        cls.addClassCleanup(close, cls.closed)

    def test_nothing_without_one(self):
        for path in "/", ALL, "/metrics", "/nothing", "/openapi.json":
            for headers in {}, {"Authorization": "Bearer wrong"}, {"Authorization": "Basic Zmlyc3QtdG9rZW4="}:
                answer = self.closed.request("GET", path, headers=headers)
                self.assert_problem(answer, 401)
                self.assertTrue(answer.headers["WWW-Authenticate"].startswith("Bearer "))
                self.assertEqual(answer.headers["Access-Control-Allow-Origin"], "*", "so that a page sees why")
        refused = self.closed.post_form("merge", [("tiles", File("a.obj", square_obj(0, 0, 1, 1)))], CRS)
        self.assertEqual(refused.status, 401)

    def test_health_is_open_and_so_are_preflights(self):
        self.assertEqual(self.closed.get("/health").status, 200)
        self.assertEqual(self.closed.get("/ready").status, 200)
        self.assertEqual(self.closed.request("OPTIONS", ALL, headers=Origins.PREFLIGHT).status, 204)

    def test_everything_with_one(self):
        for token in "first-token", "second-token":
            headers = {"Authorization": "Bearer " + token}
            self.assertEqual(self.closed.request("GET", ALL, headers=headers).status, 200)
            self.assertEqual(self.closed.request("GET", "/metrics", headers=headers).status, 200)
            merged = self.closed.post_form("merge", [("tiles", File("a.obj", square_obj(0, 0, 1, 1)))], CRS, headers)
            self.assertEqual(merged.status, 200, merged.body)

    def test_the_log_names_the_owner_never_the_token(self):
        self.closed.request("GET", ALL, headers={"Authorization": "Bearer first-token", "X-Request-Id": "whose"})
        end = time.monotonic() + 10  # a line follows its answer
        while '"whose"' not in (log := self.closed.log_text()) and time.monotonic() < end:
            time.sleep(0.02)
        mine = [json.loads(line) for line in log.splitlines() if '"whose"' in line]
        self.assertEqual([line["user"] for line in mine], ["the mapping team"])
        self.assertNotIn("first-token", log)

    def test_strangers_are_let_in_on_purpose_only(self):
        code, said = refusal(["--host", "0.0.0.0", "--port", str(free_port())])
        self.assertEqual(code, 2)
        self.assertIn("--token-file", said)
        self.assertIn("--allow-anonymous", said)
        for arguments in ["--allow-anonymous"], ["--token-file", self.file]:
            wide = Service("--host", "0.0.0.0", *arguments)
            self.assertEqual(wide.get("/health").status, 200)
            self.assertEqual(wide.close(), 0)

    def test_files_that_are_no_tokens(self):
        for content in "", "# nobody\n", "tok\u00e4n\n", "same\nsame\n":
            path = os.path.join(self.folder.name, "wrong")
            with open(path, "w", encoding="utf-8") as file:
                file.write(content)
            code, said = refusal(["--port", str(free_port()), "--token-file", path])
            self.assertEqual(code, 2, (content, said))
            self.assertNotIn("same", said)
        self.assertEqual(refusal(["--token-file", "/nowhere"])[0], 2)


class Metrics(unittest.TestCase):
    def value(self, name):
        answer = service.get("/metrics")
        self.assertEqual(answer.media_type, "text/plain; version=0.0.4; charset=utf-8")
        found = re.search("^" + re.escape(name) + r" ([0-9.e+-]+)$", answer.body.decode(), re.MULTILINE)
        return float(found[1]) if found else 0

    def test_requests_are_counted_by_route(self):
        name = 'terrane_http_requests_total{method="GET",route="/processes/{id}",status="%d"}'
        found, missing = self.value(name % 200), self.value(name % 404)
        for process in "merge", "add", "nope":
            service.get("/processes/" + process)
        self.assertEqual(self.value(name % 200), found + 2)
        self.assertEqual(self.value(name % 404), missing + 1)
        duration = 'terrane_http_request_duration_seconds_count{method="GET",route="/processes/{id}"}'
        self.assertGreaterEqual(self.value(duration), 3)

    def test_bytes_are_counted(self):
        before = self.value("terrane_http_sent_bytes_total"), self.value("terrane_http_received_bytes_total")
        large = [("dem", File("hills.asc", hills(200)))]
        answer = service.post_form("triangulate", large, CRS + "&f=obj&max-error=0", {"Accept-Encoding": "gzip"})
        # A request is counted when it is over, and its client may have the last byte a moment before.
        sent, deadline = before[0] + len(answer.body), time.monotonic() + 5
        while self.value("terrane_http_sent_bytes_total") < sent and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertGreaterEqual(self.value("terrane_http_sent_bytes_total"), sent)
        self.assertGreater(self.value("terrane_http_received_bytes_total"), before[1] + len(hills(200)))

    def test_nothing_a_client_says_becomes_a_label(self):
        for path in '/%22%7D', "/jobs/secret-name", "/secret-name":
            service.get(path)
        service.request("BREW", "/health")
        text = service.get("/metrics").body.decode()
        self.assertNotIn("secret", text)
        self.assertNotIn("BREW", text)
        routes = set(re.findall('route="([^"]*)"', text))
        self.assertLess(len(routes), 25)

    def test_the_process_and_the_build(self):
        self.assertGreater(self.value("process_resident_memory_bytes"), 1e6)
        self.assertIn(b'terrane_build_info{version="', service.get("/metrics").body)
        self.assertEqual(self.value('terrane_executions{state="running"}'), 0)
        for status in "accepted", "running", "successful", "failed", "dismissed":
            self.assertIn(f'terrane_jobs{{status="{status}"}} '.encode(), service.get("/metrics").body)
        self.assertEqual(service.request("POST", "/metrics", b"x").status, 405)


class Settings(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = os.path.join(self.folder.name, "terrane.json")
        self.addCleanup(self.folder.cleanup)

    def write(self, text):
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(text)

    def start(self, arguments, **environment):
        """The port that the service takes."""
        command = [TERRANE, "serve", "--data", os.path.join(self.folder.name, "data"), *arguments]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                   env={**os.environ, **environment})
        line = process.stdout.readline().decode()
        process.terminate()
        process.communicate(timeout=15)
        self.assertTrue(line.startswith("listening on "), line)
        return int(line.rsplit(":", 1)[1])

    def test_flag_over_environment_over_file(self):
        ports = [free_port() for _ in range(3)]
        self.write(json.dumps({"port": ports[0]}))
        self.assertEqual(self.start(["--config", self.file]), ports[0])
        self.assertEqual(self.start([], TERRANE_CONFIG=self.file), ports[0])
        self.assertEqual(self.start(["--config", self.file], TERRANE_PORT=str(ports[1])), ports[1])
        flags = ["--config", self.file, f"--port={ports[2]}"]
        self.assertEqual(self.start(flags, TERRANE_PORT=str(ports[1])), ports[2])

    def test_complaints_say_where(self):
        self.write('{\n  "port": 0,\n  "max-bodi": "1G"\n}')
        code, said = refusal(["--config", self.file])
        self.assertEqual(code, 2)
        self.assertIn("'max-bodi' in line 3", said)
        self.write('{"port": 70000}')
        self.assertIn("'port' in line 1", refusal(["--config", self.file])[1])
        code, said = refusal([], {"TERRANE_THREADS": "many"})
        self.assertEqual(code, 2)
        self.assertIn("TERRANE_THREADS is 'many'", said)
        self.assertEqual(refusal(["--config", "/nowhere"])[0], 2)
        self.assertEqual(refusal(["--no-such-flag", "1"])[0], 2)

    def test_help_lists_them_all(self):
        said = subprocess.run([TERRANE, "serve", "--help"], capture_output=True, check=True).stdout.decode()
        page = subprocess.run([TERRANE, "docs", "settings"], capture_output=True, check=True).stdout.decode()
        flags = re.findall(r"^\| `(--[a-z-]+)", page, re.MULTILINE)
        self.assertGreater(len(flags), 10)
        for flag in flags:
            self.assertIn(f"  {flag}", said)


class Logs(unittest.TestCase):
    def test_start_and_stop(self):
        with tempfile.TemporaryFile() as log, tempfile.TemporaryDirectory() as data:
            command = [TERRANE, "serve", "--port", str(free_port()), "--data", data]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log)
            process.stdout.readline()
            process.terminate()
            process.communicate(timeout=15)
            log.seek(0)
            lines = [json.loads(line) for line in log.read().splitlines()]
        self.assertEqual([line["message"] for line in lines], ["start", "stopping", "stop"])
        self.assertEqual(lines[0]["host"], "127.0.0.1")
        self.assertTrue(lines[2]["clean"])
        self.assertTrue(all(line["time"].endswith("Z") for line in lines))

    def test_only_what_is_grave_enough(self):
        for level, wanted in ("info", [200, 404, 503]), ("warning", [503]), ("error", []):
            service = Service("--log-level", level, "--max-jobs", "0")
            answers = [service.get("/health"), service.get("/nothing"), service.post_json(
                "echo", {"inputs": {"answer": "x"}}, headers={"Prefer": "respond-async"})]
            self.assertEqual([answer.status for answer in answers], [200, 404, 503])
            self.assertEqual(service.stop(), 0)
            lines = [json.loads(line) for line in service.log_text().splitlines()]
            service.close()
            self.assertEqual([line["status"] for line in lines if "status" in line], wanted)
            self.assertLessEqual({line["level"] for line in lines}, {level, "warning", "error"})


if __name__ == "__main__":
    unittest.main()
