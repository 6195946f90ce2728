"""Readers of the formats that are text, and of .msh, that know nothing of tetstream."""

import itertools
import re
import warnings

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


def numbers_in(text, kind, separator=" "):
    """All of the text's numbers, and it has nothing else. numpy reads on to what it does not understand, and warns."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return numpy.fromstring(text, dtype=kind, sep=separator)


def table(lines, kind, separator=","):
    """The numbers of lines that have equally many, as rows."""
    width = lines[0].count(separator) + 1
    assert all(line.count(separator) == width - 1 for line in lines)
    numbers = numbers_in(separator.join(lines), kind, separator)
    assert len(numbers) == len(lines) * width
    return numbers.reshape(-1, width)


def inp_columns(side, nodes):
    """Which of an element's nodes a face has: its corners, and of ten nodes the middles from each to the next."""
    corners = INP_FACES[side]
    middles = [INP_MIDDLES[min(a, b), max(a, b)] for a, b in zip(corners, (*corners[1:], corners[0]))]
    return list(corners if nodes == 4 else (*corners, *middles))


def inp_faces(lines, tets):
    """Of lines that name an element and a side of it."""
    pairs = [line.split(",") for line in lines]
    of_faces = tets[[int(number) - 1 for number, _ in pairs]]
    columns = {side: inp_columns(side, tets.shape[1]) for side in INP_FACES}
    return numpy.take_along_axis(of_faces, numpy.array([columns[side.strip()] for _, side in pairs]), axis=1)


def read_inp(path):
    points, elements, surfaces, node_sets = [], {}, {}, {}
    for keyword, parameters, lines in inp_sections(path):
        if keyword == "NODE":
            assert parameters == {"NSET": "Nall"}
            words = ",".join(lines).split(",")
            assert max(map(len, map(str.strip, words))) <= 20
            rows = table(lines, float)
            assert (rows[:, 0] == numpy.arange(1, len(rows) + 1)).all()
            points = rows[:, 1:]
        elif keyword == "ELEMENT":
            rows = table(lines, int)
            assert parameters["TYPE"] == f"C3D{rows.shape[1] - 1}"
            assert parameters["ELSET"] not in elements
            elements[parameters["ELSET"]] = rows
        elif keyword == "ELSET":
            assert parameters == {"ELSET": "Eall"} and [line.strip() for line in lines] == list(elements)
        elif keyword == "SURFACE":
            assert parameters["TYPE"] == "ELEMENT"
            surfaces[parameters["NAME"]] = lines
        elif keyword == "NSET":
            node_sets[parameters["NSET"]] = table(lines, int)[:, 0] - 1
        else:
            assert keyword == "HEADING", keyword
    rows = numpy.concatenate(list(elements.values()))
    labels = numpy.concatenate([numpy.full(len(members), LABELS[name]) for name, members in elements.items()])
    order = numpy.argsort(rows[:, 0])
    assert (rows[order, 0] == numpy.arange(1, len(rows) + 1)).all()
    tets = rows[order, 1:] - 1
    faces = {name: inp_faces(lines, tets) for name, lines in surfaces.items()}
    assert list(node_sets) == list(faces)
    for name, triangles in faces.items():
        numpy.testing.assert_array_equal(node_sets[name], numpy.unique(triangles))
    return Read(points, tets, None if list(elements) == ["inside"] else labels[order], faces)


# ---- .mesh ----

def read_mfem(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "MFEM mesh v1.0"
    names = {kind: {int(number): name for number, name in
                    re.findall(rf"^# {kind} (\d+): (.*)$", "\n".join(lines), re.MULTILINE)}
             for kind in ("attribute", "boundary attribute")}
    words = iter(" ".join(line for line in lines[1:] if not line.startswith("#")).split())

    def numbers(kind, rows, width):
        return numbers_in(" ".join(itertools.islice(words, rows * width)), kind).reshape(rows, width)

    def rows(section, kind, corners):
        assert next(words) == section
        rows = numbers(int, int(next(words)), 2 + corners)
        assert (rows[:, 1] == kind).all()
        return rows

    assert [next(words), next(words)] == ["dimension", "3"]
    tets, triangles = rows("elements", 4, 4), rows("boundary", 2, 3)
    assert next(words) == "vertices"
    count = int(next(words))
    assert next(words) == "3"
    points = numbers(float, count, 3)
    assert next(words, None) is None
    return Read(points, tets[:, 2:], tets[:, 0] if len(names["attribute"]) > 1 else None,
                {name: triangles[triangles[:, 0] == number, 2:]
                 for number, name in names["boundary attribute"].items()})


# ---- .usda ----

USD_MARKS = str.maketrans("(),", "   ")

def usd_list(text, name, width):
    """The numbers of the only list of that name, which stands first in its line."""
    begin, = (found.end() for found in re.finditer(re.escape(f"{name} = ["), text)
              if not text[text.rfind("\n", 0, found.start()) + 1:found.start()].strip(" "))
    numbers = numbers_in(text[begin:text.index("]", begin)].translate(USD_MARKS), float)
    return numbers.reshape(-1, width) if width > 1 else numbers


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
