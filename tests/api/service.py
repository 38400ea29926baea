# SPDX-License-Identifier: GPL-3.0-or-later
"""A running `terrane serve` and a small client for it."""
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import tempfile
import threading
import uuid

TERRANE = os.environ.get(
    "TERRANE", os.path.join(os.path.dirname(__file__), "..", "..", "build", "release", "terrane"))


class Answer:
    def __init__(self, response, body):
        self.status = response.status
        self.headers = response.headers
        self.body = body

    @property
    def media_type(self):
        return self.headers.get("Content-Type", "")

    def json(self):
        return json.loads(self.body)


class File:
    """A part with a file name."""

    def __init__(self, name, content, media_type="application/octet-stream"):
        self.name = name
        self.content = content.encode() if isinstance(content, str) else content
        self.media_type = media_type


def form(parts):
    """multipart/form-data of (name, File or text) pairs: (content type, body)."""
    boundary = uuid.uuid4().hex
    body = b""
    for name, value in parts:
        body += f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"'.encode()
        if isinstance(value, File):
            body += f'; filename="{value.name}"\r\nContent-Type: {value.media_type}\r\n\r\n'.encode() + value.content
        else:
            body += b"\r\n\r\n" + str(value).encode()
        body += b"\r\n"
    return f"multipart/form-data; boundary={boundary}", body + f"--{boundary}--\r\n".encode()


class Service:
    """Starts the program on a free port; `close` stops it and returns its exit code."""

    def __init__(self, *arguments, data=None, preexec_fn=None):
        # A file takes standard error, so that a chatty service cannot block on a full pipe.
        self.log = tempfile.TemporaryFile()
        self.data = None if data else tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.command = [TERRANE, "serve", "--port", str(free_port()), "--data", data or self.data.name, *arguments]
        self.preexec_fn = preexec_fn
        self.start()

    def start(self):
        """Again on the same port and folder, after kill() or stop()."""
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=self.log,
                                        preexec_fn=self.preexec_fn)
        line = self.process.stdout.readline().decode()
        match = re.fullmatch(r"listening on http://([^:]+):(\d+)\n", line)
        if not match:
            self.process.kill()
            raise AssertionError(f"no service: {line!r} {self.log_text()}")
        self.host, self.port = match[1], int(match[2])

    def log_text(self):
        self.log.seek(0)
        return self.log.read().decode()

    def request(self, method, path, body=None, headers=None, timeout=60):
        connection = http.client.HTTPConnection(self.host, self.port, timeout=timeout)
        try:
            connection.request(method, path, body=body, headers=headers or {})
            response = connection.getresponse()
            return Answer(response, response.read())
        finally:
            connection.close()

    def get(self, path, **headers):
        return self.request("GET", path, headers={k.replace("_", "-"): v for k, v in headers.items()})

    def post_form(self, operation, parts, query="", headers=None):
        content_type, body = form(parts)
        return self.request("POST", f"/processes/{operation}/execution{query}", body,
                            {"Content-Type": content_type, **(headers or {})})

    def post_json(self, operation, request, query="", headers=None):
        body = request if isinstance(request, (str, bytes)) else json.dumps(request)
        return self.request("POST", f"/processes/{operation}/execution{query}", body,
                            {"Content-Type": "application/json", **(headers or {})})

    def raw(self, data, timeout=20):
        """Bytes as they are; what comes back until the service closes."""
        with socket.create_connection((self.host, self.port), timeout=timeout) as connection:
            try:
                connection.sendall(data)
            except (BrokenPipeError, ConnectionResetError):
                pass
            answer = b""
            try:
                while piece := connection.recv(65536):
                    answer += piece
            except ConnectionResetError:
                pass
            return answer

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def stop(self, signal_number=signal.SIGTERM, timeout=15):
        """The exit code; the folder and the log stay."""
        if self.process.poll() is None:
            self.process.send_signal(signal_number)
        try:
            code = self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            code = None
        self.process.stdout.close()
        return code

    def close(self, signal_number=signal.SIGTERM, timeout=15):
        code = self.stop(signal_number, timeout)
        self.log.close()
        if self.data:
            self.data.cleanup()
        return code


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def in_background(work):
    """Runs work() in a thread; returns a function that waits for its result."""
    result = []
    thread = threading.Thread(target=lambda: result.append(work()))
    thread.start()

    def wait():
        thread.join()
        return result[0] if result else None
    return wait
