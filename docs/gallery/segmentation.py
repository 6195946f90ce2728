#!/usr/bin/python3
"""Makes a segmentation for docs/gallery.md: whole numbers, one a voxel, as a .npy file.

    docs/gallery/segmentation.py grains|shells|nest FILE.npy

grains  20 Voronoi cells in a cube, as crystals grow
shells  five spheres, one in the other
nest    a lobed body in which a folded sheet lies around a core with two hollows, as in a head
"""
import sys

import numpy as np

EDGE = 128  # voxels


def places():
    """Coordinates of the voxels' middles, from -1 to 1 along each axis."""
    along = (np.arange(EDGE, dtype=np.float32) + 0.5) * 2 / EDGE - 1
    return np.meshgrid(along, along, along, indexing="ij")


def grains():
    seeds = np.random.default_rng(20).uniform(-0.8, 0.8, (20, 3)).astype(np.float32)
    x, y, z = places()
    distances = np.stack([(x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 for a, b, c in seeds])
    inside = np.maximum.reduce([abs(x), abs(y), abs(z)]) < 0.8
    return np.where(inside, distances.argmin(axis=0) + 1, 0)


def shells():
    x, y, z = places()
    radius = np.sqrt(x ** 2 + y ** 2 + z ** 2)
    return np.searchsorted([0.18, 0.36, 0.54, 0.72, 0.9], radius).clip(0, 5).choose([5, 4, 3, 2, 1, 0])


def nest():
    x, y, z = places()
    radius = np.sqrt((x / 0.9) ** 2 + (y / 0.75) ** 2 + (z / 0.8) ** 2)
    folds = sum(np.sin(13 * a) * np.cos(13 * b) for a, b in ((x, y), (y, z), (z, x)))
    depth = radius + 0.06 * folds
    labels = np.zeros((EDGE,) * 3, np.int64)
    labels[radius < 0.97] = 1  # what is around
    labels[depth < 0.82] = 2   # the folded sheet
    labels[depth < 0.7] = 3    # the core
    for side in (-1, 1):
        hollow = ((x - side * 0.2) / 0.1) ** 2 + ((y - 0.05) / 0.32) ** 2 + ((z + 0.1 * y) / 0.12) ** 2
        labels[hollow < 1] = 4
    return labels


def main():
    makers = {"grains": grains, "shells": shells, "nest": nest}
    if len(sys.argv) != 3 or sys.argv[1] not in makers:
        sys.exit(__doc__)
    np.save(sys.argv[2], makers[sys.argv[1]]().astype(np.int16))


if __name__ == "__main__":
    main()
