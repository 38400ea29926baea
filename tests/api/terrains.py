# SPDX-License-Identifier: GPL-3.0-or-later
"""Small terrains that one can check by hand, in the formats the service reads."""
import json
import struct

UTM = {"assume-crs": "EPSG:25831"}


def obj(vertices, faces, crs=None):
    lines = [f"# crs: {crs}"] if crs else []
    lines += ["v " + " ".join(str(c) for c in v) for v in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    return "\n".join(lines) + "\n"


def tin(vertices, faces, crs=None):
    value = {"type": "TIN", "vertices": vertices, "triangles": faces}
    if crs:
        value["crs"] = crs
    return value


def square(x, y, size, z, dz=0.0):
    """Two faces over a square; the height rises by dz from west to east."""
    return ([[x, y, z], [x + size, y, z + dz], [x + size, y + size, z + dz], [x, y + size, z]],
            [[0, 1, 2], [0, 2, 3]])


def square_obj(*arguments, crs=None):
    return obj(*square(*arguments), crs=crs)


def square_tin(*arguments, crs=None):
    return tin(*square(*arguments), crs=crs)


def ascii_grid(columns, rows, height, x=0.0, y=0.0, cell=10.0):
    """Cell centres from (x, y) at the lower left; height(column, row)."""
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcenter {x}", f"yllcenter {y}", f"cellsize {cell}",
             "NODATA_value -9999"]
    lines += [" ".join(str(height(c, r)) for c in range(columns)) for r in reversed(range(rows))]
    return "\n".join(lines) + "\n"


def hills(count):
    """Enough work to be busy with: a rough raster of count x count samples."""
    return ascii_grid(count, count, lambda c, r: (c * 7919 + r * 104729 + c * r * 31) % 1009)


def lattice_ply(cells, size):
    """A rough surface of cells x cells squares, two faces each."""
    places = range(cells + 1)
    vertices = b"".join(struct.pack("<3f", c * size, r * size, (c * 7919 + r * 104729 + c * r * 31) % 1009)
                        for r in places for c in places)
    corners = [r * (cells + 1) + c for r in range(cells) for c in range(cells)]
    faces = b"".join(struct.pack("<B3iB3i", 3, v, v + 1, v + cells + 2, 3, v, v + cells + 2, v + cells + 1)
                     for v in corners)
    return (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(places)**2}\nproperty float x\n"
            f"property float y\nproperty float z\nelement face {2 * cells**2}\n"
            "property list uchar int vertex_indices\nend_header\n").encode() + vertices + faces


def read_obj(text):
    vertices, faces = [], []
    for line in text.decode().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(tuple(float(w) for w in words[1:4]))
        elif words[:1] == ["f"]:
            faces.append(tuple(int(w.split("/")[0]) - 1 for w in words[1:4]))
    return vertices, faces


def plan_area(vertices, faces):
    area = 0.0
    for a, b, c in faces:
        (ax, ay, _), (bx, by, _), (cx, cy, _) = vertices[a], vertices[b], vertices[c]
        area += ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
    return area


def dumps(value):
    return json.dumps(value)
