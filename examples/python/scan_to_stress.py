"""A scan to a stress plot: triangles of a body become a mesh, dolfinx presses on it, and the picture shows where it
gives way.

    python3 examples/python/scan_to_stress.py [SCAN.stl VOXEL_SIZE]
"""

import sys

import dolfinx
import numpy as np
import tetstream as ts
import ufl
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI


def scanned():
    """A scan's triangles: unless a file is given, those of a bone of our own."""
    if len(sys.argv) > 1:
        return ts.Volume.from_surface_file(sys.argv[1], voxel_size=float(sys.argv[2]), open="close")
    bone = ts.union(ts.capsule(0.25, 1.4), ts.sphere(0.42, center=(0.08, 0, 0.8)),
                    ts.sphere(0.38, center=(0, 0.05, -0.8)), smoothing=0.3) - ts.cylinder(0.1, 1.2)
    scan = ts.mesh(bone, spacing=0.05, faces=True)
    return ts.Volume.from_triangles(scan.points, scan.faces, voxel_size=0.05)


mesh = ts.mesh(scanned(), spacing=0.06, improve=True)
domain = mesh.to_dolfinx(MPI.COMM_SELF)

# Linear elasticity: the lower end is held, and the upper one is pressed down by a hundredth of the height.
low, high = mesh.points[:, 2].min(), mesh.points[:, 2].max()
height, young, poisson = high - low, 17e9, 0.3  # of cortical bone, in pascals
mu, lame = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
space = dolfinx.fem.VectorFunctionSpace(domain, ("CG", 1))


def strain(u):
    return ufl.sym(ufl.grad(u))


def stress(u):
    return lame * ufl.tr(strain(u)) * ufl.Identity(3) + 2 * mu * strain(u)


def held(where, displacement):
    value = dolfinx.fem.Function(space)
    value.x.array[:] = np.tile(displacement, len(value.x.array) // 3)
    return dolfinx.fem.dirichletbc(value, dolfinx.fem.locate_dofs_geometrical(space, where))


u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
zero = dolfinx.fem.Function(space)
moved = LinearProblem(
    ufl.inner(stress(u), strain(v)) * ufl.dx, ufl.inner(zero, v) * ufl.dx,
    [held(lambda x: x[2] < low + 0.05 * height, (0.0, 0.0, 0.0)),
     held(lambda x: x[2] > high - 0.05 * height, (0.0, 0.0, -0.01 * height))],
    petsc_options={"ksp_type": "preonly", "pc_type": "lu"}).solve()

# Von Mises stress of each tet, as the mean of it at each vertex.
deviator = stress(moved) - ufl.tr(stress(moved)) / 3 * ufl.Identity(3)
cells = dolfinx.fem.FunctionSpace(domain, ("DG", 0))
mises = dolfinx.fem.Function(cells)
mises.interpolate(dolfinx.fem.Expression(ufl.sqrt(1.5 * ufl.inner(deviator, deviator)),
                                         cells.element.interpolation_points()))
cell_of = np.asarray(domain.topology.original_cell_index)  # dolfinx has an order of its own
of_tets = np.empty(len(mesh.tets))
of_tets[cell_of] = mises.x.array[:len(cell_of)]
sums, counts = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))
for corner in range(4):
    np.add.at(sums, mesh.tets[:, corner], of_tets)
    np.add.at(counts, mesh.tets[:, corner], 1)
mesh.picture("scan_to_stress.png", values=sums / counts, size=(480, 640))
print(f"{len(mesh.tets)} tets, stress {np.median(of_tets) / 1e6:.0f} MPa in the middle, "
      f"{of_tets.max() / 1e6:.0f} MPa at most")
