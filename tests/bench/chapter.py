#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rebuilds the experiments of the chapter that the operations come from, on real terrain, and writes docs/chapter.md:
points in and out and whole-process times, beside the chapter's own figures and beside GDAL on the rasters.
Usage: chapter.py TERRANE DATA [OUTPUT]; DATA is a folder with balearic/window_*.tif and tiles/N44W072.hgt."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

terrane, data = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
output = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else "docs/chapter.md").resolve()
REPEAT = 3
table = []


def timed(*words):
    """Least wall time of a program."""
    least = float("inf")
    for _ in range(REPEAT):
        start = time.perf_counter()
        subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        least = min(least, time.perf_counter() - start)
    return least


def ran(operation, *words):
    """Runs an operation into OPERATION.ply; returns the output part of its certificate and the time."""
    result = words[-1]
    time_taken = timed(terrane, operation, *words[:-1], "-o", result, "--report", "report.json", "--force", "--quiet")
    with open("report.json", encoding="utf-8") as report:
        certificate = json.load(report)
    assert not any(certificate["topology"].values()), certificate["topology"]
    return certificate["output"], time_taken


def entry(what, into, out, taken, chapter, rasters=""):
    table.append(f"| {what} | {into} | {out['vertices']:,} ({out['faces']:,} faces) | {taken * 1000:.0f} ms | {chapter} | {rasters} |")
    print(table[-1], flush=True)


def rasters(expression, *names):
    """gdal_calc on rasters of the same size, in milliseconds."""
    letters = [word for name, letter in zip(names, "AB") for word in (f"-{letter}", name)]
    return f"{timed('gdal_calc.py', *letters, '--calc', expression, '--outfile', 'calc.tif', '--overwrite', '--quiet') * 1000:.0f} ms"


def image(name, column, line):
    """512 x 512 samples of the Presidential Range, as an image with cells of one metre in one frame."""
    subprocess.run(["gdal_translate", "-q", "-srcwin", str(column), str(line), "512", "512", "-a_ullr", "500000", "4500512",
                    "500512", "4500000", "-a_srs", "EPSG:32619", data / "tiles" / "N44W072.hgt", name], check=True)


def sums():
    image("a.tif", 60, 60)
    image("b.tif", 660, 620)
    points = [ran("triangulate", f"{s}.tif", "--max-error", n, f"{s}.ply")[0]["vertices"] for s, n in (("a", 43), ("b", 67))]
    out, taken = ran("add", "a.ply", "b.ply", "sum.ply")
    entry("sum of two meshes", " + ".join(f"{p:,}" for p in points), out, taken, "2,461 + 2,624 to 19,776 in 21.18 s (images: 0.14 s)",
          rasters("A+B", "a.tif", "b.tif"))
    less, taken = ran("simplify", "sum.ply", "--coplanar-only", "true", "less.ply")
    entry("the sum without faces that its surface does not need", f"{out['vertices']:,}", less, taken, "not there")


def integration():
    meshes, points = [], []
    for name, faces in (("nw", 3600), ("ne", 3300), ("sw", 3250), ("se", 3080)):
        mesh = f"{name}.ply"
        points.append(ran("triangulate", data / "balearic" / f"window_{name}.tif", "--max-triangles", faces, mesh)[0]["vertices"])
        meshes.append(mesh)
    policy = ("--overlap", "sum", "--seam", "ramp")
    start = 0.0
    result = meshes[0]
    for step, mesh in enumerate(meshes[1:]):
        out, taken = ran("merge", result, mesh, *policy, f"step{step}.ply")
        result, start = f"step{step}.ply", start + taken
    entry("four Balearic meshes, pairwise (`overlap=sum seam=ramp`)", " + ".join(f"{p:,}" for p in points), out, start,
          "1,828 + 1,673 + 1,654 + 1,307 to 13,369 in 22.98 s")
    out, taken = ran("merge", *meshes, "--overlap", "mean", "merged.ply")
    entry("the same as one surface (`overlap=mean`)", "all four", out, taken, "not there")


def logic():
    for s in "ab":
        out, taken = ran("threshold", f"{s}.ply", "--level", 700, f"{s}-true.ply")
        entry(f"threshold of {s.upper()}", f"{s.upper()}", out, taken, "not timed", rasters("A>=700", f"{s}.tif"))
    out, taken = ran("not", "a-true.ply", "not.ply")
    entry("NOT", "threshold of A", out, taken, "1,649 points: 0.0001 s, in memory", rasters("255-255*(A>=700)", "a.tif"))
    for word, formula in (("and", "(A>=700)&(B>=700)"), ("or", "(A>=700)|(B>=700)"), ("xor", "(A>=700)^(B>=700)"),
                          ("nand", "1-((A>=700)&(B>=700))"), ("nor", "1-((A>=700)|(B>=700))")):
        out, taken = ran(word, "a-true.ply", "b-true.ply", f"{word}.ply")
        entry(word.upper(), "both thresholds", out, taken, "0.11 to 0.12 s", rasters(formula, "a.tif", "b.tif"))


def regions():
    out, _ = ran("triangulate", "a.tif", "--max-triangles", 14900, "fine.ply")
    points = f"{out['vertices']:,}"
    out, taken = ran("clip", "fine.ply", "--bbox", "500100,4500120,500400,4500380", "box.ply")
    box = timed("gdal_translate", "-q", "-projwin", "500100", "4500380", "500400", "4500120", "a.tif", "box.tif")
    entry("rectangular region of interest", points, out, taken, "7,492 points: 0.17 s", f"{box * 1000:.0f} ms")
    ring = "500060 4500080,500300 4500030,500470 4500260,500330 4500480,500200 4500300,500050 4500400,500060 4500080"
    out, taken = ran("clip", "fine.ply", "--region", f"POLYGON(({ring}))", "part.ply")
    corners = [[float(v) for v in corner.split()] for corner in ring.split(",")]
    with open("ring.geojson", "w", encoding="ascii") as region:
        json.dump({"type": "Polygon", "coordinates": [corners],
                   "crs": {"type": "name", "properties": {"name": "EPSG:32619"}}}, region)
    part = timed("gdalwarp", "-q", "-overwrite", "-cutline", "ring.geojson", "-dstnodata", "-9999", "a.tif", "part.tif")
    entry("polygonal region of interest", points, out, taken, "7,492 points: 0.78 s", f"{part * 1000:.0f} ms")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for experiment in (sums, integration, logic, regions):
        experiment()
output.write_text(
    "<!-- Generated by tests/bench/chapter.py. -->\n# The chapter's experiments on today's data\n\n"
    "Terrane's times are those of whole processes, files read, checked, verified and written (least of three runs); the\n"
    "chapter's are of the operation alone, on an R10000 at 175 MHz. Rasters: `gdal_calc.py`,\n`gdal_translate` and `gdalwarp` on the 512 x 512 images.\n\n"
    "| experiment | points in | points out | time | the chapter | rasters |\n|---|---|---|---|---|---|\n" + "\n".join(table) + "\n",
    encoding="utf-8")
