"""Volumes: what is meshed."""

from __future__ import annotations

import importlib
import os
import tempfile
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _tetstream
from ._errors import invalid
from ._names import Point, member, point, real_array

Kind = Literal["level_set", "density", "values"]
Open = Literal["refuse", "close", "shell"]
Axes = str | Sequence[str]
_Step = tuple[float, float, float]
_MOST_VERTICES = 2**32


class Volume:
    """Samples of a field on a regular grid, ready to be meshed any number of times.

    Made by one of the `from_...` methods. A volume is never changed, so any thread may use it.

    kind         "level_set": inside where a value is below the iso value (0 unless given),
                 "density": inside where a value is above the iso value (0.5 unless given),
                 "values": no inside; for the `fields` of another volume's mesh
    voxel_size   distance from sample to sample, world units
    """

    def __init__(self, volume: _tetstream.Volume) -> None:
        if not isinstance(volume, _tetstream.Volume):
            raise TypeError("make a Volume by one of its methods, such as Volume.from_array")
        self._volume = volume

    @classmethod
    def from_array(
        cls,
        values: ArrayLike,
        *,
        spacing: float,
        origin: Point = (0, 0, 0),
        kind: Kind = "level_set",
        background: float | None = None,
        axes: Axes = "xyz",
    ) -> Volume:
        """Copies an array of samples: values[x, y, z].

        values      shape (nx, ny, nz), finite numbers; they are kept as float32. Of a level set
                    they are signed distances in world units, negative inside; the closer to
                    distances, the better the mesh.
        spacing     from sample to sample along every axis, world units
        origin      world coordinates of values[0, 0, 0]
        background  the value outside of the array; unless given 3 * spacing for a level set, so
                    that what touches the array's edge is closed there, and 0 otherwise
        axes        the world's axis that each of the array's runs along: "zyx" for values[z, y, x], and
                    ("-x", "y", "z") where the first runs towards lower x. Spacing and origin stay
                    those of the world and of values[0, 0, 0].

        Errors: InvalidArgumentError (another shape, masked or complex values, a spacing that is not positive, axes
        that are none),
        FailedPreconditionError (a value that is not finite).
        """
        array = real_array("values", values)
        if array.ndim != 3:
            raise invalid(f"values have the shape {array.shape}; three axes are needed, as values[x, y, z]")
        if array.dtype == np.bool_:
            raise invalid("values are True and False; Volume.from_mask meshes those")
        array, origin = _along_axes(array, axes, _one_spacing(spacing), point("origin", origin))
        samples = _tetstream.Samples(_one_spacing(spacing), point("origin", origin),
                                     member("kind", kind, _tetstream.VolumeKind.__members__), background)
        return cls(_tetstream.Volume.from_samples(np.ascontiguousarray(array, dtype=np.float32), samples))

    @classmethod
    def from_mask(
        cls, mask: ArrayLike, *, spacing: float, origin: Point = (0, 0, 0), axes: Axes = "xyz"
    ) -> Volume:
        """Meshes the voxels that are True; the surface lies halfway to those that are False.

        mask     shape (nx, ny, nz), of booleans; beyond it all is False
        spacing  edge of a voxel, world units
        origin   world coordinates of the middle of voxel (0, 0, 0)
        axes     as in `from_array`
        """
        array = real_array("mask", mask)
        if array.dtype != np.bool_:
            raise invalid(f"a mask has booleans, and this has {array.dtype}: compare it, as in labels == 3")
        return cls.from_array(array.astype(np.float32), spacing=spacing, origin=origin, kind="density", axes=axes)

    @classmethod
    def from_density(
        cls,
        values: ArrayLike,
        *,
        spacing: float,
        origin: Point = (0, 0, 0),
        background: float = 0,
        axes: Axes = "xyz",
    ) -> Volume:
        """Copies an array whose inside is where values are above the iso value, 0.5 unless given.

        Arguments and errors are those of `from_array`.
        """
        return cls.from_array(values, spacing=spacing, origin=origin, kind="density", background=background,
                              axes=axes)

    @classmethod
    def from_triangles(
        cls, points: ArrayLike, triangles: ArrayLike, *, voxel_size: float, open: Open = "refuse"
    ) -> Volume:
        """Makes a level set of what a closed surface goes around.

        points      shape (n, 3), world units
        triangles   shape (m, 3), ids of points
        open        what becomes of a surface with large openings: "refuse", "close" (each gets a cap), or
                    "shell" (a solid two voxels thick around the surface)

        Errors: InvalidArgumentError (an id without a point, no triangles, a voxel size that is not
        positive or larger than the inside), FailedPreconditionError (the surface is open),
        ResourceExhaustedError (too many voxels).
        """
        corners = np.ascontiguousarray(real_array("points", points), dtype=np.float64)
        ids = real_array("triangles", triangles)
        for name, array in (("points", corners), ("triangles", ids)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise invalid(f"{name} have the shape {array.shape}; rows of three are needed")
        choice = member("open", open, _tetstream.OpenSurface.__members__)
        return cls(_tetstream.Volume.from_triangles(corners, _vertex_ids(ids), voxel_size, choice))

    @classmethod
    def from_surface_file(
        cls, path: str | os.PathLike[str], *, voxel_size: float, open: Open = "refuse"
    ) -> Volume:
        """Makes a level set of an .obj, .stl or .ply file.

        Arguments and errors: those of `from_triangles`, NotFoundError, InvalidArgumentError (with the line or byte).
        """
        choice = member("open", open, _tetstream.OpenSurface.__members__)
        return cls(_tetstream.Volume.from_surface_file(os.fspath(path), voxel_size, choice))

    @classmethod
    def from_openvdb(cls, grid: Any) -> Volume:
        """Takes a grid of the package pyopenvdb (or openvdb), by way of a temporary file.

        Errors: those of `from_vdb`, TypeError (no such grid).
        """
        module = importlib.import_module(type(grid).__module__)
        if not hasattr(module, "write"):
            raise TypeError(f"a grid of pyopenvdb is needed, and this is {type(grid).__name__}")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "grid.vdb")
            module.write(path, grids=[grid])
            return cls.from_vdb(path, trusted=True)

    @classmethod
    def from_vdb(cls, path: str | os.PathLike[str], grid: str = "", *, trusted: bool = False) -> Volume:
        """Reads a grid of an OpenVDB file; without a name the only one that can be meshed.

        trusted   read it in this process. Otherwise the program tetstream-decoder reads it, which can
                  do nothing else, as is right for files of others.

        Errors: NotFoundError (the file or the grid; the message lists what there is),
        InvalidArgumentError (not such a file), FailedPreconditionError (a grid that cannot be meshed, or
        several and no name).
        """
        return cls(_tetstream.Volume.from_vdb(os.fspath(path), grid, trusted))

    @classmethod
    def values_from_vdb(cls, path: str | os.PathLike[str], grid: str = "", *, trusted: bool = False) -> Volume:
        """Reads a float or vector grid whose values are wanted at the vertices of another mesh: see `fields`."""
        return cls(_tetstream.Volume.values_from_vdb(os.fspath(path), grid, trusted))

    @property
    def kind(self) -> Kind:
        """What the values say."""
        names: dict[str, Kind] = {"level_set": "level_set", "density": "density", "values": "values"}
        return names[self._volume.kind.name]

    @property
    def voxel_size(self) -> float:
        """Distance from sample to sample, world units."""
        return self._volume.voxel_size

    def write_vdb(self, path: str | os.PathLike[str]) -> None:
        """Writes an OpenVDB file, whole or not at all. Errors: UnavailableError (the disk)."""
        self._volume.write_vdb(os.fspath(path))

    def __repr__(self) -> str:
        return f"<tetstream.Volume: {self.kind}, voxel size {self.voxel_size:g}>"


