"""What the table of formats says is in the files: each is read by a reader that knows nothing of tetstream.

    read_formats.py path/to/write_samples
"""

import re
import struct
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import meshio
import numpy

from samples import SAMPLES, SampleTest, plain, sorted_triangles, volumes


class Read:
    """What a reader found. Nothing of what a format has no place for."""

    def __init__(self, points, tets=None, labels=None, faces=None, fields=None):
        self.points, self.tets, self.labels = points, tets, labels
        self.faces, self.fields = faces or {}, fields or {}


# ---- .inp ----

def inp_sections(path):
    """Keyword, parameters and lines of data of each."""
    sections = []
    for line in path.read_text(encoding="ascii").splitlines():
        assert len(line) <= 132, line  # as much as CalculiX reads
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            keyword, *rest = [word.strip() for word in line[1:].split(",")]
            sections.append((keyword, dict(word.split("=") for word in rest), []))
        else:
            sections[-1][2].append(line)
    return sections


# As seen from outside; the manuals list them as seen from within.
INP_FACES = {"S1": (0, 2, 1), "S2": (0, 1, 3), "S3": (1, 2, 3), "S4": (2, 0, 3)}


def read_inp(path):
    points, elements, sets, faces, node_sets = [], {}, {}, {}, {}
    for keyword, parameters, lines in inp_sections(path):
        rows = [[word.strip() for word in line.split(",")] for line in lines]
        if keyword == "NODE":
            assert parameters == {"NSET": "Nall"}
            assert max(len(word) for row in rows for word in row) <= 20
            assert [int(row[0]) for row in rows] == list(range(1, len(rows) + 1))
            points = numpy.array([[float(word) for word in row[1:]] for row in rows])
        elif keyword == "ELEMENT":
            assert parameters["TYPE"] == "C3D4"
            for number, *nodes in rows:
                assert number not in elements
                elements[int(number)] = [int(node) - 1 for node in nodes]
            sets[parameters["ELSET"]] = [int(row[0]) - 1 for row in rows]
        elif keyword == "ELSET":
            assert parameters == {"ELSET": "Eall"} and [row[0] for row in rows] == list(sets)
        elif keyword == "SURFACE":
            assert parameters["TYPE"] == "ELEMENT"
            faces[parameters["NAME"]] = [
                [elements[int(number)][corner] for corner in INP_FACES[side]] for number, side in rows]
        elif keyword == "NSET":
            node_sets[parameters["NSET"]] = [int(row[0]) - 1 for row in rows]
        else:
            assert keyword == "HEADING", keyword
    assert sorted(elements) == list(range(1, len(elements) + 1))
    assert node_sets == {name: sorted(set(numpy.ravel(triangles).tolist()))
                         for name, triangles in faces.items()}
    tets = numpy.array([elements[number] for number in sorted(elements)])
    labels = numpy.zeros(len(tets), dtype=int)
    names = {"inside": 1, "outside": 2, "femur__left_": 1, "a_b__c____d": 2}
    for name, members in sets.items():
        labels[members] = names[name]
    return Read(points, tets, None if list(sets) == ["inside"] else labels, faces)


# ---- .xdmf ----

def xdmf_item(path, element, expected_type=None):
    item = element.find("DataItem")
    file, dataset = item.text.strip().split(":")
    with h5py.File(path.parent / file) as columns:
        values = columns[dataset][()]
    assert [int(n) for n in item.get("Dimensions").split()] == list(values.shape)
    assert int(item.get("Precision")) == values.dtype.itemsize
    assert {"Int": "i", "Float": "f"}[item.get("NumberType")] == values.dtype.kind
    return values


def read_xdmf(path):
    grids = {grid.get("Name"): grid for grid in ElementTree.parse(path).getroot().iter("Grid")}
    mesh, cells = grids["mesh"], grids["cell_tags"]
    points = xdmf_item(path, mesh.find("Geometry"))
    tets = xdmf_item(path, mesh.find("Topology"))
    assert mesh.find("Topology").get("TopologyType") == "Tetrahedron"
    assert cells.find("Topology/DataItem").text == mesh.find("Topology/DataItem").text
    fields = {}
    for attribute in mesh.findall("Attribute"):
        values = xdmf_item(path, attribute)
        assert attribute.get("AttributeType") == {1: "Scalar", 3: "Vector"}[values.shape[1]]
        fields[attribute.get("Name")] = values.squeeze(axis=1) if values.shape[1] == 1 else values
    names = {grid: {int(each.get("Name")): each.get("Value") for each in grids[grid].findall("Information")}
             for grid in grids}
    labels = xdmf_item(path, cells.find("Attribute"))
    assert set(labels) <= set(names["cell_tags"])
    facets = grids["facet_tags"]
    triangles, tags = (xdmf_item(path, facets.find(what)) for what in ("Topology", "Attribute"))
    assert set(tags) == set(names["facet_tags"])
    faces = {name: triangles[tags == tag] for tag, name in names["facet_tags"].items()}
    return Read(points, tets, labels if len(names["cell_tags"]) > 1 else None, faces, fields)


# ---- .msh ----

