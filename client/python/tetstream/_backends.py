"""Where meshes are made: in this process, or by a server. A `Client` has one of the two."""

from __future__ import annotations

import dataclasses
import os
import weakref
from collections.abc import Callable
from typing import Protocol, TypeVar

from . import _tetstream
from ._errors import NotFoundError, invalid
from ._volume import Volume

T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class StoredVolume:
    """A volume that a server stores. It may be kept as text, and used again.

    name   "grids/{sha256}": the same file has the same name everywhere
    grid   within the file; empty takes the only one that can be meshed
    """

    name: str
    grid: str = ""
    _here: Volume | None = dataclasses.field(default=None, repr=False, compare=False)


VolumeLike = Volume | StoredVolume | str | os.PathLike[str]


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

    def upload(self, volume: Volume, options: _tetstream.Options) -> StoredVolume: ...
    def upload_file(self, path: str, grid: str, options: _tetstream.Options) -> StoredVolume: ...
    def mesh(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> _tetstream.Mesh: ...
    def estimate(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> dict[str, float]: ...
    def stream(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> _tetstream.Stream: ...
    def capabilities(self, options: _tetstream.Options) -> Capabilities: ...
    def check_health(self, service: str, options: _tetstream.Options) -> None: ...


class Here:
    """This process. What is uploaded stays where it is."""

    def upload(self, volume: Volume, options: _tetstream.Options) -> StoredVolume:
        return StoredVolume(f"here/{id(volume):x}", "", volume)

    def upload_file(self, path: str, grid: str, options: _tetstream.Options) -> StoredVolume:
        return StoredVolume(f"here/{path}", grid, Volume.from_vdb(path, grid))

    def mesh(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> _tetstream.Mesh:
        return _tetstream.mesh(self._volume(volume), request, options)

    def estimate(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> dict[str, float]:
        return _tetstream.estimate(self._volume(volume), request, options)

    def stream(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> _tetstream.Stream:
        return _tetstream.stream(self._volume(volume), request, options)

    def capabilities(self, options: _tetstream.Options) -> Capabilities:
        return Capabilities(_tetstream.version(), "", 0, 0, 0, 0)

    def check_health(self, service: str, options: _tetstream.Options) -> None:
        pass

    @staticmethod
    def _volume(volume: VolumeLike) -> _tetstream.Volume:
        if isinstance(volume, StoredVolume):
            if volume._here is None:
                raise invalid(f"{volume.name} is stored by a server: mesh it by that server's Client")
            return volume._here._volume
        if isinstance(volume, Volume):
            return volume._volume
        return Volume.from_vdb(volume)._volume


class Served:
    """A server. A volume of this process is uploaded when it is meshed for the first time."""

    def __init__(self, address: str, options: _tetstream.ClientOptions) -> None:
        self._client = _tetstream.Client(address, options)
        self._uploaded: weakref.WeakKeyDictionary[Volume, _tetstream.StoredVolume] = (
            weakref.WeakKeyDictionary())

    def upload(self, volume: Volume, options: _tetstream.Options) -> StoredVolume:
        stored = self._uploaded[volume] = self._client.upload(volume._volume, options)
        return StoredVolume(stored.name, stored.grid)

    def upload_file(self, path: str, grid: str, options: _tetstream.Options) -> StoredVolume:
        stored = self._client.upload_file(path, grid, options)
        return StoredVolume(stored.name, stored.grid)

    def mesh(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> _tetstream.Mesh:
        return self._with(volume, options, lambda stored: self._client.mesh(stored, request, options))

    def estimate(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> dict[str, float]:
        return self._with(volume, options, lambda stored: self._client.estimate(stored, request, options))

    def stream(
        self, volume: VolumeLike, request: _tetstream.Request, options: _tetstream.Options
    ) -> _tetstream.Stream:
        return self._with(volume, options, lambda stored: self._client.stream(stored, request, options))

    def capabilities(self, options: _tetstream.Options) -> Capabilities:
        return Capabilities(**self._client.capabilities(options))

    def check_health(self, service: str, options: _tetstream.Options) -> None:
        self._client.check_health(service, options)

    def _with(
        self, volume: VolumeLike, options: _tetstream.Options, work: Callable[[_tetstream.StoredVolume], T]
    ) -> T:
        """Does `work` with a volume that the server has."""
        uploading = _tetstream.Options()
        uploading.deadline = options.deadline
        if isinstance(volume, StoredVolume):
            if volume._here is not None:
                raise invalid(f"{volume.name} is in this process: upload its volume by this Client")
            return work(_tetstream.StoredVolume(volume.name, volume.grid))
        if not isinstance(volume, Volume):
            return work(self._client.upload_file(os.fspath(volume), "", uploading))
        if volume in self._uploaded:
            try:
                return work(self._uploaded[volume])
            except NotFoundError as error:
                if error.reason != "GRID_NOT_FOUND":
                    raise  # else the server has evicted it
        self.upload(volume, uploading)
        return work(self._uploaded[volume])
