# SPDX-License-Identifier: GPL-3.0-or-later
"""A PostgreSQL server of our own on loopback, for as long as a test takes."""
import glob
import os
import shutil
import socket
import subprocess
import tempfile
import time


def programs():
    """The folder of PostgreSQL's programs, or None."""
    found = sorted(glob.glob("/usr/lib/postgresql/*/bin/initdb"))
    return os.path.dirname(found[-1]) if found else None


class Postgresql:
    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="terrane-postgresql-")
        # It refuses to run as root.
        self.prefix = []
        if os.geteuid() == 0:
            shutil.chown(self.folder, "nobody", "nogroup")
            self.prefix = ["setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups"]
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        data = os.path.join(self.folder, "data")
        run = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": "/"}
        subprocess.run([*self.prefix, f"{programs()}/initdb", "-D", data, "-U", "terrane", "-A", "trust", "-E", "UTF8",
                        "--no-sync"], **run)
        self.process = subprocess.Popen(
            [*self.prefix, f"{programs()}/postgres", "-D", data, "-p", str(self.port), "-k", self.folder, "-c",
             "listen_addresses=127.0.0.1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd="/")
        self.uri = f"postgresql://terrane@127.0.0.1:{self.port}/postgres"
        for _ in range(200):
            ready = subprocess.run([f"{programs()}/pg_isready", "-q", "-h", "127.0.0.1", "-p", str(self.port)],
                                   check=False)
            if ready.returncode == 0:
                return
            time.sleep(0.05)
        raise AssertionError("PostgreSQL does not start")

    def close(self):
        self.process.terminate()
        self.process.wait(20)
        shutil.rmtree(self.folder, ignore_errors=True)
