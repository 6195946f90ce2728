"""Which side of a grid's surface the tetstream command takes for the inside, and what it says of it.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_inside_test.py [unittest options]
"""

import filecmp
import json
import math
import unittest

from command_case import REFUSED, USAGE, CommandTest, ServerTest
from job_case import JobTest

BALL = 4 / 3 * math.pi
BOX = ("--box", "-1.6", "-1.6", "-1.6", "1.6", "1.6", "1.6")


class Inside(CommandTest):
    volumes = {"scan": 0.1, "raw-density": 0.1, "inverted": 0.1, "fog": 0.1, "sphere": 0.1}

    def volume_of(self, name, *options):
        report = self.out / "r.json"
        result = self.mesh(name, ".vtu", "--report", report, *options)
        self.assert_done(result)
        self.report = json.loads(report.read_text())
        return self.report["volume"], result.stderr

    def test_of_a_scan_has_to_be_said(self):
        for options in ((), BOX, ("--preset", "both-sides")):
            self.assert_fails(self.mesh("scan.vdb", ".vtu", *options), REFUSED,
                              "inside must be set", "-1000 to 1000", "--inside")
        volume, said = self.volume_of("scan.vdb", "--inside", "above")
        self.assertAlmostEqual(volume, BALL, delta=0.05)
        self.assertNotIn("note", said)
        self.assertNotIn("inside_guess", self.report)
        whole, _ = self.volume_of("scan.vdb", "--inside", "below", *BOX)
        self.assertGreater(whole, 3.2**3 - BALL - 0.1)

    def test_of_a_density_with_a_voxel_below_zero_is_guessed_and_told(self):
        meant, _ = self.volume_of("fog.vdb")
        volume, said = self.volume_of("raw-density.vdb")
        self.assertAlmostEqual(volume, meant, delta=1e-9)
        self.assertRegex(said, r"note: grid 'raw-density' has no class, .*-1e-06 to 1 .*density")
        self.assertIn("above 0.5", self.report["inside_guess"])
        estimate = self.tetstream("estimate", self.inputs / "raw-density.vdb", "--json")
        self.assert_done(estimate)
        self.assertIn("density", json.loads(estimate.stdout)["inside_guess"])
        self.assertIn("note: ", estimate.stderr)

    def test_of_an_inverted_level_set_is_never_its_complement_in_silence(self):
        for options in (BOX, ("--preset", "both-sides"), ()):
            self.assert_fails(self.mesh("inverted.vdb", ".vtu", *options), REFUSED,
                              "the level set is inverted", "--inside")
        volume, _ = self.volume_of("inverted.vdb", "--inside", "above")
        self.assertAlmostEqual(volume, BALL, delta=0.05)

    def test_that_is_said_again_changes_nothing(self):
        self.assert_done(self.mesh("sphere.vdb", ".vtu"))
        self.assert_done(self.mesh("sphere.vdb", ".msh"))
        same = self.out / "same.vtu"
        self.assert_done(self.tetstream(
            "mesh", self.inputs / "sphere.vdb", "-o", same, "--inside", "below"))
        self.assertTrue(filecmp.cmp(self.out / "mesh.vtu", same, shallow=False))

    def test_that_is_nothing_tells_the_values_there_are(self):
        self.assert_fails(self.mesh("fog.vdb", ".vtu", "--iso", "2"), REFUSED,
                          "nothing is inside at iso 2", "from 0 to 1", "--inside")

    def test_is_above_or_below(self):
        self.assert_fails(self.mesh("fog.vdb", ".vtu", "--inside", "out"), USAGE, "--inside")

    def test_info_shows_values_and_side(self):
        for name, side, guessed in (("scan", "unclear", False), ("raw-density", "above", True),
                                    ("inverted", "below", False), ("fog", "above", False)):
            result = self.tetstream("info", self.inputs / f"{name}.vdb", "--json")
            self.assert_done(result)
            (grid,) = json.loads(result.stdout)
            self.assertEqual((grid["inside"], grid["inside_is_guessed"]), (side, guessed), name)
        result = self.tetstream("info", self.inputs / "scan.vdb")
        self.assertIn("-1000 to 1000", result.stdout)
        quick = self.tetstream("info", self.inputs / "scan.vdb", "--json", "--no-values")
        self.assertNotIn("values", json.loads(quick.stdout)[0])

    def test_of_a_grid_in_a_scene_is_said_there(self):
        def scene(**grid):
            path = self.inputs / "scene.json"
            nodes = [{"name": "a", "grid": {"name": "scan.vdb", **grid}}]
            path.write_text(json.dumps({"nodes": nodes}))
            return path.name
        self.assert_fails(self.mesh(scene(), ".vtu", "--spacing", "0.1"), REFUSED,
                          "nodes[0].grid.inside must be set")
        self.assert_fails(self.mesh(scene(inside="out"), ".vtu", "--spacing", "0.1"), REFUSED,
                          'grid.inside "out"')
        volume, _ = self.volume_of(scene(inside="above"), "--spacing", "0.1")
        self.assertAlmostEqual(volume, BALL, delta=0.05)
        self.out.joinpath("mesh.vtu").unlink()
        self.out.joinpath("r.json").unlink()
        self.assert_fails(self.mesh(scene(inside="above"), ".vtu", "--inside", "above"), REFUSED,
                          "--inside is for grids")


