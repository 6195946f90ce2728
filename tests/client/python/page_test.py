"""What docs/python.md, README.md and the examples say is run: every line of Python."""

import re
import subprocess
import sys

import pytest

from conftest import ROOT, fixture_file

BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["docs/python.md", "README.md"])
def test_every_line_of_a_page_does_what_it_says(page, server, tmp_path, monkeypatch):
    blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
    assert blocks, "the page has no Python"
    monkeypatch.chdir(tmp_path)
    fixture_file("sphere", 0.1, tmp_path / "ball.vdb")
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    space = {}
    for block in blocks:
        exec(compile(block.replace("localhost:7447", server.address), page, "exec"), space)
    assert (tmp_path / "ball.vtu").exists()


def test_the_first_example_makes_a_mesh(tmp_path):
    done = subprocess.run([sys.executable, ROOT / "examples/python/first_mesh.py"], cwd=tmp_path, check=True,
                          capture_output=True, text=True)
    assert re.fullmatch(r"<tetstream.Mesh: [\d,]+ vertices, [\d,]+ tets, .*>, volume 4\.1\d\d\n", done.stdout)
    assert (tmp_path / "ball.vtu").stat().st_size > 10_000
