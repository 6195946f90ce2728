"""Meshes with a sizing by the tetstream command: in its own process and on a server.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_sizing_test.py [unittest options]
"""

import filecmp
import json
import pathlib
import unittest

from command_case import REFUSED, CommandTest, ServerTest

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
BRACKET = DOCS / "scenes" / "bracket.json"


class Sizings(CommandTest):
    def tets(self, *options):
        report = self.out / "report.json"
        self.assert_done(self.mesh("sphere.vdb", ".vtu", "--report", report, *options))
        return json.loads(report.read_text())["tets"]

    def refuse(self, sizing, *words):
        self.assert_fails(
            self.mesh("sphere.vdb", ".vtu", "--sizing", sizing), REFUSED, *words)

    def test_lets_tets_be_smaller_inside(self):
        plain, uniform = self.tets(), self.tets("--levels", "0")
        slow = self.tets("--sizing", '{"growth": 0.25}')
        self.assertLess(plain, slow)
        self.assertLess(slow, uniform)
        self.assertEqual(self.tets("--sizing", '{"coarsest": 0.05}'), uniform)

    def test_takes_every_example(self):
        for path in sorted((DOCS / "sizings").glob("*.json")):
            with self.subTest(path.name):
                report = self.out / "report.json"
                self.assert_done(self.tetstream(
                    "mesh", BRACKET, "-o", self.out / "mesh.vtu", "--spacing", "0.05",
                    "--sizing", path, "--report", report))
                graded = json.loads(path.read_text()).get("grade_surface", False)
                self.assertGreaterEqual(json.loads(report.read_text())["min_dihedral_deg"],
                                        5 if graded else 11.2)

    def test_takes_a_grid_of_sizes(self):
        """The level set itself is one: beyond its band 0.15."""
        coarse = self.tets("--sizing", '{"coarsest": 0.15}')
        by_grid = self.tets("--sizing", '{"grid": {}}')
        self.assertEqual(by_grid, coarse)
        self.assertEqual(by_grid, self.tets("--sizing-grid", self.inputs / "sphere.vdb"))

    def test_refuses_a_grid_of_sizes_in_a_scene(self):
        self.assert_fails(
            self.tetstream("mesh", BRACKET, "-o", self.out / "a.vtu", "--sizing", '{"grid": {}}'),
            REFUSED, "bracket.json has no grids", "--sizing-grid")

    def test_refuses_with_the_field(self):
        self.refuse('{"growth": 2}', "--sizing: growth 2 is not from 0.0625 to 1")
        self.refuse('{"coarsest": 0.01}', "sizing.coarsest 0.01 is below the spacing 0.05")
        self.refuse('{"grade_surface": true}', "coarsest must be set where grade_surface is")
        self.refuse('{"regions": [{"size": 0.1, "ball": {"radius": "NaN"}}]}',
                    "regions[0].ball.radius nan")

    def test_refuses_what_is_no_sizing(self):
        self.refuse('{"grwoth": 2}', "is not a sizing", "grwoth")
        self.refuse(self.inputs / "none.json", "none.json", "No such file")


class EstimatesTest(CommandTest):
    def estimate(self, *options):
        result = self.tetstream(
            "estimate", self.inputs / "sphere.vdb", "--json", *options)
        self.assert_done(result)
        return json.loads(result.stdout)


class Estimates(EstimatesTest):
    def test_counts_are_those_of_the_mesh(self):
        for options in ((), ("--levels", "0"), ("--preset", "both-sides"),
                        ("--sizing", '{"growth": 0.3}', "--spacing", "0.03")):
            with self.subTest(options):
                report = self.out / "report.json"
                self.assert_done(self.mesh("sphere.vdb", ".vtu", "--report", report, *options))
                made, estimated = json.loads(report.read_text()), self.estimate(*options)
                self.assertEqual(estimated["tets"], made["tets"])
                self.assertEqual(estimated["vertices"], made["vertices"])
                per_tet = 17 if "both-sides" in options else 16
                self.assertEqual(
                    estimated["bytes"], 12 * made["vertices"] + per_tet * made["tets"])
                self.assertGreater(estimated["fill_seconds"], 0)

    def test_says_so_in_a_line(self):
        result = self.tetstream("estimate", self.inputs / "sphere.vdb")
        self.assert_done(result)
        self.assertRegex(result.stdout, r"vertices, \d+ tets, [\d.]+ MB; counted in [\d.]+ s")

    def test_refuses_what_mesh_refuses(self):
        self.assert_fails(
            self.tetstream("estimate", self.inputs / "sphere.vdb", "--sizing", '{"growth": 2}'),
            REFUSED, "growth 2 is not from")


class EstimatesOnAServer(ServerTest, EstimatesTest):
    def test_counts_are_those_of_this_process(self):
        here = self.estimate("--sizing", '{"growth": 0.3}')
        there = self.estimate("--sizing", '{"growth": 0.3}', "--server", self.address)
        for count in ("vertices", "tets", "bytes"):
            self.assertEqual(here[count], there[count])


class SizingsOnAServer(ServerTest):
    def test_takes_a_grid_of_sizes(self):
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        for path, server in ((here, ()), (there, ("--server", self.address))):
            self.assert_done(self.tetstream(
                "mesh", BRACKET, "-o", path, "--spacing", "0.05", "--sizing-grid",
                self.inputs / "sphere.vdb", *server))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))

    def test_gives_the_same_bytes_as_this_process(self):
        for ways in (("--server", self.address), ("--server", self.address, "--compact")):
            here, there = self.out / "here.vtu", self.out / "there.vtu"
            for path, server in ((here, ()), (there, ways)):
                self.assert_done(self.tetstream(
                    "mesh", BRACKET, "-o", path, "--spacing", "0.05",
                    "--sizing", DOCS / "sizings" / "bracket.json", *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ways)

    def test_grades_the_surface_alike(self):
        sizing = ('{"coarsest": 0.2, "grade_surface": true,'
                  ' "regions": [{"size": 0.05, "ball": {"radius": 0.5}}]}')
        here, there, estimated = (self.out / name for name in ("h.vtu", "t.vtu", "report.json"))
        command = ("mesh", BRACKET, "--spacing", "0.05", "--sizing", sizing)
        self.assert_done(self.tetstream(*command, "-o", here, "--report", estimated))
        self.assert_done(self.tetstream(*command, "-o", there, "--server", self.address))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))
        self.assertGreaterEqual(json.loads(estimated.read_text())["min_dihedral_deg"], 5)
        for path in (here, there, estimated):
            path.unlink()
        self.assert_fails(
            self.tetstream(*command, "-o", there, "--server", self.address, "--compact"),
            REFUSED, "--compact", "grade_surface")


if __name__ == "__main__":
    unittest.main()
