# SPDX-License-Identifier: GPL-3.0-or-later
"""Resources, executions by form and by JSON, formats, certificates; and the same bytes as the command line."""
import base64
import gzip
import http.client
import json
import os
import subprocess
import tempfile
import unittest
import zlib

from one_service import Problems, for_module
from service import TERRANE, File, in_background
from terrains import UTM, ascii_grid, plan_area, read_obj, square_obj, square_tin

WEST = square_obj(0, 0, 100, 10)
EAST = square_obj(60, 0, 100, 20)


setUpModule, tearDownModule = for_module(globals())


def query(**parameters):
    return "?" + "&".join(f"{name.replace('_', '-')}={value}" for name, value in parameters.items())


MERGE_QUERY = query(f="obj", overlap="mean", assume_crs="EPSG:25831")


class Resources(unittest.TestCase):
    def test_every_resource_is_json(self):
        for path in "/", "/health", "/ready", "/processes", "/conformance", "/jobs":
            answer = service.get(path)
            self.assertEqual(answer.status, 200, path)
            self.assertEqual(answer.media_type, "application/json", path)
            answer.json()

    def test_links_of_the_landing_page_lead_somewhere(self):
        links = service.get("/").json()["links"]
        relations = {link["rel"] for link in links}
        self.assertLessEqual({"self", "alternate", "service-desc", "service-doc",
                              "http://www.opengis.net/def/rel/ogc/1.0/conformance",
                              "http://www.opengis.net/def/rel/ogc/1.0/processes",
                              "http://www.opengis.net/def/rel/ogc/1.0/job-list"}, relations)
        prefix = f"http://127.0.0.1:{service.port}"
        for link in links:
            self.assertTrue(link["href"].startswith(prefix), link)
            answer = service.get(link["href"][len(prefix):], Accept=link["type"])
            self.assertEqual(answer.status, 200, link)
            self.assertEqual(answer.media_type.split(";")[0], link["type"].split(";")[0])

    def test_browsers_get_a_page(self):
        answer = service.get("/", Accept="text/html,application/xhtml+xml,*/*;q=0.8")
        self.assertTrue(answer.media_type.startswith("text/html"))
        self.assertIn(b"/processes/merge", answer.body)
        self.assertTrue(service.get("/?f=html").media_type.startswith("text/html"))
        self.assertEqual(service.get("/?f=json", Accept="text/html").media_type, "application/json")
        self.assertEqual(service.get("/", Accept="*/*").media_type, "application/json")

    def test_processes_are_described(self):
        processes = service.get("/processes").json()["processes"]
        ids = [process["id"] for process in processes]
        self.assertLessEqual({"add", "subtract", "merge", "volume", "triangulate", "validate", "info", "convert",
                              "transform", "render", "and", "or", "xor", "nand", "nor", "not", "threshold", "quantize",
                              "simplify", "contour"},
                             set(ids))
        for process in processes:
            description = service.get("/processes/" + process["id"]).json()
            self.assertEqual(description["id"], process["id"])
            self.assertIn("inputs", description)
            self.assertIn("outputs", description)
            self.assertIn("sync-execute", description["jobControlOptions"])
        self.assertIn("tiles", service.get("/processes/merge").json()["inputs"])

    def test_openapi_names_what_is_there(self):
        document = service.get("/openapi.json").json()
        self.assertTrue(document["openapi"].startswith("3.1"))
        for path, methods in document["paths"].items():
            if "{" in path:
                continue
            for method in methods:
                if method == "get":
                    self.assertLess(service.get(path).status, 400, path)
                elif method == "post":
                    self.assertNotIn(service.request("POST", path, b"", {}).status, (404, 405), path)

    def test_head_and_options(self):
        answer = service.request("HEAD", "/processes")
        self.assertEqual((answer.status, answer.body), (200, b""))
        self.assertEqual(int(answer.headers["Content-Length"]), len(service.get("/processes").body))
        self.assertEqual(service.request("OPTIONS", "/processes/merge/execution").headers["Allow"], "POST, OPTIONS")

    def test_request_ids_go_in_and_out(self):
        self.assertEqual(service.get("/health", X_Request_Id="abc-1.2").headers["X-Request-Id"], "abc-1.2")
        made = service.get("/health", X_Request_Id='"; drop').headers["X-Request-Id"]
        self.assertRegex(made, "^[0-9a-f]{32}$")
        self.assertRegex(service.get("/nothing").headers["X-Request-Id"], "^[0-9a-f]{32}$")

    def test_one_json_line_per_request(self):
        service.request("GET", "/health", headers={"X-Request-Id": "find-me"})
        lines = [json.loads(line) for line in service.log_text().splitlines()]
        mine = [line for line in lines if line["request_id"] == "find-me"]
        self.assertEqual(len(mine), 1)
        self.assertEqual((mine[0]["method"], mine[0]["path"], mine[0]["status"]), ("GET", "/health", 200))


