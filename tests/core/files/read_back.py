"""Reads the VTK files that write_samples makes with other people's readers: the same counts,
coordinates and ids, and positive volumes.

    read_back.py path/to/write_samples
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import meshio
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from samples import PART_NAMES, SAMPLES, SECOND_SAMPLES, SampleTest, volumes

# Samples of labels that have no tags of their own, in VTK's formats; and the names that labels have.
LABEL_SAMPLES = {"labels": numpy.float32, "large_labels": numpy.float32}
LABEL_NAMES = {"labels": {'bone "left"': -3, "<grey> & white": 11175},
               "large_labels": {'bone "left"': 3_000_000_000, "<grey> & white": 11175},
               "tissues": {"bone": 4, "fat/skin": 9}}


def read_vtu_with_meshio(path):
    mesh = meshio.read(path)
    assert [block.type for block in mesh.cells] in (["tetra"], ["tetra10"]), mesh.cells
    assert set(mesh.cell_data) < {"region", "part", "label"}, mesh.cell_data
    labels = next(iter(mesh.cell_data.values()), [None])[0]
    if "part" in mesh.cell_data:
        assert {name: list(number) for name, number in mesh.field_data.items()} == {
            name: [i + 1] for i, name in enumerate(PART_NAMES)}, mesh.field_data
    if "label" in mesh.cell_data:
        assert {name: int(number[0]) for name, number in mesh.field_data.items()} \
            == LABEL_NAMES[path.stem], mesh.field_data
    return mesh.points, mesh.cells[0].data, labels, mesh.point_data


def read_with_vtk(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    assert reader.GetErrorCode() == 0
    kind, = set(vtk_to_numpy(grid.GetCellTypesArray()))
    nodes = {VTK_TETRA: 4, VTK_QUADRATIC_TETRA: 10}[kind]
    points = vtk_to_numpy(grid.GetPoints().GetData())
    cells = grid.GetCells()
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    assert (offsets == nodes * numpy.arange(grid.GetNumberOfCells() + 1)).all()
    data = grid.GetCellData()
    labels = data.GetArray("region") or data.GetArray("part") or data.GetArray("label")
    assert data.GetNumberOfArrays() == (labels is not None)
    return (points, vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, nodes),
            None if labels is None else vtk_to_numpy(labels), point_data_of(grid))


def point_data_of(grid):
    data = grid.GetPointData()
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    return {array.GetName(): vtk_to_numpy(array) for array in arrays}


class ReadBack(SampleTest):
    def check_every_sample(self, ending, read):
        for name, coordinates in {**SAMPLES, **SECOND_SAMPLES, **LABEL_SAMPLES}.items():
            with self.subTest(name=name, ending=ending):
                expected = self.expected(name)
                points, tets, regions, fields = read(self.directory / f"{name}{ending}")
                self.assertEqual(points.dtype, coordinates)
                numpy.testing.assert_array_equal(points, expected["points"].astype(points.dtype))
                numpy.testing.assert_array_equal(tets, expected["tets"])
                if regions is None:
                    self.assertEqual(len(expected["labels"]), 0)
                else:
                    numpy.testing.assert_array_equal(regions, expected["labels"])
                self.assertGreater(volumes(points, tets).min(), 0.1)
                self.check_fields(fields, expected["fields"])

    def check_fields(self, fields, expected):
        self.assertEqual(set(fields), set(expected))
        for name, values in expected.items():
            self.assertEqual(fields[name].dtype, numpy.float32)
            numpy.testing.assert_array_equal(fields[name], values)

    def test_meshio_reads_vtu(self):
        self.check_every_sample(".vtu", read_vtu_with_meshio)

    def test_vtk_reads_vtu(self):
        self.check_every_sample(
            ".vtu", lambda path: read_with_vtk(vtkXMLUnstructuredGridReader(), path)
        )

    def test_vtk_reads_vtkhdf(self):
        self.check_every_sample(
            ".vtkhdf", lambda path: read_with_vtk(vtkHDFReader(), path)
        )

    def test_vtkhdf_says_its_version_and_counts(self):
        with h5py.File(self.directory / "near.vtkhdf") as file:
            group = file["VTKHDF"]
            self.assertEqual(list(group.attrs["Version"]), [1, 0])
            self.assertEqual(group.attrs["Type"], b"UnstructuredGrid")
            self.assertEqual(list(group["NumberOfPoints"]), [7**3])
            self.assertEqual(list(group["NumberOfCells"]), [6 * 6**3])
            self.assertEqual(list(group["NumberOfConnectivityIds"]), [24 * 6**3])
            self.assertNotIn("CellData", group)

    def test_fields_are_what_a_viewer_shows_first(self):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.directory / "fields.vtu"))
        reader.Update()
        data = reader.GetOutput().GetPointData()
        self.assertEqual(data.GetScalars().GetName(), "heat")
        self.assertEqual(data.GetVectors().GetName(), "flow <x> & co")

    def test_regions_are_bytes_and_what_a_viewer_colours_by(self):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.directory / "sides.vtu"))
        reader.Update()
        scalars = reader.GetOutput().GetCellData().GetScalars()
        self.assertEqual(scalars.GetName(), "region")
        self.assertEqual(vtk_to_numpy(scalars).dtype, numpy.uint8)
        with h5py.File(self.directory / "sides.vtkhdf") as file:
            self.assertEqual(file["VTKHDF/CellData/region"].dtype, numpy.uint8)

    def test_parts_are_bytes_and_their_numbers_have_the_names_of_grids(self):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.directory / "parts.vtu"))
        reader.Update()
        grid = reader.GetOutput()
        self.assertEqual(grid.GetCellData().GetScalars().GetName(), "part")
        self.assertEqual(vtk_to_numpy(grid.GetCellData().GetScalars()).dtype, numpy.uint8)
        for i, name in enumerate(PART_NAMES):
            self.assertEqual(list(vtk_to_numpy(grid.GetFieldData().GetArray(name))), [i + 1])
        with h5py.File(self.directory / "parts.vtkhdf") as file:
            group = file["VTKHDF"]
            self.assertEqual(group["CellData/part"].dtype, numpy.uint8)
            self.assertEqual({name: list(number) for name, number in group["FieldData"].items()},
                             {name.replace("/", "_"): [i + 1]
                              for i, name in enumerate(PART_NAMES)})

    def test_the_same_mesh_is_the_same_bytes(self):
        with tempfile.TemporaryDirectory() as again:
            subprocess.run([self.write_samples, again], check=True)
            for path in sorted(self.directory.rglob("*")):  # some meshes are folders
                other = pathlib.Path(again) / path.relative_to(self.directory)
                if path.is_file():
                    self.assertEqual(path.read_bytes(), other.read_bytes(), path.name)


if __name__ == "__main__":
    SampleTest.write_samples = sys.argv.pop(1)
    unittest.main(verbosity=2)
