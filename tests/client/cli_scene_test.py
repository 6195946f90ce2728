"""Scenes meshed by the tetstream command: in its own process and on a server.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_scene_test.py [unittest options]
"""

import filecmp
import hashlib
import json
import math
import pathlib
import shutil
import unittest

from command_case import REFUSED, CommandTest, ServerTest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "docs" / "scenes"
BALL = {"nodes": [{"sphere": {"radius": 1}}]}
TORUS_WITHOUT_A_TUBE = {"nodes": [{"torus": {"major_radius": 1}}]}
GYROID = {"nodes": [{"gyroid": {"period": 1}}]}


def bored(name, **grid):
    """A grid with a hole through it."""
    return {"nodes": [{"name": "scan", "grid": {"name": str(name), **grid}},
                      {"name": "rod", "cylinder": {"radius": 0.4, "height": 3}},
                      {"difference": {"of": ["scan", "rod"]}}]}


def grown(name, by):
    return {"nodes": [{"name": "scan", "grid": {"name": name}},
                      {"offset": {"of": "scan", "distance": by}}]}


class SceneTest(CommandTest):
    volumes = {}

    def write_scene(self, scene):
        path = self.inputs / "scene.json"
        path.write_text(scene if isinstance(scene, str) else json.dumps(scene))
        return path

    def refuse(self, scene, *words, options=()):
        self.write_scene(scene)
        self.assert_fails(self.mesh("scene.json", ".vtu", *options), REFUSED, *words)


    def report(self, scene, *options, **process):
        report = self.out / "report.json"
        self.assert_done(self.tetstream(
            "mesh", scene, "-o", self.out / "mesh.vtu", "--report", report, *options, **process))
        return json.loads(report.read_text())


class Scenes(SceneTest):
    def test_meshes_a_ball_by_a_128th_of_its_extent(self):
        report = self.report(self.write_scene(BALL))
        self.assertAlmostEqual(report["spacing"], 2 / 128)
        self.assertAlmostEqual(report["volume"], 4 / 3 * math.pi, delta=1e-3)
        self.assertEqual(report["boundary"]["euler_characteristic"], 2)

    def test_takes_field_names_in_camel_case_too(self):
        camel = {"nodes": [{"roundedBox": {"size": [1, 2, 3], "rounding": 0}}]}
        self.assertAlmostEqual(
            self.report(self.write_scene(camel), "--spacing", "0.1")["volume"], 6, delta=0.06)

    def test_meshes_every_example(self):
        """The genus tells that holes and pins are where they should be."""
        euler = {"bracket": -8, "heat_sink": 2, "link": 0}
        endless = {"gyroid_block"}
        for path in sorted(EXAMPLES.glob("*.json")):
            if path.stem in endless:
                continue
            with self.subTest(path.name):
                report = self.report(path, "--spacing", "0.08")
                self.assertGreaterEqual(report["min_dihedral_deg"], 11.2)
                self.assertLessEqual(report["max_dihedral_deg"], 154.9)
                if path.stem in euler:
                    self.assertEqual(
                        report["boundary"]["euler_characteristic"], euler[path.stem])

    def test_meshes_an_example_without_an_end_in_a_box(self):
        path = EXAMPLES / "gyroid_block.json"
        self.assert_fails(self.mesh(path, ".vtu", "--spacing", "0.0625"), REFUSED, "has no end")
        one, two = (self.report(path, "--spacing", "0.0625", "--box", *box.split())
                    for box in ("0 0 0 1 1 1", "0 0 0 2 1 1"))
        self.assertAlmostEqual(two["volume"], 2 * one["volume"], delta=0.001)
        for report in (one, two):
            self.assertGreaterEqual(report["min_dihedral_deg"], 4)
            self.assertLessEqual(report["max_dihedral_deg"], 175)

    def test_meshes_both_sides(self):
        report = self.report(self.write_scene(GYROID), "--preset", "both-sides", "--spacing",
                             "0.05", "--box", *"-.8 -.8 -.8 .8 .8 .8".split())
        self.assertAlmostEqual(report["volume"], 1.6**3, delta=0.03 * 1.6**3)
        self.assertAlmostEqual(
            report["regions"]["inside"]["volume"] / report["volume"], 0.5, delta=0.01)

    def test_refuses_sizes_with_the_field(self):
        self.refuse(TORUS_WITHOUT_A_TUBE, "scene.json: nodes[0].torus.minor_radius 0 is not")
        self.refuse('{"nodes": [{"sphere": {"radius": "NaN"}}]}', "nodes[0].sphere.radius nan")
        self.refuse({"nodes": [{"rounded_box": {"size": [1, 2]}}]},
                    "nodes[0].rounded_box.size has 2 numbers, not 3")

    def test_refuses_what_is_no_scene(self):
        self.refuse("{", "scene.json: ", "not a scene")
        self.refuse({"nodes": [{"sphere": {"radus": 1}}]}, "radus")
        self.refuse({"nodes": [{"icosahedron": {}}]}, "icosahedron")
        self.refuse({}, "nodes is empty")

    def test_refuses_what_has_no_end(self):
        self.refuse(GYROID, "nodes[0].gyroid has no end", options=("--spacing", "0.1"))

    def test_refuses_too_much_at_once(self):
        self.refuse(BALL, "lie near the surface", options=("--spacing", "1e-5"))
        self.refuse(BALL, "the scene reaches 1e+15 spacings", options=("--spacing", "1e-15"))

    def test_refuses_options_for_grids(self):
        self.refuse(BALL, "a scene names its grids itself", options=("--grid", "a"))
        self.refuse(BALL, "--spacing", options=("--voxel", "1"))
        self.refuse(BALL, "iso 1 is for grids", options=("--iso", "1"))

    def test_refuses_a_file_that_is_not_there(self):
        self.assert_fails(self.mesh("none.json"), REFUSED, "none.json", "No such file")


