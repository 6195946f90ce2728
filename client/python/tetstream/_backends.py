"""Where meshes are made: in this process, or by a server. A `Client` has one of the two."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _tetstream
from ._errors import FailedPreconditionError, NotFoundError, StatusCode, invalid
from ._labels import Labels
from ._request import HERE, Meshable, Request, StoredVolume
from ._solid import Solid
from ._uploads import Uploads
from ._volume import Volume

T = TypeVar("T")
_Frame = _tetstream.Volume | _tetstream.Scene
_Used = list[tuple[Meshable, _tetstream.StoredVolume]]  # what was uploaded for a call, and its names
_STORED = "grids/"


@dataclasses.dataclass(frozen=True)
class Capabilities:
    """What a server can do; 0 where there is no limit but this machine's memory.

    max_tets                of one mesh
    max_store_bytes         of all stored volumes together
    max_chunk_bytes         of one chunk's arrays
    max_concurrent_meshes   that all clients together may have in work
    """

    server_version: str
    algorithm_version: str
    max_tets: int
    max_store_bytes: int
    max_chunk_bytes: int
    max_concurrent_meshes: int


class Backend(Protocol):
    """Makes meshes."""

    def upload(self, volume: Volume | Labels, options: _tetstream.Options) -> StoredVolume: ...
    def upload_file(self, path: str, grid: str, options: _tetstream.Options) -> StoredVolume: ...
    def mesh(self, request: Request, options: _tetstream.Options) -> _tetstream.Mesh: ...
    def estimate(self, request: Request, options: _tetstream.Options) -> dict[str, float]: ...
    def stream(
        self, request: Request, options: _tetstream.Options, first: int = 0, end: int | None = None
    ) -> _tetstream.Stream: ...
    def sample(
        self, request: Request, points: NDArray[np.float64], options: _tetstream.Options
    ) -> dict[str, Any]: ...
    def session(self, request: Request, options: _tetstream.Options) -> _tetstream.Session: ...
    def stable_session(self, request: Request, options: _tetstream.Options) -> _tetstream.StableSession: ...
    def with_frame(
        self, volume: Meshable, options: _tetstream.Options, work: Callable[[_Frame], T]
    ) -> T: ...
    def capabilities(self, options: _tetstream.Options) -> Capabilities: ...
    def check_health(self, service: str, options: _tetstream.Options) -> None: ...


class Here:
    """This process. What is uploaded stays where it is."""

    def upload(self, volume: Volume | Labels, options: _tetstream.Options) -> StoredVolume:
        _tell(options)
        return StoredVolume(f"{HERE}{id(volume):x}", "", isinstance(volume, Labels), _here=volume)

    def upload_file(self, path: str, grid: str, options: _tetstream.Options) -> StoredVolume:
        """The file stays where it is, too. What is meshed of it may be said later, as with a server."""
        volume = None
        with contextlib.suppress(FailedPreconditionError):  # of several grids, or none with an inside
            volume = Volume.from_vdb(path, grid)
        _tell(options)
        return StoredVolume(HERE + os.path.abspath(path), grid, _here=volume, _grid=grid)

    def mesh(self, request: Request, options: _tetstream.Options) -> _tetstream.Mesh:
        return _tetstream.mesh(self._shape(request), request._wire(_field_here), options)

    def estimate(self, request: Request, options: _tetstream.Options) -> dict[str, float]:
        return _tetstream.estimate(self._shape(request), request._wire(_field_here), options)

    def stream(
        self, request: Request, options: _tetstream.Options, first: int = 0, end: int | None = None
    ) -> _tetstream.Stream:
        return _tetstream.stream(self._shape(request), request._wire(_field_here), options, first, end)

    def sample(
        self, request: Request, points: NDArray[np.float64], options: _tetstream.Options
    ) -> dict[str, Any]:
        _refuse_labels(request.volume)
        return _tetstream.sample(self.frame(request.volume), points, request._wire(_field_here), options)

    def session(self, request: Request, options: _tetstream.Options) -> _tetstream.Session:
        return _tetstream.session(self.frame(request.volume), request._wire(_field_here), options)

    def stable_session(self, request: Request, options: _tetstream.Options) -> _tetstream.StableSession:
        return _tetstream.stable_session(self.frame(request.volume), request._wire(_field_here), options)

    def capabilities(self, options: _tetstream.Options) -> Capabilities:
        return Capabilities(_tetstream.version(), "", 0, 0, 0, 0)

    def check_health(self, service: str, options: _tetstream.Options) -> None:
        pass

    def with_frame(
        self, volume: Meshable, options: _tetstream.Options, work: Callable[[_Frame], T]
    ) -> T:
        """Does `work` with what a session is given."""
        return work(self.frame(volume))

    def frame(self, volume: Meshable) -> _Frame:
        """What is meshed, as the library has it."""
        if isinstance(volume, Solid):
            return _scene_here(volume)
        if isinstance(volume, StoredVolume):
            volume = _read_here(volume)
        if isinstance(volume, Volume):
            return volume._volume
        if isinstance(volume, Labels):
            raise _no_frame()
        return Volume.from_vdb(volume)._volume

    def _shape(self, request: Request) -> _Frame | _tetstream.Labels:
        """What is meshed, as the request has it read."""
        if request._asks_for_labels and not isinstance(request.volume, Solid):
            return _labels_here(request.volume)._labels
        return self.frame(request.volume)


class Served:
    """A server. A volume of this process is uploaded when it is meshed for the first time."""

    def __init__(self, address: str, options: _tetstream.ClientOptions) -> None:
        self.client = _tetstream.Client(address, options)
        self._uploads = Uploads()

    def upload(self, volume: Volume | Labels, options: _tetstream.Options) -> StoredVolume:
        stored = self._uploads.renewed(volume, options, lambda: self._upload(volume, options))
        return StoredVolume(stored.name, stored.grid, isinstance(volume, Labels))

    def upload_file(self, path: str, grid: str, options: _tetstream.Options) -> StoredVolume:
        stored = self.client.upload_file(path, grid, options)
        return StoredVolume(stored.name, stored.grid)

    def mesh(self, request: Request, options: _tetstream.Options) -> _tetstream.Mesh:
        return self.asked(request, options, lambda what, wire: self.client.mesh(what, wire, options))

    def estimate(self, request: Request, options: _tetstream.Options) -> dict[str, float]:
        return self.asked(request, options, lambda what, wire: self.client.estimate(what, wire, options))

    def stream(
        self, request: Request, options: _tetstream.Options, first: int = 0, end: int | None = None
    ) -> _tetstream.Stream:
        return self.asked(request, options,
                          lambda what, wire: self.client.stream(what, wire, options, first, end))

    def sample(
        self, request: Request, points: NDArray[np.float64], options: _tetstream.Options
    ) -> dict[str, Any]:
        _refuse_labels(request.volume)
        return self.asked(request, options, lambda what, wire: _tetstream.sample_there(
            self.client, what, points, wire, options))

    def session(self, request: Request, options: _tetstream.Options) -> _tetstream.Session:
        return self._begun(_tetstream.session_there, request, options)

    def stable_session(self, request: Request, options: _tetstream.Options) -> _tetstream.StableSession:
        return self._begun(_tetstream.stable_session_there, request, options)

    def with_frame(
        self, volume: Meshable, options: _tetstream.Options, work: Callable[[_Frame], T]
    ) -> T:
        """Does `work` with what a session is given; again where the server has evicted a volume of a solid."""
        return self.stored(volume, options, work) if isinstance(volume, Solid) else work(self._volume_here(volume))

    def _volume_here(self, volume: Volume | Labels | StoredVolume | str | os.PathLike[str]) -> _tetstream.Volume:
        """A session needs volumes here, to see what changes."""
        if isinstance(volume, StoredVolume):
            raise invalid(f"{volume.name} is stored by a server: a session begins with a Volume or a solid")
        if isinstance(volume, Labels):
            raise _no_frame()
        return volume._volume if isinstance(volume, Volume) else Volume.from_vdb(volume)._volume

    def capabilities(self, options: _tetstream.Options) -> Capabilities:
        return Capabilities(**self.client.capabilities(options))

    def check_health(self, service: str, options: _tetstream.Options) -> None:
        self.client.check_health(service, options)

    def asked(
        self, request: Request, options: _tetstream.Options, work: Callable[[Any, _tetstream.Request], T]
    ) -> T:
        """Does `work` with what is meshed and how, once the server has all of it; again where it has evicted a volume."""
        def do(uploading: _tetstream.Options, used: _Used) -> T:
            wire = request._wire(lambda values: self._stored_volume(values, uploading, used))
            return work(self._stored(request.volume, uploading, used), wire)

        return self._tried(options, do)

    def stored(self, volume: Meshable, options: _tetstream.Options, work: Callable[[Any], T]) -> T:
        """Does `work` with what is meshed, as `asked` does."""
        return self._tried(options, lambda uploading, used: work(self._stored(volume, uploading, used)))

    def _begun(self, begin: Callable[..., T], request: Request, options: _tetstream.Options) -> T:
        """A session, which reads its first frame from what is here."""
        volume = request.volume
        here = None if isinstance(volume, Solid) else self._volume_here(volume)

        def do(uploading: _tetstream.Options, used: _Used) -> T:
            frame = here or self._stored(volume, uploading, used)
            wire = request._wire(lambda values: self._stored_volume(values, uploading, used))
            return begin(self.client, frame, wire, options)

        return self._tried(options, do)

    def _tried(self, options: _tetstream.Options, do: Callable[[_tetstream.Options, _Used], T]) -> T:
        """What `do` does, which notes the names that it has used; once more where one of them is evicted."""
        uploading = _tetstream.Options()
        uploading.deadline = options.deadline
        uploading.stop = options.stop
        used: _Used = []
        try:
            return do(uploading, used)
        except NotFoundError as error:
            if error.reason != "GRID_NOT_FOUND" or not used:
                raise
        for leaf, stored in used:
            if isinstance(leaf, (Volume, Labels)):
                self._uploads.forget(leaf, uploading, stored)
        return do(uploading, [])

    def _stored(
        self, volume: Meshable, options: _tetstream.Options, used: _Used
    ) -> _tetstream.StoredVolume | _tetstream.Scene:
        if isinstance(volume, Solid):
            nodes = volume._nodes(lambda leaf, grid: self._stored_volume(leaf, options, used).name)
            return _tetstream.Scene.from_json(json.dumps({"nodes": nodes}), [])
        return self._stored_volume(volume, options, used)

    def _stored_volume(
        self, volume: Meshable, options: _tetstream.Options, used: _Used
    ) -> _tetstream.StoredVolume:
        """The name of a volume, which is noted with it in `used` where it is one of this process."""
        if isinstance(volume, StoredVolume):
            if volume._is_here:
                raise invalid(f"{volume.name} is in this process: upload its volume by this Client")
            return _tetstream.StoredVolume(volume.name, volume.grid, list(volume.grids))
        if isinstance(volume, (Volume, Labels)):
            ours = volume
            stored = self._uploads.known(ours, options, lambda: self._upload(ours, options))
        else:
            path = os.fspath(volume)  # type: ignore[arg-type]
            if path.startswith(_STORED):
                return _tetstream.StoredVolume(path, "", [])
            stored = self.client.upload_file(path, "", options)
        used.append((volume, stored))
        return stored

    def _upload(self, volume: Volume | Labels, options: _tetstream.Options) -> _tetstream.StoredVolume:
        return self.client.upload(volume._labels if isinstance(volume, Labels) else volume._volume, options)


def _scene_here(solid: Solid) -> _tetstream.Scene:
    """The solid with the volumes of its grids, which are called v0, v1 ..."""
    volumes: dict[str, _tetstream.Volume] = {}
    names: dict[Any, str] = {}

    def name_of(leaf: Any, grid: str) -> str:
        key = leaf if isinstance(leaf, str) else id(leaf), grid
        if key not in names:
            names[key] = f"v{len(names)}"
            volumes[names[key]] = _volume_of_leaf(leaf, grid)._volume
        return names[key]

    nodes = solid._nodes(name_of)
    return _tetstream.Scene.from_json(json.dumps({"nodes": nodes}), list(volumes.items()))


def _labels_here(volume: Meshable) -> Labels:
    """A segmentation of this process, or of a file."""
    if isinstance(volume, StoredVolume):
        if volume._here is None or _is_file(volume):
            path = _path_here(volume)
            if volume.grids:
                return Labels.from_level_sets([Volume.from_vdb(path, name) for name in volume.grids])
            return Labels.from_file(path, volume.grid)
        volume = _read_here(volume)
    if isinstance(volume, (Volume, Solid)):
        raise invalid(f"labels are asked for of a {type(volume).__name__}: give Labels, the path of an image, "
                      "or a solid")
    return volume if isinstance(volume, Labels) else Labels.from_file(volume)


def _is_file(stored: StoredVolume) -> bool:
    """Whether it is one that `Here` has taken, of which any grid may be meant."""
    return stored._path is not None


def _path_here(stored: StoredVolume) -> str:
    """Of a file that `Here` has taken."""
    if not stored._is_here:
        raise invalid(f"{stored.name} is stored by a server: mesh it by that server's Client")
    if stored._path is not None:
        return stored._path
    if stored._here is not None:
        raise NotFoundError(f"{stored.name} is a volume of this process, and has no grid '{stored.grid}'",
                            StatusCode.NOT_FOUND)
    raise invalid(f"{stored.name} is the name of a volume of this process, which has to be kept with it")


def _read_here(stored: StoredVolume) -> Volume | Labels:
    """What this process keeps of it, unless another grid of its file is meant."""
    if stored._here is not None and stored.grid == stored._grid:
        return stored._here
    return Volume.from_vdb(_path_here(stored), stored.grid)


def _refuse_labels(volume: Meshable) -> None:
    if isinstance(volume, Labels) or (isinstance(volume, StoredVolume) and volume.labels):
        raise invalid("labels have no distances that could be sampled: give a Volume, a solid or a file of one")


def _no_frame() -> Exception:
    return invalid("labels do not go with a session: mesh each segmentation")


def _field_here(values: Volume | StoredVolume) -> _tetstream.Volume:
    """Of a file the grid that has values, which is not what can be meshed of it."""
    if isinstance(values, StoredVolume):
        if _is_file(values):
            return Volume.values_from_vdb(_path_here(values), values.grid)._volume
        kept = _read_here(values)
        if isinstance(kept, Labels):
            raise invalid(f"{values.name} has labels, which are no values of a field")
        values = kept
    return values._volume


def _volume_of_leaf(leaf: Any, grid: str) -> Volume:
    if isinstance(leaf, Volume):
        return leaf
    if isinstance(leaf, StoredVolume) and leaf._is_here:
        read = _read_here(dataclasses.replace(leaf, grid=grid))
        if isinstance(read, Labels):
            raise invalid(f"{leaf.name} has labels, which are no solid")
        return read
    if isinstance(leaf, StoredVolume) or str(leaf).startswith(_STORED):
        raise invalid(f"{leaf} is stored by a server: mesh the solid by that server's Client")
    return Volume.from_vdb(leaf, grid)


def _tell(options: _tetstream.Options) -> None:
    if options.progress is not None:
        options.progress(1.0)
