"""Areas of named facets and volumes of regions as dolfinx has them, of a mesh whose ranks each read their share.

    mpirun -n 2 python3 tags_on_ranks.py
"""

import dolfinx
import tetstream as ts
import ufl
from mpi4py import MPI
from petsc4py import PETSc

comm = MPI.COMM_WORLD
request = ts.Request(ts.sphere(1), spacing=0.12, preset="both_sides", box=((-2, -2, -2), (2, 2, 2)), faces=True)
with ts.stream(request, rank=comm.rank, size=comm.size) as stream:
    header = stream.header
    domain, cell_tags, facet_tags = stream.to_dolfinx(comm, tags=True)
one = dolfinx.fem.Constant(domain, PETSc.ScalarType(1))


def total(form):
    return comm.allreduce(dolfinx.fem.assemble_scalar(dolfinx.fem.form(form)), MPI.SUM)


cells = ufl.Measure("dx", domain, subdomain_data=cell_tags)
outer = ufl.Measure("ds", domain, subdomain_data=facet_tags)
inner = ufl.Measure("dS", domain, subdomain_data=facet_tags)
found = [f"inside {total(one * cells(1)):.4f}", f"outside {total(one * cells(2)):.4f}"]
for label in header.face_labels:
    tag = header.face_tag(label.name)
    area = total(one("+") * inner(tag)) if label.name == "interface" else total(one * outer(tag))
    found.append(f"{label.name} {area:.4f}")
if comm.rank == 0:
    print(", ".join(found))
