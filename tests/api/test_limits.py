# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits counted while reading, a bounded number of executions, one owner of a port, and a clean stop."""
import signal
import socket
import subprocess
import time
import unittest
import zlib

from one_service import OneService, Problems
from service import TERRANE, File, Service, form, in_background
from terrains import hills, square_obj

LIMIT = 5_000_000
EXECUTION = "/processes/merge/execution"
CRS = "?assume-crs=EPSG:25831"


def resident_bytes(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        for line in file:
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    raise AssertionError("no VmHWM")


class Bodies(OneService):
    arguments = "--max-body", str(LIMIT)

    def tearDown(self):
        self.assertEqual(self.service.get("/health").status, 200, "the service lives on")

    def status(self, raw):
        answer = self.service.raw(raw)
        self.assertTrue(answer.startswith(b"HTTP/1.1 "), answer[:100])
        self.assertIn(b"application/problem+json", answer)
        return int(answer.split()[1])

    def post(self, *headers, body=b""):
        lines = ["POST " + EXECUTION + " HTTP/1.1", "Host: x", "Content-Type: application/json", *headers, "", ""]
        return self.status("\r\n".join(lines).encode() + body)

    def test_too_large_by_its_own_word(self):
        self.assertEqual(self.post(f"Content-Length: {LIMIT + 1}"), 413)
        self.assertEqual(self.post("Content-Length: 99999999999999999999"), 413)

    def test_too_large_while_it_is_read(self):
        chunk = b"%x\r\n" % 1_000_000 + b" " * 1_000_000 + b"\r\n"
        self.assertEqual(self.post("Transfer-Encoding: chunked", body=chunk * 20), 413)

    def test_endless_bodies_cost_nothing(self):
        def chunks():
            for _ in range(2000):
                yield b" " * 1_000_000
        started = time.monotonic()
        try:
            answer = self.service.request("POST", EXECUTION, chunks(), {"Content-Type": "application/json"})
            self.assertEqual(answer.status, 413)
        except (BrokenPipeError, ConnectionResetError):
            pass  # we were still sending when the service had seen enough and closed
        self.assertLess(time.monotonic() - started, 20)
        self.assertLess(resident_bytes(self.service.process), 300_000_000)

    def test_too_large_when_unpacked(self):
        packer = zlib.compressobj(9, wbits=31)
        bomb = b"".join(packer.compress(b" " * 1_000_000) for _ in range(1000)) + packer.flush()
        self.assertLess(len(bomb), LIMIT)
        headers = {"Content-Type": "application/json", "Content-Encoding": "gzip"}
        answer = self.service.request("POST", EXECUTION, bomb, headers)
        self.assertEqual(answer.status, 413)
        self.assertLess(resident_bytes(self.service.process), 300_000_000)

    def test_a_large_form(self):
        kind, body = form([("tiles", File("a.obj", b"#" * (LIMIT + 1000)))])
        answer = self.service.request("POST", EXECUTION, body, {"Content-Type": kind})
        self.assertEqual(answer.status, 413)

    def test_expect_is_answered_before_the_body(self):
        self.assertEqual(self.post("Expect: 100-continue", f"Content-Length: {LIMIT + 1}"), 413)

    def test_a_body_of_no_length(self):
        self.assertEqual(self.post(), 411)
        self.assertEqual(self.post("Content-Length: 2", "Transfer-Encoding: chunked"), 400)
        self.assertEqual(self.post("Content-Length: 2", "Content-Length: 3"), 400)
        self.assertEqual(self.post("Content-Length: -2"), 400)
        self.assertEqual(self.post("Transfer-Encoding: gzip"), 400)

    def test_codings_have_no_case(self):
        body = b"2\r\n{}\r\n0\r\n\r\n"
        answer = self.service.raw(b"POST /processes/echo/execution HTTP/1.1\r\nHost: x\r\nConnection: close\r\n"
                                  b"Content-Type: application/json\r\nTransfer-Encoding: Chunked\r\n\r\n" + body)
        self.assertEqual(int(answer.split()[1]), 204, answer)

    def test_broken_chunks(self):
        for body in b"-2\r\n", b"zz\r\nab\r\n0\r\n\r\n", b"5\r\nabcdeX0\r\n\r\n":
            self.assertEqual(self.post("Transfer-Encoding: chunked", body=body), 400)

    def test_what_is_not_http(self):
        self.assertEqual(self.status(b"hello\r\n\r\n"), 400)
        self.assertEqual(self.status(b"GET /health HTTP/1.1\r\nX: " + b"a" * 200_000 + b"\r\n\r\n"), 431)
        self.assertEqual(self.status(b"GET /" + b"a" * 20_000 + b" HTTP/1.1\r\n\r\n"), 414)
        self.assertEqual(self.status(b"GET /" + b"a" * 200_000 + b" HTTP/1.1\r\n\r\n"), 414)

    def test_one_host_is_needed(self):
        self.assertEqual(self.status(b"GET /health HTTP/1.1\r\nConnection: close\r\n\r\n"), 400)
        self.assertEqual(self.status(b"GET /health HTTP/1.1\r\nHost: x\r\nHost: y\r\nConnection: close\r\n\r\n"), 400)
        old = self.service.raw(b"GET /health HTTP/1.0\r\nConnection: close\r\n\r\n")
        self.assertEqual(int(old.split()[1]), 200, old)

    def test_closing_is_said_once(self):
        answer = self.service.raw(b"POST " + EXECUTION.encode() + b" HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
        self.assertEqual(int(answer.split()[1]), 411, answer)
        self.assertEqual(answer.count(b"Connection: close"), 1, answer)

    def test_a_refused_body_is_not_the_next_request(self):
        smuggled = b"GET /health HTTP/1.1\r\nHost: x\r\n\r\n"
        header = b"POST /nothing HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n" % len(smuggled)
        answer = self.service.raw(header + smuggled)
        self.assertEqual(answer.count(b"HTTP/1.1 "), 1, answer)
        self.assertIn(b"Connection: close", answer)

    def test_many_ranges_are_not_served(self):
        ranges = "bytes=" + ",".join("0-" for _ in range(500))
        answer = self.service.request("GET", "/processes", headers={"Range": ranges})
        self.assertIn(answer.status, (200, 416))
        self.assertLess(len(answer.body), 100_000)


class Executions(Problems):
    """One at work, two waiting."""

    def setUp(self):
        self.service = Service("--threads", "1")
        self.slow = form([("dem", File("hills.asc", hills(1000)))])

    def tearDown(self):
        self.service.close(signal.SIGKILL)

    def triangulate(self, max_error=1):
        kind, body = self.slow
        return self.service.request("POST", f"/processes/triangulate/execution{CRS}&f=obj&max-error={max_error}", body,
                                    {"Content-Type": kind}, timeout=300)

    def result(self):
        """The path of a result that is there."""
        job = self.service.post_form("merge", [("tiles", File("a.obj", square_obj(0, 0, 1, 1)))], CRS,
                                     {"Prefer": "respond-async"}).json()["jobID"]
        while self.service.get("/jobs/" + job).json()["status"] != "successful":
            time.sleep(0.05)
        return f"/jobs/{job}/results/surface"

    def wait_until_ready_is(self, status):
        for _ in range(600):
            if self.service.get("/ready").status == status:
                return
            time.sleep(0.05)
        self.fail(f"/ready never was {status}")

    def test_full_is_503_and_health_is_alive(self):
        waiting = [in_background(self.triangulate) for _ in range(3)]
        self.wait_until_ready_is(503)
        started = time.monotonic()
        self.assertEqual(self.service.get("/health").status, 200)
        self.assertLess(time.monotonic() - started, 2)
        refused = self.service.post_form("merge", [("tiles", File("a.obj", square_obj(0, 0, 1, 1)))], CRS)
        self.assert_problem(refused, 503)
        self.assertTrue(refused.headers["Retry-After"].isdigit())
        answers = [wait() for wait in waiting]
        self.assertEqual([a.status for a in answers], [200, 200, 200])
        self.assertEqual(len({a.body for a in answers}), 1, "the same bytes")
        self.wait_until_ready_is(200)

    def test_a_result_in_another_format_is_work_as_any_other(self):
        path = self.result() + "?f=ply"
        self.assertEqual(self.service.get(path).status, 200)
        waiting = [in_background(self.triangulate) for _ in range(3)]
        self.wait_until_ready_is(503)
        for method in "GET", "HEAD":
            refused = self.service.request(method, path)
            self.assertEqual(refused.status, 503, method)
            self.assertTrue(refused.headers["Retry-After"].isdigit())
        self.assertEqual([wait().status for wait in waiting], [200, 200, 200])
        head = self.service.request("HEAD", path)
        self.assertEqual((head.status, head.headers["Content-Length"]),
                         (200, str(len(self.service.get(path).body))))

    def test_whoever_leaves_the_line_makes_room(self):
        path = self.result() + "?f=ply"
        working = in_background(lambda: self.triangulate(0.0001))
        for _ in range(600):
            if 'terrane_executions{state="running"} 1' in self.service.get("/metrics").body.decode():
                break
            time.sleep(0.05)
        request = f"GET {path} HTTP/1.1\r\nHost: x\r\n\r\n".encode()
        clients = [socket.create_connection((self.service.host, self.service.port)) for _ in range(2)]
        for client in clients:
            client.sendall(request)
        self.wait_until_ready_is(503)
        for client in clients:
            client.close()
        self.wait_until_ready_is(200)
        self.assertIn('terrane_executions{state="running"} 1', self.service.get("/metrics").body.decode())
        working()

    def test_requests_in_flight_are_finished_or_told_at_a_stop(self):
        waiting = in_background(self.triangulate)
        time.sleep(0.5)
        started = time.monotonic()
        code = self.service.close()
        self.assertEqual(code, 0)
        self.assertLess(time.monotonic() - started, 10)
        self.assertIn(waiting().status, (200, 503))

    def test_idle_stops_at_once(self):
        self.service.get("/health")
        for number in (signal.SIGTERM, signal.SIGINT):
            service = Service()
            started = time.monotonic()
            self.assertEqual(service.close(number), 0)
            self.assertLess(time.monotonic() - started, 2)


class Ports(unittest.TestCase):
    def test_a_port_has_one_owner(self):
        first = Service()
        try:
            command = [TERRANE, "serve", "--port", str(first.port)]
            second = subprocess.run(command, capture_output=True, timeout=20, check=False)
            self.assertIn(second.returncode, (2, 4))
            self.assertIn(str(first.port).encode(), second.stderr)
            self.assertEqual(second.stdout, b"")
        finally:
            self.assertEqual(first.close(), 0)

    def test_options_out_of_range(self):
        for arguments in (["--port", "70000"], ["--port", "x"], ["--max-body", "0"], ["--host", "256.1.1.1"]):
            run = subprocess.run([TERRANE, "serve", *arguments], capture_output=True, timeout=20, check=False)
            self.assertEqual(run.returncode, 2, (arguments, run.stderr))
            self.assertTrue(run.stderr)

    def test_loopback_only_unless_told_otherwise(self):
        service = Service()
        try:
            with open("/proc/net/tcp", encoding="ascii") as file:
                listening = [line.split()[1] for line in file if line.split()[3] == "0A"]
            mine = [address for address in listening if address.endswith(f":{service.port:04X}")]
            self.assertEqual(mine, [f"0100007F:{service.port:04X}"])
        finally:
            service.close()


if __name__ == "__main__":
    unittest.main()
