"""What the tests of the Python package stand on: the package as it is installed, and shapes to mesh.

TETSTREAM_BUILD names the build tree, TETSTREAM_BIN its programs.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(os.environ["TETSTREAM_BUILD"])
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tests/server"))

_installed = tempfile.mkdtemp()


def pytest_addoption(parser):
    parser.addoption("--meshes", type=int, default=1_000, help="of the test that looks for what stays in memory")


def pytest_configure(config):
    """Installs the package; the tests, and the programs that they start, import it from there."""
    for component in ("python", "lib", "common"):
        subprocess.run(["cmake", "--install", BUILD, "--prefix", _installed, "--component", component],
                       check=True, stdout=subprocess.DEVNULL)
    folder = next(pathlib.Path(_installed).glob("lib/python3*/dist-packages"))
    sys.path.insert(0, str(folder))
    os.environ["PYTHONPATH"] = str(folder)


def pytest_unconfigure(config):
    shutil.rmtree(_installed)


def distances(radius=16):
    """To a sphere of radius 1, as an array of samples, with the arguments that say where they are."""
    spacing = 1 / radius
    edge = spacing * (radius + 4)
    axis = np.linspace(-edge, edge, 2 * radius + 9)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    return np.sqrt(x * x + y * y + z * z) - 1, {"spacing": spacing, "origin": (-edge, -edge, -edge)}


def make_ball(radius=16):
    import tetstream as ts
    values, place = distances(radius)
    return ts.Volume.from_array(values, **place)


def assert_same(one, other):
    """Two meshes, or what has their arrays, byte for byte."""
    for name in ("local_points", "tets", "regions", "_field_rows", "labels"):
        a, b = getattr(one, name), getattr(other, name)
        assert (a is None) == (b is None), name
        if a is not None:
            assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes(), name
    assert one.header.origin == other.header.origin


@pytest.fixture(scope="session")
def ball():
    return make_ball()


@pytest.fixture(scope="session")
def mesh(ball):
    import tetstream as ts
    return ts.mesh(ball)


@pytest.fixture
def server(tmp_path):
    import running_server
    with running_server.RunningServer(tmp_path / "store") as running:
        yield running


@pytest.fixture
def client(server):
    import tetstream as ts
    return ts.Client(server.address)


def fixture_file(kind, voxel, path):
    """One of the files that tests read."""
    import running_server
    subprocess.run([running_server.binaries() / "make_fixture", kind, str(voxel), path], check=True)
    return path