def _named_axes(axes: Axes) -> tuple[list[str], list[bool]]:
    """Which of the world's axes those of an array run along, and whether they run towards lower coordinates."""
    signs = [str(axis).startswith("-") for axis in axes]
    names = [str(axis).lstrip("-") for axis in axes]
    if sorted(names) != ["x", "y", "z"]:
        raise invalid(f"axes {axes!r} are not x, y and z in some order, such as 'zyx'")
    return names, signs


def axis_steps(axes: Axes, spacing: Sequence[float]) -> tuple[_Step, _Step, _Step]:
    """From a voxel to the next along each axis of an array; `spacing` is along the world's."""
    steps = np.zeros((3, 3))
    for i, (name, falls) in enumerate(zip(*_named_axes(axes))):
        along = "xyz".index(name)
        steps[i, along] = -spacing[along] if falls else spacing[along]
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in steps)
    return x, y, z


def _along_axes(
    array: NDArray[Any], axes: Axes, spacing: float, origin: tuple[float, float, float]
) -> tuple[NDArray[Any], tuple[float, float, float]]:
    """The array as values[x, y, z] with growing coordinates, and where its new first sample is."""
    names, signs = _named_axes(axes)
    low = list(origin)
    for i, (name, falls) in enumerate(zip(names, signs)):
        if falls:
            array = np.flip(array, i)
            low["xyz".index(name)] -= spacing * (array.shape[i] - 1)
    return array.transpose([names.index(name) for name in "xyz"]), (low[0], low[1], low[2])


def _one_spacing(spacing: object) -> float:
    """Some arrays come with a spacing along each axis, which must be the same."""
    along = np.unique(np.asarray(spacing, dtype=np.float64))
    if along.size != 1:
        raise invalid(f"spacing {spacing} is not the same along every axis: resample the array "
                      "first, for instance by scipy.ndimage.zoom")
    return float(along[0])


def _vertex_ids(ids: NDArray[Any]) -> NDArray[np.uint32]:
    if not np.issubdtype(ids.dtype, np.integer):
        raise invalid(f"triangles have {ids.dtype}; ids are integers")
    outside = ids[(ids < 0) | (ids >= _MOST_VERTICES)]
    if outside.size:
        raise invalid(f"a triangle refers to vertex {outside[0]}; ids are 0 to {_MOST_VERTICES - 1}")
    return np.ascontiguousarray(ids, dtype=np.uint32)
