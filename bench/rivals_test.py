#!/usr/bin/python3
"""Shows that the comparison with other meshers measures what it says, and tells who failed."""
import pathlib
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "rivals"))

import compare_meshers
import contenders
import judge
import solids

# Five tets of a unit cube, the first in its middle.
CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
TETS = np.array([[0, 3, 5, 6], [1, 0, 3, 5], [2, 3, 0, 6], [4, 5, 6, 0], [7, 6, 5, 3]])


def oriented(tets):
    corners = CUBE[tets]
    return np.where((judge.six_volumes(corners) > 0)[:, None], tets, tets[:, [1, 0, 2, 3]])


class Judge(unittest.TestCase):

    def test_knows_the_angles_of_a_regular_tet(self):
        angles = judge.dihedral_angles(CUBE[[[0, 3, 5, 6]]])
        np.testing.assert_allclose(angles, np.degrees(np.arccos(1 / 3)))

    def test_tells_volume_angles_and_distance_of_a_cube(self):
        def distance(points):
            return -np.min([points.min(axis=1), (1 - points).min(axis=1)], axis=0) + 0.25
        verdict = judge.judge(CUBE, oriented(TETS), distance=distance)
        self.assertAlmostEqual(verdict.volume, 1)
        self.assertAlmostEqual(verdict.max_deg, 90)
        self.assertAlmostEqual(verdict.min_deg, np.degrees(np.arccos(1 / 3 ** 0.5)))
        self.assertAlmostEqual(verdict.rms, 0.25)
        self.assertEqual((verdict.flat, verdict.loose), (0, 0))

    def test_counts_turned_and_flat_tets(self):
        tets = oriented(TETS)
        tets[1] = tets[1][[1, 0, 2, 3]]
        self.assertEqual(judge.judge(CUBE, tets).flat, 1)
        vertices = CUBE.copy()
        vertices[7] = (vertices[6] + vertices[5]) / 2
        self.assertEqual(judge.judge(vertices, oriented(TETS)).flat, 1)

    def test_counts_faces_of_three_tets_and_tets_that_meet_at_an_edge_alone(self):
        self.assertGreater(judge.judge(CUBE, oriented(TETS[[0, 1, 1]])).loose, 0)
        self.assertEqual(judge.judge(CUBE, oriented(TETS[[1, 2]])).loose, 1)

    def test_refuses_what_is_no_mesh(self):
        with self.assertRaisesRegex(ValueError, "without tets"):
            judge.judge(CUBE, np.empty((0, 4), int))
        with self.assertRaisesRegex(ValueError, "not finite"):
            judge.judge(CUBE * np.nan, TETS)


class Solids(unittest.TestCase):

    def test_distances_are_true_to_first_order(self):
        random = np.random.default_rng(1)
        for make in (solids.all_solids()[name] for name in ("ball", "torus", "gyroid")):
            solid = make()
            at = random.uniform(-0.9, 0.9, (200000, 3))
            far = solid.distance(at)
            near = at[np.abs(far) < 0.002]
            slope = np.stack([(solid.distance(near + step) - solid.distance(near - step)) / 2e-5
                              for step in 1e-5 * np.eye(3)])
            self.assertGreater(len(near), 50, solid.name)
            # But for the few where two surfaces meet.
            off = np.abs(np.linalg.norm(slope, axis=0) - 1)
            self.assertLess(np.median(off), 0.05, solid.name)

    def test_their_volumes_are_those_of_what_is_inside(self):
        for name in ("ball", "torus"):
            solid = solids.all_solids()[name]()
            counted = solids.volume_within(solid.distance, steps=100)
            self.assertAlmostEqual(counted / solid.volume, 1, 2, name)


class Contenders(unittest.TestCase):

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def contender(self, script, found=True):
        """Writes a mesh of as many times the cube's five tets as a length of the size goes into
        the cube, by whatever the script does before."""
        def prepare(solid, size, folder):
            code = (f"import numpy as np\n{script}\nn = max(round({size} ** -3), 1)\n"
                    f"np.savez('out.npz', vertices=np.array({CUBE.tolist()}),"
                    f" tets=np.tile({oriented(TETS).tolist()}, (n, 1)))\n")
            return [[contenders.PYTHON, "-c", code]], folder / "out.npz"
        return contenders.Contender("stand-in", "a-package", prepare, lambda: found, 1.7)

    def solid(self, **more):
        return solids.Solid("cube", None, 1, **more)

    def test_asks_for_another_size_until_there_are_about_as_many_tets(self):
        verdict, measured = compare_meshers.mesh(self.contender(""), self.solid(), 3000, 60,
                                                 self.path)
        self.assertAlmostEqual(verdict.tets / 3000, 1, delta=0.1)
        self.assertGreater(measured.cpu_seconds, 0)
        self.assertGreater(measured.peak_bytes, 1e6)

    def failure_of(self, *args, **more):
        row = compare_meshers.row_of(self.contender(*args, **more), self.solid(), 3000, 2)
        self.assertEqual(len(compare_meshers.told(row)), len(compare_meshers.HEADER))
        return row["failure"]

    def test_says_who_is_not_installed_fails_or_takes_too_long(self):
        self.assertEqual(self.failure_of("", found=False), "not installed: a-package")
        self.assertEqual(self.failure_of("raise SystemExit('no such solid')"),
                         "exit 1: no such solid")
        self.assertEqual(self.failure_of("while True: pass"), "not done after 2 s")
        self.assertEqual(self.failure_of("import os; os.abort()"), "signal 6: without a word")
        self.assertEqual(self.failure_of("raise SystemExit(0)"), "no mesh was written")

    def test_says_what_is_wrong_with_a_mesh(self):
        row = compare_meshers.row_of(self.contender(""), self.solid(labels=3), 3000, 60)
        self.assertIn("1 labels of 3", compare_meshers.told(row)[-1])
        self.assertIn("places where it is no solid", compare_meshers.told(row)[-1])

    def test_its_surfaces_files_are_read_back(self):
        path = self.path / "surface.stl"
        triangles = np.array([[0, 1, 3], [4, 5, 7]])
        contenders.write_stl(path, CUBE, triangles)
        vertices, read, _ = compare_meshers.read(path)
        np.testing.assert_array_equal(vertices[read], CUBE[triangles])


if __name__ == "__main__":
    unittest.main()
