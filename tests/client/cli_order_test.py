"""Meshes of second order by the tetstream command, read by others.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_order_test.py [unittest options]
"""

import filecmp
import json
import math
import unittest

import numpy

from command_case import REFUSED, USAGE, CommandTest, ServerTest, read_mesh

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
ORDER = ("--spacing", "0.2", "--order", "2")
SIZES = ("--sizing", '{"grid": {}}')


def volume_of(points, tets):
    """By a rule of four points, exact for quadratics: close to that of the cubic Jacobian."""
    a, b = 0.58541020, 0.13819660
    total = 0
    for at in range(4):
        shares = numpy.full(4, b)
        shares[at] = a
        # How the ten functions change along each share; the first corner's share follows.
        slopes = numpy.zeros((10, 4))
        for i in range(4):
            slopes[i, i] = 4 * shares[i] - 1
        for e, (i, j) in enumerate(EDGES):
            slopes[4 + e, i] = 4 * shares[j]
            slopes[4 + e, j] = 4 * shares[i]
        along = slopes[:, 1:] - slopes[:, :1]
        jacobian = numpy.einsum("tnx,nk->txk", points[tets], along)
        total += numpy.linalg.det(jacobian).sum() / 24
    return total


class SecondOrder(CommandTest):
    volumes = {"sphere": 0.05}

    def test_is_read_as_quadratic_tets_that_are_nearer_to_the_ball(self):
        exact, error = 4 / 3 * math.pi, {}
        for order in ("1", "2"):
            report = self.out / "report.json"
            self.assert_done(self.mesh("sphere.vdb", ".vtu", "--spacing", "0.2", "--order", order,
                                       "--report", report))
            told = json.loads(report.read_text())
            error[order] = abs(told["volume"] - exact)
        error["2"] = abs(told["second_order"]["volume"] - exact)
        self.assertLess(error["2"], error["1"] / 5)  # voxels are flat between each other
        self.assertGreaterEqual(told["second_order"]["least_jacobian_share"], 0.199)
        mesh = read_mesh(self.out / "mesh.vtu")
        self.assertEqual([block.type for block in mesh.cells], ["tetra10"])
        self.assertEqual(len(mesh.points), told["second_order"]["nodes"])
        self.assertAlmostEqual(volume_of(mesh.points, mesh.cells[0].data),
                               told["second_order"]["volume"], delta=1e-4)

    def test_is_the_same_in_both_formats(self):
        self.assert_done(self.mesh("sphere.vdb", ".vtu", *ORDER))
        self.assert_done(self.mesh("sphere.vdb", ".msh", *ORDER))
        vtu, msh = read_mesh(self.out / "mesh.vtu"), read_mesh(self.out / "mesh.msh")
        numpy.testing.assert_allclose(vtu.points, msh.points, atol=1e-6)
        # meshio brings Gmsh's order of nodes into VTK's.
        numpy.testing.assert_array_equal(vtu.cells_dict["tetra10"], msh.cells_dict["tetra10"])

    def test_has_curved_triangles_and_flat_ones_where_a_box_cuts(self):
        self.assert_done(self.mesh("sphere.vdb", ".msh", *ORDER, "--box", *"0 -2 -2 2 2 2".split()))
        mesh = read_mesh(self.out / "mesh.msh")
        tag = mesh.field_data["cut_x_min"][0]
        for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
            if block.type == "triangle6":
                flat = mesh.points[block.data[tags == tag]][..., 0]
                self.assertTrue((abs(flat) < 1e-6).all())

    def test_goes_with_a_grid_of_sizes(self):
        self.assert_done(self.mesh("sphere.vdb", ".vtu", *ORDER, *SIZES))
        self.assertEqual([block.type for block in read_mesh(self.out / "mesh.vtu").cells], ["tetra10"])

    def test_has_the_same_bytes_for_any_number_of_threads(self):
        for threads in ("1", "3"):
            self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o",
                                            self.out / f"{threads}.vtu", *ORDER, "--threads",
                                            threads))
        self.assertTrue(filecmp.cmp(self.out / "1.vtu", self.out / "3.vtu", shallow=False))

    def test_is_refused_where_there_is_no_place_for_it(self):
        self.assert_fails(self.mesh("sphere.vdb", ".mesh", "--order", "2"), REFUSED, "--order",
                          ".vtu", ".exo")
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", "--order", "3"), USAGE, "--order")
        self.assert_nothing_written()


class SecondOrderOnAServer(ServerTest):
    volumes = {"sphere": 0.05}

    def test_is_that_of_a_mesh_made_here(self):
        for sizes in ((), SIZES):
            for path, options in (("here.vtu", ()), ("served.vtu", ("--server", self.address))):
                self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o",
                                                self.out / path, *ORDER, *sizes, *options))
            self.assertTrue(filecmp.cmp(self.out / "here.vtu", self.out / "served.vtu", shallow=False),
                            sizes)


if __name__ == "__main__":
    unittest.main()
