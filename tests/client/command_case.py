"""What every test of the tetstream command stands on."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))

from waiting import (  # noqa: E402 (re-exported)
    GENEROUS_END, catches, processor_seconds, samples_of, unused_port, wait_until)

__all__ = ["CUBE", "DONE", "ENDINGS", "GENEROUS_END", "LID", "REFUSED", "SERVER", "USAGE", "CommandTest",
           "ServerTest", "binaries", "catches", "processor_seconds", "read_mesh", "samples_of",
           "unused_port", "wait_until"]

DONE, REFUSED, USAGE, SERVER = 0, 1, 2, 3
# Of one file each, and with all that a mesh has: what other tests compare. cli_formats_test.py has every format.
ENDINGS = (".vtu", ".msh", ".vtkhdf")

# A cube of two triangles a side, and the last side of it.
CUBE = """\
v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1
f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n"""
LID = "f 2 4 8 6\n"


def binaries():
    """Where tetstream, tetstreamd and make_fixture are."""
    return pathlib.Path(os.environ["TETSTREAM_BIN"])


def read_mesh(path):
    """What meshio finds in a mesh's file. It takes half a second of a processor to load, which most tests need not."""
    import meshio
    return meshio.read(path)


class CommandTest(unittest.TestCase):
    """A scratch directory with a few volumes beside an empty `out` that tests write to."""

    volumes = {"sphere": 0.05}  # kind of fixture: voxel size

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.inputs = pathlib.Path(scratch.name)
        for kind, voxel in cls.volumes.items():
            cls.make_fixture(kind, voxel)

    @classmethod
    def make_fixture(cls, kind, voxel):
        path = cls.inputs / f"{kind}.vdb"
        subprocess.run([binaries() / "make_fixture", kind, str(voxel), path], check=True)

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.out = pathlib.Path(scratch.name)

    def tetstream(self, *arguments, **options):
        return subprocess.run(
            [binaries() / "tetstream", *map(str, arguments)],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False, **options)

    def mesh(self, name="sphere.vdb", ending=".vtu", *arguments, **options):
        return self.tetstream(
            "mesh", self.inputs / name, "-o", self.out / f"mesh{ending}", *arguments, **options)

    def assert_done(self, result):
        self.assertEqual(result.returncode, DONE, result.stderr)

    def assert_fails(self, result, code, *words):
        """With this code, every word in one line on stderr, and no file left behind."""
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assert_nothing_written()

    def assert_nothing_written(self):
        self.assertEqual(sorted(path.name for path in self.out.iterdir()), [])


class ServerTest(CommandTest):
    """A real server at `address`, which may be killed and started again; its metrics at `metrics`."""

    settings = ()  # of the server

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.address, cls.metrics = (f"127.0.0.1:{unused_port()}" for _ in range(2))
        cls.start_server()
        cls.addClassCleanup(lambda: cls.stop_server())

    @classmethod
    def start_server(cls):
        cls.server = subprocess.Popen(
            [binaries() / "tetstreamd", "--listen", cls.address, "--metrics-listen", cls.metrics,
             "--lame-duck-seconds", "0", "--store", cls.inputs / "store", *map(str, cls.settings)],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until(lambda: subprocess.run(
            [binaries() / "tetstream", "health", "--server", cls.address],
            capture_output=True, check=False).returncode == DONE)

    @classmethod
    def sample(cls, name):
        """One of the server's metrics; 0 as long as there is none."""
        return samples_of(cls.metrics).get(name, 0)

    @classmethod
    def stop_server(cls):
        cls.server.terminate()
        cls.server.wait(GENEROUS_END)

    @classmethod
    def kill_server(cls):
        cls.server.kill()
        cls.server.wait(GENEROUS_END)
