"""Readers of the boundary alone, .stl, .ply and .obj, that know nothing of tetstream."""

import re
import struct

import numpy

from samples import Read
from text_readers import table


def read_stl(path):
    content = path.read_bytes()
    count, = struct.unpack_from("<I", content, 80)
    rows = numpy.frombuffer(content, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")],
                            offset=84)
    assert len(rows) == count and not content.startswith(b"solid")
    corners = rows["corners"].astype(float)
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    cosines = numpy.einsum("ij,ij->i", rows["normal"], normals) / numpy.linalg.norm(normals, axis=1)
    assert cosines.min() > 0.99
    points = rows["corners"].reshape(-1, 3)
    return Read(points, faces={"": numpy.arange(len(points)).reshape(-1, 3)})


def read_ply(path):
    head, _, body = path.read_bytes().partition(b"end_header\n")
    lines = head.decode("ascii").splitlines()
    kinds = {"float": "<f4", "double": "<f8"}
    vertex = [(line.split()[2], kinds[line.split()[1]]) for line in lines
              if re.match(r"property (float|double) ", line)]
    counts = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    names = {int(line.split()[2]): line.split(maxsplit=3)[3] for line in lines
             if line.startswith("comment label")}
    rows = numpy.frombuffer(body, dtype=vertex, count=counts["vertex"])
    faces = numpy.frombuffer(body, offset=rows.nbytes,
                             dtype=[("count", "u1"), ("corners", "<i4", 3), ("label", "<u2")])
    assert len(faces) == counts["face"] and (faces["count"] == 3).all()
    fields = {}
    for name, _ in vertex[3:]:
        if name.endswith("_x"):
            fields[name[:-2]] = numpy.stack([rows[f"{name[:-2]}_{axis}"] for axis in "xyz"], 1)
        elif not name.endswith(("_y", "_z")):
            fields[name] = rows[name]
    return Read(numpy.stack([rows[axis] for axis in "xyz"], 1), fields=fields,
                faces={name: faces["corners"][faces["label"] == label] for label, name in names.items()})


def read_obj(path):
    points, faces = [], {}
    for line in path.read_text(encoding="utf-8").splitlines():
        kind, _, rest = line.partition(" ")
        if kind == "v":
            points.append(rest)
        elif kind == "g":
            triangles = faces.setdefault(rest, [])
        elif kind == "f":
            triangles.append(rest)
    return Read(table(points, float, " "), faces={name: table(rows, int, " ") - 1 for name, rows in faces.items()})
