"""What the table of formats says is in the files: each is read by a reader that knows nothing of tetstream.

    read_formats.py path/to/write_samples
"""

import sys
import unittest

import numpy

from binary_readers import read_exodus, read_polymesh, read_xdmf
from boundary_readers import read_obj, read_ply, read_stl
from samples import SAMPLES, SECOND_SAMPLES, SampleTest, plain, sorted_triangles, volumes
from text_readers import read_inp, read_mfem, read_msh, read_usd

READERS = {"msh": read_msh, "inp": read_inp, "xdmf": read_xdmf, "exodus": read_exodus, "polymesh": read_polymesh,
           "mfem": read_mfem, "usd": read_usd,
           "stl": read_stl, "ply": read_ply, "obj": read_obj}
# How each calls things; the others as the mesh does.
NAMES = {"exodus": plain, "usd": plain, "polymesh": plain, "msh": lambda name: name.replace('"', "'"), "inp": plain, "obj": plain, "stl": lambda name: ""}
FIELD_NAMES = {"ply": plain, "exodus": plain, "usd": plain}
# Of those that have cells by their faces, corners come in no order.
UNORDERED = {"polymesh"}
SECOND_ORDER = {"msh", "inp", "xdmf", "exodus"}
# Read by read_back.py.
VTK = {"vtu", "vtkhdf"}


def by_place(corners):
    """Triangles of points, in an order that does not depend on numbers."""
    points = numpy.asarray(corners, dtype=float).reshape(-1, 3).round(5)
    order = numpy.lexsort(points.T[::-1])
    place = numpy.zeros(len(points), dtype=int)
    place[order[1:]] = numpy.cumsum((points[order[1:]] != points[order[:-1]]).any(axis=1))
    first = place.reshape(-1, 3).argmin(axis=1)
    triangles = points.reshape(-1, 3, 3)
    turned = numpy.concatenate(
        [triangles[numpy.arange(len(triangles)), (first + k) % 3] for k in range(3)], axis=1)
    return turned[numpy.lexsort(turned.T)].reshape(-1, 3)


class ReadFormats(SampleTest):
    def test_each_row_of_the_table_has_a_reader(self):
        self.assertEqual({row["name"] for row in self.formats}, set(READERS) | VTK)
        self.assertEqual({row["name"] for row in self.formats if row["second_order"]}, SECOND_ORDER | VTK)

    def check(self, row, name):
        expected, wide = self.expected(name), {**SAMPLES, **SECOND_SAMPLES}[name] == numpy.float64
        read = READERS[row["name"]](self.directory / f"{name}{row['ending']}")
        points = expected["points"]
        if row["coordinates"].startswith(("float32", "text of at most")) and not (wide and "or float64" in row["coordinates"]):
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
            wanted.setdefault(NAMES.get(row["name"], str)(label), []).append(rows)
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
            kept = numpy.unique(numpy.concatenate(list(expected["faces"].values())))
        for name, values in wanted.items():
            numpy.testing.assert_array_equal(read.fields[name], values[kept])


def add_test(name, sample):
    def test(self):
        row, = (row for row in self.formats if row["name"] == name)
        self.check(row, sample)
    setattr(ReadFormats, f"test_{name}_has_what_the_table_says_of_{sample}", test)


for each_format in READERS:
    for each_sample in {**SAMPLES, **(SECOND_SAMPLES if each_format in SECOND_ORDER else {})}:
        add_test(each_format, each_sample)


if __name__ == "__main__":
    SampleTest.write_samples = sys.argv.pop(1)
    unittest.main()
