"""Scenes meshed by the tetstream command: in its own process and on a server.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_scene_test.py [unittest options]
"""

import filecmp
import json
import math
import pathlib
import unittest

from command_case import REFUSED, CommandTest, ServerTest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "docs" / "scenes"
BALL = {"nodes": [{"sphere": {"radius": 1}}]}
TORUS_WITHOUT_A_TUBE = {"nodes": [{"torus": {"major_radius": 1}}]}
GYROID = {"nodes": [{"gyroid": {"period": 1}}]}


class SceneTest(CommandTest):
    volumes = {}

    def write_scene(self, scene):
        path = self.inputs / "scene.json"
        path.write_text(scene if isinstance(scene, str) else json.dumps(scene))
        return path

    def refuse(self, scene, *words, options=()):
        self.write_scene(scene)
        self.assert_fails(self.mesh("scene.json", ".vtu", *options), REFUSED, *words)


class Scenes(SceneTest):
    def report(self, scene, *options):
        report = self.out / "report.json"
        self.assert_done(self.tetstream(
            "mesh", scene, "-o", self.out / "mesh.vtu", "--report", report, *options))
        return json.loads(report.read_text())

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
        for path in sorted(EXAMPLES.glob("*.json")):
            with self.subTest(path.name):
                report = self.report(path, "--spacing", "0.06")
                self.assertGreaterEqual(report["min_dihedral_deg"], 11.2)
                self.assertLessEqual(report["max_dihedral_deg"], 154.9)
                if path.stem in euler:
                    self.assertEqual(
                        report["boundary"]["euler_characteristic"], euler[path.stem])

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
        self.refuse(BALL, "no grids", options=("--grid", "a"))
        self.refuse(BALL, "--spacing", options=("--voxel", "1"))
        self.refuse(BALL, "iso 1 is for grids", options=("--iso", "1"))

    def test_refuses_a_file_that_is_not_there(self):
        self.assert_fails(self.mesh("none.json"), REFUSED, "none.json", "No such file")


class ScenesOnAServer(ServerTest, SceneTest):
    def test_gives_the_same_bytes_as_this_process(self):
        for ways in (("--server", self.address), ("--server", self.address, "--compact")):
            here, there = self.out / "here.vtu", self.out / "there.vtu"
            for path, server in ((here, ()), (there, ways)):
                self.assert_done(self.tetstream(
                    "mesh", EXAMPLES / "bracket.json", "-o", path, "--spacing", "0.05",
                    *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ways)

    def test_refusals_are_those_of_this_process(self):
        for scene, words in ((TORUS_WITHOUT_A_TUBE, "nodes[0].torus.minor_radius 0 is not"),
                             (GYROID, "nodes[0].gyroid has no end")):
            self.refuse(scene, words, options=("--server", self.address))


if __name__ == "__main__":
    unittest.main()