class Executions(Problems):
    def merged(self, *parts):
        return service.post_form("merge", [("tiles", part) for part in parts], MERGE_QUERY)

    def test_merge_by_form(self):
        answer = self.merged(File("west.obj", WEST), File("east.obj", EAST))
        self.assertEqual(answer.status, 200, answer.body)
        self.assertEqual(answer.media_type, "model/obj")
        self.assertEqual(answer.headers["Content-Disposition"], 'attachment; filename="merge.obj"')
        vertices, faces = read_obj(answer.body)
        self.assertAlmostEqual(plan_area(vertices, faces), 160 * 100, places=6)
        self.assertEqual({z for _, _, z in vertices}, {10, 15, 20})
        self.assertRegex(answer.headers["Terrane-Warnings"], "^[0-9]+$")
        self.assertIn("work;dur=", answer.headers["Server-Timing"])

    def test_the_certificate_is_linked(self):
        answer = self.merged(File("west.obj", WEST), File("east.obj", EAST))
        link = answer.headers["Link"]
        self.assertIn('rel="describedby"', link)
        certificate = service.get(link[link.index("<") + 1:link.index(">")])
        self.assertEqual(certificate.status, 200)
        value = certificate.json()
        self.assertEqual(value["type"], "Certificate")
        self.assertEqual([i["name"] for i in value["inputs"]], ["west.obj", "east.obj"])
        self.assertEqual(value["topology"]["inverted"], 0)
        self.assertEqual(len(value["warnings"]), int(answer.headers["Terrane-Warnings"]))

    def test_the_same_bytes_by_form_json_and_command_line(self):
        by_form = self.merged(File("west.obj", WEST), File("east.obj", EAST))
        tiles = [{"value": base64.b64encode(text.encode()).decode(), "encoding": "base64", "mediaType": "model/obj"}
                 for text in (WEST, EAST)]
        inputs = {"tiles": tiles, "overlap": "mean", **UTM}
        self.assertEqual(service.post_json("merge", {"inputs": inputs}, "?f=obj").body, by_form.body)
        tins = [square_tin(0, 0, 100, 10), square_tin(60, 0, 100, 20)]
        inline = {"inputs": {"tiles": tins, "overlap": "mean", **UTM},
                  "outputs": {"surface": {"format": {"mediaType": "model/obj"}}}}
        self.assertEqual(service.post_json("merge", inline).body, by_form.body)
        fields = [("tiles", File("w", WEST)), ("overlap", "mean"), ("tiles", File("e", EAST)), ("f", "obj"),
                  ("assume-crs", "EPSG:25831")]
        self.assertEqual(service.post_form("merge", fields).body, by_form.body)
        with tempfile.TemporaryDirectory() as folder:
            names = []
            for name, text in ("west.obj", WEST), ("east.obj", EAST):
                names.append(os.path.join(folder, name))
                with open(names[-1], "w", encoding="utf-8") as file:
                    file.write(text)
            out = os.path.join(folder, "out.obj")
            command = [TERRANE, "merge", *names, "--overlap", "mean", "--assume-crs", "EPSG:25831",
                       "--quiet", "-o", out]
            run = subprocess.run(command, capture_output=True, check=False)
            self.assertEqual(run.returncode, 0, run.stderr)
            with open(out, "rb") as file:
                self.assertEqual(file.read(), by_form.body)

    def test_compressed_bodies_are_the_same(self):
        request = json.dumps({"inputs": {"tiles": [square_tin(0, 0, 100, 10)], **UTM}}).encode()
        plain = service.post_json("merge", request)
        whole, halves = gzip.compress(request), gzip.compress(request[:100]) + gzip.compress(request[100:])
        for coding, body in ("gzip", whole), ("GZIP", whole), ("x-gzip", halves), ("deflate", zlib.compress(request)):
            packed = service.post_json("merge", body, headers={"Content-Encoding": coding})
            self.assertEqual((packed.status, packed.body), (200, plain.body), coding)

    def test_a_compressed_body_that_is_cut_off_is_refused(self):
        text = "".join(f"v {i} {i * 7 % 13} 0\n" for i in range(10_000)).encode()
        for coding, body in ("gzip", gzip.compress(text)), ("deflate", zlib.compress(text)):
            for size in 1, 20, len(body) // 2, len(body) - 1:
                answer = service.request("POST", "/uploads", body[:size], {"Content-Encoding": coding})
                self.assert_problem(answer, 400, "ends too early")

    def test_f_overrides_accept_and_accept_decides_else(self):
        tiles = [("tiles", File("west.obj", WEST)), ("assume-crs", "EPSG:25831")]
        for accept, expected in (("model/ply", "model/ply"), ("model/obj;q=0.5, model/ply", "model/ply"),
                                 ("*/*", "application/json"), ("application/json", "application/json"),
                                 ("image/png, model/*", None)):
            answer = service.post_form("merge", tiles, headers={"Accept": accept})
            self.assertEqual(answer.status, 200, accept)
            if expected:
                self.assertEqual(answer.media_type, expected, accept)
            else:
                self.assertTrue(answer.media_type.startswith("model/"), accept)
        answer = service.post_form("merge", tiles, "?f=obj", headers={"Accept": "image/png"})
        self.assertEqual((answer.status, answer.media_type), (200, "model/obj"))

    def test_documents_hold_result_and_certificate(self):
        request = {"inputs": {"tiles": [square_tin(0, 0, 100, 10)], **UTM}, "response": "document",
                   "outputs": {"surface": {"format": {"mediaType": "model/obj"}}}}
        answer = service.post_json("merge", request)
        self.assertEqual((answer.status, answer.media_type), (200, "application/json"))
        document = answer.json()
        self.assertEqual(document["surface"]["mediaType"], "model/obj")
        self.assertTrue(document["surface"]["value"].startswith("#"))
        self.assertEqual(document["certificate"]["value"]["type"], "Certificate")
        request["outputs"]["surface"]["format"]["mediaType"] = "application/json"
        self.assertEqual(service.post_json("merge", request).json()["surface"]["value"]["type"], "TIN")
        request["outputs"]["surface"]["format"]["mediaType"] = "model/ply"
        value = service.post_json("merge", request).json()["surface"]
        self.assertEqual(value["encoding"], "base64")
        self.assertTrue(base64.b64decode(value["value"], validate=True).startswith(b"ply"))

    def test_levels_are_surfaces(self):
        difference = service.post_json("subtract", {"inputs": {
            "minuend": square_tin(0, 0, 100, 10, 4), "subtrahend": 2.5, **UTM}}, "?f=obj")
        self.assertEqual(difference.status, 200, difference.body)
        self.assertEqual({z for _, _, z in read_obj(difference.body)[0]}, {7.5, 11.5})
        by_form = service.post_form("subtract", [
            ("minuend", File("a.obj", square_obj(0, 0, 100, 10, 4))), ("subtrahend", "2.5")],
            "?f=obj&assume-crs=EPSG:25831")
        self.assertEqual(by_form.body, difference.body)

    def test_a_volume_report(self):
        answer = service.post_json("volume", {"inputs": {
            "surface": square_tin(0, 0, 100, 10), "reference": square_tin(0, 0, 100, 8), **UTM}})
        self.assertEqual(answer.status, 200, answer.body)
        row = answer.json()["rows"][0]
        self.assertAlmostEqual(row["fill"]["volume"], 20000, places=6)
        self.assertEqual(row["cut"]["volume"], 0)
        self.assertAlmostEqual(row["net_volume"], 20000, places=6)
        table = service.post_json(
            "volume", {"inputs": {"surface": square_tin(0, 0, 100, 10), "reference": 8, **UTM}}, "?f=csv")
        self.assertEqual(table.status, 200)
        self.assertTrue(table.media_type.startswith("text/csv"))

    def test_volumes_of_parcels_and_as_polygons(self):
        def box(name, x0, x1):
            ring = [[x0, 0], [x1, 0], [x1, 100], [x0, 100], [x0, 0]]
            return {"type": "Feature", "properties": {"name": name},
                    "geometry": {"type": "Polygon", "coordinates": [ring]}}
        parcels = json.dumps({"type": "FeatureCollection", "features": [box("west", 0, 40), box("east", 40, 100)]})
        form = [("surface", File("a.obj", square_obj(0, 0, 100, 10, 4))), ("reference", "8"),
                ("region", File("parcels.geojson", parcels)), ("region-crs", "EPSG:25831")]
        answer = service.post_form("volume", form, "?assume-crs=EPSG:25831")
        self.assertEqual(answer.status, 200, answer.body)
        rows = answer.json()["rows"]
        self.assertEqual([row["region"] for row in rows], ["west", "east"])
        self.assertAlmostEqual(sum(row["coverage"]["overlap_area_2d"] for row in rows), 10000, places=6)
        areas = service.post_form("volume", form + [("polygons", "true")], "?assume-crs=EPSG:25831")
        self.assertEqual(areas.status, 200, areas.body)
        self.assertEqual(areas.media_type, "application/geo+json")
        features = areas.json()["features"]
        above = sum(f["properties"]["volume"] for f in features if f["properties"]["kind"] == "above")
        self.assertAlmostEqual(above, sum(row["above"]["volume"] for row in rows), places=6)
        with tempfile.TemporaryDirectory() as folder:
            for name, content in (("a.obj", square_obj(0, 0, 100, 10, 4)), ("parcels.geojson", parcels)):
                with open(os.path.join(folder, name), "w") as file:
                    file.write(content)
            subprocess.run([TERRANE, "volume", "a.obj", "8", "--region", "parcels.geojson", "--region-crs", "EPSG:25831",
                            "--assume-crs", "EPSG:25831", "--polygons", "-o", "areas.geojson", "--quiet"],
                           cwd=folder, check=True)
            with open(os.path.join(folder, "areas.geojson"), "rb") as file:
                self.assertEqual(file.read(), areas.body)

    def test_provenance_is_in_terrane_json(self):
        inputs = {"tiles": [square_tin(0, 0, 100, 10), square_tin(50, 0, 100, 20)], "provenance": True, **UTM}
        tin = service.post_json("merge", {"inputs": inputs})
        self.assertEqual(tin.status, 200, tin.body)
        found = tin.json()["provenance"]
        self.assertEqual(found["policy"], "merge overlap=first")
        self.assertEqual(len(found["faces"]), len(tin.json()["triangles"]))
        self.assertEqual(set(found["decided"]), {0, 1, None})
        self.assertEqual(service.post_json("merge", {"inputs": inputs}, "?f=obj").status, 400)
        again = service.post_json("info", {"inputs": {"surface": tin.json()}})
        self.assertEqual(again.status, 200, again.body)

    def test_a_region_of_interest(self):
        inputs = {"surface": square_tin(0, 0, 100, 10, 4), "bbox": [20, 30, 70, 90], **UTM}
        inside = service.post_json("clip", {"inputs": inputs}, "?f=obj")
        self.assertEqual(inside.status, 200, inside.body)
        self.assertAlmostEqual(plan_area(*read_obj(inside.body)), 3000, places=6)
        outside = service.post_json("clip", {"inputs": {**inputs, "side": "outside"}}, "?f=obj")
        self.assertAlmostEqual(plan_area(*read_obj(outside.body)), 7000, places=6)
        region = '{"type":"Polygon","coordinates":[[[20,30],[70,30],[70,90],[20,90],[20,30]]]}'
        by_form = service.post_form("clip", [
            ("surface", File("a.obj", square_obj(0, 0, 100, 10, 4))), ("region", File("r.geojson", region)),
            ("region-crs", "EPSG:25831")], "?f=obj&assume-crs=EPSG:25831")
        self.assertEqual(by_form.body, inside.body)
        apart = service.post_json("clip", {"inputs": {**inputs, "bbox": [500, 0, 600, 100]}})
        self.assertEqual(apart.status, 422)
        self.assertIn("400 m apart", apart.json()["detail"])
        self.assertEqual(service.post_json("clip", {"inputs": {**inputs, "bbox": [5, 5]}}).status, 400)

    def test_surfaces_made_from_nothing(self):
        disc = service.post_json("synthesize-circle", {"inputs": {
            "center": [10, 20], "radius": 5, "z": 3, "crs": "EPSG:25831"}}, "?f=obj")
        self.assertEqual(disc.status, 200, disc.body)
        vertices, faces = read_obj(disc.body)
        self.assertEqual((len(vertices), len(faces), {z for _, _, z in vertices}), (64, 62, {3}))
        crossing = service.post_json("synthesize-polygon", {"inputs": {
            "points": "0,0;10,10;10,0;0,10", "spline": False, "crs": "EPSG:25831"}})
        self.assertEqual(crossing.status, 422)
        self.assertIn("5.0, 5.0", crossing.json()["detail"])

    def test_a_raster_and_a_picture(self):
        grid = ascii_grid(20, 20, lambda c, r: c * r)
        mesh = service.post_form("triangulate", [("dem", File("dem.asc", grid))], "?f=obj&assume-crs=EPSG:25831")
        self.assertEqual(mesh.status, 200, mesh.body)
        vertices, faces = read_obj(mesh.body)
        self.assertEqual((len(vertices), len(faces)), (400, 722))
        picture = service.post_form("render", [("surface", File("dem.asc", grid))], "?assume-crs=EPSG:25831")
        self.assertEqual((picture.status, picture.media_type), (200, "image/png"), picture.body[:300])
        self.assertTrue(picture.body.startswith(b"\x89PNG"))

    def test_a_surface_is_simplified_and_contoured(self):
        grid = File("cone.asc", ascii_grid(21, 21, lambda c, r: 10 - max(abs(c - 10), abs(r - 10))))
        query = "?assume-crs=EPSG:25831&"
        roof = File("roof.asc", ascii_grid(21, 21, lambda c, r: 10 - abs(c - 10)))
        flat = service.post_form("simplify", [("surface", roof)], query + "f=obj&coplanar-only=true&keep-boundary=false")
        self.assertEqual(flat.status, 200, flat.body)
        vertices, faces = read_obj(flat.body)
        self.assertEqual((len(vertices), len(faces)), (6, 4))
        lines = service.post_form("contour", [("surface", grid)], query + "interval=2.5")
        self.assertEqual((lines.status, lines.media_type), (200, "application/geo+json"), lines.body)
        features = lines.json()["features"]
        self.assertEqual([f["properties"]["level"] for f in features], [2.5, 5, 7.5])
        for f in features:
            line = f["geometry"]["coordinates"]
            self.assertEqual(line[0], line[-1])
            self.assertTrue(all(z == f["properties"]["level"] for _, _, z in line))
        for word in "gpkg", "dxf":
            self.assertEqual(service.post_form("contour", [("surface", grid)], query + "levels=5&f=" + word).status, 200)
        for operation, wrong in (("simplify", ""), ("contour", ""), ("contour", "interval=1&levels=3")):
            self.assertEqual(service.post_form(operation, [("surface", grid)], query + wrong).status, 400)

    def test_thresholds_are_combined(self):
        grids = [File(name, ascii_grid(20, 20, height)) for name, height in
                 (("columns.asc", lambda c, r: c), ("rows.asc", lambda c, r: r))]
        query = "?f=obj&assume-crs=EPSG:25831&"
        areas = [service.post_form("threshold", [("surface", grid)], query + "level=9.5").body for grid in grids]
        for operation, heights in (("and", 0.25), ("or", 0.75), ("xor", 0.5), ("nand", 0.75), ("nor", 0.25)):
            answer = service.post_form(operation, [("a", File("a.obj", areas[0])), ("b", File("b.obj", areas[1]))],
                                       query + "z-true=1")
            self.assertEqual(answer.status, 200, answer.body)
            vertices, faces = read_obj(answer.body)
            true = [face for face in faces if all(vertices[v][2] == 1 for v in face)]
            self.assertAlmostEqual(plan_area(vertices, true), heights * 190 * 190)
        grey = service.post_form("and", [("a", File("a.obj", areas[0])), ("b", grids[1])], query)
        self.assertEqual(grey.status, 422)
        self.assertIn("threshold", grey.json()["detail"])
        terraces = service.post_form("quantize", [("surface", grids[0])], query + "levels=0,5,10")
        self.assertEqual({v[2] for v in read_obj(terraces.body)[0]}, {0, 5, 10})
        self.assertEqual(service.post_form("threshold", [("surface", grids[0])], query).status, 400)

    def test_heights_at_cells_along_lines_and_at_points(self):
        square = ("surface", File("west.obj", WEST))
        raster = service.post_form("rasterize", [square, ("cell-size", "25")], "?f=asc&assume-crs=EPSG:25831")
        self.assertEqual(raster.status, 200, raster.body)
        self.assertIn(b"ncols 4\nnrows 4\n", raster.body)
        again = service.post_form("rasterize", [square, ("like", File("like.asc", raster.body))],
                                  "?f=asc&assume-crs=EPSG:25831")
        self.assertEqual(again.body, raster.body)
        tiff = service.post_form("rasterize", [square, ("cell-size", "25")], "?assume-crs=EPSG:25831")
        self.assertEqual((tiff.status, tiff.media_type, tiff.body[:2]), (200, "image/tiff", b"II"))
        line = service.post_form("profile", [square, ("line", "0,50,100,50")], "?assume-crs=EPSG:25831")
        self.assertEqual((line.status, line.media_type), (200, "text/csv"), line.body)
        self.assertEqual(line.body.decode().splitlines()[:2], ["distance,x,y,z", "0,0,50,10"])
        chart = service.post_form("profile", [square, ("line", "0,50,100,50")], "?f=png&assume-crs=EPSG:25831")
        self.assertTrue(chart.body.startswith(b"\x89PNG"), chart.body[:300])
        points = json.dumps({"type": "MultiPoint", "coordinates": [[10, 20], [500, 500]]})
        heights = service.post_form("sample", [square, ("points", File("points.geojson", points))],
                                    "?assume-crs=EPSG:25831&points-crs=EPSG:25831")
        self.assertEqual(heights.body.decode(), "x,y,z\n10,20,10\n500,500,\n")
        for operation, parts, status in (("profile", [square], 400), ("profile", [square, ("line", "1,1")], 422),
                                         ("sample", [square, ("points", "POINT EMPTY")], 422),
                                         ("rasterize", [square, ("cell-size", "-1")], 400),
                                         ("rasterize", [square, ("cell-size", "0.0001")], 413),
                                         ("rasterize", [square, ("like", File("w.obj", WEST))], 422)):
            answer = service.post_form(operation, parts, "?assume-crs=EPSG:25831")
            self.assert_problem(answer, status)

    def test_the_media_type_or_the_name_or_the_magic_tells_the_format(self):
        for part in (File("x", WEST, "model/obj"), File("west.obj", WEST), File("x", WEST)):
            answer = self.merged(part, File("east.obj", EAST))
            self.assertEqual(answer.status, 200, (part.name, part.media_type, answer.body))

    def test_requests_side_by_side_do_not_disturb_each_other(self):
        grid = File("dem.asc", ascii_grid(40, 40, lambda c, r: c * r % 17, 400000, 4600000))
        query = "?f=obj&assume-crs=EPSG:25831&target-crs=EPSG:"

        def transformed(code):
            return service.post_form("transform", [("surface", grid)], query + code).body
        codes = ["25830", "4326", "3857", "25831"] * 3
        alone = {code: transformed(code) for code in set(codes)}
        self.assertEqual(len(set(alone.values())), 4)
        waiting = [(code, in_background(lambda code=code: transformed(code))) for code in codes]
        # More than there are places at once: those that were refused say so.
        for code, wait in waiting:
            body = wait()
            self.assertTrue(body == alone[code] or b"/problems/busy" in body, code)

    def test_connections_are_kept(self):
        connection = http.client.HTTPConnection(service.host, service.port, timeout=20)
        for _ in range(20):
            connection.request("GET", "/health")
            first = connection.sock
            self.assertEqual(connection.getresponse().read().strip()[:1], b"{")
            self.assertIs(connection.sock, first)
        connection.close()


if __name__ == "__main__":
    unittest.main()
