"""Clients: the calls that make meshes, here and on a server."""

from __future__ import annotations

import dataclasses
import os
import warnings
from collections.abc import Iterable
from types import TracebackType

from numpy.typing import ArrayLike

from . import _tetstream
from ._backends import Backend, Capabilities, Here, Served
from ._errors import CancelledError, StatusCode
from ._job import JobBackend
from ._jobs import Jobs
from ._labels import Background, LabelNames, LabelRanges, LabelSizes, Labels, Smooth
from ._local_jobs import LocalJobs
from ._mesh import Mesh
from ._request import (Box, Coordinates, Encoding, FaceRegions, Fields, Inside, Preset, Progress, Request, Sizing,
                       StoredVolume, VolumeLike, options_of)
from ._samples import Samples, rows_of
from ._served_jobs import ServedJobs
from ._session import Session
from ._stable import StableSession
from ._share import SharedStream, growing
from ._stream import MeshStream
from ._volume import Volume

LOCAL = ":local:"


@dataclasses.dataclass(frozen=True)
class Estimate:
    """What a mesh would take.

    bytes     of its arrays together
    seconds   about how long making it takes, once it is counted
    """

    vertex_count: int
    tet_count: int
    chunk_count: int
    bytes: int
    seconds: float


class Client:
    """Makes meshes on a server: `Client("host:port")`; or in this process, by the same calls: `Client(":local:")`.

    address         host:port, unix:PATH (a socket file of this host), or several with commas between that know the
                    same volumes. The first call tells whether the server is there; making a Client does not wait for it.
    token           goes with every call. It needs TLS or `token_in_plain`, unless the server is on this host.
    token_in_plain  send it even where others can read it on its way
    tls             speak TLS; also where one of the following files (PEM) is given
    tls_ca          who signs the server's certificate; unless given the system's
    tls_cert, tls_key   the client's own certificate and its private key, where the server asks for them
    attempts        at a call that fails because the server cannot be reached
    shared_memory   take chunks from it, where the server's socket file is on this host

    Any thread may call any member. While a call works, other threads of Python run; Ctrl-C stops the work
    and raises KeyboardInterrupt. Meshes of a file are the same, byte for byte, wherever they are made.

    Errors: NotFoundError and InvalidArgumentError (a file), FailedPreconditionError (a token that others
    could read).
    """

    def __init__(
        self,
        address: str = LOCAL,
        *,
        token: str = "",
        token_in_plain: bool = False,
        tls: bool = False,
        tls_ca: str | os.PathLike[str] = "",
        tls_cert: str | os.PathLike[str] = "",
        tls_key: str | os.PathLike[str] = "",
        attempts: int = 8,
        shared_memory: bool = True,
    ) -> None:
        self.address = address
        here = Here()
        self._open: tuple[Backend, JobBackend] | None = here, LocalJobs(here)
        if address == LOCAL:
            return
        options = _tetstream.ClientOptions()
        options.token = token
        options.token_in_plain = token_in_plain
        options.tls = tls
        options.tls_ca = os.fspath(tls_ca)
        options.tls_cert = os.fspath(tls_cert)
        options.tls_key = os.fspath(tls_key)
        options.attempts = attempts
        options.shared_memory = shared_memory
        served = Served(address, options)
        self._open = served, ServedJobs(served)

    @property
    def _opened(self) -> tuple[Backend, JobBackend]:
        opened = self._open  # which another thread may close
        if opened is None:
            raise CancelledError("the client is closed", StatusCode.CANCELLED)
        return opened

    @property
    def _backend(self) -> Backend:
        return self._opened[0]

    def mesh(
        self,
        volume: VolumeLike,
        *,
        spacing: float | None = None,
        iso: float | None = None,
        inside: Inside | None = None,
        levels: int | None = None,
        preset: Preset = "default",
        box: Box | None = None,
        sizing: Sizing | None = None,
        improve: bool = False,
        manifold: bool = False,
        statistics: bool = True,
        faces: bool = False,
        fidelity: bool = False,
        face_regions: FaceRegions | None = None,
        coordinates: Coordinates = "automatic",
        fields: Fields | None = None,
        labels: LabelRanges | None = None,
        merge: Iterable[LabelRanges] = (),
        background: Background = "left_out",
        background_label: int = 0,
        label_names: LabelNames | None = None,
        smooth: Smooth | None = None,
        label_sizes: LabelSizes | None = None,
        threads: int = 0,
        encoding: Encoding = "plain",
        skip_cache: bool = False,
        progress: Progress | None = None,
        timeout: float | None = None,
    ) -> Mesh:
        """Makes a mesh. Without options it is as fine as the voxels at the surface, and coarser inside.

        volume       a Volume, which a server is sent when it is meshed there for the first time; a solid
                     (`ts.sphere(1) - ts.box(1)`); `Labels`; the path of a .vdb file or an image; what `upload` or
                     `upload_file` returned; or a `Request` of one of them, which then has the options up to `label_sizes`
        spacing      edge of the finest cells, world units; unless given the voxel size, and of a solid its
                     longest extent / 128
        iso          the surface's value; unless given 0 for level sets and 0.5 for densities
        inside       which side of the iso value is meshed, "above" or "below"; unless given what the volume's kind
                     says. A file's grid without a class may need it: docs/inside.md
        levels       octree levels above the finest, 0 (uniform) to 24 (as coarse as the inside allows);
                     by default 1, or 24 with a sizing that has coarsest or growth
        preset       bounds on dihedral angles: "default" 11.3 to 154.7 degrees, "min_angle" 11.8 to 161.2,
                     "both_sides" (inside and outside in one mesh, up to a box) 9.4 to 157.4
        box          (lowest, highest) corner, world units: with "both_sides" how far both sides go, else
                     where the inside is cut off with flat faces
        sizing       how large tets may be, and where, as in docs/sizing.md:
                     {"growth": 0.25, "coarsest": 0.4}, or JSON
        improve      move vertices to better the worst angles
        manifold     the boundary touches itself nowhere, whatever the field
        statistics   measure angles and boundary: a little slower
        faces        boundary triangles beside the tets, with names: docs/faces.md
        fidelity     hold the mesh's surface against the one that is meshed, and measure the shapes of tets:
                     `statistics` has both. About as long as meshing takes; asks for `faces`, too: docs/report.md
        face_regions   names of pieces of the surface, and where each lies; they ask for `faces`, too:
                     {"bore": {"cylinder": {"start": [0, 0, 0], "end": [0, 0, 1], "radius": 0.3}}}. Several
                     places are a list; a list of {"name": ..., ...} or JSON will do, too: docs/faces.md. A
                     region that took no face is a UserWarning, and one with "creases" has its patches
                     named after it
        coordinates  how they are stored: "float32", "float64", or "automatic", which takes float64 where
                     float32 would bend the angle bounds
        fields       {name: Volume}, or what `upload` or `upload_file` returned: arrays of values that the vertices
                     get, at most 16. A server is sent them when they are asked for there for the first time
        labels       which labels of a segmentation are meshed: "1,4,7:12", 4, [1, 4, range(7, 13)]; all of
                     them unless given. This and the next six are for `Labels`, have a file read as such, and make
                     each part of a solid that is a union (`a | b`) a label, 1, 2, ... in their order; what
                     parts have in common is the first one's
        merge        labels that become one, the first: ["4,7:9", [1, 2]]; they are chosen when all is merged
        background   the space around, "left_out", or "meshed" up to the box; what is not chosen is part of it
        background_label   the label that it has
        label_names  {4: "bone"}, or the path of a table: docs/labels.md
        smooth       how interfaces are smoothed: the width of a Gaussian in voxels, 0.7 unless given; 0 keeps
                     every stair, "thin" keeps sheets one voxel thin
        label_sizes  {4: 2.5, "7:12": 1}: how long tets of some labels may be inside, world units, not below
                     the spacing; "all" for all of them. With sizes `levels` is 24 unless given
        threads      in this process; 0 takes every core
        encoding     how a server's chunks travel: "plain", "packed" (a fifth of the bytes), "compact" (the
                     least, and the mesh is made here; not with `improve`, `fields` or regions with creases)
        skip_cache   have a server make it even where one of its jobs has stored it
        progress     called with the fraction that is done, which grows from 0 to 1, by the thread that waits
        timeout      seconds, for all of the call

        Errors: InvalidArgumentError (an option, named in the text), FailedPreconditionError (no surface at
        this iso value, an inside without an end), ResourceExhaustedError (too large), NotFoundError,
        DeadlineExceededError; of a server also UnavailableError, AccessError, DataLossError. What `progress`
        raises stops the work and is raised here.
        """
        request = Request._of(
            volume, spacing=spacing, iso=iso, inside=inside, levels=levels, preset=preset, box=box, sizing=sizing,
            improve=improve, manifold=manifold, statistics=statistics, faces=faces, fidelity=fidelity,
            face_regions=face_regions, coordinates=coordinates, fields=fields,
            labels=labels, merge=merge, background=background, background_label=background_label,
            label_names=label_names, smooth=smooth, label_sizes=label_sizes)
        options = options_of(progress=progress, timeout=timeout, threads=threads, encoding=encoding,
                             skip_cache=skip_cache)
        made = Mesh(self._backend.mesh(request, options))
        for name in made.statistics.empty_face_regions:
            low, high = made.header.bounds
            warnings.warn(f"no face is in region {name!r}: none meets all its conditions, or earlier regions took "
                          f"them; the mesh lies between {low} and {high}", stacklevel=2)
        return made

    def stream(
        self,
        volume: VolumeLike,
        *,
        spacing: float | None = None,
        iso: float | None = None,
        inside: Inside | None = None,
        levels: int | None = None,
        preset: Preset = "default",
        box: Box | None = None,
        sizing: Sizing | None = None,
        improve: bool = False,
        manifold: bool = False,
        statistics: bool = True,
        faces: bool = False,
        fidelity: bool = False,
        face_regions: FaceRegions | None = None,
        coordinates: Coordinates = "automatic",
        fields: Fields | None = None,
        labels: LabelRanges | None = None,
        merge: Iterable[LabelRanges] = (),
        background: Background = "left_out",
        background_label: int = 0,
        label_names: LabelNames | None = None,
        smooth: Smooth | None = None,
        label_sizes: LabelSizes | None = None,
        threads: int = 0,
        encoding: Encoding = "plain",
        skip_cache: bool = False,
        rank: int = 0,
        size: int = 1,
        progress: Progress | None = None,
        timeout: float | None = None,
    ) -> MeshStream:
        """Makes a mesh chunk by chunk: returns when it is counted, before it is made.

        Options and errors are those of `mesh`. `progress` is called while chunks are read, and `timeout` is for
        all of the stream. A compact stream hands on its first chunk when all of it has come.

        rank, size   of several processes, as of MPI, that read the mesh side by side: each gets its share of
                     the vertices and of the tets, contiguous and as large as any other's, whose ids count in
                     the whole mesh. `stream.share` says which. Chunks then come plain, and without statistics.
        """
        request = Request._of(
            volume, spacing=spacing, iso=iso, inside=inside, levels=levels, preset=preset, box=box, sizing=sizing,
            improve=improve, manifold=manifold, statistics=statistics, faces=faces, fidelity=fidelity,
            face_regions=face_regions, coordinates=coordinates, fields=fields,
            labels=labels, merge=merge, background=background, background_label=background_label,
            label_names=label_names, smooth=smooth, label_sizes=label_sizes)
        options = options_of(progress=growing(progress) if progress and size > 1 else progress, timeout=timeout,
                             threads=threads, encoding=encoding, skip_cache=skip_cache)
        backend = self._backend
        if size == 1 and rank == 0:
            return MeshStream(backend.stream(request, options))
        counted = backend.estimate(request, options_of(timeout=timeout, threads=threads))
        shared = SharedStream(lambda first, end: backend.stream(request, options, first, end), counted, rank, size)
        return MeshStream(shared, shared.share)

    def estimate(
        self,
        volume: VolumeLike,
        *,
        spacing: float | None = None,
        iso: float | None = None,
        inside: Inside | None = None,
        levels: int | None = None,
        preset: Preset = "default",
        box: Box | None = None,
        sizing: Sizing | None = None,
        improve: bool = False,
        manifold: bool = False,
        statistics: bool = True,
        faces: bool = False,
        fidelity: bool = False,
        face_regions: FaceRegions | None = None,
        coordinates: Coordinates = "automatic",
        fields: Fields | None = None,
        labels: LabelRanges | None = None,
        merge: Iterable[LabelRanges] = (),
        background: Background = "left_out",
        background_label: int = 0,
        label_names: LabelNames | None = None,
        smooth: Smooth | None = None,
        label_sizes: LabelSizes | None = None,
        threads: int = 0,
        timeout: float | None = None,
    ) -> Estimate:
        """Counts a mesh without making it. Options and errors are those of `mesh`."""
        request = Request._of(
            volume, spacing=spacing, iso=iso, inside=inside, levels=levels, preset=preset, box=box, sizing=sizing,
            improve=improve, manifold=manifold, statistics=statistics, faces=faces, fidelity=fidelity,
            face_regions=face_regions, coordinates=coordinates, fields=fields,
            labels=labels, merge=merge, background=background, background_label=background_label,
            label_names=label_names, smooth=smooth, label_sizes=label_sizes)
        told = self._backend.estimate(request, options_of(timeout=timeout, threads=threads))
        return Estimate(int(told["vertex_count"]), int(told["tet_count"]), int(told["chunk_count"]),
                        int(told["bytes"]), told["seconds"])

    def sample(
        self,
        volume: VolumeLike,
        points: ArrayLike,
        *,
        spacing: float | None = None,
        iso: float | None = None,
        inside: Inside | None = None,
        fields: Fields | None = None,
        threads: int = 0,
        progress: Progress | None = None,
        timeout: float | None = None,
    ) -> Samples:
        """phi, its slope, and values of fields at points, without a mesh: what a mesh would be made from.

        volume    as of `mesh`
        points    x, y and z of each, world units, shape (n, 3): any number, sent a few thousands at a time
        spacing   as of `mesh`: a solid's slope is measured over 1e-4 of it
        iso, inside, fields, threads, progress, timeout   as of `mesh`

        The same bytes here and on a server. Errors: those of `mesh`; InvalidArgumentError (a point that is not
        finite, labels).
        """
        request = Request._of(volume, spacing=spacing, iso=iso, inside=inside, fields=fields)
        options = options_of(progress=progress, timeout=timeout, threads=threads)
        return Samples._of(self._backend.sample(request, rows_of(points), options))

    def session(
        self,
        volume: VolumeLike,
        *,
        spacing: float | None = None,
        threads: int = 0,
        timeout: float | None = None,
    ) -> Session:
        """Begins a session: a mesh that follows its shape, frame by frame.

        volume    the first frame, a Volume or a solid; or a `Request` of one, which has all options
        spacing   as of `mesh`
        timeout   seconds, for all of the session
        """
        request = Request._of(volume, spacing=spacing)
        backend = self._backend
        return Session(backend.session(request, options_of(timeout=timeout, threads=threads)), backend)

    def stable_session(
        self,
        volume: VolumeLike,
        *,
        spacing: float | None = None,
        threads: int = 0,
        timeout: float | None = None,
    ) -> StableSession:
        """Begins a session whose vertices and tets keep their ids, and whose arrays are patched in place.

        volume, spacing, threads, timeout   as of `session`
        """
        request = Request._of(volume, spacing=spacing)
        backend = self._backend
        options = options_of(timeout=timeout, threads=threads)
        return StableSession(backend.stable_session(request, options), backend)

    @property
    def jobs(self) -> Jobs:
        """Meshes that are made while nobody waits."""
        return Jobs(self._opened[1])

    def upload(
        self, volume: Volume | Labels, *, progress: Progress | None = None, timeout: float | None = None
    ) -> StoredVolume:
        """Stores a volume, or labels, of this process. `mesh` does so by itself; this tells its progress, and gives a name."""
        return self._backend.upload(volume, options_of(progress=progress, timeout=timeout))

    def upload_file(
        self,
        path: str | os.PathLike[str],
        grid: str = "",
        *,
        progress: Progress | None = None,
        timeout: float | None = None,
    ) -> StoredVolume:
        """Stores a .vdb file; nothing travels where the server has it. An upload that broke goes on where
        it ended. Errors: NotFoundError (no such file here), ResourceExhaustedError (larger than the store)."""
        return self._backend.upload_file(os.fspath(path), grid, options_of(progress=progress, timeout=timeout))

    def capabilities(self, *, timeout: float | None = None) -> Capabilities:
        """What the server is, and its limits."""
        return self._backend.capabilities(options_of(timeout=timeout))

    def check_health(self, service: str = "readiness", *, timeout: float | None = None) -> None:
        """Raises an Error unless the server says that it serves: "readiness", "liveness" or "jobs"."""
        self._backend.check_health(service, options_of(timeout=timeout))

    def close(self) -> None:
        """Forgets the connection. Streams that were begun go on; jobs of this process are cancelled."""
        opened, self._open = self._open, None
        if opened is not None and isinstance(opened[1], LocalJobs):
            opened[1].close()

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"tetstream.Client({self.address!r})"
