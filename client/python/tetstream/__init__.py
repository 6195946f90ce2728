"""Tetrahedral meshes of volumes, with guaranteed angles: made in this process, or by a server.

    import numpy as np
    import tetstream as ts

    x, y, z = np.mgrid[-1.2:1.2:41j, -1.2:1.2:41j, -1.2:1.2:41j]
    ball = ts.Volume.from_array(np.sqrt(x**2 + y**2 + z**2) - 1, spacing=0.06, origin=(-1.2, -1.2, -1.2))
    mesh = ts.mesh(ball)
    mesh.write("ball.vtu")

A volume comes from an array of distances (`Volume.from_array`), of booleans (`from_mask`) or of densities
(`from_density`), from triangles (`from_triangles`, `from_surface_file`), or from an OpenVDB file (`from_vdb`,
`from_openvdb`). `Labels` are a segmentation, and their mesh has all of them. A solid is an expression, and
is meshed like a volume:

    part = ts.box((4, 4, 1)) - ts.cylinder(0.5, 2)
    ts.mesh(part, spacing=0.1).picture("part.png")

`mesh` makes a mesh here, `stream` makes it chunk by chunk, `estimate` counts it; `sample` tells of points. The same calls make
meshes on a server; a client also has sessions, which follow a shape that moves, and jobs:

    client = ts.Client("localhost:7447")
    mesh = client.mesh(ball)

`Client(":local:")` has all of that and no server; `AsyncClient` has it for asyncio.

`mesh.points` has the shape (n, 3), in world units; `mesh.tets` (m, 4), ids of points. Failures are raised as
`tetstream.Error`, of a class for each kind. `help(tetstream.Client.mesh)` has all options.
"""

from ._async import AsyncClient, AsyncJobs, AsyncJobWatch, AsyncMeshStream, AsyncSession, AsyncStableSession
from ._backends import Capabilities
from ._client import Client, Estimate
from ._errors import (AccessError, CancelledError, DataLossError, DeadlineExceededError, Error,
                      FailedPreconditionError, InternalError, InvalidArgumentError, NotFoundError,
                      ResourceExhaustedError, StatusCode, UnavailableError)
from ._job import Job, JobEvent, JobProgress
from ._job_watch import JobWatch
from ._jobs import Jobs
from ._labels import Labels
from ._header import (Boundary, FaceLabel, Fidelity, FieldArray, Header, Improvement, MeshLabel, MeshPart, Quality,
                      Ratio, Shapes, Statistics, SurfaceDistance, ThinWalls)
from ._mesh import Chunk, Mesh
from ._request import Request, StoredVolume
from ._samples import Samples
from ._session import Session
from ._share import Share
from ._solid import (Solid, box, capsule, cone, cylinder, diamond, difference, ellipsoid, grid, gyroid, half_space,
                     intersection, read_scene, schwarz_p, sphere, torus, union)
from ._stable import StableMesh, StableSession
from ._stream import MeshStream
from ._tetstream import version
from ._volume import Volume

__all__ = [
    "AccessError", "AsyncClient", "AsyncJobWatch", "AsyncJobs", "AsyncMeshStream", "AsyncSession",
    "AsyncStableSession", "Boundary", "CancelledError", "Capabilities", "Chunk", "Client", "DataLossError", "DeadlineExceededError", "Error",
    "Estimate", "FaceLabel", "FailedPreconditionError", "Fidelity", "FieldArray", "Header", "Improvement",
    "InternalError", "InvalidArgumentError", "Job", "JobEvent", "JobProgress", "JobWatch", "Jobs", "Labels",
    "Mesh", "MeshLabel", "MeshPart", "MeshStream", "NotFoundError", "Quality", "Ratio", "Request",
    "ResourceExhaustedError", "Samples", "Session", "Shapes", "Share", "Solid", "StableMesh", "StableSession",
    "Statistics", "StatusCode", "StoredVolume", "SurfaceDistance", "ThinWalls", "UnavailableError", "Volume", "box", "capsule", "cone",
    "cylinder", "diamond", "difference", "ellipsoid", "estimate", "grid", "gyroid", "half_space",
    "intersection", "mesh", "read_scene", "sample", "schwarz_p", "session", "sphere", "stable_session",
    "stream", "torus",
    "union", "version",
]

__version__ = version()

_here = Client()
mesh = _here.mesh
stream = _here.stream
estimate = _here.estimate
sample = _here.sample
session = _here.session
stable_session = _here.stable_session
