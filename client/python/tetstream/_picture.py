"""Small pictures of meshes, drawn with nothing but numpy."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import invalid
from ._names import Point, mask_of, point

_FACES_OF_TET = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
_PLAIN = np.array([0.62, 0.71, 0.80])
_UNKNOWN = np.array([0.5, 0.5, 0.5])  # what values that are not finite are painted in
# From low to high, evenly: dark blue, green, yellow, as eyes that do not see all colours tell them apart.
_COLOURS = np.array([[0.27, 0.00, 0.33], [0.23, 0.32, 0.55], [0.13, 0.57, 0.55], [0.37, 0.79, 0.38],
                     [0.99, 0.91, 0.14]])


def boundary_of(tets: NDArray[Any]) -> NDArray[np.int64]:
    """The triangles that one tet has, and no other; shape (n, 3)."""
    faces = np.concatenate([tets[:, corners] for corners in _FACES_OF_TET]).astype(np.int64)
    keys = np.sort(faces, axis=1)
    order = np.lexsort(keys.T)
    same = np.all(keys[order][1:] == keys[order][:-1], axis=1)
    alone = np.ones(len(faces), dtype=bool)
    alone[1:] &= ~same
    alone[:-1] &= ~same
    found: NDArray[np.int64] = faces[order[alone]]
    return found


def picture(
    points: NDArray[np.float64],
    triangles: NDArray[Any],
    values: ArrayLike | None,
    size: tuple[int, int],
    view: Point,
) -> bytes:
    """A PNG of triangles, seen against the direction `view` with z upwards; coloured by values at points."""
    width, height = size
    if not (0 < width <= 4096 and 0 < height <= 4096):
        raise invalid(f"size {width} x {height}: each may be 1 to 4096 pixels")
    image = np.full((height, width, 3), 255, np.uint8)
    if len(triangles):
        colours = None if values is None else _colours_of(_unmasked(values), len(points))
        _draw(image, _Camera(points, view, width, height).see(points), triangles, colours)
    return _png(image)


class _Camera:
    """Looks at all of the points, without perspective."""

    def __init__(self, points: NDArray[np.float64], view: Point, width: int, height: int) -> None:
        towards = np.array(point("view", view))
        if not np.any(towards):
            raise invalid("view is (0, 0, 0), which is no direction")
        towards /= np.linalg.norm(towards)
        up = np.array([0.0, 1.0, 0.0] if abs(towards[2]) > 0.999 else [0.0, 0.0, 1.0])
        right = np.cross(up, towards)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, -np.cross(towards, right), towards], axis=1)
        flat = points @ self.axes
        low, high = flat[:, :2].min(axis=0), flat[:, :2].max(axis=0)
        extent = np.maximum(high - low, 1e-300)
        self.scale = 0.9 * min(width / extent[0], height / extent[1])
        self.shift = np.array([width, height]) / 2 - self.scale * (low + high) / 2

    def see(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Columns: pixels to the right, pixels down, and towards the eye."""
        flat: NDArray[np.float64] = points @ self.axes
        flat[:, :2] = flat[:, :2] * self.scale + self.shift
        flat[:, 2] *= self.scale
        return flat


def _draw(
    image: NDArray[np.uint8], seen: NDArray[np.float64], triangles: NDArray[Any], colours: NDArray[np.float64] | None
) -> None:
    """Paints each triangle with as many dots as it has pixels, the nearest dot over all others."""
    height, width = image.shape[:2]
    corners = seen[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    towards_us = normals[:, 2] < 0  # as pixels count downwards
    triangles, corners, normals = triangles[towards_us], corners[towards_us], normals[towards_us]
    lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    light = np.abs(normals @ np.array([-0.35, -0.5, 0.79])) / lengths
    darkest = 0.25 if colours is None else 0.6  # where they say something, colours stay what they are
    shade = (darkest + (1 - darkest) * light)[:, None]
    longest = np.sqrt(((corners - np.roll(corners, 1, axis=1))[:, :, :2] ** 2).sum(axis=2).max(axis=1))
    steps = np.clip(np.ceil(1.5 * longest).astype(np.int64), 1, 4 * max(width, height))
    nearest = np.full(height * width, -np.inf)
    flat = image.reshape(-1, 3)
    for step in np.unique(steps):
        chosen = np.flatnonzero(steps == step)
        weights = _dots(int(step))
        for some in np.array_split(chosen, -(-len(chosen) * len(weights) // 2_000_000)):
            dots = np.einsum("dk,tkc->tdc", weights, corners[some]).reshape(-1, 3)
            if colours is None:
                paint = np.repeat(_PLAIN * shade[some], len(weights), axis=0)
            else:
                mixed = np.einsum("dk,tkc->tdc", weights, colours[triangles[some]])
                paint = (mixed * shade[some][:, None]).reshape(-1, 3)
            _splat(flat, nearest, dots, paint, width, height)


def _splat(
    flat: NDArray[np.uint8],
    nearest: NDArray[np.float64],
    dots: NDArray[np.float64],
    paint: NDArray[np.float64],
    width: int,
    height: int,
) -> None:
    x, y = (np.clip(dots[:, i].astype(np.int64), 0, most - 1) for i, most in ((0, width), (1, height)))
    pixels = y * width + x
    order = np.argsort(dots[:, 2])
    order = order[dots[order, 2] > nearest[pixels[order]]]  # of those in one pixel the last one stays
    nearest[pixels[order]] = dots[order, 2]
    flat[pixels[order]] = np.clip(255 * paint[order], 0, 255).astype(np.uint8)


def _dots(steps: int) -> NDArray[np.float64]:
    """Weights of a triangle's corners, at points that are as far apart as its longest edge over `steps`."""
    i, j = np.meshgrid(np.arange(steps + 1), np.arange(steps + 1))
    inside = i + j <= steps
    a, b = i[inside] / steps, j[inside] / steps
    return np.stack([a, b, 1 - a - b], axis=1)


def _unmasked(values: ArrayLike) -> NDArray[np.float64]:
    """NaN where there is a mask."""
    return np.where(mask_of(values), np.nan, np.asarray(values, dtype=np.float64))


def _colours_of(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    if values.shape != (count,):
        raise invalid(f"values have the shape {values.shape}; one for each of {count} points is needed")
    mixed = np.tile(_UNKNOWN, (count, 1))
    known = np.isfinite(values)
    if known.any():
        halves = values[known] / 2  # of which differences are finite, too
        low, high = halves.min(), halves.max()
        place = (halves - low) / (high - low if high > low else 1.0) * (len(_COLOURS) - 1)
        below = np.minimum(place.astype(np.int64), len(_COLOURS) - 2)
        share = (place - below)[:, None]
        mixed[known] = (1 - share) * _COLOURS[below] + share * _COLOURS[below + 1]
    return mixed


def _png(image: NDArray[np.uint8]) -> bytes:
    height, width = image.shape[:2]

    def part(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, -1)], axis=1)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head) + part(b"IDAT", zlib.compress(rows.tobytes()))
            + part(b"IEND", b""))
