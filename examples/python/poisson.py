"""A Poisson problem on a mesh that no rank ever has whole: each reads its share from a stream.

    mpirun -n 2 python3 examples/python/poisson.py [HOST:PORT]
"""

import sys

import dolfinx
import tetstream as ts
import ufl
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI

comm = MPI.COMM_WORLD
client = ts.Client(sys.argv[1] if len(sys.argv) > 1 else ":local:")
part = ts.box((2, 2, 1), rounding=0.1) - ts.cylinder(0.5, 2)
stream = client.stream(part, spacing=0.06, rank=comm.rank, size=comm.size)
domain = stream.to_dolfinx(comm)
print(f"rank {comm.rank}: {stream.share.tet_count} of {stream.header.tet_count} tets", flush=True)

# -div(grad u) = 1, and u = 0 on the surface.
space = dolfinx.fem.FunctionSpace(domain, ("CG", 1))
u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
domain.topology.create_connectivity(2, 3)
surface = dolfinx.fem.locate_dofs_topological(space, 2, dolfinx.mesh.exterior_facet_indices(domain.topology))
fixed = dolfinx.fem.dirichletbc(0.0, surface, space)
solution = LinearProblem(ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, v * ufl.dx, [fixed],
                         petsc_options={"ksp_type": "cg", "pc_type": "gamg", "ksp_rtol": 1e-10}).solve()
energy = comm.allreduce(dolfinx.fem.assemble_scalar(dolfinx.fem.form(solution * ufl.dx)))
if comm.rank == 0:
    print(f"on {comm.size} ranks the solution's integral is {energy:.9f}")
