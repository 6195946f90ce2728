"""What every test of faults stands on: scratch folders, fixtures, and stores that must be whole."""

import hashlib
import pathlib
import subprocess
import sys
import tempfile
import unittest
import uuid

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "server"))

from running_server import (  # noqa: E402 (re-exported)
    GENEROUS_END, RunningServer, binaries, unused_port, wait_until)

__all__ = ["FaultTest", "GENEROUS_END", "RunningServer", "binaries", "unused_port",
           "wait_until"]


class FaultTest(unittest.TestCase):
    """A scratch folder with grids, and for each the mesh that this machine makes without a server."""

    volumes = {"sphere": 0.05}  # kind of fixture: voxel size
    spacing = ()  # of meshes, as the command line takes it; that of the voxels where it is not given

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.inputs = pathlib.Path(scratch.name)
        cls.expected = {}
        for kind, voxel in cls.volumes.items():
            grid, mesh = cls.inputs / f"{kind}.vdb", cls.inputs / f"{kind}.vtu"
            subprocess.run([binaries() / "make_fixture", kind, str(voxel), grid], check=True)
            subprocess.run([binaries() / "tetstream", "mesh", grid, "-o", mesh, *cls.spacing],
                           check=True, stdout=subprocess.DEVNULL)
            cls.expected[kind] = mesh.read_bytes()

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.store = self.folder / "store"

    def start(self, *options, **more):
        server = RunningServer(self.store, *options, **more)
        self.addCleanup(server.close)
        return server

    def mesh(self, server, kind="sphere"):
        """The result of meshing a grid on a server, or on one of several addresses."""
        address = getattr(server, "address", server)
        return subprocess.run(
            [binaries() / "tetstream", "mesh", self.inputs / f"{kind}.vdb",
             "-o", self.folder / f"{kind}.vtu", "--server", address, *self.spacing],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False)

    def assert_meshed(self, result, kind="sphere"):
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / f"{kind}.vtu").read_bytes() == self.expected[kind])

    def stored(self):
        """Digests of the whole files in the store; each must be its bytes' own."""
        files = [path for path in self.store.glob("grids/*/*") if path.is_file()]
        for path in files:
            self.assertEqual(hashlib.sha256(path.read_bytes()).hexdigest(), path.name)
        return {path.name for path in files}

    def another_grid(self, number, kind="sphere"):
        """A file of the same grid and of other bytes: the UUID in its head is another."""
        content = bytearray((self.inputs / f"{kind}.vdb").read_bytes())
        # After it come the file's metadata; before it a magic number, three versions and a flag.
        content[21:57] = str(uuid.UUID(int=number)).encode("ascii")
        path = self.folder / f"{kind}{number}.vdb"
        path.write_bytes(content)
        return path

    def digest(self, kind="sphere"):
        return hashlib.sha256((self.inputs / f"{kind}.vdb").read_bytes()).hexdigest()
