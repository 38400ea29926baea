# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors that are small and would cost a lot: seconds, gigabytes."""
import io
import json
import time
import unittest
import zipfile

from one_service import for_module
from service import File
from terrains import square_obj

CRS = "?assume-crs=EPSG:25831"


setUpModule, tearDownModule = for_module(globals())


def drawing(entities, blocks=""):
    return ("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n" + blocks +
            "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n")


def resident_megabytes():
    with open(f"/proc/{service.process.pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) // 1024


class Vectors(unittest.TestCase):
    surface = "surface", File("a.obj", square_obj(0, 0, 100, 1))

    def ask(self, operation, parts, status, query=CRS, seconds=20):
        start = time.monotonic()
        answer = service.post_form(operation, parts, query)
        self.assertEqual(answer.status, status, answer.body[:1000])
        self.assertLess(time.monotonic() - start, seconds)
        return answer

    def test_corners_too_far_away(self):
        points = "points", "1e308,0;0,1e308;-1e308,0"
        answer = self.ask("synthesize-polygon", [points], 422, "?crs=EPSG:25831")
        self.assertIn("too far away", answer.json()["detail"])

    def test_a_block_that_is_inserted_very_often(self):
        block = "0\nBLOCK\n8\n0\n2\nB\n10\n0\n20\n0\n0\nPOINT\n8\n0\n10\n0\n20\n0\n0\nENDBLK\n"
        insert = "0\nINSERT\n8\n0\n2\nB\n10\n0\n20\n0\n70\n30000\n71\n30000\n44\n0.001\n45\n0.001\n"
        answer = self.ask("clip", [self.surface, ("region", File("r.dxf", drawing(insert, block)))], 413)
        self.assertIn("400000 features", answer.json()["detail"])

    def test_zip_files_of_very_many_entries_and_folders(self):
        for names in ([f"e{i}" for i in range(20_000)], ["a/" * 4000 + str(i) for i in range(5)]):
            packed = io.BytesIO()
            with zipfile.ZipFile(packed, "w") as archive:
                for name in ["r.shp", *names]:
                    archive.writestr(name, b"")
            answer = self.ask("clip", [self.surface, ("region", File("r.zip", packed.getvalue()))], 413)
            self.assertIn("1000 files", answer.json()["detail"])

    def test_properties_that_every_point_repeats(self):
        points = {"type": "Feature", "properties": {"note": "x" * 1_000_000},
                  "geometry": {"type": "MultiPoint", "coordinates": [[i % 100, 1] for i in range(3000)]}}
        for word in "csv", "geojson":
            answer = self.ask("sample", [self.surface, ("points", json.dumps(points))], 413, "?f=" + word)
            self.assertIn("properties", answer.json()["detail"])

    def test_memory_is_given_back(self):
        points = "".join(f"0\nPOINT\n8\n0\n10\n{i % 97}\n20\n{i % 89}\n" for i in range(100_000))
        for _ in range(6):
            self.ask("clip", [self.surface, ("region", File("r.dxf", drawing(points)))], 422)
        self.assertLess(resident_megabytes(), 400)

    def test_media_types_in_any_case(self):
        body = b'--X\r\nContent-Disposition: form-data; name="tiles"; filename="a.obj"\r\n\r\n' + \
            square_obj(0, 0, 1, 1).encode() + b"\r\n--X--\r\n"
        answer = service.request("POST", "/processes/merge/execution", body,
                                 {"Content-Type": "Multipart/Form-Data; boundary=X"})
        self.assertEqual(answer.status, 200, answer.body)


if __name__ == "__main__":
    unittest.main()
