"""A drop that falls into a tank, followed by a session: each frame's mesh, and the temperature that stays with
the liquid, carried from mesh to mesh.

    python3 examples/python/moving_liquid.py [HOST:PORT]
"""

import sys

import numpy as np
import tetstream as ts

SPACING = 0.05
AXIS = np.arange(-1, 1 + SPACING / 2, SPACING)
X, Y, Z = np.meshgrid(AXIS, AXIS, AXIS, indexing="ij")


def liquid(time):
    """Distances to the tank's surface, with the ripple that the drop makes, and to the drop."""
    radius = np.sqrt(X**2 + Y**2)
    ripple = 0.08 * time * np.cos(9 * radius - 4 * time) * np.exp(-2 * radius)
    tank = np.maximum(Z + 0.4 - ripple, np.maximum(np.maximum(np.abs(X), np.abs(Y)) - 0.85, -0.85 - Z))
    drop = np.sqrt(X**2 + Y**2 + (Z - 0.6 + 0.7 * time) ** 2) - 0.25
    return ts.Volume.from_array(np.minimum(tank, drop), spacing=SPACING, origin=(-1, -1, -1))


def carried(values, old, new):
    """Values at the vertices of the old mesh, at those of the new one: what was kept keeps its value, and all
    others get the mean of those around them, ring by ring."""
    both = np.concatenate([old.local_points, new.local_points])
    place = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    known = np.full(place.max() + 1, np.nan)
    known[place[:len(values)]] = values
    result = known[place[len(values):]]
    while np.isnan(result).any():
        corners = result[new.tets]
        there = ~np.isnan(corners)
        sums, counts = (np.bincount(new.tets.ravel(), np.repeat(of_tet, 4), len(result))
                        for of_tet in (np.where(there, corners, 0).sum(axis=1), there.sum(axis=1)))
        reached = np.isnan(result) & (counts > 0)
        if not reached.any():
            return np.where(np.isnan(result), 0, result)  # a piece that is new has no warmth of its own
        result[reached] = sums[reached] / counts[reached]
    return result


client = ts.Client(sys.argv[1] if len(sys.argv) > 1 else ":local:")
with client.session(liquid(0)) as session:
    mesh = session.mesh
    warmth = np.where(mesh.points[:, 2] > 0, 1.0, 0.0)  # the drop is warm, the tank is cold
    for step in range(1, 17):
        frame = session.update(liquid(step / 16))
        warmth = carried(warmth, mesh, frame)
        mesh = frame
        print(f"{step / 16:.3f} s: {len(mesh.tets):6d} tets, {session.tets_sent:6d} of them new, "
              f"warmth {warmth.min():.2f} to {warmth.max():.2f}")
mesh.picture("moving_liquid.png", values=warmth)
