"""Finite elements of first order on a mesh of ours, by dolfinx: how far a solution is from the true one."""
import logging
import math

import dolfinx
import numpy
import ufl
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI
from petsc4py import PETSc

logging.getLogger("ffcx").setLevel(logging.ERROR)
logging.getLogger("UFL").setLevel(logging.ERROR)
logging.getLogger("root").setLevel(logging.ERROR)

LAME = (1.0, 0.5)  # the first constant, and the shear modulus


def domain_of(points, tets):
    """A dolfinx mesh of (n, 3) points and (m, 4) ids."""
    cell = ufl.Cell("tetrahedron", geometric_dimension=3)
    return dolfinx.mesh.create_mesh(MPI.COMM_WORLD, tets.astype(numpy.int64), points,
                                    ufl.Mesh(ufl.VectorElement("Lagrange", cell, 1)))


def poisson(domain):
    """The L2 error of a Poisson problem whose solution is smooth and known."""
    x = ufl.SpatialCoordinate(domain)
    true = ufl.sin(3 * x[0]) * ufl.cos(2 * x[1]) * ufl.exp(x[2])
    space = dolfinx.fem.FunctionSpace(domain, ("CG", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    return _error(space, ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx,
                  -ufl.div(ufl.grad(true)) * v * ufl.dx, true,
                  lambda y: numpy.sin(3 * y[0]) * numpy.cos(2 * y[1]) * numpy.exp(y[2]))


def elasticity(domain):
    """The L2 error of the displacements of an elastic body, which are smooth and known."""
    x = ufl.SpatialCoordinate(domain)
    true = ufl.as_vector((ufl.sin(3 * x[0]) * ufl.cos(2 * x[1]), ufl.exp(x[2]) * x[0],
                          ufl.cos(2 * x[0] + x[1])))
    space = dolfinx.fem.VectorFunctionSpace(domain, ("CG", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)

    def stress(w):
        return LAME[0] * ufl.div(w) * ufl.Identity(3) + 2 * LAME[1] * ufl.sym(ufl.grad(w))

    return _error(space, ufl.inner(stress(u), ufl.sym(ufl.grad(v))) * ufl.dx,
                  ufl.inner(-ufl.div(stress(true)), v) * ufl.dx, true,
                  lambda y: numpy.stack((numpy.sin(3 * y[0]) * numpy.cos(2 * y[1]),
                                         numpy.exp(y[2]) * y[0],
                                         numpy.cos(2 * y[0] + y[1]))))


def _error(space, bilinear, linear, true, values):
    """Solves with the true values on the boundary; the L2 norm of what is wrong inside."""
    domain = space.mesh
    domain.topology.create_connectivity(2, 3)
    boundary = dolfinx.fem.Function(space)
    boundary.interpolate(values)
    facets = dolfinx.mesh.exterior_facet_indices(domain.topology)
    fixed = dolfinx.fem.dirichletbc(
        boundary, dolfinx.fem.locate_dofs_topological(space, 2, facets))
    multigrid = "hypre" if PETSc.Sys.hasExternalPackage("hypre") else "gamg"
    solution = LinearProblem(bilinear, linear, [fixed], petsc_options={
        "ksp_type": "cg", "pc_type": multigrid, "ksp_rtol": 1e-9}).solve()
    wrong = ufl.inner(solution - true, solution - true)
    return math.sqrt(dolfinx.fem.assemble_scalar(dolfinx.fem.form(
        wrong * ufl.dx(metadata={"quadrature_degree": 4}))))