class ScenesOfGrids(SceneTest):
    volumes = {"sphere": 0.05, "vec3": 0.2}

    def test_bores_a_hole_through_a_grid(self):
        for options in ((), ("--trust",)):
            report = self.report(self.write_scene(bored("sphere.vdb")), "--spacing", "0.04", *options)
            self.assertEqual(report["boundary"]["euler_characteristic"], 0)
            ring = 4 / 3 * math.pi * (1 - 0.4**2)**1.5
            self.assertAlmostEqual(report["volume"], ring, delta=0.01 * ring)

    def test_looks_for_grids_beside_the_scene_and_then_here(self):
        """The example asks for a bunny that scripts/demo makes here: a ball will do."""
        bunny = self.out / "build" / "demo" / "bunny.vdb"
        bunny.parent.mkdir(parents=True)
        shutil.copy(self.inputs / "sphere.vdb", bunny)
        report = self.report(EXAMPLES / "scans" / "bored_bunny.json", "--spacing", "0.06",
                             cwd=self.out)
        self.assertEqual(report["boundary"]["components"], 1)
        self.assertGreaterEqual(report["min_dihedral_deg"], 11.2)

    def test_takes_another_iso_value(self):
        smaller = self.report(self.write_scene(bored("sphere.vdb", iso=-0.1)), "--spacing", "0.04")
        ring = 4 / 3 * math.pi * (0.9**2 - 0.4**2)**1.5
        self.assertAlmostEqual(smaller["volume"], ring, delta=0.01 * ring)

    def test_refuses_grids_that_cannot_be_leaves(self):
        self.refuse(bored("none.vdb"), "there is no file 'none.vdb'")
        self.refuse(bored("part.obj"), 'nodes[0].grid.name "part.obj" is no .vdb file')
        self.refuse(bored("grids/" + "0" * 64), "is for --server")
        self.refuse(bored("sphere.vdb", grid_name="density"), "density")
        self.refuse(bored("vec3.vdb"), "vec3")
        self.refuse(bored("sphere.vdb", iso="NaN"), "nodes[0].grid.iso nan")
        self.refuse(bored("sphere.vdb", iso=7), "nodes[0].grid has no surface at iso 7")
        self.refuse(grown("sphere.vdb", 0.2), "nodes[0].grid knows distances from -0.15 to 0.15")
        self.refuse({"nodes": [
            *({"name": str(i), "grid": {"name": f"{i}.vdb"}} for i in range(17)),
            {"union": {"of": [str(i) for i in range(17)]}}]}, "the limit is 16")


class ScenesOnAServer(ServerTest, SceneTest):
    volumes = {"sphere": 0.05}

    def test_grids_of_scenes_give_the_same_bytes_as_this_process(self):
        scene = self.write_scene(bored("sphere.vdb"))
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        self.assert_done(self.tetstream("mesh", scene, "-o", here))
        stored = "grids/" + hashlib.sha256((self.inputs / "sphere.vdb").read_bytes()).hexdigest()
        for name in ("sphere.vdb", stored):
            for encoding in ((), ("--compact",)):
                self.assert_done(self.tetstream(
                    "mesh", self.write_scene(bored(name)), "-o", there,
                    "--server", self.address, *encoding))
                self.assertTrue(filecmp.cmp(here, there, shallow=False), encoding)

    def test_refuses_a_grid_that_is_not_stored(self):
        self.write_scene(bored("grids/" + "0" * 64))
        self.assert_fails(self.mesh("scene.json", ".vtu", "--server", self.address), REFUSED,
                          "grids/0000", "is not stored")

    def test_gives_the_same_bytes_as_this_process(self):
        for ways in (("--server", self.address), ("--server", self.address, "--compact")):
            here, there = self.out / "here.vtu", self.out / "there.vtu"
            for path, server in ((here, ()), (there, ways)):
                self.assert_done(self.tetstream(
                    "mesh", EXAMPLES / "bracket.json", "-o", path, "--spacing", "0.05",
                    *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ways)

    def test_refusals_are_those_of_this_process(self):
        for scene, words in ((grown("sphere.vdb", 0.2), "nodes[0].grid knows distances from -0.15"),
                             (TORUS_WITHOUT_A_TUBE, "nodes[0].torus.minor_radius 0 is not"),
                             (GYROID, "nodes[0].gyroid has no end")):
            self.refuse(scene, words, options=("--server", self.address))


if __name__ == "__main__":
    unittest.main()
