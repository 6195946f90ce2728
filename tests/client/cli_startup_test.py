"""What the tetstream command loads and starts, and for what: shown by taking away the rest.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_startup_test.py [unittest options]
"""

import shutil
import subprocess
import unittest

from command_case import CUBE, DONE, REFUSED, CommandTest, binaries

DECODER, MODULE, HDF5 = "tetstream-decoder", "libtetstream-openvdb.so", "libtetstream-hdf5.so"


class Startup(CommandTest):
    volumes = {"sphere": 0.1, "sheared": 0.2, "vec3": 0.4}

    def alone(self, *beside):
        """Where the command is with nothing beside it but this."""
        for name in ("tetstream", *beside):
            shutil.copy2(binaries() / name, self.out)
        return self.out / "tetstream"

    def run_alone(self, program, *arguments):
        return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)

    def test_lists_ordinary_grids_without_a_decoder(self):
        tetstream = self.alone()
        listed = self.run_alone(tetstream, "info", "--no-values", self.inputs / "sphere.vdb")
        self.assertEqual(listed.returncode, DONE, listed.stderr)
        self.assertIn("sphere", listed.stdout)
        values = self.run_alone(tetstream, "info", self.inputs / "sphere.vdb")
        self.assertIn("no decoder program", values.stderr)

    def test_meshes_ordinary_grids_without_openvdb(self):
        tetstream = self.alone(DECODER)
        for trust in ([], ["--trust"]):
            mesh = self.out / "mesh.vtu"
            done = self.run_alone(tetstream, "mesh", self.inputs / "sphere.vdb", "-o", mesh, *trust)
            self.assertEqual(done.returncode, DONE, done.stderr)
            whole = self.out / "whole.vtu"
            self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", whole))
            self.assertEqual(mesh.read_bytes(), whole.read_bytes())

    def test_says_what_is_missing_where_it_takes_openvdb(self):
        if not (binaries() / MODULE).exists():
            self.skipTest("the programs have OpenVDB linked in")
        tetstream = self.alone(DECODER)
        (self.out / "cube.obj").write_text(CUBE + "f 2 4 8 6\n", encoding="utf-8")
        for arguments in (["info", self.inputs / "vec3.vdb"],
                          ["mesh", self.inputs / "sheared.vdb", "-o", self.out / "mesh.vtu", "--trust"],
                          ["convert", self.out / "cube.obj", self.out / "cube.vdb"]):
            failed = self.run_alone(tetstream, *arguments)
            self.assertIn(failed.returncode, (REFUSED, 3), arguments)
            self.assertIn(MODULE, failed.stderr)

    def test_says_what_is_missing_where_it_takes_hdf5_before_it_meshes(self):
        if not (binaries() / HDF5).exists():
            self.skipTest("the programs have HDF5 linked in")
        tetstream = self.alone()  # without a decoder nothing could be read
        for name in ("mesh.vtkhdf", "mesh.xdmf"):
            failed = self.run_alone(tetstream, "mesh", self.inputs / "sphere.vdb", "-o", self.out / name)
            self.assertNotEqual(failed.returncode, DONE, name)
            self.assertIn(HDF5, failed.stderr)
            self.assertFalse((self.out / name).exists())
        tetstream = self.alone(DECODER, HDF5)
        mesh, whole = self.out / "mesh.vtkhdf", self.out / "whole.vtkhdf"
        done = self.run_alone(tetstream, "mesh", self.inputs / "sphere.vdb", "-o", mesh)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", whole))
        self.assertEqual(mesh.read_bytes(), whole.read_bytes())

    def test_finds_openvdb_where_it_takes_it(self):
        self.assert_done(self.tetstream("info", self.inputs / "vec3.vdb"))


if __name__ == "__main__":
    unittest.main()
