"""Labels: of each voxel what it is a part of, or solids that share their interfaces."""

from __future__ import annotations

import math
import numbers
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _tetstream
from ._errors import invalid
from ._names import Point, point, real_array
from ._volume import Axes, Volume, axis_steps

LabelRanges = str | int | Iterable[int | range | tuple[int, int]]
LabelSizes = Mapping[str | int | range | tuple[int, int], float]
LabelNames = Mapping[int, str] | str | os.PathLike[str]
Background = Literal["left_out", "meshed"]
Smooth = float | Literal["thin"]

_BACKGROUNDS = ("left_out", "meshed")
_ALL = "all"
_Ends = list[tuple[int, int]]
_EVERY = (-2**63, 2**63 - 1)


class Labels:
    """A segmentation, ready to be meshed any number of times: one mesh of all its labels, which share the
    faces between them.

        head = ts.Labels.from_array(np.load("head.npy"), spacing=(0.5, 0.5, 1.5))
        mesh = ts.mesh(head, labels="1,4,7:12", label_names={4: "bone"})

    Labels are never changed, so any thread may use them.

    counts       {value: how many voxels have it}, by ascending value; 0 of level sets
    voxel_edges  lengths of a voxel's edges along the image's axes, world units
    """

    def __init__(self, labels: _tetstream.Labels) -> None:
        if not isinstance(labels, _tetstream.Labels):
            raise TypeError("make Labels by one of their methods, such as Labels.from_array")
        self._labels = labels

    @classmethod
    def from_array(
        cls,
        values: ArrayLike,
        *,
        spacing: float | Sequence[float] | None = None,
        origin: Point | None = None,
        axes: Axes | None = None,
        affine: ArrayLike | None = None,
    ) -> Labels:
        """Copies an array of labels: values[x, y, z].

        values   shape (nx, ny, nz), integers of any type, or booleans; brick by brick, so that no copy of 64
                 bits a voxel is made
        spacing  from voxel to voxel, world units: one number, or three along x, y and z; 1 unless given
        origin   world coordinates of the middle of values[0, 0, 0]; (0, 0, 0) unless given
        axes     the world's axis that each of the array's runs along: "zyx" for values[z, y, x], and
                 ("-x", "y", "z") where the first runs towards lower x; "xyz" unless given
        affine   instead of these three, as nibabel has it: shape (4, 4), and affine @ (i, j, k, 1) are the
                 world coordinates of the middle of values[i, j, k]

        Errors: InvalidArgumentError (another shape, values that are masked or no integers, axes that are none, an
        affine beside what it is instead of), FailedPreconditionError (voxels without volume, more than 65,535 labels).
        """
        array = real_array("values", values)
        if array.ndim != 3:
            raise invalid(f"labels have the shape {array.shape}; three axes are needed, as values[x, y, z]")
        if affine is None:
            first = point("origin", (0, 0, 0) if origin is None else origin)
            steps = axis_steps(axes or "xyz", _three_spacings(1 if spacing is None else spacing))
        elif spacing is None and origin is None and axes is None:
            first, steps = _parts_of(affine)
        else:
            raise invalid("affine says where voxels lie, and so do spacing, origin and axes: give it alone, or these")
        return cls(_tetstream.Labels.from_voxels(_integers(array), first, steps))

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], name: str = "", *, trusted: bool = False) -> Labels:
        """Reads an image: NIfTI, NRRD, MetaImage, VTK or NumPy (docs/images.md); or a .vdb file's grid of int32,
        int64, bool or mask.

        name      of one of several arrays or grids
        trusted   read it in this process; else the program tetstream-decoder does, as is right for files of others

        Errors: those of `Volume.from_vdb`; FailedPreconditionError (values that are no whole numbers).
        """
        return cls(_tetstream.Labels.from_file(os.fspath(path), name, trusted))

    @classmethod
    def from_level_sets(cls, volumes: Sequence[Volume]) -> Labels:
        """Makes each of several volumes a label, 1, 2, ... in their order: droplets, or phases of a fluid.

        Where several are below their iso values the lowest one's label is taken, of equal ones the first.

        Errors: InvalidArgumentError (no volumes, more than 64), FailedPreconditionError (a volume without an
        inside). A server is not sent them: upload the .vdb file that has them, and mesh
        `StoredVolume(name, grids=(...))`.
        """
        return cls(_tetstream.Labels.from_level_sets([volume._volume for volume in volumes]))

    @property
    def counts(self) -> dict[int, int]:
        """How many voxels have each value, by ascending value."""
        return dict(self._labels.counts)

    @property
    def voxel_edges(self) -> tuple[float, float, float]:
        """Lengths of a voxel's edges along the image's axes, world units."""
        x, y, z = self._labels.voxel_edges
        return x, y, z

    def write_nrrd(self, path: str | os.PathLike[str]) -> None:
        """Writes an image, whole or not at all. Errors: UnavailableError, ResourceExhaustedError (the disk)."""
        self._labels.write_nrrd(os.fspath(path))

    def __repr__(self) -> str:
        edges = " x ".join(f"{edge:g}" for edge in self.voxel_edges)
        return f"<tetstream.Labels: {len(self.counts)} labels, voxels of {edges}>"


