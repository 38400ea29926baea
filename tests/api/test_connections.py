# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests one after the other on one connection, in pieces, in chunks, announced: what HTTP/1.1 lets a client do."""
import socket
import time
import unittest

from one_service import OneService
from service import File, form, in_background
from terrains import hills, square_obj

HEALTH = b"GET /health HTTP/1.1\r\nHost: x\r\n\r\n"
LIMIT = 5_000_000
CRS = "?assume-crs=EPSG:25831"


class Talk:
    """One connection, answers read one at a time."""

    def __init__(self, service):
        self.socket = socket.create_connection((service.host, service.port), timeout=30)
        self.buffer = b""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        self.socket.sendall(data)

    def fill(self):
        piece = self.socket.recv(65536)
        self.buffer += piece
        return bool(piece)

    def answer(self):
        """(status, header, body), or None when the service has closed."""
        while b"\r\n\r\n" not in self.buffer:
            if not self.fill():
                return None
        header, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        status = int(header.split()[1])
        lengths = [line.split(b":")[1] for line in header.split(b"\r\n") if line.lower().startswith(b"content-length:")]
        length = int(lengths[0]) if lengths and status != 100 else 0
        while len(self.buffer) < length:
            if not self.fill():
                raise AssertionError("a cut answer")
        body, self.buffer = self.buffer[:length], self.buffer[length:]
        return status, header, body


def merge_request(*headers, size=0, chunked=False, piece=1000):
    parts = [("tiles", File("a.obj", square_obj(0, 0, 1, 1) + "#" * size))]
    kind, body = form(parts)
    if chunked:
        pieces = [body[i:i + piece] for i in range(0, len(body), piece)]
        body = b"".join(b"%x\r\n" % len(p) + p + b"\r\n" for p in pieces) + b"0\r\n\r\n"
        headers += ("Transfer-Encoding: chunked",)
    else:
        headers += (f"Content-Length: {len(body)}",)
    head = "\r\n".join([f"POST /processes/merge/execution{CRS}&f=obj HTTP/1.1", "Host: x", f"Content-Type: {kind}",
                        *headers, "", ""])
    return head.encode(), body


