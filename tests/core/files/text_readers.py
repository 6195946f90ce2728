"""Readers of the formats that are text, and of .msh, that know nothing of tetstream."""

import re

import meshio
import numpy

from samples import LABELS, Read


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
# Where a C3D10 has the middle of each edge.
INP_MIDDLES = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}


def inp_face(nodes, side):
    """Its corners, and of ten nodes the middles from each to the next."""
    corners = INP_FACES[side]
    middles = [INP_MIDDLES[min(a, b), max(a, b)] for a, b in zip(corners, (*corners[1:], corners[0]))]
    return [nodes[k] for k in (corners if len(nodes) == 4 else (*corners, *middles))]


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
            for number, *nodes in rows:
                assert parameters["TYPE"] == f"C3D{len(nodes)}"
                assert number not in elements
                elements[int(number)] = [int(node) - 1 for node in nodes]
            sets[parameters["ELSET"]] = [int(row[0]) - 1 for row in rows]
        elif keyword == "ELSET":
            assert parameters == {"ELSET": "Eall"} and [row[0] for row in rows] == list(sets)
        elif keyword == "SURFACE":
            assert parameters["TYPE"] == "ELEMENT"
            faces[parameters["NAME"]] = [
                inp_face(elements[int(number)], side) for number, side in rows]
        elif keyword == "NSET":
            node_sets[parameters["NSET"]] = [int(row[0]) - 1 for row in rows]
        else:
            assert keyword == "HEADING", keyword
    assert sorted(elements) == list(range(1, len(elements) + 1))
    assert node_sets == {name: sorted(set(numpy.ravel(triangles).tolist()))
                         for name, triangles in faces.items()}
    tets = numpy.array([elements[number] for number in sorted(elements)])
    labels = numpy.zeros(len(tets), dtype=int)
    for name, members in sets.items():
        labels[members] = LABELS[name]
    return Read(points, tets, None if list(sets) == ["inside"] else labels, faces)


# ---- .mesh ----

def read_mfem(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "MFEM mesh v1.0"
    names = {kind: {int(number): name for number, name in
                    re.findall(rf"^# {kind} (\d+): (.*)$", "\n".join(lines), re.MULTILINE)}
             for kind in ("attribute", "boundary attribute")}
    words = iter(" ".join(line for line in lines[1:] if not line.startswith("#")).split())

    def rows(section, kind, corners):
        assert next(words) == section
        rows = [[int(next(words)) for _ in range(2 + corners)] for _ in range(int(next(words)))]
        assert {row[1] for row in rows} == {kind}
        return numpy.array(rows)

    assert [next(words), next(words)] == ["dimension", "3"]
    tets, triangles = rows("elements", 4, 4), rows("boundary", 2, 3)
    assert next(words) == "vertices"
    count = int(next(words))
    assert next(words) == "3"
    points = numpy.array([float(next(words)) for _ in range(3 * count)]).reshape(-1, 3)
    assert next(words, None) is None
    return Read(points, tets[:, 2:], tets[:, 0] if len(names["attribute"]) > 1 else None,
                {name: triangles[triangles[:, 0] == number, 2:]
                 for number, name in names["boundary attribute"].items()})


# ---- .usda ----

def usd_list(text, name, width):
    found, = re.findall(rf"^ *{re.escape(name)} = \[(.*?)\]", text, re.MULTILINE | re.DOTALL)
    numbers = [float(word) for word in re.sub(r"[(),]", " ", found).split()]
    return numpy.array(numbers).reshape(-1, width) if width > 1 else numpy.array(numbers)


def read_usd(path):
    text = path.read_text(encoding="ascii")
    assert text.startswith("#usda 1.0\n") and "def TetMesh" in text
    assert text.count("{") == text.count("}") and text.count("[") == text.count("]")
    place, = re.findall(r"double3 xformOp:translate = \((.*), (.*), (.*)\)", text)
    points = usd_list(text, "point3f[] points", 3)
    least, most = usd_list(text, "float3[] extent", 3)
    assert (least <= points.min(axis=0) + 1e-5).all() and (most >= points.max(axis=0) - 1e-5).all()
    points = points + [float(word) for word in place]
    tets = usd_list(text, "int4[] tetVertexIndices", 4).astype(int)
    triangles = usd_list(text, "int3[] surfaceFaceVertexIndices", 3).astype(int)
    faces, labels, fields = {}, numpy.zeros(len(tets), dtype=int), {}
    subsets = re.findall(r'def GeomSubset "(\w+)"\n    \{\n(.*?)\n    \}', text, re.DOTALL)
    for name, body in subsets:
        members = usd_list(body, "int[] indices", 1).astype(int)
        if 'elementType = "tetrahedron"' in body:
            labels[members] = LABELS[name]
        else:
            assert 'elementType = "face"' in body
            faces[name] = triangles[members]
    for kind, name in re.findall(r"^    (\w+)\[\] primvars:(\w+) = ", text, re.MULTILINE):
        fields[name] = usd_list(text, f"{kind}[] primvars:{name}", {"float": 1, "vector3f": 3}[kind])
    has_labels = [name for name, _ in subsets if name in LABELS] != ["inside"]
    return Read(points, tets, labels if has_labels else None, faces, fields)


# ---- .msh ----

def read_msh(path):
    mesh = meshio.read(path)
    names = {(dimension, tag): name for name, (tag, dimension) in mesh.field_data.items()}
    tags = mesh.cell_data["gmsh:physical"]
    tets, labels, faces = [], [], {}
    for block, tag in zip(mesh.cells, tags):
        assert len(set(tag)) == 1
        if block.type in ("tetra", "tetra10"):
            tets.append(block.data)
            labels.append(tag)
        else:
            faces[names[2, tag[0]]] = block.data
    volumes_named = [name for (dimension, _), name in names.items() if dimension == 3]
    fields = {name: values for name, values in mesh.point_data.items() if not name.startswith("gmsh:")}
    return Read(mesh.points, numpy.concatenate(tets),
                numpy.concatenate(labels) if len(volumes_named) > 1 else None, faces, fields)
