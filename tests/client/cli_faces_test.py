"""Runs tetstream mesh for faces: named triangles in a .msh, the same here, from a server and from a job.

    TETSTREAM_BIN=build/release/bin python3 cli_faces_test.py
"""

import filecmp
import json
import unittest

import meshio
import numpy

from command_case import CommandTest, ServerTest
from job_case import JobTest

HALF = ("--box", "0", "-2", "-2", "2", "2", "2")


def triangles_by_name(path):
    """{name: (n, 3) points of the triangles' corners, one after the other}"""
    mesh = meshio.read(path)
    triangles = {}
    for name, (tag, dimension) in mesh.field_data.items():
        if dimension != 2:
            continue
        blocks = [block.data[tags == tag] for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"])
                  if block.type == "triangle"]
        triangles[name] = mesh.points[numpy.concatenate(blocks)]
    return triangles


def volume_within(triangles):
    a, b, c = (triangles[:, i] for i in range(3))
    return numpy.einsum("ij,ij->", numpy.cross(a, b), c) / 6


class Faces(CommandTest):
    volumes = {"sphere": 0.05, "parts": 0.1}

    def test_are_the_physical_surfaces_of_a_msh(self):
        self.assert_done(self.mesh("sphere.vdb", ".msh"))
        triangles = triangles_by_name(self.out / "mesh.msh")
        self.assertEqual(list(triangles), ["surface"])
        self.assertAlmostEqual(volume_within(triangles["surface"]), 4 / 3 * numpy.pi, delta=0.03)

    def test_of_a_cut_are_named_by_the_faces_of_the_box(self):
        self.assert_done(self.mesh("sphere.vdb", ".msh", *HALF))
        triangles = triangles_by_name(self.out / "mesh.msh")
        self.assertEqual(set(triangles), {"surface", "cut_x_min"})
        self.assertTrue((triangles["cut_x_min"][:, :, 0] == 0).all())
        whole = numpy.concatenate(list(triangles.values()))
        self.assertAlmostEqual(volume_within(whole), 2 / 3 * numpy.pi, delta=0.03)

    def test_of_both_sides_lie_between_them_and_at_the_box(self):
        self.assert_done(self.mesh("sphere.vdb", ".msh", "--preset", "both-sides", "--box",
                                   *"-1.5 -1.5 -1.5 1.5 1.5 1.5".split()))
        triangles = triangles_by_name(self.out / "mesh.msh")
        self.assertEqual(len(triangles), 7)
        self.assertAlmostEqual(volume_within(triangles.pop("interface")), 4 / 3 * numpy.pi, delta=0.03)
        low, high = -1.6, 1.6  # whole bricks of 8 spacings
        box = volume_within(numpy.concatenate(list(triangles.values())))
        self.assertAlmostEqual(box, (high - low) ** 3, places=3)

    def test_of_several_grids_are_named_by_them(self):
        self.assert_done(self.mesh("parts.vdb", ".msh", "--grid", "ball", "--grid", "ring"))
        self.assertEqual(set(triangles_by_name(self.out / "mesh.msh")), {"ball_surface", "ring_surface"})

    def test_are_told_in_a_report(self):
        self.assert_done(self.mesh("sphere.vdb", ".vtu", "--faces", *HALF, "--report", self.out / "r.json"))
        faces = json.loads((self.out / "r.json").read_text())["faces"]
        self.assertEqual({name for name, count in faces.items() if count > 0}, {"surface", "cut_x_min"})
        self.assertEqual(len(faces), 7)


class FacesOnAServer(ServerTest):
    volumes = {"sphere": 0.05}

    def test_are_the_same_bytes(self):
        for options in ((), ("--improve",), HALF, ("--preset", "both-sides")):
            here = self.out / "here.msh"
            self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", here, *options))
            encodings = ((), ("--packed",)) if HALF == options or options == ("--improve",) else (
                (), ("--packed",), ("--compact",))
            for encoding in encodings:
                there = self.out / "there.msh"
                self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", there, *options,
                                                *encoding, "--server", self.address))
                self.assertTrue(filecmp.cmp(here, there, shallow=False), (options, encoding))


class FacesOfJobs(JobTest):
    volumes = {"sphere": 0.05}

    def test_are_the_same_bytes_as_in_this_process(self):
        job, = self.submit(self.inputs / "sphere.vdb", "--faces")
        here, there = self.out / "here.msh", self.out / "there.msh"
        self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", here))
        self.assert_done(self.job("fetch", job, "--wait", "-o", there))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))


if __name__ == "__main__":
    unittest.main()
