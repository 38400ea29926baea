#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""N uploads that are broken, over HTTP: files of every format that is read, cut, changed, repeated, mixed up; bombs, deep
nesting, wrong types. Each is answered with 200 (what was changed was of no account) or a 4xx problem; no 5xx, nothing
that takes long, no process left behind, and the service works on.

  bad_uploads.py N [--seed SEED]
"""
import argparse
import collections
import gzip
import io
import json
import os
import random
import subprocess
import sys
import tempfile
import time
import zipfile

sys.path[:0] = [os.path.dirname(__file__), os.path.join(os.path.dirname(__file__), "..", "api")]
from service import TERRANE, File, Service  # noqa: E402
from terrains import ascii_grid, square_obj  # noqa: E402

LONG = 10  # seconds for one of these small requests, on a busy machine


def good_files():
    """{file name: bytes} of every format that Terrane writes, and of those that are quickly made by hand."""
    files = {"a.obj": square_obj(0, 0, 100, 1, 2).encode(),
             "a.asc": ascii_grid(12, 9, lambda c, r: (c * 7 + r * 13) % 11).encode(),
             "a.xyz": "".join(f"{x} {y} {(x * y) % 7}\n" for x in range(6) for y in range(5)).encode(),
             "a.csv": ("x,y,z\n" + "".join(f"{x},{y},{(x * y) % 7}\n" for x in range(6) for y in range(5))).encode(),
             "a.hgt": b"".join(bytes((0, (i * 7) % 90)) for i in range(1201 * 1201))[:1201 * 1201 * 2]}
    with tempfile.TemporaryDirectory() as folder:
        for name in ("a.obj", "a.asc"):
            with open(os.path.join(folder, name), "wb") as file:
                file.write(files[name])
        for source, operation, names in (("a.obj", "convert", ("b.ply", "b.json")), ("a.asc", "contour", ("c.geojson", "c.gpkg", "c.dxf")),
                                         ("a.obj", "rasterize", ("r.tif",))):
            for name in names:
                extra = {"contour": ["--interval", "2"], "rasterize": ["--cell-size", "10"]}.get(operation, [])
                subprocess.run([TERRANE, operation, source, "--crs", "EPSG:25831", *extra, "-o", name, "--quiet"],
                               cwd=folder, check=True, capture_output=True)
                with open(os.path.join(folder, name), "rb") as file:
                    files[name] = file.read()
    return files


def broken(files, dice):
    """One broken file: (name, bytes)."""
    name, content = dice.choice(list(files.items()))
    content = bytearray(content[:200_000])
    kind = dice.randrange(9)
    if kind == 0:
        return name, bytes(content[:dice.randrange(len(content))])
    if kind == 1:
        for _ in range(dice.choice((1, 3, 30))):
            content[dice.randrange(len(content))] = dice.randrange(256)
        return name, bytes(content)
    if kind == 2:
        at, size = dice.randrange(len(content)), dice.randrange(1, 200)
        return name, bytes(content[:at] + content[at:at + size] * dice.choice((2, 50)) + content[at + size:])
    if kind == 3:
        return dice.choice(list(files)), bytes(content)  # another name than it has
    if kind == 4:
        at = dice.randrange(len(content))
        token = dice.choice((b"nan", b"1e400", b"-1", b"99999999999", b"\0\0\0\0", b"\xff\xff\xff\xff", b"[" * 300, b'"', b"\r\n"))
        return name, bytes(content[:at] + token + content[at + dice.randrange(8):])
    if kind == 5:
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(dice.choice((name, "roi.shp", "../" + name)), b"\0" * dice.choice((10, 1_000_000)))
        return "a.zip", packed.getvalue()
    if kind == 6:
        depth = dice.choice((10, 100, 20_000))
        return "a.json", b'{"type":"TIN","vertices":' + b"[" * depth + b"]" * dice.randrange(depth + 1) + b"}"
    if kind == 7:
        return name, gzip.compress(bytes(content))
    return name, bytes(dice.randrange(256) for _ in range(dice.randrange(400)))


def children(service):
    listing = subprocess.run(["ps", "-eo", "pid,ppid"], capture_output=True, text=True, check=True).stdout
    parents = dict(map(int, line.split()) for line in listing.splitlines()[1:])
    makers = {p for p, parent in parents.items() if parent == service.process.pid}
    return [p for p, parent in parents.items() if parent in makers]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("uploads", type=int)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    dice, begun = random.Random(options.seed), time.monotonic()
    files, statuses, wrong, slowest = good_files(), collections.Counter(), [], 0.0
    service = Service("--job-memory", "1G")
    for number in range(options.uploads):
        name, content = broken(files, dice)
        started = time.monotonic()
        shape = number % 3
        if shape == 0:
            answer = service.post_form("info", [("surface", File(name, content))], "?crs=EPSG:25831")
        elif shape == 1:
            answer = service.post_form("clip", [("surface", File("a.obj", files["a.obj"])), ("region", File(name, content))],
                                       "?f=obj&crs=EPSG:25831")
        else:
            answer = service.post_form("merge", [("tiles", File(name, content)), ("tiles", File("a.obj", files["a.obj"]))],
                                       "?f=obj&crs=EPSG:25831")
        took = time.monotonic() - started
        slowest = max(slowest, took)
        statuses[answer.status] += 1
        problem = answer.media_type == "application/problem+json"
        if (answer.status != 200 and not (400 <= answer.status < 500 and problem and json.loads(answer.body)["detail"])) or took > LONG:
            wrong.append((number, name, answer.status, f"{took:.1f} s", answer.body[:200]))
            with open(os.path.join(tempfile.gettempdir(), f"bad-upload-{options.seed}-{number}-{name}"), "wb") as file:
                file.write(content)
    time.sleep(0.5)
    left = children(service)
    works = service.post_form("info", [("surface", File("a.obj", files["a.obj"]))], "?crs=EPSG:25831").status == 200
    clean = service.close() == 0
    print(f"{options.uploads} uploads in {time.monotonic() - begun:.0f} s: {dict(sorted(statuses.items()))}, the slowest "
          f"{slowest:.1f} s, {len(wrong)} wrong, {len(left)} processes left, works on: {works}, clean stop: {clean}")
    for line in wrong[:20]:
        print(" ", *line)
    return 1 if wrong or left or not works or not clean else 0


if __name__ == "__main__":
    sys.exit(main())
