"""A ball from an array of distances: meshed in this process, and written for ParaView."""

import numpy as np
import tetstream as ts

x, y, z = np.mgrid[-1.2:1.2:41j, -1.2:1.2:41j, -1.2:1.2:41j]
ball = ts.Volume.from_array(np.sqrt(x**2 + y**2 + z**2) - 1, spacing=0.06, origin=(-1.2, -1.2, -1.2))
mesh = ts.mesh(ball)
mesh.write("ball.vtu")
print(f"{mesh!r}, volume {mesh.quality().volume:.3f}")
