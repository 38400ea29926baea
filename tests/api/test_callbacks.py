# SPDX-License-Identifier: GPL-3.0-or-later
"""Subscribers: told how their jobs begin and end, again when they do not answer; they hold up nothing."""
import http.server
import json
import threading
import time
import unittest

from jobs import ASYNC, obj, wait_for
from service import Service


class Subscriber(http.server.ThreadingHTTPServer):
    """Remembers what it is told; answers with the next of `answers`, then with 200. 0: not at all."""
    daemon_threads = True

    def __init__(self, *answers):
        self.told, self.answers, self.end = [], list(answers), threading.Event()
        told, replies, end = self.told, self.answers, self.end

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                told.append((self.path, self.rfile.read(int(self.headers["Content-Length"]))))
                status = replies.pop(0) if replies else 200
                if status == 0:
                    end.wait()
                else:
                    self.send_response(status)
                    self.end_headers()

            def log_message(self, *_):
                pass
        super().__init__(("127.0.0.1", 0), Handler)
        self.place = f"127.0.0.1:{self.server_port}"
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end.set()
        self.shutdown()
        self.server_close()

    def paths(self):
        return [path for path, _ in self.told]

    def wait_for(self, count, timeout=30):
        end = time.monotonic() + timeout
        while len(self.told) < count and time.monotonic() < end:
            time.sleep(0.05)


class Callbacks(unittest.TestCase):
    def submit(self, service, place, *events):
        request = {"inputs": {"minuend": {"value": obj(1), "mediaType": "model/obj"},
                              "subtrahend": {"value": obj(4), "mediaType": "model/obj"}, "crs": "local:m"},
                   "subscriber": {"successUri": f"http://{place}/done", "failedUri": f"http://{place}/failed"}}
        for event in events:
            request["subscriber"][event] = f"http://{place}/begun"
        return service.post_json("subtract", request, "?f=obj", ASYNC).json()["jobID"]

    def test_a_subscriber_gets_the_results(self):
        with Subscriber() as subscriber:
            for allowed in (True, False):
                subscriber.told.clear()
                service = Service(*(["--allow-hosts", subscriber.place] if allowed else []))
                job = self.submit(service, subscriber.place, "inProgressUri")
                wait_for(service, job)
                subscriber.wait_for(2 if allowed else 1, 5 if allowed else 2)
                result = service.get(f"/jobs/{job}/results").body
                self.assertEqual(subscriber.paths(), ["/begun", "/done"] if allowed else [])
                if allowed:
                    begun = json.loads(subscriber.told[0][1])
                    self.assertEqual((begun["jobID"], begun["status"]), (job, "running"))
                    self.assertEqual(subscriber.told[1][1], result)
                self.assertEqual(service.close(), 0)

    def test_who_does_not_answer_is_told_again_and_who_refuses_is_not(self):
        for answers, paths in (((500, 302), ["/done"] * 3), ((404,), ["/done"]), ((404, 200), ["/begun", "/done"])):
            with Subscriber(*answers) as subscriber:
                service = Service("--allow-hosts", subscriber.place)
                self.submit(service, subscriber.place, *(["inProgressUri"] if "/begun" in paths else []))
                subscriber.wait_for(len(paths))
                time.sleep(1.5)
                self.assertEqual(subscriber.paths(), paths)
                self.assertEqual(service.close(), 0)

    def test_a_subscriber_that_is_silent_holds_up_neither_jobs_nor_the_stop(self):
        with Subscriber(0, 0) as silent, Subscriber() as other:
            service = Service("--threads", "1", "--allow-hosts", f"{silent.place},{other.place}")
            self.submit(service, silent.place)
            silent.wait_for(1)
            begun = time.monotonic()
            wait_for(service, self.submit(service, other.place))
            other.wait_for(1)
            self.assertEqual(other.paths(), ["/done"])
            self.assertLess(time.monotonic() - begun, 5)
            begun = time.monotonic()
            self.assertEqual(service.stop(), 0)
            self.assertLess(time.monotonic() - begun, 3)
            service.start()  # what was not told is told now
            silent.wait_for(2)
            self.assertEqual(silent.paths(), ["/done"] * 2)
            self.assertEqual(service.close(), 0)


if __name__ == "__main__":
    unittest.main()
