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

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOExodus import vtkExodusIIReader

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


# ---- .exo ----

def netcdf_column(path, name):
    """A variable of floating-point numbers of a classic netCDF file with offsets of 64 bits."""
    content = path.read_bytes()
    assert content.startswith(b"CDF\2")
    place = content.index(struct.pack(">I", len(name)) + name.encode()) + 4 + (len(name) + 3) // 4 * 4
    dimensions, = struct.unpack_from(">I", content, place)
    place += 4 + 4 * dimensions
    assert content[place:place + 8] == bytes(8)  # no attributes
    kind, size, offset = struct.unpack_from(">IIQ", content, place + 8)
    dtype = {5: ">f4", 6: ">f8"}[kind]
    return numpy.frombuffer(content, dtype, size // numpy.dtype(dtype).itemsize, offset)


def exodus_objects(output, kind):
    """The grids of one kind by their names."""
    for i in range(output.GetNumberOfBlocks()):
        block = output.GetBlock(i)
        if output.GetMetaData(i).Get(output.NAME()) == kind and block is not None:
            return {block.GetMetaData(k).Get(block.NAME()): block.GetBlock(k)
                    for k in range(block.GetNumberOfBlocks())}
    return {}


def read_exodus(path):
    reader = vtkExodusIIReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for kind in (reader.ELEM_BLOCK, reader.SIDE_SET, reader.NODE_SET):
        for i in range(reader.GetNumberOfObjects(kind)):
            reader.SetObjectStatus(kind, i, 1)
    reader.SetAllArrayStatus(reader.NODAL, 1)
    reader.GenerateGlobalNodeIdArrayOn()
    reader.GenerateGlobalElementIdArrayOn()
    reader.Update()
    output = reader.GetOutput()
    blocks = exodus_objects(output, "Element Blocks")
    count = max(vtk_to_numpy(block.GetPointData().GetArray("GlobalNodeId")).max() for block in blocks.values())
    points, fields, tets, labels = numpy.empty((count, 3)), {}, {}, {}
    names = {"inside": 1, "outside": 2, "femur__left_": 1, "a_b__c____d": 2}

    def cells_of(grid, corners):
        nodes = vtk_to_numpy(grid.GetPointData().GetArray("GlobalNodeId")) - 1
        return nodes[vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, corners)]

    for block_name, block in blocks.items():
        data = block.GetPointData()
        nodes = vtk_to_numpy(data.GetArray("GlobalNodeId")) - 1
        points[nodes] = vtk_to_numpy(block.GetPoints().GetData())
        for i in range(data.GetNumberOfArrays()):
            values = vtk_to_numpy(data.GetArray(i))
            name = data.GetArrayName(i)
            if name not in ("GlobalNodeId", "PedigreeNodeId"):
                # Of x_x, x_y and x_z VTK makes the vector x_.
                name = name[:-1] if values.ndim == 2 else name
                fields.setdefault(name, numpy.empty((count, *values.shape[1:])))[nodes] = values
        numbers = vtk_to_numpy(block.GetCellData().GetArray("GlobalElementId")) - 1
        tets.update(zip(numbers, cells_of(block, 4)))
        labels.update(dict.fromkeys(numbers, names[block_name]))
    faces = {name: cells_of(grid, 3) for name, grid in exodus_objects(output, "Side Sets").items()}
    assert {name: sorted(cells_of(grid, 1)[:, 0]) for name, grid in
            exodus_objects(output, "Node Sets").items()} == {
                name: sorted(set(triangles.ravel())) for name, triangles in faces.items()}
    order = sorted(tets)
    assert order == list(range(len(order)))  # by the element number map
    stored = numpy.stack([netcdf_column(path, f"coord{axis}") for axis in "xyz"], 1)
    numpy.testing.assert_allclose(points, stored, rtol=1e-6)  # VTK rounds them to float32
    points = stored
    return Read(points, numpy.array([tets[i] for i in order]),
                None if list(blocks) == ["inside"] else numpy.array([labels[i] for i in order]), faces, fields)


