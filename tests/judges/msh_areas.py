"""Reads a .msh file with dolfinx and says the areas of its physical surfaces in one line of JSON.

    msh_areas.py MESH.msh
"""
import json
import logging
import sys

import dolfinx
import gmsh
import ufl
from dolfinx.io import gmshio
from mpi4py import MPI
from petsc4py import PETSc

for name in ("ffcx", "UFL", "root"):
    logging.getLogger(name).setLevel(logging.ERROR)


def main(path):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    names = {gmsh.model.getPhysicalName(2, tag): tag for _, tag in gmsh.model.getPhysicalGroups(2)}
    mesh, _, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0, gdim=3)
    gmsh.finalize()
    one = dolfinx.fem.Constant(mesh, PETSc.ScalarType(1))
    outer = ufl.Measure("ds", domain=mesh, subdomain_data=facets)
    print(json.dumps({name: dolfinx.fem.assemble_scalar(dolfinx.fem.form(one * outer(tag)))
                      for name, tag in names.items()}))


if __name__ == "__main__":
    main(*sys.argv[1:])
