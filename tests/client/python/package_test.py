"""The package as pip, type checkers and readers of its help meet it."""

import importlib.metadata
import inspect
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

import tetstream as ts
from conftest import BUILD, ROOT
from running_server import GENEROUS_END

PACKAGE = ROOT / "client/python"
PIP = [sys.executable, "-m", "pip", "--no-cache-dir", "--disable-pip-version-check"]


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("how", ["pip", "wheel"])
def test_is_installed_into_an_empty_folder_without_a_network(tmp_path, how, ball):
    building = {**os.environ, "TETSTREAM_BUILD": str(BUILD.resolve()), "PIP_NO_INDEX": "1"}
    source, target = PACKAGE, tmp_path / "target"
    if how == "wheel":
        run(sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", tmp_path, PACKAGE, env=building)
        source = next(tmp_path.glob("tetstream-*.whl"))
        assert source.name == f"tetstream-{ts.version()}-cp311-cp311-linux_x86_64.whl"
    run(*PIP, "install", "--no-index", "--no-build-isolation", "--no-deps", "--target", target, source, env=building)
    ball.write_vdb(tmp_path / "ball.vdb")
    said = run(sys.executable, "-c", "import tetstream as ts; print(ts.__file__, ts.mesh('ball.vdb').header.tet_count)",
               cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(target)})
    assert said.split() == [str(target / "tetstream/__init__.py"), str(ts.mesh(ball).header.tet_count)]
    assert (target / "tetstream/py.typed").exists()
    assert not list(PACKAGE.glob("*.egg-info")) and not (PACKAGE / "build").exists()


def test_is_known_to_pip():
    assert importlib.metadata.version("tetstream") == ts.version() == ts.__version__
    assert importlib.metadata.requires("tetstream") == ["numpy (>=1.24)"]


def test_the_module_needs_nothing_of_the_tree():
    module = pathlib.Path(sys.modules["tetstream._tetstream"].__file__)
    assert str(BUILD.resolve()) not in run("readelf", "--dynamic", "--wide", module)
    assert "not found" not in run("ldd", module)


TYPED = """
import numpy as np
import tetstream as ts
volume = ts.Volume.from_array(np.zeros((2, 2, 2)), spacing=1)
mesh = ts.Client("localhost:1").mesh(volume, sizing={"growth": 0.5}, progress=print)
reveal_type(mesh.points)
reveal_type(ts.mesh(volume).quality())
reveal_type(ts.Client().jobs.wait(ts.Client().jobs.submit(ts.sphere(1) - volume)))
async def there(client: ts.AsyncClient) -> None:
    reveal_type(await client.mesh(volume, spacing=0.1))
    reveal_type([chunk async for chunk in await client.stream(volume)])
ts.mesh(volume, preset="best")
"""


@pytest.mark.skipif(not shutil.which("mypy"), reason="there is no mypy")
def test_its_types_are_whole_and_strict(tmp_path):
    (tmp_path / "typed.py").write_text(TYPED)
    # Both at once, as NumPy's types are most of the work. The one error is that of the last line above.
    done = subprocess.run(["mypy", "--strict", "--cache-dir", tmp_path, PACKAGE / "tetstream", tmp_path / "typed.py"],
                          check=False, capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(PACKAGE)})
    assert "numpy.ndarray[Any, numpy.dtype[numpy.floating[numpy._typing._64Bit]]]" in done.stdout
    for told in ("_header.Quality", "_job.Job", "_mesh.Mesh", "list[tetstream._mesh.Chunk]"):
        assert told in done.stdout, told
    assert 'has incompatible type "Literal[\'best\']"' in done.stdout
    assert "Found 1 error" in done.stdout, done.stdout


def test_everything_public_says_what_it_is():
    for name in ts.__all__:
        thing = getattr(ts, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_the_three_calls_take_the_same_options():
    options = {name: list(inspect.signature(getattr(ts, name)).parameters.values())
               for name in ("mesh", "stream", "estimate")}
    ranks = [option for option in options["stream"] if option.name in ("rank", "size")]
    assert len(ranks) == 2
    assert options["mesh"] == [option for option in options["stream"] if option not in ranks]
    assert set(map(str, options["estimate"])) < set(map(str, options["mesh"]))


def test_the_help_has_a_first_mesh(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(inspect.cleandoc(ts.__doc__.split("\n\n", 1)[1].split("\n\nA volume")[0]), {})
    assert (tmp_path / "ball.vtu").stat().st_size > 10_000


FORKING = """
import asyncio, os, sys
import tetstream as ts

def count():
    return ts.estimate(ts.sphere(1), spacing=0.5, threads=1).tet_count

async def count_too():
    return (await ts.AsyncClient().estimate(ts.sphere(1), spacing=0.5, threads=1)).tet_count

assert count() == asyncio.run(count_too())  # by threads that stay
child = os.fork()
if child == 0:
    {does}
    sys.exit(7)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.parametrize("does", ["pass", "count()", "asyncio.run(count_too())"])
def test_a_forked_process_works_and_ends(does):
    assert run(sys.executable, "-c", FORKING.format(does=does), timeout=GENEROUS_END) == "7\n"
