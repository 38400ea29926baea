#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes docs/gallery.md and its pictures: what each operation does, on two small hills, every picture drawn by
`terrane render` or `terrane profile`. Usage: gallery.py TERRANE [FOLDER]; FOLDER is docs unless told otherwise."""
import math
import os
import pathlib
import subprocess
import sys
import tempfile

terrane = pathlib.Path(sys.argv[1]).resolve()
docs = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).parent.parent).resolve()
pictures = docs / "gallery"
page = []
SIZE = 340


def run(*words):
    done = subprocess.run([str(terrane), *map(str, words), "--quiet", "--force"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"terrane {' '.join(map(str, words))}\n{done.stderr}")


def hills(name, x0, seed, shift):
    """An ESRI grid of 129 x 129 samples, 4 m apart: waves of six lengths, heights 80 to 220 or so."""
    waves = [(math.sin(seed * 7.1 + k * 1.7) * math.pi, 0.006 * 1.6**k, 34 / 1.55**k, seed + k) for k in range(6)]

    def height(x, y):
        return 150 + shift + sum(a * math.sin(f * (x * math.cos(t) + y * math.sin(t)) + p) for t, f, a, p in waves)

    with open(name, "w", encoding="ascii") as grid:
        print(f"ncols 129\nnrows 129\nxllcenter {500000 + x0}\nyllcenter 4500000\ncellsize 4\nNODATA_value -9999", file=grid)
        for row in range(129):
            print(*(f"{height(x0 + 4 * i, 4 * (128 - row)):.3f}" for i in range(129)), file=grid)


def title(text, words=""):
    page.extend(["", f"## {text}", ""] + ([words, ""] if words else []))


def row(*figures):
    """A row of pictures with what made them below."""
    page.append("| " + " | ".join(f"![{caption}](gallery/{name}.png)" for name, caption in figures) + " |")
    page.append("|" + "---|" * len(figures))
    page.append("| " + " | ".join(caption for _, caption in figures) + " |")
    page.append("")


def picture(surface, name, shading="hillshade", *more):
    run("render", surface, "--shading", shading, "--size", SIZE, *more, "-o", pictures / f"{name}.png")


def made(name, caption, *words, shading="hillshade", wires=False):
    """Runs an operation and draws its result; returns the figure."""
    run(*words, "-o", f"{name}.obj")
    picture(f"{name}.obj", name, shading, *(["--wireframe"] if wires else []))
    return name, caption


def inputs():
    crs = ["--assume-crs", "EPSG:25831"]
    for name, x0, seed, shift in (("a", 0, 1, 0), ("b", 256, 1, 18), ("c", 0, 5, 0)):
        hills(f"{name}.asc", x0, seed, shift)
        run("triangulate", f"{name}.asc", "--max-error", 3, *crs, "-o", f"{name}.obj")


def adaptive():
    title("Triangulate, simplify", "A DEM becomes a TIN within a bound; a TIN becomes a coarser one, within a bound again.")
    run("simplify", "a.obj", "--max-error", 10, "-o", "coarse.obj")
    picture("a.obj", "triangulate", "hillshade", "--wireframe")
    picture("coarse.obj", "simplify", "hillshade", "--wireframe")
    picture("a.obj", "elevation", "elevation")
    row(("elevation", "surface A, `render shading=elevation`"), ("triangulate", "`triangulate max-error=3`"),
        ("simplify", "`simplify max-error=10`"))


def arithmetic():
    title("Add, subtract", "Exact on every face of the overlay of both, not only at vertices.")
    row(made("add", "`add A C outside=drop`", "add", "a.obj", "c.obj", "--outside", "drop", wires=True),
        made("subtract", "`subtract A C`", "subtract", "a.obj", "c.obj", shading="diverging"))


def merging():
    title("Merge", "B overlaps A by half and lies 18 metres above it.")
    merge = lambda name, caption, *more: made(name, caption, "merge", "a.obj", "b.obj", *more, shading="elevation")
    row(merge("merge-first", "`overlap=first`: a cliff, closed by a wall"),
        merge("merge-ramp", "`overlap=first seam=ramp`", "--seam", "ramp"),
        merge("merge-blend", "`overlap=blend blend-width=120`", "--overlap", "blend", "--blend-width", 120))
    row(merge("merge-min", "`overlap=min`", "--overlap", "min"), merge("merge-mean", "`overlap=mean`", "--overlap", "mean"),
        merge("merge-sum", "`overlap=sum`", "--overlap", "sum"))


def logic():
    title("Threshold, logic", "True is white, false is green; walls between them.")
    figures = [made(f"threshold-{s}", f"`threshold {s.upper()} level=165`", "threshold", f"{s}.obj", "--level", 165,
                    shading="elevation") for s in "ac"]
    figures.append(made("not", "`not A`", "not", "threshold-a.obj", shading="elevation"))
    row(*figures)
    both = ["threshold-a.obj", "threshold-c.obj"]
    for group in (("and", "or", "xor"), ("nand", "nor")):
        row(*(made(word, f"`{word} A C`", word, *both, shading="elevation") for word in group))


def regions():
    title("Clip", "Faces inside are untouched, those that the border cuts are triangulated anew.")
    ring = "POLYGON((500060 4500080,500300 4500030,500470 4500260,500330 4500480,500200 4500300,500050 4500400,500060 4500080))"
    row(made("clip-box", "`clip bbox=…`", "clip", "a.obj", "--bbox", "500100,4500120,500400,4500380", wires=True),
        made("clip-polygon", "`clip region=POLYGON(…)`", "clip", "a.obj", "--region", ring, wires=True),
        made("clip-outside", "`side=outside`", "clip", "a.obj", "--region", ring, "--side", "outside", wires=True))


def synthetic():
    title("Synthetic meshes")
    crs = ["--crs", "EPSG:25831"]
    ramp = [f"--{k}={v}" for k, v in
            dict(xmin=500000, ymin=4500000, xmax=500400, ymax=4500250, zmin=100, zmax=160).items()]
    star = ";".join(f"{500200 + r * math.cos(t):.3f},{4500200 + r * math.sin(t):.3f}"
                    for t, r in ((k * math.pi / 5, 180 if k % 2 else 95) for k in range(10)))
    edge = ["--max-edge", 40]
    row(made("rectangle", "`synthesize-rectangle`: a ramp", "synthesize-rectangle", *ramp, *edge, *crs, wires=True),
        made("circle", "`synthesize-circle`", "synthesize-circle", "--center", "500200,4500200", "--radius", 150, "--z", 120,
             *edge, *crs, wires=True))
    row(made("ellipse", "`synthesize-ellipse azimuth=-30`", "synthesize-ellipse", "--center", "500200,4500200",
             "--major-axis", 360, "--minor-axis", 180, "--azimuth", -30, "--z", 120, *edge, *crs, wires=True),
        made("polygon", "`synthesize-polygon`: a spline through ten points", "synthesize-polygon", "--points", star,
             "--samples", 120, "--z", 120, *edge, *crs, wires=True))


def levels():
    title("Quantize, profile")
    run("profile", "a.obj", "c.obj", "--line", "500000,4500060;500512,4500450", "-o", pictures / "profile.png")
    row(made("quantize", "`quantize interval=15`", "quantize", "a.obj", "--interval", 15, shading="elevation"),
        ("profile", "`profile A C`"))


pictures.mkdir(parents=True, exist_ok=True)
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    page.append("<!-- Generated by docs/gallery/gallery.py. -->\n# Gallery\n\nEvery picture is drawn by Terrane; "
                "`docs/gallery/gallery.py` makes this page. North is up.")
    inputs()
    for part in (adaptive, arithmetic, merging, logic, regions, synthetic, levels):
        part()
(docs / "gallery.md").write_text("\n".join(page).rstrip() + "\n", encoding="utf-8")
