"""Reads an .xdmf file with dolfinx, clamps the facets of one name, lets the body sag, and says what it found.

    elasticity.py MESH.xdmf CLAMPED
"""
import json
import logging
import sys
import xml.etree.ElementTree as ElementTree

import dolfinx
import numpy
import ufl
from mpi4py import MPI
from petsc4py import PETSc

for name in ("ffcx", "UFL", "root"):
    logging.getLogger(name).setLevel(logging.ERROR)


def names_of_facets(path):
    """The number of each name."""
    grid, = (grid for grid in ElementTree.parse(path).getroot().iter("Grid")
             if grid.get("Name") == "facet_tags")
    return {each.get("Value"): int(each.get("Name")) for each in grid.findall("Information")}


def integral(form):
    return dolfinx.fem.assemble_scalar(dolfinx.fem.form(form))


def main(path, clamped):
    with dolfinx.io.XDMFFile(MPI.COMM_WORLD, path, "r") as file:
        mesh = file.read_mesh(name="mesh")
        mesh.topology.create_connectivity(2, 3)
        cells = file.read_meshtags(mesh, name="cell_tags")
        facets = file.read_meshtags(mesh, name="facet_tags")
    tags = names_of_facets(path)
    one = dolfinx.fem.Constant(mesh, PETSc.ScalarType(1))
    outer = ufl.Measure("ds", domain=mesh, subdomain_data=facets)
    inner = ufl.Measure("dS", domain=mesh, subdomain_data=facets)
    areas = {name: integral(one * outer(tag)) + integral(one("+") * inner(tag)) for name, tag in tags.items()}

    space = dolfinx.fem.VectorFunctionSpace(mesh, ("CG", 1))
    held = facets.indices[facets.values == tags[clamped]]
    dofs = dolfinx.fem.locate_dofs_topological(space, 2, held)
    fixed = dolfinx.fem.dirichletbc(numpy.zeros(3, dtype=PETSc.ScalarType), dofs, space)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    weight = dolfinx.fem.Constant(mesh, PETSc.ScalarType((0, 0, -1)))

    def stress(w):
        return 500 * ufl.div(w) * ufl.Identity(3) + 800 * ufl.sym(ufl.grad(w))

    problem = dolfinx.fem.petsc.LinearProblem(
        ufl.inner(stress(u), ufl.sym(ufl.grad(v))) * ufl.dx, ufl.dot(weight, v) * ufl.dx, bcs=[fixed],
        petsc_options={"ksp_type": "preonly", "pc_type": "lu"})
    moved = problem.solve()
    # What holds it: the residual in the direction of z at the nodes that are held.
    holding = dolfinx.fem.Function(space)
    blocks = numpy.asarray(dofs)
    for block in blocks:
        holding.x.array[3 * block + 2] = 1
    residual = ufl.inner(stress(moved), ufl.sym(ufl.grad(holding))) * ufl.dx - ufl.dot(weight, holding) * ufl.dx
    plane = space.tabulate_dof_coordinates()[blocks, 2]
    print(json.dumps({
        "cell_tags": sorted(set(cells.values.tolist())),
        "areas": areas,
        "boundary_area": integral(one * ufl.ds(domain=mesh)),
        "clamped_outside_of_plane": float(plane.max() - plane.min()),
        "least_displacement": float(moved.x.array[2::3].min()),
        "reaction": integral(residual),
        "weight": integral(one * ufl.dx(domain=mesh)),
    }))


if __name__ == "__main__":
    main(*sys.argv[1:])
