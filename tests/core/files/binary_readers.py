"""Readers of XDMF, Exodus and polyMesh that know nothing of tetstream."""

import re
import struct
import xml.etree.ElementTree as ElementTree

import h5py
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOExodus import vtkExodusIIReader

from samples import LABELS, Read


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
    assert mesh.find("Topology").get("TopologyType") == {4: "Tetrahedron", 10: "Tetrahedron_10"}[tets.shape[1]]
    assert int(mesh.find("Topology").get("NodesPerElement")) == tets.shape[1]
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
    assert facets.find("Topology").get("TopologyType") == {3: "Triangle", 6: "Triangle_6"}[triangles.shape[1]]
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
    points, fields, numbers, tets, labels = numpy.empty((count, 3)), {}, [], [], []

    def cells_of(grid):
        nodes = vtk_to_numpy(grid.GetPointData().GetArray("GlobalNodeId")) - 1
        offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
        assert len(set(numpy.diff(offsets))) == 1  # all have as many nodes
        return nodes[vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(len(offsets) - 1, -1)]

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
        numbers.append(vtk_to_numpy(block.GetCellData().GetArray("GlobalElementId")) - 1)
        tets.append(cells_of(block))
        labels.append(numpy.full(len(tets[-1]), LABELS[block_name]))
    faces = {name: cells_of(grid) for name, grid in exodus_objects(output, "Side Sets").items()}
    node_sets = {name: cells_of(grid)[:, 0] for name, grid in exodus_objects(output, "Node Sets").items()}
    assert set(node_sets) == set(faces)
    for name, triangles in faces.items():
        numpy.testing.assert_array_equal(numpy.sort(node_sets[name]), numpy.unique(triangles))
    numbers = numpy.concatenate(numbers)
    order = numpy.argsort(numbers)
    assert (numbers[order] == numpy.arange(len(order))).all()  # by the element number map
    stored = numpy.stack([netcdf_column(path, f"coord{axis}") for axis in "xyz"], 1)
    numpy.testing.assert_allclose(points, stored, rtol=1e-6)  # VTK rounds them to float32
    points = stored
    return Read(points, numpy.concatenate(tets)[order],
                None if list(blocks) == ["inside"] else numpy.concatenate(labels)[order], faces, fields)


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
    assert (numpy.lexsort((neighbour, owner[:inner])) == numpy.arange(inner)).all()
    assert (owner[:inner] < neighbour).all()
    # Each corner of a face is one of the cells on both sides. The last cell owns no face where it is not at the
    # boundary.
    sides = numpy.concatenate([owner, neighbour]).repeat(3).astype(numpy.int64)
    corners = numpy.concatenate([triangles, triangles[:inner]]).ravel()
    of_sides, of_cells = numpy.divmod(numpy.unique(sides * len(points) + corners), len(points))
    assert (of_sides == numpy.arange(sides.max() + 1).repeat(4)).all()
    cells = of_cells.reshape(-1, 4)
    text = foam_content(path / "boundary", "polyBoundaryMesh")[0].decode("ascii")
    faces, next_face = {}, inner
    for name, count, start in re.findall(r"(\w+)\n    \{\n\s+type\s+patch;\n\s+nFaces\s+(\d+);\n"
                                         r"\s+startFace\s+(\d+);", text):
        assert int(start) == next_face
        next_face += int(count)
        faces[name] = triangles[int(start):next_face]
    assert next_face == len(owner)
    labels = numpy.zeros(len(cells), dtype=int)
    zones = foam_zones(path / "cellZones")
    for name, (members,) in zones.items():
        labels[members] = LABELS[name]
    if (path / "faceZones").exists():
        for name, (members, flips) in foam_zones(path / "faceZones").items():
            turned = numpy.where(numpy.array(flips)[:, None] == 1, triangles[members][:, ::-1], triangles[members])
            faces[name] = turned
    return Read(points, cells, None if list(zones) == ["inside"] else labels, faces)
