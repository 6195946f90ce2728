"""What a caller asks of a mesh, as the library takes it."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

from . import _tetstream
from ._errors import invalid
from ._names import Point, member, point
from ._volume import Volume

Progress = Callable[[float], object]
Inside = Literal["above", "below"]
Preset = Literal["default", "min_angle", "both_sides"]
Coordinates = Literal["automatic", "float32", "float64"]
Encoding = Literal["plain", "packed", "compact"]
Box = tuple[Point, Point]
Sizing = Mapping[str, Any] | str
FaceRegions = Mapping[str, Any] | Sequence[Mapping[str, Any]] | str


def request_of(
    *,
    spacing: float | None,
    iso: float | None,
    inside: Inside | None,
    levels: int | None,
    preset: Preset,
    box: Box | None,
    sizing: Sizing | None,
    improve: bool,
    manifold: bool,
    statistics: bool,
    faces: bool,
    face_regions: FaceRegions | None,
    coordinates: Coordinates,
    fields: Mapping[str, Volume] | None,
) -> _tetstream.Request:
    """A request of the library. The arguments are those of `Client.mesh`."""
    request = _tetstream.Request()
    request.spacing = spacing
    request.iso = iso
    if inside is not None:
        request.inside = member("inside", inside, _tetstream.Inside.__members__)
    request.levels = levels
    request.preset = member("preset", preset, _tetstream.Preset.__members__)
    if box is not None:
        low, high = box
        request.set_box((point("box[0]", low), point("box[1]", high)))
    if sizing is not None:
        request.sizing = sizing if isinstance(sizing, str) else json.dumps(dict(sizing))
    request.improve = improve
    request.manifold = manifold
    request.statistics = statistics
    request.faces = faces
    if face_regions is not None:
        request.face_regions = _json_of_regions(face_regions)
    request.coordinates = member("coordinates", coordinates, _tetstream.Coordinates.__members__)
    for name, values in (fields or {}).items():
        request.add_field(name, values._volume)
    return request


def _json_of_regions(regions: FaceRegions) -> str:
    """`{"bore": {...}}`, a list of regions with names, or JSON as docs/faces.md has it."""
    if isinstance(regions, str):
        return regions
    if not isinstance(regions, Mapping):
        return json.dumps({"regions": [dict(region) for region in regions]})
    named: list[Any] = []
    for name, places in regions.items():
        for place in [places] if isinstance(places, Mapping) else places:
            named.append({"name": name, **place})
    return json.dumps({"regions": named})


def options_of(
    *,
    progress: Progress | None = None,
    timeout: float | None = None,
    threads: int = 0,
    encoding: Encoding = "plain",
    skip_cache: bool = False,
) -> _tetstream.Options:
    """How a call is made. The arguments are those of `Client.mesh`."""
    if timeout is not None and (math.isnan(timeout) or timeout < 0):
        raise invalid(f"timeout {timeout} is no number of seconds from now on")
    options = _tetstream.Options()
    options.progress = progress
    options.deadline = None if timeout is None else time.time() + timeout
    options.threads = threads
    options.encoding = member("encoding", encoding, _tetstream.Encoding.__members__)
    options.skip_cache = skip_cache
    return options
