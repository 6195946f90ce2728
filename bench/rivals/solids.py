"""What the rivals mesh: solids of which the true surface is known, and an image of labels.

A Solid tells how far points are from its surface, and what it is made of for whoever meshes it: a
scene of tetstream, a name of bench/rivals/mesh3_solids.cpp, triangles, or voxels with labels.
"""
import dataclasses
import functools
import pathlib

import numpy as np

BUNNY = pathlib.Path("/usr/share/glmark2/models/bunny.obj")  # package glmark2-data
TORUS = (0.75, 0.25)  # radius of the ring and of its tube
PERIOD = 0.7          # of the gyroid
EDGE = 64             # voxels of the image of grains
GRAINS = 20


@dataclasses.dataclass(frozen=True)
class Solid:
    """A solid of about unit size.

    distance   of points (n, 3) to the surface (n), to first order at the surface; negative inside;
               None where it is not known
    volume     as it truly is
    scene      as a scene of tetstream, or None
    triangles  whether it is given as triangles
    labels     how many it has
    """
    name: str
    distance: object
    volume: float
    scene: object = None
    triangles: bool = False
    labels: int = 1


def ball_distance(points):
    return np.linalg.norm(points, axis=1) - 1


def torus_distance(points):
    ring, tube = TORUS
    return np.hypot(np.hypot(points[:, 0], points[:, 1]) - ring, points[:, 2]) - tube


def gyroid_distance(points):
    """Where the gyroid's value is negative in the ball: value by slope."""
    at = points * (2 * np.pi / PERIOD)
    (sx, sy, sz), (cx, cy, cz) = np.sin(at).T, np.cos(at).T
    value = sx * cy + sy * cz + sz * cx
    slope = np.stack([cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz])
    steep = np.linalg.norm(slope, axis=0) * (2 * np.pi / PERIOD)
    return np.maximum(ball_distance(points), value / np.maximum(steep, 1e-9))


def volume_within(distance, reach=1.05, steps=400):
    """Of what is inside, by midpoints of a lattice; the error is about a part in ten thousand."""
    step = 2 * reach / steps
    along = (np.arange(steps) + 0.5) * step - reach
    inside = 0
    for z in along:  # slice by slice, in little memory
        x, y = np.meshgrid(along, along)
        at = np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1)
        inside += np.count_nonzero(distance(at) < 0)
    return inside * step ** 3


@functools.cache
def bunny_triangles():
    """(vertices (n, 3), triangles (m, 3)) of the scan."""
    vertices, triangles = [], []
    with open(BUNNY, encoding="ascii") as file:
        for line in file:
            kind, *words = line.split() or [""]
            if kind == "v":
                vertices.append([float(word) for word in words])
            elif kind == "f":
                triangles.append([int(word.split("/")[0]) - 1 for word in words])
    return np.array(vertices), np.array(triangles)


def triangles_volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return abs(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


def bunny_distance(points):
    """Without a sign."""
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonCore import reference
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator
    vertices, triangles = bunny_triangles()
    at, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    at.SetData(numpy_support.numpy_to_vtk(vertices, deep=True))
    cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(
        triangles.ravel().astype(np.int64), deep=True))
    surface.SetPoints(at)
    surface.SetPolys(cells)
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    nearest, cell, part, square = [0.0] * 3, reference(0), reference(0), reference(0.0)
    out = np.empty(len(points))
    for i, point in enumerate(points):
        locator.FindClosestPoint(point, nearest, cell, part, square)
        out[i] = float(square) ** 0.5
    return out


@functools.cache
def grains():
    """(EDGE, EDGE, EDGE) uint8: Voronoi cells in a ball that leaves a margin; 0 is outside."""
    seeds = np.random.default_rng(1).uniform(-0.7, 0.7, (GRAINS, 3))
    along = (np.arange(EDGE) + 0.5) * 2 / EDGE - 1
    at = np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1)
    nearest = np.stack([((at - seed) ** 2).sum(axis=-1) for seed in seeds]).argmin(axis=0)
    return np.where((at ** 2).sum(axis=-1) < 0.81, nearest + 1, 0).astype(np.uint8)


DISTANCES = {"ball": ball_distance, "torus": torus_distance, "gyroid": gyroid_distance,
             "bunny": bunny_distance}


def all_solids():
    """{name: a call that makes the Solid}, in the table's order."""
    def ball():
        return Solid("ball", ball_distance, 4 / 3 * np.pi, {"nodes": [{"sphere": {"radius": 1}}]})

    def torus():
        ring, tube = TORUS
        return Solid("torus", torus_distance, 2 * np.pi ** 2 * ring * tube ** 2, {"nodes": [
            {"torus": {"major_radius": ring, "minor_radius": tube}}]})

    def gyroid():
        return Solid("gyroid", gyroid_distance, volume_within(gyroid_distance), {"nodes": [
            {"name": "ball", "sphere": {"radius": 1}},
            {"name": "labyrinth", "gyroid": {"period": PERIOD}},
            {"intersection": {"of": ["ball", "labyrinth"]}}]})

    def bunny():
        return Solid("bunny", bunny_distance, triangles_volume(*bunny_triangles()), triangles=True)

    def image():
        labels = np.unique(grains())
        return Solid("grains", None, np.count_nonzero(grains()) * (2 / EDGE) ** 3,
                     labels=np.count_nonzero(labels))

    return {"ball": ball, "torus": torus, "gyroid": gyroid, "bunny": bunny, "grains": image}
