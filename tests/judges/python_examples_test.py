"""Runs the examples in Python that solve, by dolfinx: alone, and on the ranks of mpirun."""

import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(os.environ["TETSTREAM_BIN"]).parent / "python"


def said_by(name, folder, *launch):
    done = subprocess.run([*launch, "/usr/bin/python3", ROOT / "examples/python" / name], cwd=folder, check=False,
                          capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(PACKAGE)})
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


class PythonExamples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_ranks_solve_what_one_process_does(self):
        integrals = []
        for ranks in (1, 2):
            said = said_by("poisson.py", self.folder, "mpirun", "--allow-run-as-root", "--oversubscribe", "-n",
                           str(ranks))
            shares = [list(map(int, share)) for share in re.findall(r"(\d+) of (\d+) tets", said)]
            self.assertEqual(len(shares), ranks)
            self.assertEqual(sum(own for own, _ in shares), shares[0][1])
            integrals.append(float(re.search(r"integral is (\S+)", said)[1]))
        self.assertAlmostEqual(integrals[0], integrals[1], delta=1e-7 * integrals[0])

    def test_ranks_have_tags_of_cells_and_facets(self):
        for ranks in (1, 3):
            said = said_by("../../tests/judges/tags_on_ranks.py", self.folder, "mpirun", "--allow-run-as-root",
                           "--oversubscribe", "-n", str(ranks))
            found = {name: float(number) for name, number in re.findall(r"(\w+) ([0-9.]+)", said)}
            self.assertAlmostEqual(found["inside"], 4 / 3 * math.pi, delta=0.02)
            self.assertAlmostEqual(found["interface"], 4 * math.pi, delta=0.04)
            sides = [area for name, area in found.items() if name.startswith("box_")]
            self.assertEqual((len(sides), len(set(sides))), (6, 1), said)
            self.assertAlmostEqual(found["inside"] + found["outside"], sides[0] ** 1.5, delta=0.01)

    def test_a_scan_becomes_a_stress_plot(self):
        said = said_by("scan_to_stress.py", self.folder)
        middle, most = map(int, re.search(r"stress (\d+) MPa in the middle, (\d+) MPa at most", said).groups())
        self.assertTrue(50 < middle < most < 5000, said)
        self.assertGreater((self.folder / "scan_to_stress.png").stat().st_size, 5_000)


if __name__ == "__main__":
    unittest.main()
