"""Meshes with the values of other grids by the tetstream command: in its own process, on a
server, and as jobs.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_field_test.py [unittest options]
"""

import filecmp
import json
import pathlib
import unittest

import numpy

from command_case import ENDINGS, REFUSED, USAGE, CommandTest, ServerTest, read_mesh
from job_case import JobTest

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
BRACKET = DOCS / "scenes" / "bracket.json"
FIELDS = ("--grid", "sphere", "--field", "heat", "--field", "flow=velocity")


class Fields(CommandTest):
    volumes = {"sphere": 0.1, "fields": 0.1}

    def made(self, *options, name="fields.vdb"):
        self.assert_done(self.mesh(name, ".vtu", *options))
        return read_mesh(self.out / "mesh.vtu")

    def check_values(self, mesh, digits=5):
        x, y, z = mesh.points.astype(float).T
        numpy.testing.assert_allclose(
            mesh.point_data["heat"], 1 + 2 * x - 3 * y + z / 2, atol=10.0 ** -digits)
        numpy.testing.assert_allclose(
            mesh.point_data["flow"],
            numpy.column_stack([x - y, 2 * z, 1 + x / 4]), atol=10.0 ** -digits)

    def test_are_arrays_of_the_vertices(self):
        for options in ((), ("--improve",), ("--preset", "both-sides", "--coordinates", "float64"),
                        ("--trust",)):
            with self.subTest(options):
                mesh = self.made(*FIELDS, *options)
                self.assertEqual(set(mesh.point_data), {"heat", "flow"})
                inside = numpy.abs(mesh.points).max(axis=1) < 1.5
                self.assertTrue(inside.any())
                mesh.points = mesh.points[inside]
                mesh.point_data = {name: values[inside]
                                   for name, values in mesh.point_data.items()}
                self.check_values(mesh)

    def test_may_lie_in_another_file(self):
        fields = self.inputs / "fields.vdb"
        mesh = self.made("--field", f"{fields}:heat", "--field", f"flow={fields}:velocity",
                         name="sphere.vdb")
        self.check_values(mesh)
        self.assert_done(self.tetstream(
            "mesh", BRACKET, "-o", self.out / "bracket.vtu", "--spacing", "0.2",
            "--field", f"T={fields}:heat"))
        self.assertEqual(set(read_mesh(self.out / "bracket.vtu").point_data), {"T"})

    def test_are_in_files_of_every_format(self):
        for ending in ENDINGS:
            self.assert_done(self.mesh("fields.vdb", ending, *FIELDS))
        vtu, msh = (read_mesh(self.out / f"mesh{ending}") for ending in (".vtu", ".msh"))
        for name in ("heat", "flow"):
            numpy.testing.assert_array_equal(vtu.point_data[name], msh.point_data[name])

    def test_are_refused_where_they_cannot_be(self):
        for options, *words in (
                (("--field", "wind"), "no grid 'wind'", "'heat'"),
                (("--field", "heat", "--field", "heat"), "fields[1].name", "two names"),
                (("--field", "a/b=heat"), "--field: fields[0].name", "a/b"),
                (("--field", "none.vdb:heat"), "none.vdb"),
                (("--field", "heat", "--compact", "--server", "127.0.0.1:1"), "--compact",
                 "--field")):
            with self.subTest(options):
                self.assert_fails(
                    self.mesh("fields.vdb", ".vtu", "--grid", "sphere", *options), REFUSED,
                    *words)
        self.assert_fails(
            self.tetstream("mesh", BRACKET, "-o", self.out / "a.vtu", "--field", "heat"),
            REFUSED, "bracket.json has no grids", "FILE.vdb:heat")

    def test_are_told_of_by_info(self):
        result = self.tetstream("info", self.inputs / "fields.vdb")
        self.assert_done(result)
        for grid, field in (("heat", "scalar"), ("velocity", "vector"), ("count", "scalar")):
            self.assertRegex(result.stdout, rf"{grid} .* {field} ")
        grids = json.loads(
            self.tetstream("info", self.inputs / "fields.vdb", "--json").stdout)
        self.assertEqual([grid["field_components"] for grid in grids], [1, 1, 3, 1])

    def test_count_in_an_estimate(self):
        result = self.tetstream(
            "estimate", self.inputs / "fields.vdb", "--json", *FIELDS)
        self.assert_done(result)
        estimate = json.loads(result.stdout)
        self.assertEqual(estimate["bytes"], 28 * estimate["vertices"] + 16 * estimate["tets"])

    def test_need_a_name(self):
        result = self.mesh("fields.vdb", ".vtu", "--field")
        self.assertEqual(result.returncode, USAGE, result.stderr)


class FieldsOnAServer(ServerTest):
    volumes = {"sphere": 0.1, "fields": 0.15}

    def test_are_the_same_bytes_as_in_this_process(self):
        other = ("--field", f"there={self.inputs / 'fields.vdb'}:heat")
        for name, options in (("fields.vdb", FIELDS), ("sphere.vdb", other),
                              ("fields.vdb", (*FIELDS, *other, "--improve"))):
            here, there = self.out / "here.vtu", self.out / "there.vtu"
            for path, server in ((here, ()), (there, ("--server", self.address))):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / name, "-o", path, *options, *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), options)


class FieldsOfJobs(JobTest):
    volumes = {"sphere": 0.1, "fields": 0.15}

    def test_are_the_same_bytes_as_in_this_process(self):
        other = f"there={self.inputs / 'fields.vdb'}:heat"
        manifest = self.out / "manifest"
        manifest.write_text(json.dumps(
            {"input": str(self.inputs / "fields.vdb"), "grid": "sphere",
             "field": ["heat", "flow=velocity"]}))
        jobs = self.submit(self.inputs / "sphere.vdb", "--field", other)
        jobs += self.submit("--manifest", manifest)
        for job, name, options in ((jobs[0], "sphere.vdb", ("--field", other)),
                                   (jobs[1], "fields.vdb", FIELDS)):
            for ending in ENDINGS:
                here, there = self.out / f"here{ending}", self.out / f"there{ending}"
                self.assert_done(
                    self.tetstream("mesh", self.inputs / name, "-o", here, *options))
                self.assert_done(self.job("fetch", job, "--wait", "-o", there))
                self.assertTrue(filecmp.cmp(here, there, shallow=False), there)


if __name__ == "__main__":
    unittest.main()
