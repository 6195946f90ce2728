"""`tetstream convert`, and surfaces that are meshed in passing: what they become, and what is said of it.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_convert_test.py [unittest options]
"""

import json
import pathlib
import re
import tempfile
import unittest

import numpy

from command_case import CUBE, LID, REFUSED, CommandTest


class Convert(CommandTest):
    def setUp(self):
        super().setUp()
        (self.inputs / "cube.obj").write_text(CUBE + LID)
        (self.inputs / "open.obj").write_text(CUBE)

    def convert(self, name, *arguments):
        return self.tetstream("convert", self.inputs / name, self.out / "made.vdb", *arguments)

    def test_makes_a_level_set_of_a_closed_surface(self):
        result = self.convert("cube.obj", "--voxel", "0.1")
        self.assert_done(result)
        self.assertIn("8 vertices, 12 triangles, closed", result.stdout)
        info = self.tetstream("info", self.out / "made.vdb", "--json")
        self.assertEqual(json.loads(info.stdout)[0]["class"], "level set")
        self.assertIn("12 triangles, closed", json.loads(info.stdout)[0]["made_of"])

    def test_follows_a_link_into_another_file_system(self):
        memory = pathlib.Path("/dev/shm")
        if not memory.is_dir() or memory.stat().st_dev == self.out.stat().st_dev:
            self.skipTest("there is one file system alone")
        with tempfile.TemporaryDirectory(dir=memory) as elsewhere:
            numpy.save(self.inputs / "ct.npy", numpy.arange(27, dtype=numpy.int16).reshape(3, 3, 3))
            for name, made in (("cube.obj", "made.vdb"), ("ct.npy", "made.nrrd")):
                target = pathlib.Path(elsewhere) / made
                (self.out / made).symlink_to(target)
                self.assert_done(self.tetstream("convert", self.inputs / name, self.out / made))
                self.assertTrue((self.out / made).is_symlink())
                self.assertTrue(target.is_file())
            self.assertEqual(len(list(pathlib.Path(elsewhere).iterdir())), 2)

    def test_refuses_a_surface_that_is_not_closed(self):
        self.assert_fails(self.convert("open.obj", "--voxel", "0.1"), REFUSED,
                          "4 open edges in 1 hole of up to 1.41", "--open close")

    def test_makes_of_an_open_surface_what_it_is_told_to(self):
        result = self.convert("open.obj", "--voxel", "0.1", "--open", "shell")
        self.assert_done(result)
        self.assertIn("made a shell two voxels thick", result.stdout)
        result = self.convert("open.obj", "--voxel", "0.1", "--open", "close")
        self.assert_done(result)
        self.assertIn("closed with caps as asked", result.stdout)
        mesh = self.mesh("open.obj", ".vtu", "--voxel", "0.1", "--open", "close",
                         "--report", self.out / "r.json")
        self.assert_done(mesh)
        surface = json.loads((self.out / "r.json").read_text())["surface"]
        self.assertEqual(surface["converted_to"], "closed solid")
        self.assertAlmostEqual(surface["converted_volume"], 1, delta=0.04)
        self.assertIn("4 open edges", surface["text"])

    def test_open_is_about_surfaces(self):
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", "--open", "close"), REFUSED, "--open")

    def test_the_report_compares_the_volume_of_a_surface(self):
        (self.inputs / "plates.obj").write_text(CUBE + LID + "".join(
            f"v {x} {y} {z + 1.015}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1)) +
            "f 9 11 12 10\nf 13 14 16 15\nf 9 10 14 13\nf 11 15 16 12\nf 9 13 15 11\nf 10 12 16 14\n")
        result = self.mesh("plates.obj", ".vtu", "--voxel", "0.099", "--report", self.out / "r.json")
        self.assert_done(result)
        surface = json.loads((self.out / "r.json").read_text())["surface"]
        self.assertAlmostEqual(surface["volume"], 2, delta=1e-6)
        self.assertGreater(surface["hidden_gaps"], 50)
        self.assertIn("pass between voxel centres", surface["warnings"][0])
        self.assertIn("warning: ", result.stderr)

    def test_any_size_survives_the_file(self):
        (self.inputs / "small.obj").write_text(re.sub(r"\b1\b", "1e-9", CUBE[:CUBE.index("f")]) +
                                               CUBE[CUBE.index("f"):] + LID)
        self.assert_done(self.convert("small.obj", "--voxel", "1e-10"))
        result = self.tetstream("mesh", self.out / "made.vdb", "-o", self.out / "m.vtu",
                                "--report", self.out / "r.json")
        self.assert_done(result)
        volume = json.loads((self.out / "r.json").read_text())["volume"]
        self.assertAlmostEqual(volume / 1e-27, 1, delta=0.01)

    def test_the_place_of_a_surface_reaches_the_file(self):
        (self.inputs / "utm.obj").write_text("".join(
            f"v {500000 + x} {5000000 + y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1)) +
            CUBE[CUBE.index("f"):] + LID)
        for voxel in ("0.05", None):
            # Of the voxel that it takes by itself the mesh need not be as fine.
            arguments = ["--voxel", voxel] if voxel else ["--spacing", "0.04"]
            result = self.mesh("utm.obj", ".vtu", *arguments, "--report", self.out / "r.json")
            self.assert_done(result)
            report = json.loads((self.out / "r.json").read_text())
            self.assertAlmostEqual(report["volume"], 1, delta=0.01)

    def test_takes_a_voxel_of_the_extent_by_128(self):
        result = self.convert("cube.obj")
        self.assert_done(result)
        self.assertIn("voxels of 0.0078125", result.stdout)

    def test_mesh_converts_in_passing_and_says_so(self):
        result = self.mesh(
            "cube.obj", ".vtu", "--voxel", "0.1", "--report", self.out / "r.json")
        self.assert_done(result)
        self.assertIn("12 triangles, closed", result.stderr)
        report = json.loads((self.out / "r.json").read_text())
        self.assertAlmostEqual(report["volume"], 1, delta=0.1)

    def test_refuses_what_is_no_surface(self):
        (self.inputs / "text.ply").write_text("hello")
        self.assert_fails(self.convert("text.ply"), REFUSED, "text.ply")
        self.assert_fails(self.convert("missing.stl"), REFUSED, "missing.stl")
        self.assert_fails(self.convert("sphere.vdb"), REFUSED, ".obj, .stl, .ply or .npy")

    def test_refuses_voxels_without_a_size(self):
        for voxel in ("0", "-1", "nan"):
            self.assert_fails(self.convert("cube.obj", "--voxel", voxel), REFUSED, voxel)

    def test_refuses_another_ending(self):
        result = self.tetstream("convert", self.inputs / "cube.obj", self.out / "made.vtu")
        self.assert_fails(result, REFUSED, ".vdb")


if __name__ == "__main__":
    unittest.main(verbosity=2)
