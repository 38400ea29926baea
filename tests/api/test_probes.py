# SPDX-License-Identifier: GPL-3.0-or-later
"""Some two hundred ways to have the service read a file or speak to somebody: nobody opens the bait, nobody calls."""
import base64
import ctypes
import io
import os
import socket
import struct
import tempfile
import threading
import unittest
import zipfile

from service import File, Service
from terrains import square_obj

IN_OPEN, IN_ACCESS = 0x20, 0x1
CRS = "?f=json&crs=local:m"


class Bait:
    """A folder whose files nobody may open, watched by the kernel; and a port that nobody may call."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="terrane-bait-")
        os.chmod(self.folder.name, 0o755)
        self.secret = "secret-" + os.urandom(8).hex()
        for name, content in {"bait.txt": self.secret, "bait.obj": f"# {self.secret}\n" + square_obj(0, 0, 10, 1),
                              "bait.asc": "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n",
                              "bait.csv": "x,y,z\n1,2,3\n4,5,6\n7,1,2\n"}.items():
            with open(os.path.join(self.folder.name, name), "w", encoding="ascii") as file:
                file.write(content)
        libc = ctypes.CDLL(None, use_errno=True)
        self.watch = libc.inotify_init1(os.O_NONBLOCK)
        assert libc.inotify_add_watch(self.watch, self.folder.name.encode(), IN_OPEN | IN_ACCESS) >= 0
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.calls = 0
        threading.Thread(target=self.count, daemon=True).start()

    def count(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            self.calls += 1
            connection.close()

    def path(self, name="bait.txt"):
        return os.path.join(self.folder.name, name)

    def opened(self):
        events, at = [], 0
        try:
            data = os.read(self.watch, 65536)
        except BlockingIOError:
            return events
        while at < len(data):
            _, _, _, size = struct.unpack_from("iIII", data, at)
            events.append(data[at + 16:at + 16 + size].rstrip(b"\0").decode())
            at += 16 + size
        return [name for name in events if name]  # the folder itself is listed by nobody's fault but rm's

    def close(self):
        self.listener.close()
        os.close(self.watch)
        self.folder.cleanup()


def places(bait):
    """Names of the bait, as readers of files and of the web would understand them."""
    http = f"http://127.0.0.1:{bait.port}"
    for name in ("bait.txt", "bait.obj", "bait.asc", "bait.csv"):
        path = bait.path(name)
        yield from (path, "file://" + path, "file:" + path, "/vsimem/../" + path, f"/vsisubfile/0_100,{path}",
                    "../../../../../.." + path, "//" + path.lstrip("/"), f"/vsizip/{path}", f"/vsitar/{path}",
                    f"/vsigzip/{path}")
    yield from (http + "/x.tif", f"http://localhost:{bait.port}/x", f"http://[::1]:{bait.port}/x",
                f"http://2130706433:{bait.port}/x", f"http://0x7f000001:{bait.port}/x", f"http://127.1:{bait.port}/x",
                f"http://0.0.0.0:{bait.port}/x", f"http://[::ffff:127.0.0.1]:{bait.port}/x",
                f"http://user@127.0.0.1:{bait.port}/x", f"http://example.org@127.0.0.1:{bait.port}/x",
                "http://169.254.169.254/latest/meta-data/", "http://[fd00:ec2::254]/latest/", "gopher://127.0.0.1:1/_x",
                f"/vsicurl/{http}/x.tif", f"/vsicurl_streaming/{http}/x.tif", f"/vsis3/b/k?{http}",
                f"ftp://127.0.0.1:{bait.port}/x", f"dict://127.0.0.1:{bait.port}/x", "jar:file:///etc/passwd!/x")


def documents(bait):
    """(file name, bytes): inputs that name others, in the formats that GDAL would follow."""
    for place in list(places(bait))[::3]:
        yield "a.vrt", (f'<VRTDataset rasterXSize="2" rasterYSize="2"><VRTRasterBand dataType="Float32" band="1">'
                        f"<SimpleSource><SourceFilename>{place}</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
                        f"</VRTRasterBand></VRTDataset>").encode()
        yield "a.obj", f"mtllib {place}\n".encode() + square_obj(0, 0, 10, 1).encode()
        yield "a.tif", f"GTIFF_DIR:1:{place}".encode()
    yield "a.wms", f'<GDAL_WMS><Service name="WMS"><ServerUrl>http://127.0.0.1:{bait.port}/?</ServerUrl></Service></GDAL_WMS>'.encode()
    yield "a.xml", f'<!DOCTYPE x [<!ENTITY e SYSTEM "file://{bait.path()}">]><x>&e;</x>'.encode()
    for name in (f"../../..{bait.path()}", bait.path(), "..\\..\\bait.txt"):
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as archive:
            archive.writestr(name, "x")
            link = zipfile.ZipInfo("roi.shp")
            link.external_attr = 0o120777 << 16
            archive.writestr(link, bait.path())
            archive.writestr("roi.shx", b"x")
        yield "a.zip", packed.getvalue()


class Probes(unittest.TestCase):
    def test_nothing_is_read_and_nobody_is_called(self):
        bait = Bait()
        service = Service()
        tile = square_obj(0, 0, 10, 1)
        made, answers = 0, []

        def ask(answer):
            nonlocal made
            made += 1
            answers.append(answer)
            self.assertLess(answer.status, 500, answer.body[:300])
        try:
            for place in places(bait):
                ask(service.post_json("info", {"inputs": {"surface": {"href": place}}}))
                ask(service.post_form("clip", [("surface", File("a.obj", tile)), ("region", place)], CRS))
                ask(service.post_form("convert", [("surface", File(place, place))], CRS))
                ask(service.post_form("convert", [("surface", File("a.obj", tile))], "?f=json&crs=" +
                                      base64.b64encode(place.encode()).decode().rstrip("=")))
                ask(service.post_form("transform", [("surface", File("a.obj", tile)), ("crs", "local:m"),
                                                    ("target-crs", f"+proj=longlat +nadgrids={place}")], "?f=json"))
            for name, content in documents(bait):
                ask(service.post_form("info", [("surface", File(name, content))]))
                ask(service.post_form("clip", [("surface", File("a.obj", tile)), ("region", File(name, content))], CRS))
            for path in ("/jobs/..%2f..%2f..%2fetc%2fpasswd", "/reports/..%2f..%2fetc%2fpasswd", "/..%2f..%2fetc/passwd",
                         "/uploads/..%2fjobs.sqlite", "/processes/..%2f..%2fetc%2fpasswd", "//etc/passwd"):
                ask(service.get(path))
            subscriber = f"http://127.0.0.1:{bait.port}/told"
            job = service.post_json("info", {
                "inputs": {"surface": {"value": tile, "mediaType": "model/obj"}, "crs": "local:m"},
                "subscriber": {"successUri": subscriber, "failedUri": subscriber, "inProgressUri": subscriber}},
                headers={"Prefer": "respond-async"}).json()["jobID"]
            while service.get("/jobs/" + job).json()["status"] not in ("successful", "failed"):
                pass
            self.assertGreater(made, 200)
            self.assertEqual(bait.opened(), [])
            self.assertEqual(bait.calls, 0)
            secret = bait.secret.encode()
            self.assertFalse([a.body for a in answers if secret in a.body or b"root:x:" in a.body])
            self.assertIn("bait.txt", self.opens(bait), "the bait is not watched")
        finally:
            self.assertEqual(service.close(), 0)
            bait.close()

    @staticmethod
    def opens(bait):
        with open(bait.path(), "rb"):
            pass
        return bait.opened()


if __name__ == "__main__":
    unittest.main()
