"""Cuts solids off at a box by the tetstream command, in its own process, on a server, and as jobs.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_cut_test.py [unittest options]
"""

import filecmp
import json
import math
import unittest

import numpy

from command_case import ENDINGS, REFUSED, CommandTest, ServerTest, read_mesh
from job_case import JobTest

HALF = ("--box", *"0 -2 -2 2 2 2".split())  # of a sphere of radius 1
IN_LOWER_X = 1  # the one face that cuts it


def area_of(mesh, triangles):
    a, b, c = (mesh.points[triangles[:, i]] for i in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2


class Cuts(CommandTest):
    volumes = {"sphere": 0.05}

    def test_leave_half_of_a_sphere(self):
        report = self.out / "report.json"
        self.assert_done(self.mesh("sphere.vdb", ".vtu", *HALF, "--report", report))
        told = json.loads(report.read_text())
        self.assertAlmostEqual(told["volume"], 2 / 3 * math.pi, delta=0.01)
        self.assertEqual(told["boundary"]["euler_characteristic"], 2)
        self.assertGreaterEqual(told["min_dihedral_deg"], 4)
        mesh = read_mesh(self.out / "mesh.vtu")
        in_face = mesh.point_data["cut_face"] == IN_LOWER_X
        self.assertTrue((mesh.points[in_face, 0] == 0).all())
        self.assertTrue((mesh.points[~in_face, 0] > 0).all())
        self.assertTrue((mesh.point_data["cut_face"][~in_face] == 0).all())

    def test_are_physical_surfaces_of_a_msh(self):
        self.assert_done(self.mesh("sphere.vdb", ".msh", *HALF))
        mesh = read_mesh(self.out / "mesh.msh")
        names = {name: tuple(tag) for name, tag in mesh.field_data.items()}
        self.assertEqual(
            {name: dimension for name, (_, dimension) in names.items()},
            {"inside": 3, "surface": 2, "cut_x_min": 2})
        area = {
            name: sum(area_of(mesh, block.data[tags == names[name][0]])
                      for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"])
                      if block.type == "triangle")
            for name in ("surface", "cut_x_min")}
        self.assertAlmostEqual(area["cut_x_min"], math.pi, delta=0.02)
        self.assertAlmostEqual(area["surface"], 2 * math.pi, delta=0.03)

    def test_are_refused_with_manifold_and_where_nothing_is(self):
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", *HALF, "--manifold"), REFUSED,
                          "manifold does not go with a box that cuts the inside")
        far = "5 5 5 6 6 6".split()
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", "--box", *far), REFUSED,
                          "nothing in the box is inside")


class CutsOnAServer(ServerTest):
    volumes = {"sphere": 0.05}

    def test_are_the_same_bytes(self):
        for ending in ENDINGS:
            here, there = self.out / f"here{ending}", self.out / f"there{ending}"
            for path, where in ((here, ()), (there, ("--server", self.address))):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / "sphere.vdb", "-o", path, *HALF, *where))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ending)


class CutsOfJobs(JobTest):
    volumes = {"sphere": 0.05}

    def test_are_the_same_bytes(self):
        job, = self.submit(self.inputs / "sphere.vdb", *HALF)
        for ending in ENDINGS:
            here, there = self.out / f"here{ending}", self.out / f"there{ending}"
            self.assert_done(
                self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", here, *HALF))
            self.assert_done(self.job("fetch", job, "--wait", "-o", there))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ending)


if __name__ == "__main__":
    unittest.main()