class Connections(OneService):
    arguments = "--max-body", str(LIMIT)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        head, body = merge_request("Connection: close")
        cls.merged = cls.service.raw(head + body).split(b"\r\n\r\n", 1)[1]

    def talk(self):
        return Talk(self.service)

    def threads(self):
        with open(f"/proc/{self.service.process.pid}/status", encoding="ascii") as file:
            return int(next(line for line in file if line.startswith("Threads:")).split()[1])

    def test_requests_in_one_go_are_answered_in_order(self):
        with self.talk() as talk:
            head, body = merge_request(size=100_000, chunked=True)
            small_head, small_body = merge_request()
            nothing = b"GET /nothing HTTP/1.1\r\nHost: x\r\n\r\n"
            talk.send((HEALTH + head + body + small_head + small_body + nothing) * 3)
            for _ in range(3):
                answers = [talk.answer() for _ in range(4)]
                self.assertEqual([a[0] for a in answers], [200, 200, 200, 404])
                self.assertEqual(answers[1][2], self.merged)
                self.assertEqual(answers[2][2], self.merged)

    def test_pieces_of_any_size(self):
        head, body = merge_request(chunked=True, piece=7)
        for size in (1, 2, 500):
            with self.talk() as talk:
                talk.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                data = head + body
                for i in range(0, len(data), size):
                    talk.send(data[i:i + size])
                self.assertEqual(talk.answer()[2], self.merged)
                talk.send(HEALTH)
                self.assertEqual(talk.answer()[0], 200)

    def test_a_body_larger_than_memory_takes(self):
        for chunked in (False, True):
            head, body = merge_request(size=3_000_000, chunked=chunked, piece=100_000)
            with self.talk() as talk:
                for data in (head, body[:100], body[100:], HEALTH):
                    talk.send(data)
                    time.sleep(0.05)
                self.assertEqual(talk.answer()[2], self.merged)
                self.assertEqual(talk.answer()[0], 200)

    def test_expected_bodies(self):
        head, body = merge_request("Expect: 100-continue")
        with self.talk() as talk:
            talk.send(head)
            self.assertEqual(talk.answer()[0], 100)
            talk.send(body)
            self.assertEqual(talk.answer()[2], self.merged)
            talk.send(head + body)  # without waiting
            answer = talk.answer()
            self.assertEqual(answer[2] if answer[0] != 100 else talk.answer()[2], self.merged)
            talk.send(head.replace(b"merge", b"nothing"))
            status, header, _ = talk.answer()
            self.assertEqual(status, 404)
            self.assertIn(b"Connection: close", header)
            self.assertIsNone(talk.answer())

    def test_a_refusal_reaches_a_client_that_is_still_sending(self):
        head, body = merge_request(size=LIMIT)
        self.assertTrue(self.service.raw(head + body).startswith(b"HTTP/1.1 413 "))

    def test_after_a_body_that_was_refused_when_read_the_connection_goes_on(self):
        with self.talk() as talk:
            talk.send(b"POST /processes/merge/execution HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
                      b"Content-Length: 5\r\n\r\n{,,,}" + HEALTH)
            self.assertEqual(talk.answer()[0], 400)
            self.assertEqual(talk.answer()[0], 200)

    def test_who_closes(self):
        with self.talk() as talk:
            talk.send(b"GET /health HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
            self.assertEqual(talk.answer()[0], 200)
            self.assertIsNone(talk.answer())
        with self.talk() as talk:
            talk.send(b"GET /health HTTP/1.0\r\n\r\n")
            self.assertEqual(talk.answer()[0], 200)
            self.assertIsNone(talk.answer())
        with self.talk() as talk:
            talk.send(b"GET /health HTTP/1.0\r\nConnection: keep-alive\r\n\r\n" * 2)
            self.assertEqual([talk.answer()[0] for _ in range(2)], [200, 200])

    def test_http_1_0_knows_no_chunks(self):
        order = b'{"inputs": {"answer": "x", "pause": 1}}'
        job = self.service.post_json("echo", order, headers={"Prefer": "respond-async"}).json()["jobID"]
        for connection in b"", b"Connection: keep-alive\r\n":
            answer = self.service.raw(f"GET /jobs/{job}/events HTTP/1.0\r\n".encode() + connection + b"\r\n")
            header, body = answer.split(b"\r\n\r\n", 1)
            self.assertNotIn(b"Transfer-Encoding", header)
            self.assertIn(b"\r\nConnection: close\r\n", header)
            self.assertTrue(body.startswith(b"event: status\ndata: {") and body.endswith(b"}\n\n"), body)

    def test_heads_have_no_body(self):
        with self.talk() as talk:
            talk.send(b"HEAD /health HTTP/1.1\r\nHost: x\r\n\r\n")
            while b"\r\n\r\n" not in talk.buffer:
                talk.fill()
            self.assertTrue(talk.buffer.endswith(b"\r\n\r\n"), talk.buffer)

    def test_idle_connections_cost_no_thread(self):
        before = self.threads()
        talks = [self.talk() for _ in range(200)]
        for talk in talks:
            talk.send(HEALTH)
            self.assertEqual(talk.answer()[0], 200)
        self.assertEqual(self.threads(), before)
        for talk in talks:
            talk.send(HEALTH)
            self.assertEqual(talk.answer()[0], 200)
            talk.socket.close()

    def test_a_header_has_five_seconds(self):
        with self.talk() as talk:
            started = time.monotonic()
            for byte in HEALTH[:20]:
                try:
                    talk.send(bytes([byte]))
                except OSError:
                    break
                time.sleep(0.3)
            self.assertEqual(talk.answer()[0], 408)
            self.assertLess(time.monotonic() - started, 7)

    def test_an_answer_that_is_taken_slowly_is_whole(self):
        expected = self.service.get("/openapi.json").body
        with socket.socket() as slow:
            slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            slow.connect((self.service.host, self.service.port))
            slow.sendall(b"GET /openapi.json HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
            time.sleep(0.5)
            answer = b""
            while piece := slow.recv(8192):
                answer += piece
                time.sleep(0.002)
        self.assertEqual(answer.split(b"\r\n\r\n", 1)[1], expected)

    def test_who_hangs_up_is_not_worked_for(self):
        kind, body = form([("dem", File("hills.asc", hills(700)))])
        with self.talk() as talk:
            target = "/processes/triangulate/execution" + CRS + "&max-error=0.01"
            talk.send(f"POST {target} HTTP/1.1\r\nHost: x\r\nContent-Type: {kind}\r\n"
                      f"Content-Length: {len(body)}\r\n\r\n".encode() + body)
            time.sleep(0.5)
        for _ in range(200):
            if '"status":499' in self.service.log_text():
                return
            time.sleep(0.05)
        self.fail("no 499 in the log")

    def test_more_than_there_are_places_for(self):
        head, body = merge_request("Connection: close", size=50_000)
        talks = [self.talk() for _ in range(300)]
        for talk in talks:
            talk.send(head + body)
        answers = [talk.answer() for talk in talks]
        self.assertTrue(all(answers), "everybody is answered")
        self.assertLessEqual({a[0] for a in answers}, {200, 503})
        self.assertIn(200, {a[0] for a in answers})
        for status, header, content in answers:
            if status == 200:
                self.assertEqual(content, self.merged)
            else:
                self.assertIn(b"\r\nRetry-After: ", header)
        for talk in talks:
            talk.socket.close()

    def test_bodies_are_received_while_others_are_answered(self):
        slow_head, slow_body = merge_request(size=1_000_000)
        with self.talk() as slow:
            slow.send(slow_head + slow_body[:500_000])
            wait = in_background(lambda: self.service.get("/health").status)
            self.assertEqual(wait(), 200)
            slow.send(slow_body[500_000:])
            self.assertEqual(slow.answer()[2], self.merged)


if __name__ == "__main__":
    unittest.main()
