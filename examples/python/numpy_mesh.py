"""A numpy array to a mesh in five lines, with a picture of it: a Schwarz P surface in a ball."""

import numpy as np
import tetstream as ts

x, y, z = np.mgrid[-1.1:1.1:56j, -1.1:1.1:56j, -1.1:1.1:56j]
sheet = np.abs(np.cos(6 * x) + np.cos(6 * y) + np.cos(6 * z)) / 10 - 0.06
phi = np.maximum(sheet, np.sqrt(x**2 + y**2 + z**2) - 1)
mesh = ts.mesh(ts.Volume.from_array(phi, spacing=0.04, origin=(-1.1, -1.1, -1.1)), improve=True)
mesh.picture("numpy_mesh.png")
print(mesh, mesh.quality())
