"""Level sets of one file, and parts of scenes, as labels of one mesh by the tetstream command.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_solid_labels_test.py [unittest options]
"""

import json
import unittest

import numpy

from command_case import REFUSED, CommandTest, ServerTest, read_mesh
from job_case import JobTest

PLANET = {"nodes": [
    {"name": "core", "sphere": {"radius": 0.5}},
    {"name": "mantle", "sphere": {"radius": 0.8}},
    {"name": "ground", "half_space": {"normal": [0, 0, 1], "offset": 0}},
    {"name": "whole", "sphere": {"radius": 1}},
    {"name": "crust", "intersection": {"of": ["whole", "ground"]}},
    {"name": "planet", "union": {"of": ["core", "mantle", "crust"]}}]}


def ball(radius):
    return 4 / 3 * numpy.pi * radius**3


class SolidCase(CommandTest):
    volumes = {"parts": 0.1}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.parts = cls.inputs / "parts.vdb"
        cls.planet = cls.inputs / "planet.json"
        cls.planet.write_text(json.dumps(PLANET))

    def mesh_solids(self, path, *options, ending=".vtu"):
        result = self.tetstream("mesh", path, "-o", self.out / f"mesh{ending}", *options)
        self.assert_done(result)
        return (self.out / f"mesh{ending}").read_bytes()

    def report(self, path, *options):
        report = self.out / "report.json"
        self.mesh_solids(path, "--report", report, *options)
        return json.loads(report.read_text())


class SolidLabels(SolidCase):
    def test_of_all_grids_are_called_like_them(self):
        labels = self.report(self.parts, "--all-grids", "--labels", "all")["labels"]
        self.assertEqual([(label["value"], label["name"]) for label in labels],
                         [(1, "ball"), (2, "ring"), (3, "cloud"), (4, "twin")])
        for label in labels[:3]:
            self.assertGreater(label["volume"], 1)
        mesh = read_mesh(self.out / "mesh.vtu")
        self.assertLessEqual(set(numpy.concatenate(mesh.cell_data["label"])), {1, 2, 3, 4})

    def test_are_chosen_and_named_as_any_labels(self):
        table = self.out / "names.json"
        table.write_text('{"2": "cloud of points"}')
        labels = self.report(self.parts, "--grid", "ball", "--grid", "cloud", "--labels", "2",
                             "--label-names", table)["labels"]
        self.assertEqual([(label["value"], label["name"]) for label in labels],
                         [(2, "cloud of points")])

    def test_of_a_scene_have_what_earlier_parts_leave(self):
        labels = self.report(self.planet, "--labels", "all", "--spacing", "0.04")["labels"]
        self.assertEqual([label["name"] for label in labels], ["core", "mantle", "crust"])
        for label, volume in zip(labels, (ball(0.5), ball(0.8) - ball(0.5), (ball(1) - ball(0.8)) / 2)):
            self.assertAlmostEqual(label["volume"], volume, delta=0.01 * volume)
            self.assertEqual(label["parts"], 1)

    def test_are_as_small_as_their_sizes_ask(self):
        options = ("--labels", "all", "--spacing", "0.05")
        plain = self.report(self.planet, *options, "--levels", "max")["labels"]
        sized = self.report(self.planet, *options, "--label-size", "1=0.05",
                            "--label-size", "2,3=1")["labels"]
        self.assertGreater(sized[0]["tets"], 1.5 * plain[0]["tets"])
        self.assertLess(sized[2]["tets"], 1.1 * plain[2]["tets"])
        result = self.tetstream("estimate", self.planet, *options, "--label-size", "1=0.05", "--json")
        self.assert_done(result)
        self.assertEqual(json.loads(result.stdout)["tets"], sum(label["tets"] for label in sized))

    def test_are_refused_with_what_to_do(self):
        for options, words in (
                (("--label-size", "1"), ("--label-size 1", "4,7:12=2.5")),
                (("--label-size", "1=0.001"), ("0.001", "spacing")),
                (("--label-size", "9=1"), ("9", "the scene has", "1, 2, 3")),
                (("--smooth", "1"), ("smooth",)),
                (("--iso", "1"), ("--iso",))):
            with self.subTest(options):
                result = self.tetstream("mesh", self.planet, "-o", self.out / "mesh.vtu", "--spacing", "0.1",
                                        "--labels", "all", *options)
                self.assert_fails(result, REFUSED, *words)

    def test_of_one_grid_of_distances_say_how(self):
        result = self.tetstream("mesh", self.parts, "-o", self.out / "mesh.vtu", "--grid", "ball",
                                "--labels", "all")
        self.assert_fails(result, REFUSED, "--all-grids")


class SolidLabelsServed(SolidCase, ServerTest):
    def test_are_the_same_bytes_as_here(self):
        for path, options in ((self.parts, ("--all-grids",)),
                              (self.parts, ("--grid", "ring", "--grid", "ball", "--background", "meshed")),
                              (self.planet, ("--spacing", "0.08", "--label-size", "all=0.2"))):
            options = (*options, "--labels", "all", "--faces")
            with self.subTest(options):
                here = self.mesh_solids(path, *options)
                for how in ((), ("--packed",)):
                    self.assertEqual(self.mesh_solids(path, *options, *how, "--server", self.address), here)


class SolidLabelsOfJobs(SolidCase, JobTest):
    volumes = {"parts": 0.1}

    def test_are_the_same_bytes_as_here(self):
        for path, options in ((self.parts, ("--grid", "ball", "--grid", "ring")),
                              (self.planet, ("--spacing", "0.08", "--label-size", "2=0.1"))):
            options = (*options, "--labels", "all")
            with self.subTest(options):
                here = self.mesh_solids(path, *options)
                job, = self.submit(path, *options)
                fetched = self.out / "fetched.vtu"
                self.assert_done(self.job("fetch", job, "-o", fetched, "--wait"))
                self.assertEqual(fetched.read_bytes(), here)


if __name__ == "__main__":
    unittest.main()