def read_msh(path):
    mesh = meshio.read(path)
    names = {(dimension, tag): name for name, (tag, dimension) in mesh.field_data.items()}
    tags = mesh.cell_data["gmsh:physical"]
    tets, labels, faces = [], [], {}
    for block, tag in zip(mesh.cells, tags):
        assert len(set(tag)) == 1
        if block.type == "tetra":
            tets.append(block.data)
            labels.append(tag)
        else:
            faces[names[2, tag[0]]] = block.data
    volumes_named = [name for (dimension, _), name in names.items() if dimension == 3]
    fields = {name: values for name, values in mesh.point_data.items() if not name.startswith("gmsh:")}
    return Read(mesh.points, numpy.concatenate(tets),
                numpy.concatenate(labels) if len(volumes_named) > 1 else None, faces, fields)


# ---- Boundaries ----

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
            points.append([float(word) for word in rest.split()])
        elif kind == "g":
            triangles = faces.setdefault(rest, [])
        elif kind == "f":
            triangles.append([int(word) - 1 for word in rest.split()])
    return Read(numpy.array(points), faces={name: numpy.array(rows) for name, rows in faces.items()})


READERS = {"msh": read_msh, "inp": read_inp, "xdmf": read_xdmf,
           "stl": read_stl, "ply": read_ply, "obj": read_obj}
# How each calls things; the others as the mesh does.
NAMES = {"msh": lambda name: name.replace('"', "'"), "inp": plain, "obj": plain, "stl": lambda name: ""}
FIELD_NAMES = {"ply": plain}
# Read by read_back.py.
VTK = {"vtu", "vtkhdf"}


def by_place(corners):
    """Triangles of points, in an order that does not depend on numbers."""
    rows = numpy.asarray(corners, dtype=float).reshape(-1, 9).round(5)
    first = numpy.array([min(range(3), key=lambda k: tuple(row[3 * k:3 * k + 3])) for row in rows])
    turned = numpy.concatenate(
        [rows.reshape(-1, 3, 3)[numpy.arange(len(rows)), (first + k) % 3] for k in range(3)], axis=1)
    return turned[numpy.lexsort(turned.T)].reshape(-1, 3)


class ReadFormats(SampleTest):
    def test_each_row_of_the_table_has_a_reader(self):
        self.assertEqual({row["name"] for row in self.formats}, set(READERS) | VTK)

    def check(self, row, name):
        expected, wide = self.expected(name), SAMPLES[name] == numpy.float64
        read = READERS[row["name"]](self.directory / f"{name}{row['ending']}")
        points = expected["points"]
        if row["coordinates"].startswith("float32") and not (wide and "or float64" in row["coordinates"]):
            points = points.astype(numpy.float32)
        if row["tets"]:
            self.check_tets(read, points, expected, row)
        else:
            self.assertIsNone(read.tets)
        if row["faces"]:
            self.check_faces(read, points, expected, row)
        else:
            self.assertEqual(read.faces, {})
        self.check_fields(read, expected, row)

    def check_points(self, read, points):
        numpy.testing.assert_allclose(read, points, rtol=1e-7 if points.dtype == numpy.float32 else 1e-12)

    def check_tets(self, read, points, expected, row):
        self.check_points(read.points, points)
        order = numpy.arange(len(expected["tets"]))
        labels = expected["labels"]
        if row["name"] == "msh" and len(labels):
            order = numpy.argsort(labels, kind="stable")
        numpy.testing.assert_array_equal(read.tets, expected["tets"][order])
        self.assertGreater(volumes(read.points, read.tets).min(), 0.1)
        if row["regions"] and len(labels):
            numpy.testing.assert_array_equal(read.labels, labels[order])
        else:
            self.assertIsNone(read.labels)

    def check_faces(self, read, points, expected, row):
        """The triangles of each name, turned as they were; by places, as vertices may have other numbers."""
        wanted = {}
        for label, rows in expected["faces"].items():
            wanted.setdefault(NAMES.get(row["name"], str)(label), []).append(rows[:, :3])
        self.assertEqual(set(read.faces), set(wanted))
        for label, triangles in wanted.items():
            of_file = numpy.asarray(read.faces[label])
            if row["tets"]:
                numpy.testing.assert_array_equal(sorted_triangles(of_file),
                                                 sorted_triangles(numpy.concatenate(triangles)))
            else:
                triangles = numpy.concatenate(triangles)
                self.check_points(by_place(read.points[of_file]), by_place(points[triangles]))
                if label:  # vertices are shared
                    self.assertEqual(len(numpy.unique(of_file)), len(numpy.unique(triangles)))

    def check_fields(self, read, expected, row):
        name_of = FIELD_NAMES.get(row["name"], str)
        wanted = {name_of(name): values for name, values in expected["fields"].items()} if row["fields"] else {}
        self.assertEqual(set(read.fields), set(wanted))
        kept = numpy.arange(len(expected["points"]))
        if not row["tets"]:
            kept = numpy.unique(numpy.concatenate([rows[:, :3] for rows in expected["faces"].values()]))
        for name, values in wanted.items():
            numpy.testing.assert_array_equal(read.fields[name], values[kept])


def add_test(name, sample):
    def test(self):
        row, = (row for row in self.formats if row["name"] == name)
        self.check(row, sample)
    setattr(ReadFormats, f"test_{name}_has_what_the_table_says_of_{sample}", test)


for each_format in READERS:
    for each_sample in SAMPLES:
        add_test(each_format, each_sample)


if __name__ == "__main__":
    SampleTest.write_samples = sys.argv.pop(1)
    unittest.main()
