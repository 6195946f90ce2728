"""Runs the commands of README.md and docs/*.md as they are written, on small stand-ins for their files.

    TETSTREAM_BIN=build/release/bin PYTHONPATH=tests/client python3 tests/docs/commands_test.py
"""

import gzip
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import unittest

import numpy

from command_case import GENEROUS_END, ServerTest, binaries, unused_port
from image_files import ellipsoid, nifti, nrrd, oblique

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
# These pages' commands need a certificate authority: tests/client/cli_secure_test.py makes one.
SKIPPED = {"security.md"}

BLOCK = re.compile(r"^```\n(.*?)^```$", re.MULTILINE | re.DOTALL)
ADDRESS = re.compile(r"\b[\w.-]+:7447\b")
# A page's file: the fixture that takes its place, and its voxel size.
FILES = {"scan.vdb": ("torus", 0.1), "ct.vdb": ("scan", 0.1), "walls.vdb": ("random-signs", 0.1),
         "fire.vdb": ("fields", 0.15), "flow.vdb": ("fields", 0.15), "body.vdb": ("parts", 0.15),
         "droplets.vdb": ("parts", 0.15),
         "scans/monday.vdb": ("sphere", 0.1), "scans/tuesday.vdb": ("torus", 0.1)}
# A page's grid: the fixture's grid that takes its place.
GRIDS = {"density": "sphere", "temperature": "heat", "femur": "ball", "tibia": "ring",
         "water": "ball", "oil": "ring"}


def is_whole(command):
    try:
        shlex.split(command, comments=True)
        return True
    except ValueError:  # a quotation goes on in the next line
        return False


def commands_of(text):
    """The calls of tetstream and tetstreamd in the blocks of a page that name no language."""
    commands, begun = [], ""
    for line in "".join(BLOCK.findall(text)).splitlines():
        begun += line
        if not begun.startswith(("tetstream ", "tetstreamd --listen ")):
            begun = ""
        elif is_whole(begun):
            commands.append(begun)
            begun = ""
        else:
            begun += "\n"
    return commands


def octahedron(path, missing=0):
    """A surface in an .obj file, closed unless faces are missing: small, but forty voxels of 0.02 across."""
    r = 0.4
    corners = [(r, 0, 0), (-r, 0, 0), (0, r, 0), (0, -r, 0), (0, 0, r), (0, 0, -r)]
    faces = [(1, 3, 5), (3, 2, 5), (2, 4, 5), (4, 1, 5), (3, 1, 6), (2, 3, 6), (4, 2, 6), (1, 4, 6)]
    path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) +
                    "".join(f"f {a} {b} {c}\n" for a, b, c in faces[missing:]))


def images(folder):
    """An ellipsoid with a value of 400 within, as the pages have scans."""
    values, affine = ellipsoid(oblique((0.6, 0.6, 1.2)))
    values = numpy.where(values > 100, 400, 0) + values
    (folder / "ct.nii.gz").write_bytes(gzip.compress(nifti(values.astype("f4"), affine)))
    (folder / "head.nhdr").write_bytes(nrrd(values.astype("f4"), affine, data_file="head.raw"))
    (folder / "head.raw").write_bytes(values.astype("<f4").tobytes(order="F"))
    labels = numpy.select([values > 550, values > 520, values > 500], [9, 7, 4], 0)
    (folder / "seg.nii.gz").write_bytes(gzip.compress(nifti(labels.astype("i2"), affine)))
    (folder / "labels.txt").write_text('4 255 0 0 1 1 1 "skin"\n7 0 255 0 1 1 1 "bone"\n')
    numpy.save(folder / "stack.npy", values.transpose(2, 1, 0))


class Commands(ServerTest):
    volumes = {}

    @classmethod
    def setUpClass(cls):
        """Makes the pages' files once; each page's commands find copies, which they may change."""
        super().setUpClass()
        cls.files = cls.inputs / "files"
        (cls.files / "scans").mkdir(parents=True)
        octahedron(cls.files / "bunny.obj")
        images(cls.files)
        octahedron(cls.files / "scan.obj", missing=1)
        for name, (kind, voxel) in FILES.items():
            subprocess.run([binaries() / "make_fixture", kind, str(voxel), cls.files / name],
                           check=True)
        subprocess.run([binaries() / "tetstream", "convert", cls.files / "bunny.obj",
                        cls.files / "bunny.vdb", "--voxel", "0.02"], check=True, stdout=subprocess.DEVNULL)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.files, self.out, dirs_exist_ok=True)
        (self.out / "docs").symlink_to(ROOT / "docs")
        self.environment = {**os.environ, "PATH": f"{binaries().resolve()}:{os.environ['PATH']}",
                            "XDG_STATE_HOME": str(self.out / "state"), "TETSTREAM_LAME_DUCK_SECONDS": "0"}

    def run_here(self, command):
        for name, grid in GRIDS.items():
            command = re.sub(rf"\b{name}\b", grid, command)
        starts_server = command.startswith("tetstreamd")
        address = f"127.0.0.1:{unused_port()}" if starts_server else self.address
        command = ADDRESS.sub(address, command)
        command = re.sub(r"--http-listen \S+", "--http-listen 127.0.0.1:0", command)
        if starts_server:  # it stays until it is stopped: here it begins, and stops at once
            command += f"""
                until tetstream health --server {address}; do kill -0 $!; sleep 0.05; done
                kill $!; wait $!"""
        return subprocess.run(["bash", "-ec", command], cwd=self.out, env=self.environment,
                              capture_output=True, text=True, timeout=GENEROUS_END, check=False)

    def check_page(self, page):
        for command in commands_of(page.read_text(encoding="utf-8")):
            with self.subTest(page=page.name, command=command):
                done = self.run_here(command)
                self.assertEqual(done.returncode, 0, done.stderr)


def add_test(page):
    name = "_".join(page.relative_to(ROOT).with_suffix("").parts).lower()  # docs has a README, too
    setattr(Commands, f"test_of_{name}_do_what_they_say", lambda self: self.check_page(page))


for each in PAGES:
    if each.name not in SKIPPED and commands_of(each.read_text(encoding="utf-8")):
        add_test(each)


class Extraction(unittest.TestCase):
    def test_takes_calls_from_blocks_without_a_language(self):
        text = ("```\ntetstream info a.vdb  # why\nls\ntetstream mesh a '{\n}'\n```\n"
                "tetstream in prose\n```cpp\ntetstream x\n```\n")
        self.assertEqual(commands_of(text),
                         ["tetstream info a.vdb  # why", "tetstream mesh a '{\n}'"])

    def test_finds_the_cookbook(self):
        self.assertGreater(len(commands_of((ROOT / "docs/cookbook.md").read_text())), 20)


if __name__ == "__main__":
    unittest.main()
