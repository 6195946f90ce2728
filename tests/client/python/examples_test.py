"""The programs of examples/python, each with the picture that it makes. Those that want dolfinx are judges'."""

import json
import re
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest

import tetstream as ts
from conftest import ROOT

EXAMPLES = ROOT / "examples/python"


def said_by(name, folder, *arguments):
    done = subprocess.run([sys.executable, EXAMPLES / name, *arguments], cwd=folder, check=False,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def size_of_picture(path):
    """How large a picture is, having looked at what its file says."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and data[12:16] == b"IHDR" and len(data) > 5_000
    return struct.unpack(">II", data[16:24])


def test_an_array_becomes_a_mesh(tmp_path):
    assert "tets" in said_by("numpy_mesh.py", tmp_path)
    assert size_of_picture(tmp_path / "numpy_mesh.png") == (640, 480)


def test_a_liquid_is_followed_and_keeps_its_warmth(tmp_path, server):
    here, there = said_by("moving_liquid.py", tmp_path), said_by("moving_liquid.py", tmp_path, server.address)
    def tets(said):
        return re.findall(r"(\d+) tets, +(\d+) of them new, warmth 0.00 to 1.00", said)

    assert len(tets(here)) == len(tets(there)) == 16
    assert [all_of for all_of, _ in tets(here)] == [all_of for all_of, _ in tets(there)]
    assert all(int(new) <= int(all_of) for all_of, new in tets(there))
    size_of_picture(tmp_path / "moving_liquid.png")


def test_a_batch_ends_in_a_table(tmp_path, server):
    here, there = said_by("night_batch.py", tmp_path), said_by("night_batch.py", tmp_path, server.address)
    assert here == there and here.count("succeeded") == 6
    size_of_picture(tmp_path / "night_batch.png")


def test_every_cell_of_the_notebook_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cells = json.loads((EXAMPLES / "notebook.ipynb").read_text(encoding="utf-8"))["cells"]
    space, shown = {}, []
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        *lines, last = "".join(cell["source"]).splitlines()
        exec("\n".join(lines), space)
        if re.match(r"\w+ = ", last):
            exec(last, space)
        else:
            shown.append(eval(last, space))
    pictures = [one._repr_html_() for one in shown if isinstance(one, ts.Mesh)]
    assert len(pictures) == 2 and all("data:image/png;base64," in picture for picture in pictures)
    size_of_picture(tmp_path / "wave.png")


def pixels_of(png):
    """Those of one of our own pictures: rows of three bytes each."""
    width, height = struct.unpack(">II", png[16:24])
    at, data = 33, b""
    while (kind := png[at + 4:at + 8]) != b"IEND":
        size, = struct.unpack(">I", png[at:at + 4])
        data += png[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 1 + 3 * width)
    return rows[:, 1:].reshape(-1, 3)


def test_a_picture_is_grey_where_nothing_is_known():
    ball = ts.mesh(ts.sphere(1), spacing=0.2)
    heights = ball.points[:, 2].copy()
    all_known = ball.picture(size=(64, 64), values=heights)
    assert not any(len(set(pixel)) == 1 for pixel in pixels_of(all_known).tolist() if min(pixel) < 255)
    masked = ball.picture(size=(64, 64), values=np.ma.masked_greater(heights, 0))
    for unknown in (np.nan, np.inf, -np.inf):
        drawn = ball.picture(size=(64, 64), values=np.where(heights > 0, unknown, heights))
        assert drawn == masked
        seen = [len(set(pixel)) for pixel in pixels_of(drawn).tolist() if min(pixel) < 255]
        assert 0.2 * len(seen) < seen.count(1) < 0.8 * len(seen)
    nothing = ball.picture(size=(64, 64), values=np.full(len(heights), np.nan))
    assert all(len(set(pixel)) == 1 for pixel in pixels_of(nothing).tolist())
    assert ball.picture(size=(64, 64), values=1e308 * heights) == all_known


def test_a_picture_shows_what_is_there():
    ball = ts.mesh(ts.sphere(1), spacing=0.2)
    with_faces = ts.mesh(ts.sphere(1), spacing=0.2, faces=True)
    assert ball.picture(size=(64, 64)) == ball.picture(size=(64, 64))
    for wrong, why in (({"size": (0, 5)}, "0 x 5"), ({"view": (0, 0, 0)}, "no direction"),
                       ({"values": "heat"}, "no field is named 'heat'"), ({"values": [1, 2]}, "shape")):
        with pytest.raises(ts.InvalidArgumentError, match=why):
            with_faces.picture(**wrong)
