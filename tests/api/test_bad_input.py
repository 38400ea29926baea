# SPDX-License-Identifier: GPL-3.0-or-later
"""The contract's table of bad input, row by row, and what HTTP adds to it."""
import json
import unittest

from one_service import Problems, for_module
from service import File
from terrains import UTM, obj, plan_area, square_obj, square_tin, tin

CRS = "?assume-crs=EPSG:25831"


setUpModule, tearDownModule = for_module(globals())


class BadInput(Problems):
    def info_of(self, file, operation="merge", slot="tiles"):
        return service.post_form(operation, [(slot, file)], CRS)


class InputData(BadInput):
    def test_numbers_that_are_none(self):
        for word in "nan", "inf", "-inf", "1e400", "x":
            text = f"v 0 0 0\nv 10 0 {word}\nv 0 10 0\nf 1 2 3\n"
            self.assert_problem(self.info_of(File("bad.obj", text)), 422, "bad.obj", "2")
        for word in "NaN", "Infinity", "1e400", "null", '"7"':
            surface = '{"type": "TIN", "vertices": [[0,0,0],[1,0,%s],[0,1,0]], "triangles": [[0,1,2]]}' % word
            body = '{"inputs": {"tiles": %s}}' % surface
            self.assert_problem(service.post_json("merge", body, CRS), 422, "vertex 1")

    def test_indices_out_of_range(self):
        for index in "0", "9", "-9", "1.5", "99999999999999999999":
            text = f"v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 {index}\n"
            self.assert_problem(self.info_of(File("bad.obj", text)), 422, "bad.obj")
        for index in 3, -1, 1.5, 1e20:
            body = {"inputs": {"tiles": tin([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, index]])}}
            self.assert_problem(service.post_json("merge", body, CRS), 422)

    def test_truncated_files_and_wrong_magic(self):
        ply = service.post_form("convert", [("surface", File("a.obj", square_obj(0, 0, 1, 1)))], CRS + "&f=ply").body
        self.assertTrue(ply.startswith(b"ply"))
        for cut in 4, len(ply) // 2, len(ply) - 1:
            self.assert_problem(self.info_of(File("cut.ply", ply[:cut])), 422, "cut.ply")
        self.assert_problem(self.info_of(File("magic.ply", b"plx" + ply[3:])), 422, "magic.ply")
        text = json.dumps(square_tin(0, 0, 1, 1))
        self.assert_problem(self.info_of(File("cut.json", text[:len(text) // 2])), 422, "cut.json")
        self.assert_problem(self.info_of(File("cut.tif", b"II*\0" + b"\0" * 20)), 422, "cut.tif")
        grid = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4"
        self.assert_problem(self.info_of(File("cut.asc", grid)), 422, "cut.asc")

    def test_bytes_of_no_format(self):
        answer = self.info_of(File("noise.bin", bytes(range(256)) * 4))
        self.assertIn(answer.status, (415, 422))
        self.assert_problem(answer, answer.status, "noise.bin")

    def test_overlapping_faces(self):
        vertices = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [5, 1, 3], [9, 1, 3], [9, 5, 3]]
        text = obj(vertices, [[0, 1, 2], [0, 2, 3], [4, 5, 6]])
        self.assert_problem(self.info_of(File("over.obj", text)), 422, "over.obj")

    def test_levels_that_are_no_numbers(self):
        for text in "nan", "inf", "-Infinity", "1e400":
            answer = service.post_form("add", [("a", File("a.obj", square_obj(0, 0, 10, 1))), ("b", text)],
                                       "?crs=local:m&f=json")
            self.assert_problem(answer, 422, text)

    def test_two_heights_at_one_place(self):
        # Two faces that share an edge in plan, and its height at one end only.
        vertices = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 0, 5], [0, 10, 0]]
        self.assert_problem(self.info_of(File("two.obj", obj(vertices, [[0, 1, 2], [3, 2, 4]]))), 422, "two.obj")

    def test_a_slanted_edge_with_three_faces(self):
        vertices = [[0, 0, 0], [10, 0, 1], [0, 10, 0], [5, -10, 0], [0, -10, 0]]
        text = obj(vertices, [[0, 1, 2], [0, 3, 1], [0, 4, 1]])
        self.assert_problem(self.info_of(File("fan.obj", text)), 422, "fan.obj")

    def test_what_can_be_mended_is_mended_and_counted(self):
        square = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]]
        cases = {
            "duplicate point": obj(square + [[0, 0, 0]], [[0, 1, 2], [4, 2, 3]]),
            "duplicate face": obj(square, [[0, 1, 2], [0, 2, 3], [1, 2, 0]]),
            "unused vertex": obj(square + [[50, 50, 0]], [[0, 1, 2], [0, 2, 3]]),
            "zero area": obj(square + [[5, 0, 0]], [[0, 1, 2], [0, 2, 3], [0, 4, 1]]),
            "orientation": obj(square, [[0, 1, 2], [0, 3, 2]]),
        }
        for name, text in cases.items():
            answer = self.info_of(File("mend.obj", text))
            self.assertEqual(answer.status, 200, (name, answer.body))
            self.assertGreater(int(answer.headers["Terrane-Warnings"]), 0, name)
            vertices, faces = answer.json()["vertices"], answer.json()["triangles"]
            self.assertAlmostEqual(plan_area(vertices, faces), 100, places=9, msg=name)
            self.assertEqual(len(vertices), 5 if name == "zero area" and len(vertices) == 5 else 4, name)

    def test_an_empty_tin(self):
        empty, full = File("empty.json", json.dumps(tin([], []))), File("full.obj", square_obj(0, 0, 10, 1))
        alone = service.post_form("merge", [("tiles", full)], CRS + "&f=obj")
        both = service.post_form("merge", [("tiles", empty), ("tiles", full)], CRS + "&f=obj")
        self.assertEqual((both.status, both.body), (200, alone.body))
        slots = ("subtract", "minuend", "subtrahend"), ("add", "a", "b"), ("volume", "surface", "reference")
        for operation, first, second in slots:
            self.assert_problem(service.post_form(operation, [(first, empty), (second, full)], CRS), 422, "empty.json")

    def test_no_overlap(self):
        west, east = File("a.obj", square_obj(0, 0, 10, 1)), File("b.obj", square_obj(110, 0, 10, 1))
        parts = [("minuend", west), ("subtrahend", east)]
        self.assert_problem(service.post_form("subtract", parts, CRS), 422, "100")
        answer = service.post_form("subtract", parts, CRS + "&allow-empty=true")
        self.assertEqual(answer.status, 200, answer.body)
        self.assertGreater(int(answer.headers["Terrane-Warnings"]), 0)
        self.assertEqual(answer.json()["triangles"], [])
        parts = [("surface", west), ("reference", east)]
        self.assert_problem(service.post_form("volume", parts, CRS), 422, "100")
        self.assertEqual(service.post_form("volume", parts, CRS + "&allow-empty=true").status, 200)

    def test_coordinate_reference_systems(self):
        a, b = File("a.obj", square_obj(0, 0, 10, 1)), File("b.obj", square_obj(5, 0, 10, 1))
        no_crs = service.post_form("merge", [("tiles", a), ("tiles", b)])
        self.assertEqual(no_crs.status, 200, no_crs.body)
        self.assertGreater(int(no_crs.headers["Terrane-Warnings"]), 0, "one local frame and a warning")
        some = service.post_form("merge", [("tiles", a), ("tiles", b)], "?crs=a.obj:EPSG:25831")
        self.assert_problem(some, 422, "assume-crs")
        different = service.post_form("merge", [("tiles", a), ("tiles", b)], "?crs=a.obj:EPSG:25831;b.obj:EPSG:25830")
        self.assert_problem(different, 422, "target-crs")
        unknown = service.post_form("merge", [("tiles", a)], "?assume-crs=EPSG:1")
        self.assert_problem(unknown, 400)


