"""Runs tetstream mesh for faces: named triangles in a .msh, the same here, from a server and from a job.

    TETSTREAM_BIN=build/release/bin python3 cli_faces_test.py
"""

import filecmp
import json
import pathlib
import unittest

import numpy

from command_case import REFUSED, CommandTest, ServerTest, read_mesh
from job_case import JobTest

HALF = ("--box", "0", "-2", "-2", "2", "2", "2")


def triangles_by_name(path):
    """{name: (n, 3) points of the triangles' corners, one after the other}"""
    mesh = read_mesh(path)
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


BRACKET = pathlib.Path(__file__).resolve().parents[2] / "docs" / "scenes" / "bracket.json"
BORE = ("--face", "bore=cylinder:0,0,-0.15,0,0,1.05,0.45")


class Regions(CommandTest):
    def bracket(self, *options, ending=".msh"):
        return self.tetstream("mesh", BRACKET, "-o", self.out / f"mesh{ending}", "--spacing", "0.1", *options)

    def test_of_a_node_and_of_places_are_physical_surfaces(self):
        result = self.bracket("--face", "bore=node:bore", "--face", "bottom=facing:0,0,-1,30/halfspace:0,0,1,-0.15",
                              "--report", self.out / "r.json")
        self.assert_done(result)
        triangles = triangles_by_name(self.out / "mesh.msh")
        self.assertEqual(set(triangles), {"surface", "bore", "bottom"})
        radius = numpy.linalg.norm(triangles["bore"][:, :, :2], axis=2)
        self.assertLess(abs(radius - 0.4).max(), 0.06)
        self.assertTrue((triangles["bottom"][:, :, 2] < -0.1).all())
        self.assertGreater(len(triangles["bore"]), 100)
        counts = json.loads((self.out / "r.json").read_text())["faces"]
        self.assertEqual(counts, {name: len(found) for name, found in triangles.items()})
        self.assertIn(f"faces: {counts['bore']} bore, {counts['bottom']} bottom", result.stdout)
        self.assertEqual(result.stderr, "")

    def test_come_from_a_json_file_as_from_options(self):
        regions = self.out / "regions.json"
        regions.write_text(json.dumps({"regions": [
            {"name": "bore", "cylinder": {"start": [0, 0, -0.15], "end": [0, 0, 1.05], "radius": 0.45}},
            {"name": "left", "nearest": {"points": [-2, 0, 0]}}, {"name": "right", "nearest": {"points": [2, 0, 0]}}]}))
        written = []
        for options in (("--face", regions), ("--face", regions.read_text()),
                        (*BORE, "--face", "left=nearest:-2,0,0", "--face", "right=nearest:2,0,0")):
            self.assert_done(self.bracket(*options))
            written.append((self.out / "mesh.msh").read_bytes())
        self.assertEqual(set(triangles_by_name(self.out / "mesh.msh")), {"bore", "left", "right"})
        self.assertEqual(len(set(written)), 1)

    def test_are_divided_at_creases(self):
        result = self.tetstream("mesh", BRACKET, "-o", self.out / "mesh.msh", "--spacing", "0.05",
                                "--face", "bore=node:bore", "--face", "side=creases:35", "--report", self.out / "r.json")
        self.assert_done(result)
        triangles = triangles_by_name(self.out / "mesh.msh")
        sides = [name for name in triangles if name.startswith("side")]
        self.assertEqual(set(triangles), {"bore", *sides})
        self.assertGreaterEqual(len(sides), 11)
        self.assertEqual(sorted(sides)[0], "side.1")
        # Of all that is not the bore, the lower side is flat, and each of the four holes is one.
        self.assertTrue(any((abs(triangles[name][:, :, 2] + 0.2) < 0.05).all() and len(triangles[name]) > 5000
                            for name in sides))
        holes = [name for name in sides if
                 (abs(numpy.linalg.norm(abs(triangles[name][:, :, :2]) - (1.6, 0.6), axis=2) - 0.2) < 0.03).all()]
        self.assertEqual([len(triangles[name]) > 500 for name in holes], [True] * 4)
        counts = json.loads((self.out / "r.json").read_text())["faces"]
        self.assertEqual({name: count for name, count in counts.items() if count > 0},
                         {name: len(found) for name, found in triangles.items()})
        self.assertEqual(result.stderr, "")

    def test_that_took_no_face_are_warned_of(self):
        result = self.bracket("--face", "nowhere=ball:9,9,9,1", "--report", self.out / "r.json")
        self.assert_done(result)
        self.assertIn("warning: no face is in region 'nowhere'", result.stderr)
        self.assertIn("the mesh lies between (-2", result.stderr)
        report = json.loads((self.out / "r.json").read_text())
        self.assertEqual(report["faces"]["nowhere"], 0)
        self.assertEqual(len(report["face_warnings"]), 1)

    def test_that_cannot_be_are_refused_before_any_work(self):
        for option, words in {
                "bore": ("--face bore: it takes a name",),
                "bore=tube:1,2": ('"tube" is no place', "cylinder"),
                "bore=ball:1,2,3": ("ball takes X,Y,Z,RADIUS, and here are 3 numbers",),
                "bore=ball:1,2,x,3": ('"x" is no number',),
                "bore=nearest:1,2,3,4": ("nearest takes", "4 numbers"),
                "bore=ball:0,0,0,1/ball:1,1,1,1": ("two places of the kind ball",),
                "bore=ball:0,0,0,-1": ("ball.radius -1 is not from",),
                "surface=ball:0,0,0,1": ("a name that faces have anyway",),
                "bore=node:": ("node takes the name",),
                "bore=creases:0": ("creases.angle_deg 0 is not from 1 to 180",),
                "bore=creases:20/creases:30": ("two places of the kind creases",),
                '{"regions": [{"name": "a"}]}': ("has no condition",),
                "missing.json": ("missing.json",)}.items():
            self.assert_fails(self.bracket("--face", option), REFUSED, *words)
        self.assert_fails(self.bracket("--face", "bore=node:boer"), REFUSED, 'node "boer" is no node', "bore")


