"""Small things that callers give: words, points, and how they are checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import invalid

Point = Sequence[float]
T = TypeVar("T")


def member(name: str, word: str, members: Mapping[str, T]) -> T:
    """The one of `members` that a word names."""
    if word not in members:
        raise invalid(f"{name} {word!r} is none of {', '.join(map(repr, members))}")
    return members[word]


def point(name: str, coordinates: Point) -> tuple[float, float, float]:
    """Three numbers."""
    if len(coordinates) != 3:
        raise invalid(f"{name} has {len(coordinates)} coordinates; a point has 3")
    x, y, z = map(float, coordinates)
    return x, y, z


def mask_of(values: ArrayLike) -> Any:
    """True where numpy's masked arrays say that nothing is known; False of all others."""
    return getattr(values, "mask", False) if isinstance(values, np.ma.MaskedArray) else False


def real_array(name: str, values: ArrayLike) -> NDArray[Any]:
    """The array as it is, unless something of it would be lost without a word: a mask, or imaginary parts."""
    array = np.asarray(values)
    hidden = int(np.count_nonzero(mask_of(values)))
    if hidden:
        raise invalid(f"{name} are masked, {hidden} of {array.size}, which says nothing of what is there: fill them, as by "
                      f"{name}.filled(...)")
    if np.iscomplexobj(array):
        raise invalid(f"{name} have {array.dtype}; real numbers are needed, as of {name}.real")
    return array
