"""Arrays from mesh to mesh by the tetstream command, read by others.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_transfer_test.py [unittest options]
"""

import unittest

import numpy

from command_case import REFUSED, USAGE, CommandTest, read_mesh


class Transfer(CommandTest):
    volumes = {"fields": 0.1}

    def make(self, name, *options):
        self.assert_done(self.tetstream("mesh", self.inputs / "fields.vdb", "-o", self.out / name,
                                        "--grid", "sphere", *options))

    def make_both(self):
        self.make("old.vtu", "--field", "heat")
        self.make("new.vtu", "--spacing", "0.13", "--field", "own=heat")

    def transfer(self, *options):
        return self.tetstream("transfer", self.out / "old.vtu", self.out / "new.vtu", "-o",
                              self.out / "filled.vtu", *options)

    def assert_refused(self, done, code, *words):
        """As assert_fails, beside the files of the test."""
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_puts_arrays_beside_those_that_a_mesh_has(self):
        self.make_both()
        done = self.transfer()
        self.assert_done(done)
        self.assertIn("heat (points): integral", done.stdout)
        old, new, filled = (read_mesh(self.out / f"{name}.vtu") for name in ("old", "new", "filled"))
        self.assertEqual(sorted(filled.point_data), ["heat", "own"])
        numpy.testing.assert_allclose(filled.points, new.points, atol=1e-6)
        numpy.testing.assert_array_equal(filled.cells[0].data, new.cells[0].data)
        numpy.testing.assert_array_equal(filled.point_data["own"].ravel(),
                                         new.point_data["own"].ravel())
        scale = abs(old.point_data["heat"]).max()
        numpy.testing.assert_allclose(filled.point_data["heat"].ravel(),
                                      new.point_data["own"].ravel(), atol=0.1 * scale)

    def test_conserves_integrals(self):
        self.make_both()
        done = self.transfer("--mode", "conservative", "--clamp", "--array", "heat")
        self.assert_done(done)
        told = done.stdout.split("integral ")[1].split()
        self.assertAlmostEqual(float(told[0].rstrip(",")), float(told[2]), delta=1e-8)
        old, filled = (read_mesh(self.out / f"{name}.vtu") for name in ("old", "filled"))
        self.assertLessEqual(filled.point_data["heat"].max(), old.point_data["heat"].max() + 1e-6)

    def test_is_refused_where_there_is_nothing_to_transfer(self):
        self.make_both()
        self.make("bare.vtu")
        before = sorted(path.name for path in self.out.iterdir())
        for arguments, words in (
                (("bare.vtu", "new.vtu", "-o", self.out / "x.vtu"), ("no arrays",)),
                (("old.vtu", "new.vtu", "-o", self.out / "x.vtu", "--array", "cold"), ("cold", "heat")),
                (("old.vtu", "new.vtu", "-o", self.out / "x.msh"), (".vtu",)),
                (("none.vtu", "new.vtu", "-o", self.out / "x.vtu"), ("none.vtu",))):
            old, new, *rest = arguments
            done = self.tetstream("transfer", self.out / old, self.out / new, *rest)
            self.assert_refused(done, REFUSED, *words)
        self.assert_refused(self.transfer("--mode", "cubic"), USAGE, "--mode")
        self.assertEqual(sorted(path.name for path in self.out.iterdir()), before)


if __name__ == "__main__":
    unittest.main()