class FacesOnAServer(ServerTest):
    volumes = {"sphere": 0.05}

    def test_of_regions_are_the_same_bytes(self):
        for name, options, encodings in (
                (BRACKET, ("--spacing", "0.1", "--face", "bore=node:bore", *BORE), ((), ("--packed",))),
                (BRACKET, ("--spacing", "0.1", "--face", "bore=node:bore", "--face", "side=creases:60"),
                 ((), ("--packed",))),
                (self.inputs / "sphere.vdb", ("--face", "top=facing:0,0,1,40"), ((), ("--packed",), ("--compact",)))):
            here, there = self.out / "here.msh", self.out / "there.msh"
            self.assert_done(self.tetstream("mesh", name, "-o", here, *options))
            for encoding in encodings:
                self.assert_done(self.tetstream("mesh", name, "-o", there, *options, *encoding,
                                                "--server", self.address))
                self.assertTrue(filecmp.cmp(here, there, shallow=False), (options, encoding))
        refused = self.tetstream("mesh", BRACKET, "-o", self.out / "no.msh", "--face", "bore=node:bore", "--compact",
                                 "--server", self.address)
        self.assertIn("ask for ENCODING_PACKED", refused.stderr)
        refused = self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", self.out / "no.msh", "--face",
                                 "side=creases:60", "--compact", "--server", self.address)
        self.assertIn("cannot carry face_regions[0].creases", refused.stderr)

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


TOP = ("--faces", "--face", "top=facing:0,0,1,40", "--face", "side=creases:60")


class FacesOfJobs(JobTest):
    volumes = {"sphere": 0.05}

    def test_are_the_same_bytes_as_in_this_process(self):
        job, = self.submit(self.inputs / "sphere.vdb", *TOP)
        here, there = self.out / "here.msh", self.out / "there.msh"
        self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", here, *TOP))
        self.assert_done(self.job("fetch", job, "--wait", "-o", there))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))


if __name__ == "__main__":
    unittest.main()
