"""Dihedral angles and volumes, measured by numpy where nobody has told them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_TETS_AT_ONCE = 100_000
_FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # counter-clockwise from outside
_EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))  # as pairs of faces


def measure(
    points: NDArray[np.floating[Any]], tets: NDArray[np.unsignedinteger[Any]]
) -> tuple[float, float, float, NDArray[np.uint64]]:
    """The smallest and the largest angle in degrees, the volume, and how many angles lie in each degree."""
    low, high, volume = 180.0, 0.0, 0.0
    histogram = np.zeros(180, np.uint64)
    for begin in range(0, len(tets), _TETS_AT_ONCE):
        corners = points[tets[begin:begin + _TETS_AT_ONCE]].astype(np.float64)
        a, b, c, d = corners.transpose(1, 0, 2)
        volume += float(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum()) / 6
        angles = _angles(corners)
        low, high = min(low, float(angles.min())), max(high, float(angles.max()))
        degrees = np.minimum(angles.astype(np.int64), 179)
        histogram += np.bincount(degrees.ravel(), minlength=180).astype(np.uint64)
    return low, high, volume, histogram


def _angles(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    normals = []
    for i, j, k in _FACES:
        normal = np.cross(corners[:, j] - corners[:, i], corners[:, k] - corners[:, i])
        normals.append(normal / np.linalg.norm(normal, axis=1, keepdims=True))
    cosines = np.stack([np.einsum("ij,ij->i", normals[f], normals[g]) for f, g in _EDGES])
    angles: NDArray[np.float64] = 180 - np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    return angles
