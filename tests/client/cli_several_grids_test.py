"""Meshes of several grids of one file by the tetstream command: in its own process, on a server,
and as jobs.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_several_grids_test.py [unittest options]
"""

import filecmp
import json
import unittest

import numpy

from command_case import ENDINGS, REFUSED, CommandTest, ServerTest, read_mesh
from job_case import JobTest

NAMES = ("ball", "ring", "cloud")
GRIDS = tuple(word for name in NAMES for word in ("--grid", name))
MESHABLE = ("ball", "ring", "cloud", "twin")


class SeveralGrids(CommandTest):
    volumes = {"parts": 0.1, "sphere": 0.1}

    def tets_alone(self, name, *options):
        self.assert_done(self.mesh("parts.vdb", ".vtu", "--grid", name, *options))
        return len(read_mesh(self.out / "mesh.vtu").cells[0].data)

    def test_are_labelled_in_files_of_every_format(self):
        counts = [self.tets_alone(name) for name in NAMES]
        for ending in ENDINGS:
            self.assert_done(self.mesh("parts.vdb", ending, *GRIDS))
        vtu, msh = (read_mesh(self.out / f"mesh{ending}") for ending in (".vtu", ".msh"))
        parts = vtu.cell_data["part"][0]
        numpy.testing.assert_array_equal(parts, numpy.repeat([1, 2, 3], counts))
        self.assertEqual({name: list(tag) for name, tag in msh.field_data.items()},
                         {name: [i + 1, 3] for i, name in enumerate(NAMES)} |
                         {f"{name}_surface": [i + 1, 2] for i, name in enumerate(NAMES)})
        numpy.testing.assert_array_equal(
            numpy.concatenate([tags for block, tags in zip(msh.cells, msh.cell_data["gmsh:physical"])
                               if block.type == "tetra"]), parts)
        for number, middle in ((1, (0, 0, 0)), (2, (3, 0.1, 0)), (3, (0.303, 3.131, 0.707))):
            corners = vtu.points[numpy.unique(vtu.cells[0].data[parts == number])]
            numpy.testing.assert_allclose(
                (corners.min(axis=0) + corners.max(axis=0)) / 2, middle, atol=0.02)

    def test_are_all_that_can_be_meshed_where_all_are_wanted(self):
        result = self.mesh("parts.vdb", ".vtu", "--all-grids", "--report", self.out / "r.json")
        self.assert_done(result)
        parts = json.loads((self.out / "r.json").read_text())["parts"]
        self.assertEqual([part["name"] for part in parts], list(MESHABLE))
        for part in parts:
            self.assertIn(f"{part['tets']} {part['name']}", result.stdout)
            self.assertGreater(part["volume"], 1)
        mesh = read_mesh(self.out / "mesh.vtu")
        self.assertEqual(set(mesh.cell_data["part"][0]), {1, 2, 3, 4})
        self.assert_done(self.mesh("sphere.vdb", ".vtu", "--all-grids"))
        self.assertEqual(set(read_mesh(self.out / "mesh.vtu").cell_data["part"][0]), {1})

    def test_go_with_what_else_a_request_says(self):
        options = ("--spacing", "0.2", "--levels", "0")
        counts = [self.tets_alone(name, *options) for name in NAMES]
        self.assert_done(self.mesh("parts.vdb", ".vtu", *GRIDS, *options, "--improve",
                                   "--field", "velocity"))
        mesh = read_mesh(self.out / "mesh.vtu")
        numpy.testing.assert_array_equal(
            mesh.cell_data["part"][0], numpy.repeat([1, 2, 3], counts))
        self.assertEqual(set(mesh.point_data), {"velocity"})

    def test_count_in_an_estimate(self):
        tets = []
        for options in (*(("--grid", name) for name in NAMES), GRIDS):
            result = self.tetstream("estimate", self.inputs / "parts.vdb", "--json", *options)
            self.assert_done(result)
            tets.append(json.loads(result.stdout)["tets"])
        self.assertEqual(tets[3], sum(tets[:3]))

    def test_are_refused_where_they_cannot_be(self):
        for options, *words in (
                (("--grid", "ball", "--grid", "bell"), "no grid 'bell'", "'ring'"),
                (("--grid", "ball", "--grid", "ball"), "--grid", "grid_names[0]"),
                (("--grid", "ball", "--grid", "velocity"), "velocity", "vec3s"),
                ((*GRIDS, "--preset", "both-sides"), "both-sides", "overlap"),
                (("--grid", "ball", "--grid", "ring", "--iso", "-0.6"), "nothing is inside",
                 "(grid 'ball')"),
                ((*GRIDS, "--iso", "-0.6"), "has no end", "(grid 'cloud')"),
                (("--all-grids", "--grid", "ball"), "--all-grids", "--grid"),
                ((*GRIDS, "--compact", "--server", "127.0.0.1:1"), "--compact")):
            with self.subTest(options):
                self.assert_fails(self.mesh("parts.vdb", ".vtu", *options), REFUSED, *words)


class SeveralGridsOnAServer(ServerTest):
    volumes = {"parts": 0.15}

    def test_are_the_same_bytes_as_in_this_process(self):
        for ending, options in ((".vtu", GRIDS), (".msh", ("--all-grids",)),
                                (".vtkhdf", (*GRIDS, "--improve", "--field", "velocity"))):
            here, there = self.out / f"here{ending}", self.out / f"there{ending}"
            for path, server in ((here, ()), (there, ("--server", self.address))):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / "parts.vdb", "-o", path, *options, *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), options)


class SeveralGridsOfJobs(JobTest):
    volumes = {"parts": 0.15}

    def test_are_the_same_bytes_as_in_this_process(self):
        manifest = self.out / "manifest"
        manifest.write_text(json.dumps(
            {"input": str(self.inputs / "parts.vdb"), "grid": list(NAMES)}))
        jobs = self.submit(self.inputs / "parts.vdb", *GRIDS) + self.submit("--manifest", manifest)
        for ending in ENDINGS:
            here, there = self.out / f"here{ending}", self.out / f"there{ending}"
            self.assert_done(
                self.tetstream("mesh", self.inputs / "parts.vdb", "-o", here, *GRIDS))
            for job in jobs:
                self.assert_done(self.job("fetch", job, "--wait", "-o", there))
                self.assertTrue(filecmp.cmp(here, there, shallow=False), there)


if __name__ == "__main__":
    unittest.main()
