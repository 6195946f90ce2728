"""The C++ library as it is: private, and wrapped by the modules beside it."""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

_Point = tuple[float, float, float]

def version() -> str: ...

class VolumeKind:
    __members__: ClassVar[dict[str, VolumeKind]]
    name: str

class Inside:
    __members__: ClassVar[dict[str, Inside]]

class Preset:
    __members__: ClassVar[dict[str, Preset]]

class Coordinates:
    __members__: ClassVar[dict[str, Coordinates]]

class Encoding:
    __members__: ClassVar[dict[str, Encoding]]

class OpenSurface:
    __members__: ClassVar[dict[str, OpenSurface]]

class Samples:
    def __init__(
        self, spacing: float, origin: _Point, kind: VolumeKind, background: float | None
    ) -> None: ...

class Volume:
    @staticmethod
    def from_samples(values: NDArray[np.float32], samples: Samples) -> Volume: ...
    @staticmethod
    def from_triangles(
        points: NDArray[np.float64], triangles: NDArray[np.uint32], voxel_size: float, open: OpenSurface
    ) -> Volume: ...
    @staticmethod
    def from_surface_file(path: str, voxel_size: float, open: OpenSurface) -> Volume: ...
    @staticmethod
    def from_vdb(path: str, grid: str, trusted: bool) -> Volume: ...
    @staticmethod
    def values_from_vdb(path: str, grid: str, trusted: bool) -> Volume: ...
    @property
    def kind(self) -> VolumeKind: ...
    @property
    def voxel_size(self) -> float: ...
    def write_vdb(self, path: str) -> None: ...

class Scene:
    @staticmethod
    def from_json(json: str, volumes: list[tuple[str, Volume]]) -> Scene: ...

class Labels:
    @staticmethod
    def from_voxels(
        values: NDArray[np.integer[Any]], origin: _Point, steps: tuple[_Point, _Point, _Point]
    ) -> Labels: ...
    @staticmethod
    def from_file(path: str, name: str, trusted: bool) -> Labels: ...
    @staticmethod
    def from_level_sets(volumes: list[Volume]) -> Labels: ...
    @property
    def counts(self) -> list[tuple[int, int]]: ...
    @property
    def voxel_edges(self) -> list[float]: ...
    def write_nrrd(self, path: str) -> None: ...

class LabelSmoothing:
    gauss: ClassVar[LabelSmoothing]
    thin: ClassVar[LabelSmoothing]
    none: ClassVar[LabelSmoothing]

class LabelChoice:
    background: int
    mesh_background: bool
    smoothing: LabelSmoothing
    smooth: float
    def set_only(self, ranges: list[tuple[int, int]]) -> None: ...
    def add_merge(self, ranges: list[tuple[int, int]]) -> None: ...
    def add_name(self, value: int, name: str) -> None: ...
    def add_size(self, first: int, last: int, size: float) -> None: ...

def read_label_names(path: str) -> list[tuple[int, str]]: ...

class Stop:
    requested: bool
    def request(self) -> None: ...

class Request:
    spacing: float | None
    iso: float | None
    inside: Inside | None
    levels: int | None
    preset: Preset
    sizing: str
    improve: bool
    manifold: bool
    statistics: bool
    faces: bool
    fidelity: bool
    face_regions: str
    coordinates: Coordinates
    labels: LabelChoice | None
    def set_box(self, box: tuple[_Point, _Point] | None) -> None: ...
    def add_field(self, name: str, values: Volume) -> None: ...

class Options:
    progress: Callable[[float], object] | None
    deadline: float | None
    threads: int
    encoding: Encoding
    skip_cache: bool
    stop: Stop

class Mesh:
    @property
    def header(self) -> dict[str, Any]: ...
    @property
    def statistics(self) -> dict[str, Any]: ...
    @property
    def points(self) -> NDArray[np.floating[Any]]: ...
    @property
    def tets(self) -> NDArray[np.unsignedinteger[Any]]: ...
    @property
    def regions(self) -> NDArray[np.uint8] | None: ...
    @property
    def field_rows(self) -> NDArray[np.float32] | None: ...
    @property
    def faces(self) -> NDArray[np.unsignedinteger[Any]] | None: ...
    @property
    def face_tets(self) -> NDArray[np.unsignedinteger[Any]] | None: ...
    @property
    def face_labels(self) -> NDArray[np.uint16] | None: ...
    @property
    def labels(self) -> NDArray[np.uint16] | None: ...
    def write(self, path: str, format: str, options: Options) -> None: ...

