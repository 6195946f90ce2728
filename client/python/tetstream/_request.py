"""What a caller asks of a mesh, as the library takes it."""

from __future__ import annotations

import contextvars
import dataclasses
import json
import math
import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np

from . import _tetstream
from ._errors import invalid
from ._labels import Background, LabelNames, LabelRanges, Labels, LabelSizes, Smooth, choice_of
from ._names import Point, member, point
from ._solid import Solid
from ._volume import Volume

Progress = Callable[[float], object]
Inside = Literal["above", "below"]
Preset = Literal["default", "min_angle", "both_sides"]
Coordinates = Literal["automatic", "float32", "float64"]
Encoding = Literal["plain", "packed", "compact"]
Box = tuple[Point, Point]
Sizing = Mapping[str, Any] | str
FaceRegions = Mapping[str, Any] | Sequence[Mapping[str, Any]] | str

# The library makes these anew whenever it is asked.
_INSIDES = dict(_tetstream.Inside.__members__)
_PRESETS = dict(_tetstream.Preset.__members__)
_COORDINATES = dict(_tetstream.Coordinates.__members__)
_ENCODINGS = dict(_tetstream.Encoding.__members__)


class Stop(_tetstream.Stop):
    """By which another thread stops calls. The library's hear of it by themselves."""

    def __init__(self) -> None:
        super().__init__()
        self._wakes: list[threading.Condition] = []

    def wakes(self, changed: threading.Condition) -> None:
        """Has `request` wake who waits there. To be called with the condition's lock, and before `requested` is asked."""
        if changed not in self._wakes:
            self._wakes.append(changed)

    def request(self) -> None:
        super().request()
        for changed in list(self._wakes):
            with changed:
                changed.notify_all()


# Of the calls that are made in this context.
stop_of_context: contextvars.ContextVar[Stop | None] = contextvars.ContextVar("stop_of_context", default=None)


# Names begin with it that `Client(":local:")` gives.
HERE = "here/"


@dataclasses.dataclass(frozen=True)
class StoredVolume:
    """A volume that a server stores. It may be kept as text, and used again.

    name    "grids/{sha256}": the same file has the same name everywhere
    grid    within the file; empty takes the only one that can be meshed
    labels  it is a segmentation, whose labels are meshed
    grids   level sets within the file instead, each of which is a label
    """

    name: str
    grid: str = ""
    labels: bool = False
    grids: tuple[str, ...] = ()
    _here: Volume | Labels | None = dataclasses.field(default=None, repr=False, compare=False)
    _grid: str = dataclasses.field(default="", repr=False, compare=False)  # that `_here` is

    @property
    def _is_here(self) -> bool:
        """Whether no server has it, but a process that makes meshes itself."""
        return self.name.startswith(HERE)

    @property
    def _path(self) -> str | None:
        """Of a file that such a process has taken, where any process of this machine finds it."""
        path = self.name.removeprefix(HERE)
        return path if self._is_here and os.path.isabs(path) else None


Fields = Mapping[str, Volume | StoredVolume]
NativeField = Callable[[Volume | StoredVolume], _tetstream.Volume | _tetstream.StoredVolume]
Meshable = Volume | Labels | Solid | StoredVolume | str | os.PathLike[str]


