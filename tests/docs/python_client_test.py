"""Runs the client in Python of docs/wire_format.md against a server, and compares its meshes with those that
`tetstream mesh` writes.

    TETSTREAM_BIN=build/release/bin PYTHONPATH=tests/client python3 tests/docs/python_client_test.py
"""

import contextlib
import io
import pathlib
import re
import subprocess
import sys
import unittest

import numpy

from command_case import ServerTest, read_mesh

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/wire_format.md").read_text(encoding="utf-8")
SECTION = PAGE.split("## A client in Python")[1].split("\n## ")[0]
GENERATE = re.search(r"^```\n(protoc .*?)^```$", SECTION, re.MULTILINE | re.DOTALL)[1]
CLIENT, USE = re.findall(r"^```python\n(.*?)^```$", SECTION, re.MULTILINE | re.DOTALL)


class PythonClient(ServerTest):
    volumes = {"sphere": 0.1, "fields": 0.1}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.inputs / "proto").symlink_to(ROOT / "proto")
        subprocess.run(["bash", "-ec", GENERATE], cwd=cls.inputs, check=True)
        sys.path.insert(0, str(cls.inputs))
        cls.client = {}
        exec(CLIENT, cls.client)  # the page's own text is what is tested

    def stream(self, name, **request):
        """The page's mesh of a file."""
        with self.client["grpc"].insecure_channel(self.address) as channel:
            stored = self.client["upload"](channel, self.inputs / name)
            return self.client["stream"](
                channel, self.client["meshes_pb2"].MeshRequest(name=stored, **request))

    def written(self, name, *options):
        """The command's mesh of a file."""
        self.assert_done(self.mesh(name, ".vtu", *options))
        return read_mesh(self.out / "mesh.vtu")

    def assert_same(self, mesh, expected):
        origin = mesh.header.origin
        world = mesh.points + numpy.array([origin.x, origin.y, origin.z])
        numpy.testing.assert_array_equal(mesh.tets, expected.cells_dict["tetra"])
        numpy.testing.assert_allclose(world, expected.points, atol=1e-6)

    def test_receives_the_mesh_that_the_command_writes(self):
        self.assert_same(self.stream("sphere.vdb"), self.written("sphere.vdb"))

    def test_receives_regions(self):
        preset = self.client["meshes_pb2"].PRESET_BOTH_SIDES
        mesh = self.stream("sphere.vdb", preset=preset)
        expected = self.written("sphere.vdb", "--preset", "both-sides")
        self.assert_same(mesh, expected)
        numpy.testing.assert_array_equal(mesh.regions, expected.cell_data_dict["region"]["tetra"])

    def test_receives_values_at_vertices(self):
        mesh = self.stream("fields.vdb", grid_name="sphere",
                           fields=[{"name": "heat", "grid_name": "heat"},
                                   {"name": "flow", "grid_name": "velocity"}])
        expected = self.written("fields.vdb", "--grid", "sphere", "--field", "heat",
                                "--field", "flow=velocity")
        self.assert_same(mesh, expected)
        numpy.testing.assert_array_equal(mesh.values["heat"][:, 0], expected.point_data["heat"])
        numpy.testing.assert_array_equal(mesh.values["flow"], expected.point_data["flow"])

    def test_does_what_the_page_does_with_it(self):
        use = USE.replace("127.0.0.1:7447", self.address)
        use = use.replace("bunny.vdb", str(self.inputs / "sphere.vdb"))
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(use, self.client)
        self.assertRegex(printed.getvalue(), r"^\d+ tets of \d+ vertices$")

    def test_refuses_a_damaged_chunk(self):
        mesh = self.stream("sphere.vdb")
        chunk = self.client["meshes_pb2"].MeshChunk(positions=b"\0" * 12, vertex_count=1)
        with self.assertRaises(ValueError):
            mesh.place(chunk)


if __name__ == "__main__":
    unittest.main()