class Stream:
    @property
    def header(self) -> dict[str, Any]: ...
    def next(
        self,
        alone: bool = False,
    ) -> (
        tuple[
            int,
            int,
            int,
            NDArray[np.floating[Any]],
            NDArray[np.unsignedinteger[Any]],
            NDArray[np.uint8] | None,
            NDArray[np.float32] | None,
            NDArray[np.unsignedinteger[Any]] | None,
            NDArray[np.unsignedinteger[Any]] | None,
            NDArray[np.uint16] | None,
            NDArray[np.uint16] | None,
        ]
        | None
    ): ...
    def statistics(self) -> dict[str, Any]: ...
    def close(self) -> None: ...

_Here = Volume | Scene
_Shape = _Here | Labels
_There = StoredVolume | Scene

def mesh(solid: _Shape, request: Request, options: Options) -> Mesh: ...
def estimate(solid: _Shape, request: Request, options: Options) -> dict[str, Any]: ...
def stream(
    solid: _Shape, request: Request, options: Options, first: int = 0, end: int | None = None
) -> Stream: ...

class Session:
    @property
    def mesh(self) -> Mesh: ...
    @property
    def tets_sent(self) -> int: ...
    @property
    def is_over(self) -> bool: ...
    def update(self, frame: _Here) -> None: ...
    def end(self) -> None: ...
    def stop(self) -> None: ...

def session(solid: _Here, request: Request, options: Options) -> Session: ...
def session_there(client: Client, solid: _Here, request: Request, options: Options) -> Session: ...

class ClientOptions:
    token: str
    token_in_plain: bool
    tls: bool
    tls_ca: str
    tls_cert: str
    tls_key: str
    attempts: int

class StoredVolume:
    def __init__(self, name: str, grid: str, grids: list[str]) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def grid(self) -> str: ...
    @property
    def grids(self) -> list[str]: ...

class Client:
    def __init__(self, address: str, options: ClientOptions) -> None: ...
    def upload(self, volume: Volume | Labels, options: Options) -> StoredVolume: ...
    def upload_file(self, path: str, grid: str, options: Options) -> StoredVolume: ...
    def mesh(self, solid: _There, request: Request, options: Options) -> Mesh: ...
    def estimate(self, solid: _There, request: Request, options: Options) -> dict[str, Any]: ...
    def stream(
        self, solid: _There, request: Request, options: Options, first: int = 0, end: int | None = None
    ) -> Stream: ...
    def capabilities(self, options: Options) -> dict[str, Any]: ...
    def check_health(self, service: str, options: Options) -> None: ...

def sample(
    solid: _Here, points: NDArray[np.float64], request: Request, options: Options
) -> dict[str, Any]: ...
def sample_there(
    client: Client, solid: _There, points: NDArray[np.float64], request: Request, options: Options
) -> dict[str, Any]: ...

class JobState:
    __members__: ClassVar[dict[str, JobState]]
    name: str

class JobOrder:
    display_name: str
    labels: dict[str, str]
    priority: int
    max_attempts: int | None
    skip_cache: bool
    request_id: str
    def set_times(self, ttl: float | None, timeout: float | None) -> None: ...

class JobFilter:
    states: list[JobState]
    labels: dict[str, str]
    display_name_prefix: str
    most: int

class JobEvents:
    def next(self) -> dict[str, Any] | None: ...
    def close(self) -> None: ...

class Jobs:
    def __init__(self, client: Client) -> None: ...
    def submit(
        self, solid: _There, request: Request, order: JobOrder, options: Options
    ) -> dict[str, Any]: ...
    def get(self, name: str, options: Options) -> dict[str, Any]: ...
    def cancel(self, name: str, options: Options) -> dict[str, Any]: ...
    def retry(self, name: str, options: Options) -> dict[str, Any]: ...
    def wait(self, name: str, options: Options) -> dict[str, Any]: ...
    def remove(self, name: str, options: Options) -> None: ...
    def list(self, jobs: JobFilter, options: Options) -> tuple[Any, int]: ...
    def fetch(self, name: str, options: Options) -> Mesh: ...
    def stream(self, name: str, options: Options, first: int = 0, end: int | None = None) -> Stream: ...
    def watch(self, name: str, after_revision: int, options: Options) -> JobEvents: ...
