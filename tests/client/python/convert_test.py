"""Meshes and volumes as other packages have them."""

import sys
import types

import numpy as np
import pytest

import tetstream as ts
from conftest import assert_same, make_ball


@pytest.fixture(scope="module")
def both_sides():
    return ts.mesh(make_ball(12), preset="both_sides", box=((-1.5,) * 3, (1.5,) * 3), faces=True,
                   fields={"distance": make_ball(8)})


def test_vtk_has_the_mesh_with_its_arrays(both_sides):
    arrays = pytest.importorskip("vtkmodules.util.numpy_support")
    grid = both_sides.to_vtk()
    assert np.array_equal(arrays.vtk_to_numpy(grid.GetPoints().GetData()), both_sides.points)
    connectivity = arrays.vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    assert np.array_equal(connectivity, both_sides.tets)
    assert set(arrays.vtk_to_numpy(grid.GetCellTypesArray())) == {10}
    assert np.array_equal(arrays.vtk_to_numpy(grid.GetPointData().GetArray("distance")), both_sides.fields["distance"])
    assert np.array_equal(arrays.vtk_to_numpy(grid.GetCellData().GetArray("region")), both_sides.regions)


def test_vtk_outlives_the_mesh():
    arrays = pytest.importorskip("vtkmodules.util.numpy_support")
    made = ts.mesh(ts.sphere(1), spacing=0.2)
    expected, grid = made.points.copy(), made.to_vtk()
    del made
    assert np.array_equal(arrays.vtk_to_numpy(grid.GetPoints().GetData()), expected)


def test_meshio_has_boundary_faces_with_their_labels(both_sides):
    pytest.importorskip("meshio")
    handed = both_sides.to_meshio()
    assert np.array_equal(handed.cells_dict["triangle"], both_sides.faces)
    names = [label.name for label in both_sides.header.face_labels]
    assert set(handed.cell_data_dict["face_label"]["triangle"]) <= set(range(1, len(names) + 1))
    assert (handed.cell_data_dict["face_label"]["tetra"] == 0).all()
    assert np.array_equal(handed.cell_data_dict["region"]["tetra"], both_sides.regions)


def test_labels_that_are_no_tags_of_dolfinx_are_refused():
    values = np.zeros((8, 8, 8), np.int64)
    values[2:4, 2:6, 2:6], values[4:6, 2:6, 2:6] = 3, 2**40 + 3  # of which 32 bits are 3, too
    made = ts.mesh(ts.Labels.from_array(values), labels=(3, 2**40 + 3))
    for handed in (made, ts.stream(ts.Labels.from_array(values), labels=(3, 2**40 + 3))):
        with pytest.raises(ts.FailedPreconditionError, match="label 1099511627779 is no tag"):
            handed.to_dolfinx(None, tags=True)


def test_what_is_masked_or_complex_is_refused():
    values = np.ma.masked_greater(np.arange(64.0).reshape(4, 4, 4), 60)
    corners = np.ma.masked_equal(np.eye(4, 3), 1)
    for take in (lambda: ts.Volume.from_array(values, spacing=1),
                 lambda: ts.Volume.from_mask(values > 3, spacing=1),
                 lambda: ts.Labels.from_array(values.astype(int)),
                 lambda: ts.sample(ts.sphere(1), corners),
                 lambda: ts.Volume.from_triangles(corners, [[0, 1, 2]], voxel_size=1)):
        with pytest.raises(ts.InvalidArgumentError, match="are masked, 3 of"):
            take()
    for take in (lambda: ts.Volume.from_array(values.data + 1j, spacing=1),
                 lambda: ts.Volume.from_triangles(corners.data * 1j, [[0, 1, 2]], voxel_size=1),
                 lambda: ts.sample(ts.sphere(1), corners.data * 1j)):
        with pytest.raises(ts.InvalidArgumentError, match="have complex128"):
            take()
    whole = np.ma.array(values.data - 30)  # nothing of it is masked
    assert_same(ts.mesh(ts.Volume.from_array(whole, spacing=1)), ts.mesh(ts.Volume.from_array(whole.data, spacing=1)))


def test_grids_of_pyopenvdb_are_volumes(ball, mesh, monkeypatch):
    module = types.ModuleType("pyopenvdb")  # which has to be nothing but able to write a file

    class FloatGrid:
        pass

    FloatGrid.__module__ = "pyopenvdb"
    module.write = lambda path, grids: ball.write_vdb(path)
    monkeypatch.setitem(sys.modules, "pyopenvdb", module)
    assert_same(ts.mesh(ts.Volume.from_openvdb(FloatGrid())), mesh)
    with pytest.raises(TypeError, match="pyopenvdb"):
        ts.Volume.from_openvdb(np.zeros(3))


def test_open_surfaces_are_what_one_says(tmp_path):
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    open_corner = [[0, 2, 1], [0, 1, 3], [0, 3, 2]]  # a face is missing
    with pytest.raises(ts.FailedPreconditionError, match="open"):
        ts.Volume.from_triangles(points, open_corner, voxel_size=0.05)
    closed = ts.Volume.from_triangles(points, open_corner, voxel_size=0.05, open="close")
    assert ts.mesh(closed).quality().volume == pytest.approx(1 / 6, abs=0.02)
    shell = ts.Volume.from_triangles(points, open_corner, voxel_size=0.05, open="shell")
    assert ts.mesh(shell).statistics.boundary.euler_characteristic == 2
    with pytest.raises(ts.InvalidArgumentError, match="open 'often'"):
        ts.Volume.from_triangles(points, open_corner, voxel_size=0.05, open="often")
