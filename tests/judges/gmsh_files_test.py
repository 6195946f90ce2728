"""dolfinx opens our .msh files as its documentation says, with the groups that gmsh sees in them.

    gmsh_files_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import dolfinx
import gmsh
import numpy
import ufl
from dolfinx.io import gmshio
from mpi4py import MPI

BALL = {"nodes": [{"sphere": {"radius": 1}}]}


class GmshFiles(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def written(self, *options):
        scene, out = self.folder / "ball.json", self.folder / "ball.msh"
        report = self.folder / "report.json"
        scene.write_text(json.dumps(BALL), encoding="utf-8")
        program = pathlib.Path(os.environ["TETSTREAM_BIN"], "tetstream")
        subprocess.run([program, "mesh", scene, "-o", out, "--spacing", "0.1", "--report", report,
                        *options], check=True, capture_output=True)
        return out, json.loads(report.read_text(encoding="utf-8"))

    def groups_of(self, path):
        """{(dimension, name): tag} as gmsh reads them."""
        gmsh.initialize()
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.open(str(path))
            return {(dimension, gmsh.model.getPhysicalName(dimension, tag)): tag
                    for dimension, tag in gmsh.model.getPhysicalGroups()}
        finally:
            gmsh.finalize()

    def opened(self, path):
        """As gmshio.read_from_msh does, whose version in Debian 12 forgets to say what it returns."""
        gmsh.initialize()
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.model.add("Mesh from file")
            gmsh.merge(str(path))
            return gmshio.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0)
        finally:
            gmsh.finalize()

    def measure(self, mesh, tags, tag):
        """Volume of the cells with a tag."""
        dx = ufl.Measure("dx", domain=mesh, subdomain_data=tags)
        one = dolfinx.fem.Constant(mesh, numpy.float64(1))
        return dolfinx.fem.assemble_scalar(dolfinx.fem.form(one * dx(tag)))

    def test_a_mesh_as_it_comes(self):
        path, report = self.written()
        groups = self.groups_of(path)
        mesh, cells, _ = self.opened(path)
        self.assertEqual(mesh.topology.index_map(3).size_local, report["tets"])
        self.assertEqual(len(cells.values), report["tets"])
        self.assertAlmostEqual(self.measure(mesh, cells, groups[3, "inside"]), report["volume"], 6)

    def test_inside_and_outside(self):
        path, report = self.written("--preset", "both-sides", "--box", *"-2 -2 -2 2 2 2".split())
        groups = self.groups_of(path)
        mesh, cells, _ = self.opened(path)
        inside = self.measure(mesh, cells, groups[3, "inside"])
        outside = self.measure(mesh, cells, groups[3, "outside"])
        self.assertAlmostEqual(inside, 4.19, delta=0.1)
        self.assertAlmostEqual(inside + outside, report["volume"], delta=1e-3)

    def test_the_faces_of_a_box_that_cuts(self):
        path, _ = self.written("--box", *"-2 -2 -2 0 2 2".split())
        groups = self.groups_of(path)
        self.assertIn((2, "surface"), groups)
        mesh, _, facets = self.opened(path)
        ds = ufl.Measure("ds", domain=mesh, subdomain_data=facets)
        one = dolfinx.fem.Constant(mesh, numpy.float64(1))
        cut = dolfinx.fem.assemble_scalar(dolfinx.fem.form(one * ds(groups[2, "cut_x_max"])))
        self.assertAlmostEqual(cut, numpy.pi, delta=0.06)


if __name__ == "__main__":
    unittest.main(verbosity=2)