def choice_of(
    labels: LabelRanges | None,
    merge: Iterable[LabelRanges],
    background: Background,
    background_label: int,
    label_names: LabelNames | None,
    smooth: Smooth | None,
    label_sizes: LabelSizes | None = None,
) -> _tetstream.LabelChoice:
    """What is asked of a segmentation, as the library takes it."""
    if background not in _BACKGROUNDS:
        raise invalid(f"background {background!r} is none of {', '.join(map(repr, _BACKGROUNDS))}")
    choice = _tetstream.LabelChoice()
    choice.set_only([] if labels is None or _is_all(labels) else _ranges("labels", labels))
    for merged in merge:
        choice.add_merge(_ranges("merge", merged))
    choice.background = background_label
    choice.mesh_background = background == "meshed"
    for value, name in _named(label_names):
        choice.add_name(value, name)
    _set_smooth(choice, smooth)
    for wanted, size in ({} if label_sizes is None else label_sizes).items():
        named = [wanted] if isinstance(wanted, tuple) else wanted
        for first, last in [_EVERY] if _is_all(wanted) else _ranges("label_sizes", named):
            choice.add_size(first, last, size)
    return choice


def _is_all(wanted: object) -> bool:
    return isinstance(wanted, str) and wanted == _ALL


def _set_smooth(choice: _tetstream.LabelChoice, smooth: Smooth | None) -> None:
    if smooth is None:
        return
    if isinstance(smooth, str) and smooth == "thin":
        choice.smoothing = _tetstream.LabelSmoothing.thin
    elif not isinstance(smooth, numbers.Real) or not math.isfinite(smooth):
        raise invalid(f"smooth {smooth!r} is neither a width in voxels nor 'thin'")
    elif smooth == 0:
        choice.smoothing = _tetstream.LabelSmoothing.none
    else:
        choice.smooth = float(smooth)


def _ranges(option: str, wanted: LabelRanges) -> _Ends:
    """First and last values: of "1,4,7:12", of 4, or of [1, 4, range(7, 13)]."""
    if isinstance(wanted, str):
        return [_ends_of(option, word) for word in wanted.split(",")]
    if isinstance(wanted, np.ndarray):
        wanted = np.atleast_1d(wanted)
    items: Iterable[Any] = [wanted]
    if isinstance(wanted, Iterable) and not isinstance(wanted, range):
        items = wanted
    ranges: _Ends = []
    for item in items:
        if isinstance(item, range) and item.step == 1:
            if item:
                ranges.append((item[0], item[-1]))
        elif isinstance(item, range):
            ranges.extend((value, value) for value in item)
        else:
            ranges.append(_ends_of_item(option, item))
    if not ranges:
        raise invalid(f"{option} names no label: give one, or 'all'")
    return ranges


def _ends_of_item(option: str, item: object) -> tuple[int, int]:
    """Of a number, or of a tuple of the first and the last."""
    match item:
        case int() | np.integer():
            return int(item), int(item)
        case (int() | np.integer() as first, int() | np.integer() as last) if isinstance(item, tuple):
            return int(first), int(last)
    raise invalid(f"{option} has {item!r}; it takes numbers, ranges, and text such as '1,4,7:12'")


def _ends_of(option: str, word: str) -> tuple[int, int]:
    first, colon, last = word.partition(":")
    try:
        return int(first), int(last if colon else first)
    except ValueError:
        raise invalid(f"{option} has {word!r}, which names no labels: it takes numbers and ranges, such as "
                      "1,4,7:12, or all") from None


def _named(names: LabelNames | None) -> Iterable[tuple[int, str]]:
    if names is None:
        return ()
    if isinstance(names, Mapping):
        return ((int(value), name) for value, name in names.items())
    return _tetstream.read_label_names(os.fspath(names))


def _integers(array: NDArray[Any]) -> NDArray[np.integer[Any]]:
    """In C order, and as this processor has them."""
    if array.dtype == np.bool_:
        array = array.astype(np.uint8)
    if not np.issubdtype(array.dtype, np.integer):
        raise invalid(f"labels have {array.dtype}; integers are needed, as of values.astype(np.int32)")
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))


def _three_spacings(spacing: float | Sequence[float]) -> tuple[float, float, float]:
    along = np.asarray(spacing, dtype=np.float64).ravel()
    if along.size not in (1, 3) or not (np.isfinite(along).all() and (along > 0).all()):
        raise invalid(f"spacing {spacing} is neither a positive number nor three of them")
    x, y, z = np.broadcast_to(along, 3).tolist()
    return x, y, z


def _parts_of(affine: ArrayLike) -> tuple[tuple[float, float, float], tuple[Any, Any, Any]]:
    matrix = np.asarray(affine, dtype=np.float64)
    if matrix.shape != (4, 4) or not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise invalid("affine is no matrix of 4 x 4 whose last row is 0 0 0 1")
    x, y, z = (tuple(matrix[:3, axis].tolist()) for axis in range(3))
    return point("affine", matrix[:3, 3].tolist()), (x, y, z)