class InsideServed(ServerTest):
    volumes = {"scan": 0.1, "raw-density": 0.1, "inverted": 0.1}

    def test_is_the_same_as_in_process(self):
        for name, options in (("scan", ("--inside", "above")), ("raw-density", ()),
                              ("inverted", ("--inside", "above"))):
            reports = []
            for where in ((), ("--server", self.address), ("--server", self.address, "--compact")):
                report = self.out / "r.json"
                result = self.mesh(f"{name}.vdb", f"{len(reports)}.vtu", "--report", report,
                                   *options, *where)
                self.assert_done(result)
                reports.append(json.loads(report.read_text()))
                self.assertTrue(filecmp.cmp(self.out / "mesh0.vtu",
                                            self.out / f"mesh{len(reports) - 1}.vtu",
                                            shallow=False))
            for report in reports:
                self.assertEqual(report.get("inside_guess"), reports[0].get("inside_guess"))
            self.assertEqual("inside_guess" in reports[0], name == "raw-density")

    def test_that_nobody_says_is_refused(self):
        for options in ((), BOX):
            self.assert_fails(self.mesh("scan.vdb", ".vtu", "--server", self.address, *options),
                              REFUSED, "inside must be set")
        estimate = self.tetstream("estimate", self.inputs / "scan.vdb", "--server", self.address)
        self.assert_fails(estimate, REFUSED, "inside must be set")


class InsideOfJobs(JobTest):
    volumes = {"scan": 0.1, "inverted": 0.1, "raw-density": 0.1}

    def test_is_the_same_as_in_process(self):
        for name, options in (("scan", ("--inside", "above")), ("inverted", ("--inside", "above")),
                              ("raw-density", ())):
            source = self.inputs / f"{name}.vdb"
            here, there = self.out / f"{name}.here.vtu", self.out / f"{name}.there.vtu"
            self.assert_done(self.tetstream("mesh", source, "-o", here, *options))
            job, = self.submit(source, *options)
            fetched = self.job("fetch", job, "-o", there, "--wait")
            self.assert_done(fetched)
            self.assertEqual("has no class" in fetched.stderr, name == "raw-density")
            self.assertTrue(filecmp.cmp(here, there, shallow=False), name)

    def test_that_nobody_says_ends_the_job_and_says_so(self):
        job, = self.submit(self.inputs / "scan.vdb")
        self.assert_fails(self.job("fetch", job, "-o", self.out / "m.vtu", "--wait"), REFUSED,
                          "inside must be set")


if __name__ == "__main__":
    unittest.main(verbosity=2)
