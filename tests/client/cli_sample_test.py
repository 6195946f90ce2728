"""phi and fields at points by the tetstream command.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_sample_test.py [unittest options]
"""

import csv
import json
import math
import os
import signal
import subprocess
import unittest

from command_case import (
    GENEROUS_END, REFUSED, USAGE, CommandTest, ServerTest, binaries, catches, wait_until)

POINTS = [(0.9, 0, 0), (0, -1.05, 0), (0.3, 0.4, 0.9), (0.6, -0.6, 0.5)]


class Sample(CommandTest):
    volumes = {"sphere": 0.05, "fields": 0.1}

    def setUp(self):
        super().setUp()
        self.points = self.inputs / "points.txt"
        self.points.write_text("# points\n" + "\n".join("%g, %g %g  # one" % p for p in POINTS) + "\n\n")

    def sample(self, name, *options):
        return self.tetstream("sample", self.inputs / name, self.points, "-o",
                              self.out / "samples.csv", *options)

    def rows(self):
        with open(self.out / "samples.csv", newline="", encoding="utf-8") as file:
            return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

    def check_ball(self, tolerance):
        rows = self.rows()
        self.assertEqual(len(rows), len(POINTS))
        for row, (x, y, z) in zip(rows, POINTS):
            radius = math.hypot(x, y, z)
            self.assertEqual((row["x"], row["y"], row["z"]), (x, y, z))
            self.assertAlmostEqual(row["phi"], radius - 1, delta=tolerance)
            for axis, at in zip("xyz", (x, y, z)):
                self.assertAlmostEqual(row[f"phi_{axis}"], at / radius, delta=40 * tolerance)

    def test_tells_phi_and_its_slope_of_a_grid(self):
        self.assert_done(self.sample("sphere.vdb"))
        self.check_ball(2e-3)

    def test_tells_them_of_a_scene(self):
        (self.inputs / "ball.json").write_text(json.dumps(
            {"nodes": [{"name": "ball", "sphere": {"radius": 1}}]}))
        self.assert_done(self.sample("ball.json"))
        self.check_ball(1e-7)

    def test_tells_fields(self):
        self.assert_done(self.sample("fields.vdb", "--grid", "sphere", "--field", "T=heat"))
        for row in self.rows():
            self.assertTrue(math.isfinite(row["T"]))

    def test_refuses_a_grid_of_what_has_none(self):
        (self.inputs / "ball.json").write_text(json.dumps(
            {"nodes": [{"name": "ball", "sphere": {"radius": 1}}]}))
        self.assert_fails(self.sample("ball.json", "--grid", "skin"), REFUSED, "scene", "--grid")

    def test_refuses_to_take_the_place_of_what_it_reads(self):
        for output in (self.inputs / "sphere.vdb", self.points):
            before = output.read_bytes()
            result = self.tetstream("sample", self.inputs / "sphere.vdb", self.points, "-o", output)
            self.assert_fails(result, REFUSED, "take the place of", output.name)
            self.assertEqual(output.read_bytes(), before)

    def test_tells_nothing_of_no_points(self):
        self.points.write_text("")
        result = self.sample("sphere.vdb")
        self.assert_done(result)
        self.assertIn("0 points", result.stdout)

    def test_reads_points_of_a_pipe_until_it_is_interrupted(self):
        pipe = self.inputs / "pipe"
        os.mkfifo(pipe)
        command = [binaries() / "tetstream", "sample", self.inputs / "sphere.vdb", pipe, "-o", self.out / "s.csv"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        with open(pipe, "w", encoding="utf-8") as points:
            points.write("0 0 0\n")
        self.assertEqual(process.communicate(timeout=GENEROUS_END), (f"{self.out}/s.csv: 1 points\n", ""))
        (self.out / "s.csv").unlink()
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait_until(lambda: catches(process, signal.SIGINT))
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, 130)
        self.assert_nothing_written()

    def test_refuses_what_is_no_point(self):
        self.points.write_text("1 2 3\n1 2\n")
        self.assert_fails(self.sample("sphere.vdb"), REFUSED, "line 2", "three")
        self.points.write_text("1 2 nan\n")
        self.assert_fails(self.sample("sphere.vdb"), REFUSED, "line 1")
        self.assert_fails(self.sample("sphere.vdb", "--inside", "out"), USAGE, "--inside")


class SamplesOnAServer(ServerTest):
    volumes = {"sphere": 0.05, "fields": 0.1}

    def test_has_the_bytes_that_are_made_here(self):
        points = self.inputs / "points.txt"
        points.write_text("\n".join("%r %r %r" % (0.001 * i, -0.5, 0.2) for i in range(-1000, 1001)))
        scene = {"nodes": [{"name": "scan", "grid": {"name": "sphere.vdb"}}]}
        (self.inputs / "part.json").write_text(json.dumps(scene))
        for name, options in (("sphere.vdb", ()), ("part.json", ()),
                              ("fields.vdb", ("--grid", "sphere", "--field", "T=heat"))):
            with self.subTest(name=name):
                here, there = self.out / "here.csv", self.out / "there.csv"
                for path, server in ((here, ()), (there, ("--server", self.address))):
                    self.assert_done(self.tetstream(
                        "sample", self.inputs / name, points, "-o", path, *options, *server))
                self.assertEqual(there.read_bytes(), here.read_bytes())
                self.assertEqual(len(here.read_text().splitlines()), 2002)
        self.assertEqual(self.sample("tetstream_sampled_points_total"), 3 * 2001)

    def test_refuses_to_trust_what_is_read_elsewhere(self):
        points = self.inputs / "one.txt"
        points.write_text("0 0 0")
        self.assert_fails(self.tetstream("sample", self.inputs / "sphere.vdb", points, "-o", self.out / "s.csv",
                                         "--trust", "--server", self.address), REFUSED, "--trust")


if __name__ == "__main__":
    unittest.main()