class Requests(BadInput):
    garbage = File("garbage.obj", b"\xff\xfe no surface at all")

    def test_an_unknown_operation(self):
        answer = service.post_form("marge", [("tiles", self.garbage)])
        self.assert_problem(answer, 404, "merge", "subtract")
        self.assertIn("no-such-process", answer.json()["type"])
        self.assert_problem(service.get("/processes/marge"), 404, "merge")

    def test_parameters_are_checked_before_any_input(self):
        queries = (("?overlop=mean", "overlap"), ("?overlap=average", "mean"), ("?z-tolerance=-1", "z-tolerance"),
                   ("?z-tolerance=high", "z-tolerance"), ("?max-error=nan", "max-error"), ("?f=dwg", "obj"),
                   ("?threads=1.5", "threads"), ("?target-crs=EPSG:1", "target-crs"))
        for query, word in queries:
            self.assert_problem(service.post_form("merge", [("tiles", self.garbage)], query), 400, word)
        self.assert_problem(service.post_form("merge", [("tiles", self.garbage), ("overlop", "mean")]), 400, "overlap")
        self.assert_problem(service.post_json("merge", {"inputs": {"tiles": "x", "overlop": 1}}), 400, "overlap")
        twice = [("tiles", self.garbage), ("overlap", "mean")]
        self.assert_problem(service.post_form("merge", twice, "?overlap=min"), 400)

    def test_the_number_of_inputs(self):
        self.assert_problem(service.post_form("merge", []), 400, "tiles")
        self.assert_problem(service.post_form("merge", [("tile", self.garbage)]), 400, "tiles")
        self.assert_problem(service.post_form("subtract", [("minuend", self.garbage)]), 400, "subtrahend")
        three = [("minuend", self.garbage), ("minuend", self.garbage), ("subtrahend", self.garbage)]
        self.assert_problem(service.post_form("subtract", three), 400, "minuend")

    def test_accept_that_cannot_be_met(self):
        tile = [("tiles", File("a.obj", square_obj(0, 0, 10, 1)))]
        self.assert_problem(service.post_form("merge", tile, CRS, {"Accept": "image/png"}), 406, "model/obj")
        self.assert_problem(service.get("/processes", Accept="image/png"), 406)
        request = {"inputs": {"tiles": square_tin(0, 0, 1, 1), **UTM},
                   "outputs": {"surface": {"format": {"mediaType": "a/b"}}}}
        self.assert_problem(service.post_json("merge", request), 406)

    def test_paths_and_methods(self):
        self.assert_problem(service.get("/nothing"), 404)
        self.assert_problem(service.get("/" + "a" * 3000), 414)
        self.assert_problem(service.get("/?f=pdf"), 400)
        self.assert_problem(service.get("/processes?limt=1"), 400)
        for method, path in (("DELETE", "/processes"), ("PUT", "/"), ("GET", "/processes/merge/execution"),
                             ("PATCH", "/health")):
            answer = service.request(method, path, b"" if method != "GET" else None)
            self.assert_problem(answer, 405)
            self.assertTrue(answer.headers["Allow"])
        self.assert_problem(service.request("POST", "/processes", b""), 405)
        for method in "PROPFIND", "FOO", "get":
            answer = service.request(method, "/processes")
            self.assert_problem(answer, 405, "GET")
            self.assertIn("GET", answer.headers["Allow"])

    def test_bodies_of_another_kind(self):
        def post(body, kind, **headers):
            return service.request("POST", "/processes/merge/execution", body, {"Content-Type": kind, **headers})
        for kind in "text/plain", "model/obj", "application/x-www-form-urlencoded":
            self.assert_problem(post(b"v 0 0 0", kind), 415, "multipart/form-data")
        for coding in "br", "gzip, gzip":
            self.assert_problem(post(b"x", "application/json", **{"Content-Encoding": coding}), 415, "zstd")
        self.assert_problem(post(b"not gzip", "application/json", **{"Content-Encoding": "gzip"}), 400)

    def test_broken_json(self):
        bodies = ["{", "[]", "nonsense", '{"inputs": {"tiles": }}', '{"inputs": {}} x', '{"inputs": 5}',
                  '{"inpots": {}}', "\xff", '{"inputs": {"tiles": {"href": "http://127.0.0.1:1/"}}}',
                  '{"inputs": {"tiles": ' + "[" * 200_000 + "]" * 200_000 + "}}",
                  '{"inputs": {"tiles": ' + "[" * 5_000_000]
        for body in bodies:
            self.assert_problem(service.post_json("merge", body.encode("latin-1"), CRS), 400)
        deep = '{"inputs": {"tiles": {"type": "TIN", "more": ' + '{"a":' * 100 + "1" + "}" * 100 + "}}}"
        self.assert_problem(service.post_json("merge", deep, CRS), 400)

    def test_names_that_come_twice(self):
        ask = '{"inputs": {"answer": "x"%s}, "outputs": {"answer": {%s}}, "subscriber": {%s}}'
        mode, uri = '"transmissionMode": "value"', '"failedUri": "http://a"'
        self.assertEqual(service.post_json("echo", ask % ("", mode, uri)).status, 200)
        for twice in (', "answer": "y"', mode, uri), ("", mode + "," + mode, uri), ("", mode, uri + "," + uri):
            self.assert_problem(service.post_json("echo", ask % twice), 400, "second value")
        self.assert_problem(service.post_json("echo", ask % ("", '"mode": "value"', uri)), 400, "transmissionMode")

    def test_text_that_is_not_utf8(self):
        for query in "?%ff=1", "?answer=%ff", "?f=%ff":
            for headers in {}, {"Prefer": "respond-async"}:
                answer = service.post_json("echo", {"inputs": {"number": 1}}, query, headers)
                self.assert_problem(answer, 400, "UTF-8")
        field = b'--X\r\nContent-Disposition: form-data; name="answer"\r\n\r\n\xff\r\n--X--\r\n'
        path, kind = "/processes/echo/execution", "multipart/form-data; boundary=X"
        self.assert_problem(service.request("POST", path, field, {"Content-Type": kind}), 400, "answer", "UTF-8")
        odd = {"Content-Type": 'application/json; x="\xff"'}
        self.assertEqual(service.request("POST", path, b'{"inputs": {"number": 1}}', odd).body, b"1\n")
        for headers in {}, {"Prefer": "respond-async"}:
            answer = service.post_json("echo", {"inputs": {"number": 1}}, headers={"Accept": "\xff/\xff", **headers})
            self.assert_problem(answer, 406)

    def test_names_in_another_encoding(self):
        """Old programs write Latin-1, in names of files and of reference systems."""
        wkt = ('PROJCS["H\xf6he",GEOGCS["x",DATUM["y",SPHEROID["z",6378137,298]],PRIMEM["g",0],UNIT["degree",'
               '0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",9],'
               'PARAMETER["scale_factor",1],PARAMETER["false_easting",500000],UNIT["metre",1]]')
        text = f"# crs: {wkt}\n{square_obj(0, 0, 10, 1)}".encode("latin-1")
        part = b'Content-Disposition: form-data; name="surface"; filename="..\\gel\xe4nde\x01.obj"'
        body, kind = b"--X\r\n" + part + b"\r\n\r\n" + text + b"\r\n--X--\r\n", "multipart/form-data; boundary=X"
        answer = service.request("POST", "/processes/info/execution", body, {"Content-Type": kind})
        self.assertEqual(answer.status, 200, answer.body)
        self.assertEqual(answer.json()["crs"]["name"], "H\xf6he")
        self.assertEqual(answer.json()["certificate"]["inputs"][0]["name"], "gel\ufffdnde_.obj")

    def test_media_types_and_names_that_are_none(self):
        for media_type in "text/html\r\nX-Evil: 1", "a\0b", "h\xf6/he":
            sent = {"value": "aGk=", "encoding": "base64", "mediaType": media_type}
            self.assert_problem(service.post_json("echo", {"inputs": {"file": sent}}), 400, "media type")
        self.assert_problem(service.request("POST", "/uploads", b"x", {"Content-Type": "a/\xff"}), 400, "media type")
        named = {"value": "aGk=", "encoding": "base64", "name": '../a"\r\nX-Evil: 1'}
        answer = service.post_json("echo", {"inputs": {"file": named}})
        self.assertEqual((answer.status, answer.body), (200, b"hi"))
        self.assertEqual(answer.headers["Content-Disposition"], 'attachment; filename="a___X-Evil: 1"')

    def test_broken_forms(self):
        path, kind = "/processes/merge/execution", "multipart/form-data; boundary=X"
        for body in (b"", b"x", b"--X\r\n\r\n", b"--X\r\nContent-Disposition: form-data\r\n\r\n1\r\n--X--",
                     b'--X\r\nContent-Disposition: form-data; name="tiles"; filename="a.obj"\r\n\r\nv 0 0 0'):
            self.assert_problem(service.request("POST", path, body, {"Content-Type": kind}), 400)
        self.assert_problem(service.request("POST", path, b"--X--", {"Content-Type": "multipart/form-data"}), 400)
        many = b'--X\r\nContent-Disposition: form-data; name="z"\r\n\r\n1\r\n' * 5000 + b"--X--"
        self.assert_problem(service.request("POST", path, many, {"Content-Type": kind}), 413)
        field = [("tiles", self.garbage), ("overlap", "m" * 2_000_000)]
        self.assert_problem(service.post_form("merge", field), 413)

    def test_a_report_that_is_not_there(self):
        self.assert_problem(service.get("/reports/" + "0" * 32), 404)


if __name__ == "__main__":
    unittest.main()
