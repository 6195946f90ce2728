"""Small things that callers give: words, points, and how they are checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

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
