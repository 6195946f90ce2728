"""What is said of points: phi, its slope, and values of fields."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import invalid
from ._names import real_array


@dataclasses.dataclass(frozen=True)
class Samples:
    """What is said of points, in their order.

    phi            negative inside, shape (n,): the distance where the volume has distances
    slopes         how fast phi grows along x, y and z, shape (n, 3)
    fields         {name: values}, each of shape (n,), or (n, 3) of a vector, float32
    inside_guess   for people: which side of a volume's surface was taken for the inside, and why, where nothing
                   says it; else empty
    """

    phi: NDArray[np.float64]
    slopes: NDArray[np.float64]
    fields: Mapping[str, NDArray[np.float32]]
    inside_guess: str

    @staticmethod
    def _of(told: Mapping[str, Any]) -> Samples:
        rows = told["field_rows"]
        fields = {}
        for name, components, offset in told["arrays"]:
            values = rows[:, offset:offset + components]
            fields[name] = np.ascontiguousarray(values[:, 0] if components == 1 else values)
        return Samples(told["phi"], told["slopes"], fields, told["inside_guess"])


def rows_of(points: ArrayLike) -> NDArray[np.float64]:
    """Points as the library takes them."""
    rows = np.ascontiguousarray(real_array("points", points), dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise invalid(f"points have the shape {rows.shape}: (n, 3) is wanted, x, y and z of each")
    return rows
