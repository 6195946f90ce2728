#!/usr/bin/python3
"""The library as its users meet it: installed into an empty folder, and programs built against that.

    examples_test.py SOURCE_DIR BUILD_DIR
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
LAUNCHER = os.environ.get("COMPILER_LAUNCHER", "").split()  # of compilers: ccache, or nothing
sys.path.insert(0, str(SOURCE / "tests/server"))

import running_server  # noqa: E402  (its folder is known only now)


def run(*command, **options):
    """What a command writes. Where it fails, the error has all that it said."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False,
                          **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def lines_of(text):
    """A text's lines without indentation, as one string: snippets are quoted without it."""
    return "\n".join(line.strip() for line in text.splitlines() if line.strip())


class Examples(unittest.TestCase):
    """What programs outside of this tree can rely on."""

    @classmethod
    def setUpClass(cls):
        # A folder of its own in the build tree, always the same: ccache knows headers by where they are.
        root = BUILD / "tests/examples/outside"
        shutil.rmtree(root, ignore_errors=True)
        cls.addClassCleanup(shutil.rmtree, root)
        cls.folder, cls.prefix, cls.out = root, root / "prefix", root / "build"
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)
        run("cmake", "-S", SOURCE / "examples/cpp", "-B", cls.out,
            f"-DCMAKE_PREFIX_PATH={cls.prefix}", f"-DCMAKE_CXX_COMPILER_LAUNCHER={';'.join(LAUNCHER)}")
        run("cmake", "--build", cls.out)
        cls.server = running_server.RunningServer(root / "store")
        cls.addClassCleanup(cls.server.close)

    def setUp(self):
        self.here = pathlib.Path(tempfile.mkdtemp(dir=self.folder))

    def test_every_snippet_of_the_pages_is_part_of_an_example(self):
        examples = [lines_of(path.read_text(encoding="utf-8"))
                    for path in (SOURCE / "examples/cpp").glob("*.cpp")]
        for page in ("docs/library.md", "README.md"):
            text = (SOURCE / page).read_text(encoding="utf-8")
            snippets = re.findall(r"```cpp\n(.*?)```", text, re.DOTALL)
            self.assertTrue(snippets, page)
            for snippet in snippets:
                self.assertTrue(any(lines_of(snippet) in example for example in examples),
                                f"{page}: no example has\n{snippet}")

    def test_the_library_shows_its_own_names_alone(self):
        library = next(self.prefix.rglob("libtetstream.so"))
        names = [line.split(maxsplit=2)[2] for line in
                 run("nm", "-D", "--defined-only", "--demangle", library).splitlines()]
        self.assertGreater(len(names), 30)
        self.assertEqual([name for name in names
                          if "tetstream::" not in name or "tetstream::v1" in name], [])

    def test_the_library_needs_nothing_of_the_tree(self):
        library = next(self.prefix.rglob("libtetstream.so"))
        dynamic = run("readelf", "--dynamic", "--wide", library)
        self.assertIn("Library soname: [libtetstream.so.0.2]", dynamic)
        self.assertNotIn("RUNPATH", dynamic)
        self.assertNotIn("not found", run("ldd", library))

    def test_a_mesh_is_made_here_and_by_a_server(self):
        said = run(self.out / "first_mesh", self.server.address, cwd=self.here)
        tets = re.match(r"(\d+) tets, volume 4\.1", said)
        self.assertIsNotNone(tets, said)
        self.assertIn(f"{tets[1]} tets from {self.server.address}", said)
        self.assertIn("VTKFile", (self.here / "ball.vtu").read_bytes()[:200].decode(errors="replace"))

    def test_labels_of_an_array_are_meshed(self):
        said = run(self.out / "mesh_labels", cwd=self.here)
        self.assertRegex(said, r"^4 bone: \d{4,} tets\n7 : \d{4,} tets\n$")
        self.assertIn(b"VTKFile", (self.here / "tissues.vtu").read_bytes()[:200])

    def test_changes_are_followed_here_and_by_a_server(self):
        here = run(self.out / "follow_shape", cwd=self.here)
        self.assertEqual(here, run(self.out / "follow_shape", self.server.address, cwd=self.here))
        frames = re.findall(r"^(\d+) tets, (\d+) slots changed(, all of them)?$", here, re.MULTILINE)
        self.assertEqual(len(frames), 5, here)
        self.assertTrue(frames[0][2])
        for tets, changed, renumbered in frames[1:]:
            self.assertFalse(renumbered)
            self.assertLess(0, int(changed))
            self.assertLess(int(changed), int(tets) / 2)
        self.assertIn(b"VTKFile", (self.here / "followed.vtu").read_bytes()[:200])

    def test_a_server_that_is_not_there_is_told_in_words(self):
        nobody = f"127.0.0.1:{running_server.unused_port()}"
        done = subprocess.run([self.out / "first_mesh", nobody], cwd=self.here, check=False,
                              capture_output=True, text=True, timeout=running_server.GENEROUS_END)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(nobody, done.stderr)

    def test_chunks_are_taken_as_they_come_and_stopped(self):
        ball = self.here / "ball.vdb"
        run(running_server.binaries() / "make_fixture", "sphere", "0.04", ball)
        said = run(self.out / "take_chunks", self.server.address, ball)
        self.assertRegex(said, r"\d+ vertices, \d+ tets\nstopped after \d+ tets\n")

    def test_pkg_config_leads_to_the_same_library(self):
        packages = next(self.prefix.rglob("tetstream.pc")).parent
        compiled, linked = (run("pkg-config", what, "tetstream",
                                env={**os.environ, "PKG_CONFIG_PATH": str(packages)}).split()
                            for what in ("--cflags", "--libs"))
        program = self.here / "by_hand"
        source, object_file = SOURCE / "examples/cpp/first_mesh.cpp", self.here / "by_hand.o"
        run(*LAUNCHER, "c++", "-std=c++20", "-c", source, *compiled, "-o", object_file)
        run("c++", object_file, *linked, "-o", program, f"-Wl,-rpath,{packages.parent}")
        self.assertRegex(run(program, cwd=self.here), r"^\d+ tets, volume 4\.1")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