@dataclasses.dataclass(frozen=True)
class Request:
    """What is meshed, and how: taken in the place of a volume by every call that takes one.

        request = ts.Request(ball, spacing=0.05, faces=True)
        mesh = client.mesh(request)
        job = client.jobs.submit(request, labels={"night": "1"})

    The fields are the arguments of `Client.mesh`, which explains them.
    """

    volume: Meshable
    spacing: float | None = None
    iso: float | None = None
    inside: Inside | None = None
    levels: int | None = None
    preset: Preset = "default"
    box: Box | None = None
    sizing: Sizing | None = None
    improve: bool = False
    manifold: bool = False
    statistics: bool = True
    faces: bool = False
    fidelity: bool = False
    face_regions: FaceRegions | None = None
    coordinates: Coordinates = "automatic"
    fields: Fields | None = None
    labels: LabelRanges | None = None
    merge: Iterable[LabelRanges] = ()
    background: Background = "left_out"
    background_label: int = 0
    label_names: LabelNames | None = None
    smooth: Smooth | None = None
    label_sizes: LabelSizes | None = None

    def __post_init__(self) -> None:
        """Iterators are read now: a request may be used more than once."""
        object.__setattr__(self, "labels", _repeatable(self.labels))
        object.__setattr__(self, "merge", tuple(_repeatable(merged) for merged in self.merge))

    @classmethod
    def _of(cls, volume: VolumeLike, **options: Any) -> Request:
        """The request that a call's arguments make; those that were not given have their defaults."""
        if not isinstance(volume, Request):
            return cls(volume, **options)
        given = [name for name, value in options.items() if _is_given(value, _DEFAULTS[name])]
        if given:
            raise invalid(f"{given[0]} is given beside a Request: give it to the Request")
        return volume

    def _wire(self, field: NativeField | None = None) -> _tetstream.Request:
        """As the library takes it, without the volume, and without fields unless there is who makes one of what is given."""
        request = _tetstream.Request()
        request.spacing = self.spacing
        request.iso = self.iso
        if self.inside is not None:
            request.inside = member("inside", self.inside, _INSIDES)
        request.levels = self.levels
        request.preset = member("preset", self.preset, _PRESETS)
        if self.box is not None:
            low, high = self.box
            request.set_box((point("box[0]", low), point("box[1]", high)))
        if self.sizing is not None:
            request.sizing = self.sizing if isinstance(self.sizing, str) else json.dumps(dict(self.sizing), default=_plain)
        request.improve = self.improve
        request.manifold = self.manifold
        request.statistics = self.statistics
        request.faces = self.faces
        request.fidelity = self.fidelity
        if self.face_regions is not None:
            request.face_regions = _json_of_regions(self.face_regions)
        request.coordinates = member("coordinates", self.coordinates, _COORDINATES)
        if self._asks_for_labels:
            request.labels = choice_of(self.labels, self.merge, self.background, self.background_label,
                                       self.label_names, self.smooth, self.label_sizes)
        for name, values in (self.fields or {}).items():
            if field is not None:
                request.add_field(name, field(values))
        return request

    @property
    def _asks_for_labels(self) -> bool:
        """Whether what is meshed is a segmentation: it says so, or an option does that is for labels."""
        volume = self.volume
        is_stored = isinstance(volume, StoredVolume) and (volume.labels or bool(volume.grids))
        return isinstance(volume, Labels) or is_stored or any(
            _is_given(getattr(self, name), _DEFAULTS[name]) for name in _LABEL_OPTIONS)


VolumeLike = Meshable | Request

_LABEL_OPTIONS = ("labels", "merge", "background", "background_label", "label_names", "smooth",
                  "label_sizes")
_DEFAULTS = {field.name: field.default for field in dataclasses.fields(Request)}


def _repeatable(labels: Any) -> Any:
    return tuple(labels) if isinstance(labels, Iterator) else labels


def _is_given(value: Any, default: Any) -> bool:
    """Whether an option asks for anything beside its default; neither no merges nor a table of nothing does. Its value may
    be an array, which is equal to nothing as a whole."""
    if isinstance(value, Mapping) or default == ():
        return isinstance(value, Iterator) or len(value) > 0
    return value is not None if default is None else bool(value != default)


def _json_of_regions(regions: FaceRegions) -> str:
    """`{"bore": {...}}`, a list of regions with names, or JSON as docs/faces.md has it."""
    if isinstance(regions, str):
        return regions
    if not isinstance(regions, Mapping):
        return json.dumps({"regions": [dict(region) for region in regions]}, default=_plain)
    named: list[Any] = []
    for name, places in regions.items():
        for place in [places] if isinstance(places, Mapping) else places:
            named.append({"name": name, **place})
    return json.dumps({"regions": named}, default=_plain)


def _plain(value: object) -> object:
    """Numbers and arrays of numpy as JSON has them."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise invalid(f"{value!r} is neither a number nor a text nor a list of them")


def options_of(
    *,
    progress: Progress | None = None,
    timeout: float | None = None,
    threads: int = 0,
    encoding: Encoding = "plain",
    skip_cache: bool = False,
) -> _tetstream.Options:
    """How a call is made. The arguments are those of `Client.mesh`."""
    _check_timeout(timeout)
    options = _tetstream.Options()
    options.progress = progress
    options.deadline = None if timeout is None else time.time() + timeout
    options.threads = threads
    options.encoding = member("encoding", encoding, _ENCODINGS)
    options.skip_cache = skip_cache
    stop = stop_of_context.get()
    if stop is not None:
        options.stop = stop
    return options


def time_left(timeout: float | None) -> Callable[[], float | None]:
    """Tells how many of these seconds are left, for what makes several calls within them."""
    _check_timeout(timeout)
    if timeout is None:
        return lambda: None
    end = time.monotonic() + timeout
    return lambda: max(0.0, end - time.monotonic())


def _check_timeout(timeout: float | None) -> None:
    if timeout is not None and (math.isnan(timeout) or timeout < 0):
        raise invalid(f"timeout {timeout} is no number of seconds from now on")