# ---- polyMesh ----

def foam_content(path, of_class):
    """What follows the header."""
    header, _, content = path.read_bytes().partition(b"}\n")
    assert f"class       {of_class};".encode() in header, header
    return content.lstrip(b"\n"), b"binary" in header


def foam_list(content, dtype):
    """A binary list, and what follows it."""
    count, _, rest = content.partition(b"\n(")
    values = numpy.frombuffer(rest, dtype=dtype, count=int(count))
    assert rest[values.nbytes:values.nbytes + 2] == b")\n"
    return values, rest[values.nbytes + 2:]


def foam_zones(path):
    """Lists of numbers by the names of zones."""
    content, is_binary = foam_content(path, "regIOobject")
    assert not is_binary
    text = content.decode("ascii")
    return {name: [[int(n) for n in numbers.split()] for numbers in
                   re.findall(r"List<\w+>\n\d+\n\(\n([\d\n]*)\)", body)]
            for name, body in re.findall(r"^    (\w+)\n    \{\n(.*?)^    \}", text, re.MULTILINE | re.DOTALL)}


def read_polymesh(path):
    points, rest = foam_list(foam_content(path / "points", "vectorField")[0], "(3,)<f8")
    assert rest == b""
    first, rest = foam_list(foam_content(path / "faces", "faceCompactList")[0], "<i4")
    corners, rest = foam_list(rest, "<i4")
    assert rest == b"" and (first == 3 * numpy.arange(len(first))).all()
    triangles = corners.reshape(-1, 3)
    owner, _ = foam_list(foam_content(path / "owner", "labelList")[0], "<i4")
    neighbour, _ = foam_list(foam_content(path / "neighbour", "labelList")[0], "<i4")
    inner = len(neighbour)
    pairs = list(zip(owner[:inner], neighbour))
    assert pairs == sorted(pairs) and (owner[:inner] < neighbour).all()
    cells = [set() for _ in range(owner.max() + 1)]
    for triangle, *sides in zip(triangles, owner, [*neighbour, *[None] * (len(owner) - inner)]):
        for cell in sides:
            if cell is not None:
                cells[cell].update(triangle.tolist())
    text = foam_content(path / "boundary", "polyBoundaryMesh")[0].decode("ascii")
    faces, next_face = {}, inner
    for name, count, start in re.findall(r"(\w+)\n    \{\n\s+type\s+patch;\n\s+nFaces\s+(\d+);\n"
                                         r"\s+startFace\s+(\d+);", text):
        assert int(start) == next_face
        next_face += int(count)
        faces[name] = triangles[int(start):next_face]
    assert next_face == len(owner)
    labels = numpy.zeros(len(cells), dtype=int)
    names = {"inside": 1, "outside": 2, "femur__left_": 1, "a_b__c____d": 2}
    zones = foam_zones(path / "cellZones")
    for name, (members,) in zones.items():
        labels[members] = names[name]
    if (path / "faceZones").exists():
        for name, (members, flips) in foam_zones(path / "faceZones").items():
            turned = numpy.where(numpy.array(flips)[:, None] == 1, triangles[members][:, ::-1], triangles[members])
            faces[name] = turned
    return Read(points, [sorted(cell) for cell in cells], None if list(zones) == ["inside"] else labels, faces)


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


READERS = {"msh": read_msh, "inp": read_inp, "xdmf": read_xdmf, "exodus": read_exodus, "polymesh": read_polymesh,
           "stl": read_stl, "ply": read_ply, "obj": read_obj}
# How each calls things; the others as the mesh does.
NAMES = {"exodus": plain, "polymesh": plain, "msh": lambda name: name.replace('"', "'"), "inp": plain, "obj": plain, "stl": lambda name: ""}
FIELD_NAMES = {"ply": plain, "exodus": plain}
# Of those that have cells by their faces, corners come in no order.
UNORDERED = {"polymesh"}
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
        if row["name"] in UNORDERED:
            numpy.testing.assert_array_equal(read.tets, numpy.sort(expected["tets"], axis=1))
        else:
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
