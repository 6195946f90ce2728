"""Tetrahedral meshes of volumes, with guaranteed angles: made in this process, or by a server.

    import numpy as np
    import tetstream as ts

    x, y, z = np.mgrid[-1.2:1.2:41j, -1.2:1.2:41j, -1.2:1.2:41j]
    ball = ts.Volume.from_array(np.sqrt(x**2 + y**2 + z**2) - 1, spacing=0.06, origin=(-1.2, -1.2, -1.2))
    mesh = ts.mesh(ball)
    mesh.write("ball.vtu")

A volume comes from an array of distances (`Volume.from_array`), of booleans (`from_mask`) or of densities
(`from_density`), from triangles (`from_triangles`, `from_surface_file`), or from an OpenVDB file (`from_vdb`).

`mesh` makes a mesh here, `stream` makes it chunk by chunk, `estimate` counts it. The same calls make
meshes on a server:

    client = ts.Client("localhost:7447")
    mesh = client.mesh(ball)

`mesh.points` has the shape (n, 3), in world units; `mesh.tets` (m, 4), ids of points. Failures are raised as
`tetstream.Error`, of a class for each kind. `help(tetstream.Client.mesh)` has all options.
"""

from ._backends import Capabilities, StoredVolume
from ._client import Client, Estimate
from ._errors import (AccessError, CancelledError, DataLossError, DeadlineExceededError, Error,
                      FailedPreconditionError, InternalError, InvalidArgumentError, NotFoundError,
                      ResourceExhaustedError, StatusCode, UnavailableError)
from ._mesh import (Boundary, Chunk, FaceLabel, FieldArray, Header, Improvement, Mesh, MeshPart, Quality,
                    Statistics, ThinWalls)
from ._stream import MeshStream
from ._tetstream import version
from ._volume import Volume

__all__ = [
    "AccessError", "Boundary", "CancelledError", "Capabilities", "Chunk", "Client", "DataLossError",
    "DeadlineExceededError", "Error", "Estimate", "FaceLabel", "FailedPreconditionError", "FieldArray", "Header",
    "Improvement", "InternalError", "InvalidArgumentError", "Mesh", "MeshPart", "MeshStream", "NotFoundError",
    "Quality", "ResourceExhaustedError", "Statistics", "StatusCode", "StoredVolume", "ThinWalls",
    "UnavailableError", "Volume", "estimate", "mesh", "stream", "version",
]

__version__ = version()

_here = Client()
mesh = _here.mesh
stream = _here.stream
estimate = _here.estimate
