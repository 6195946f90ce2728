"""What is solved on a mesh of ours converges as the spacing falls.

    convergence_test.py            # the claims
    convergence_test.py --table    # the errors that docs/sizing.md has, in some ten minutes
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import meshio
import numpy

import finite_elements

BALL = {"nodes": [{"sphere": {"radius": 1}}]}
SPACINGS = (0.1, 0.05, 0.025)
SIZES = {
    "uniform": ("--levels", "0"),
    "1 level (default)": (),
    "2 levels": ("--levels", "2"),
    "3 levels": ("--levels", "3"),
    "as coarse as it gets": ("--levels", "max"),
    "growth 1/2": ("--sizing", '{"growth": 0.5}'),
    "growth 1/4": ("--sizing", '{"growth": 0.25}'),
    "growth 1/8": ("--sizing", '{"growth": 0.125}'),
}


def mesh_of_ball(spacing, *options):
    """The points and tets that the command writes."""
    with tempfile.TemporaryDirectory() as folder:
        scene, out = pathlib.Path(folder, "ball.json"), pathlib.Path(folder, "ball.vtu")
        scene.write_text(json.dumps(BALL), encoding="utf-8")
        program = pathlib.Path(os.environ["TETSTREAM_BIN"], "tetstream")
        subprocess.run([program, "mesh", scene, "-o", out, "--spacing", str(spacing), *options],
                       check=True, capture_output=True)
        mesh = meshio.read(out)
        return numpy.asarray(mesh.points, float), mesh.cells_dict["tetra"]


def order(errors, spacings):
    """How fast an error falls between two spacings."""
    return math.log(errors[0] / errors[1]) / math.log(spacings[0] / spacings[1])


class Convergence(unittest.TestCase):
    """By halving the spacing once; the orders at finer ones are higher."""

    def errors(self, problem, *options):
        return [problem(finite_elements.domain_of(*mesh_of_ball(spacing, *options)))
                for spacing in SPACINGS[1:]]

    def test_a_poisson_problem_on_the_default_mesh_converges_nearly_as_on_a_uniform_one(self):
        self.assertGreater(order(self.errors(finite_elements.poisson), SPACINGS[1:]), 1.8)

    def test_so_does_an_elastic_body(self):
        self.assertGreater(order(self.errors(finite_elements.elasticity), SPACINGS[1:]), 1.8)

    def test_on_a_mesh_as_coarse_as_it_gets_it_does_not(self):
        errors = self.errors(finite_elements.poisson, "--levels", "max")
        self.assertLess(order(errors, SPACINGS[1:]), 1)


def print_table():
    """A row for each choice of sizes: tets, errors and orders at each spacing.

    Of the elastic body without the finest spacing: its system has three times as many unknowns.
    """
    for name, options in SIZES.items():
        row, before = [], None
        for spacing in SPACINGS:
            points, tets = mesh_of_ball(spacing, *options)
            domain = finite_elements.domain_of(points, tets)
            problems = [finite_elements.poisson]
            if spacing != SPACINGS[-1]:
                problems.append(finite_elements.elasticity)
            now = [problem(domain) for problem in problems]
            orders = [f" ({order((b, e), (before[0], spacing)):.2f})" if before else ""
                      for b, e in zip(before[1] if before else now, now)]
            row += [f"{len(tets):,}"] + [f"{e:.2g}{o}" for e, o in zip(now, orders)]
            before = (spacing, now)
        print(f"| {name} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["--table"]:
        print_table()
    else:
        unittest.main()
