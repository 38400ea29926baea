# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors as they come, and small ones that would cost a lot: seconds, gigabytes."""
import io
import json
import struct
import time
import unittest
import zipfile

from one_service import for_module
from service import File
from terrains import plan_area, read_obj, square_obj

CRS = "?assume-crs=EPSG:25831"


setUpModule, tearDownModule = for_module(globals())


def drawing(entities, blocks=""):
    return ("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n" + blocks +
            "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n")


def zipped(files):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return File("r.zip", packed.getvalue())


def shapefile(path, x, y, size):
    """The .shp and .shx of one square."""
    ring = [(x, y), (x, y + size), (x + size, y + size), (x + size, y), (x, y)]
    box = struct.pack("<4d", x, y, x + size, y + size)
    shape = struct.pack("<i", 5) + box + struct.pack("<3i", 1, 5, 0) + b"".join(struct.pack("<2d", *p) for p in ring)
    words = len(shape) // 2

    def file(body):
        header = struct.pack(">7i", 9994, 0, 0, 0, 0, 0, 50 + len(body) // 2) + struct.pack("<2i", 1000, 5) + box
        return header + bytes(32) + body
    return {path + ".shp": file(struct.pack(">2i", 1, words) + shape),
            path + ".shx": file(struct.pack(">2i", 50, words))}


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

    def clipped_area(self, region):
        return plan_area(*read_obj(self.ask("clip", [self.surface, ("region", region)], 200, CRS + "&f=obj").body))

    def test_shapefiles_in_folders(self):
        junk = {"__MACOSX/parcels/._a.shp": b"\0\5\x16\7", "__MACOSX/parcels/._a.shx": b""}
        for path in "a", "parcels/a", "x/y z/A":
            self.assertAlmostEqual(self.clipped_area(zipped({**shapefile(path, 10, 10, 20), **junk})), 400)
        both = {**shapefile("north/a", 10, 10, 20), **shapefile("south/b", 60, 60, 30)}
        self.assertAlmostEqual(self.clipped_area(zipped(both)), 1300)

    def test_shapefiles_that_are_no_good(self):
        files = shapefile("parcels/a", 10, 10, 20)
        del files["parcels/a.shx"]
        for files, says in (files, ".shx"), ({"parcels/a.txt": b""}, "no .shp"):
            answer = self.ask("clip", [self.surface, ("region", zipped(files))], 422)
            self.assertIn(says, answer.json()["detail"])

    def test_points_of_a_table(self):
        table = File("p.csv", "id\tEasting\tNorthing\nA 1\t10\t20\nB\t30\t40\n")
        answer = self.ask("sample", [self.surface, ("points", table)], 200, CRS + "&f=csv")
        self.assertEqual(answer.body.decode(), "id,x,y,z\nA 1,10,20,1\nB,30,40,1\n")

    def test_vectors_are_laid_over_a_surface_by_whole_turns(self):
        degrees = "?assume-crs=EPSG:4326"
        halves = [[[[x, 0], [x + 1, 0], [x + 1, 1], [x, 1], [x, 0]]] for x in (179, -180)]
        split = json.dumps({"type": "MultiPolygon", "coordinates": halves})
        for x in 178, -182:
            surface = "surface", File("a.obj", square_obj(x, -1, 4, 1))
            clipped = self.ask("clip", [surface, ("region", split)], 200, degrees + "&f=obj")
            self.assertAlmostEqual(plan_area(*read_obj(clipped.body)), 2)
            rows = self.ask("sample", [surface, ("points", "MULTIPOINT((-179 0),(179 0),(-90 0))")], 200, degrees + "&f=csv").body
            self.assertEqual([row.split(",")[-1] for row in rows.decode().split()], ["z", "1", "1", ""])
        east = "surface", File("a.obj", square_obj(350, -1, 20, 1))
        around = json.dumps({"type": "Polygon", "coordinates": [[[-5, 0], [5, 0], [5, 1], [-5, 1], [-5, 0]]]})
        clipped = self.ask("clip", [east, ("region", around)], 200, degrees + "&f=obj")
        self.assertAlmostEqual(plan_area(*read_obj(clipped.body)), 10)

    def test_a_region_far_from_where_its_coordinates_can_be_transformed(self):
        region = {"type": "Polygon", "coordinates": [[[100, 0], [101, 0], [101, 1], [100, 0]]]}
        detail = self.ask("clip", [self.surface, ("region", json.dumps(region))], 422).json()["detail"]
        self.assertIn("'region'", detail)
        self.assertIn("between longitude, latitude 100, 0 and 101, 1", detail)

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
            answer = self.ask("clip", [self.surface, ("region", zipped(dict.fromkeys(["r.shp", *names], b"")))], 413)
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
