"""A mesh chunk by chunk."""

from __future__ import annotations

import functools
from types import TracebackType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _convert
from ._errors import FailedPreconditionError, StatusCode
from ._header import Header, Statistics
from ._mesh import Chunk
from ._share import Share


class ChunkSource(Protocol):
    """What a stream reads: the library's, or a rank's share of one."""

    @property
    def header(self) -> dict[str, Any]: ...
    def next(self) -> tuple[Any, ...] | None: ...
    def statistics(self) -> dict[str, Any]: ...
    def close(self) -> None: ...


class MeshStream:
    """A mesh that is made while it is read: an iterator of `Chunk`s that has the header already.

        with ts.stream(volume) as stream:
            print(stream.header.tet_count)
            for chunk in stream:
                use(chunk.points, chunk.tets)

    Whoever does not ask for the next chunk holds the work back. Leaving the `with`, `close` and the end
    of the object's life stop the work, here or on the server. A connection that breaks is taken up where
    it broke, and no chunk comes twice. One thread at a time may be in a stream.

    Errors, while it is read: those of the call that made it, UnavailableError (the server is gone, after
    all attempts), CancelledError (it was closed).
    """

    def __init__(self, stream: ChunkSource, share: Share | None = None) -> None:
        self._stream = stream
        self._share = share
        self._begun = False  # somebody has asked for a chunk

    @functools.cached_property
    def header(self) -> Header:
        """The mesh's totals: enough to allocate all of it."""
        return Header._of(self._stream.header)

    def __iter__(self) -> MeshStream:
        return self

    def __next__(self) -> Chunk:
        self._begun = True
        chunk = self._stream.next()
        if chunk is None:
            raise StopIteration
        return Chunk(self.header, *chunk)

    @property
    def share(self) -> Share:
        """Which of the mesh's vertices and tets come: all of them, unless it is the stream of one rank."""
        return self._share or Share(0, self.header.vertex_count, 0, self.header.tet_count)

    def to_dolfinx(self, comm: Any, *, tags: bool = False) -> Any:
        """The mesh as a `dolfinx.mesh.Mesh`, from all of the stream.

        comm   of mpi4py. Every rank reads a stream of its own: `client.stream(request, rank=comm.rank,
               size=comm.size)`. All ranks call this together.
        tags   also its cells' and facets', as of `Mesh.to_dolfinx`

        Errors: those of reading it; FailedPreconditionError (a chunk has been read before, a label's value is no tag).
        """
        if tags:
            _convert.check_tags(self.header)
        piece = self._collected()
        return _convert.tagged_dolfinx(piece, comm) if tags else _convert.to_dolfinx(piece, comm)

    def _collected(self) -> _convert.Piece:
        """All that comes, as one piece."""
        if self._begun:
            raise FailedPreconditionError("chunks of this stream have been read, and are no longer there to make a whole mesh "
                                          "of: begin another", StatusCode.FAILED_PRECONDITION)
        tets = np.empty((self.share.tet_count, 4), np.int64)
        points = np.empty((self.share.vertex_count, 3))
        # All ranks have the same columns, those without a chunk, too.
        parts: dict[str, list[NDArray[Any]]] = {}
        kinds = "label_values" if self.header.labels else "regions" if self.header.has_regions else None
        if kinds is not None:
            parts[kinds] = [np.empty(0, np.uint8)]
        if self.header.face_labels:
            parts |= {"faces": [np.empty((0, 3), np.int64)], "face_labels": [np.empty(0, np.uint16)]}
        for chunk in self:
            points[chunk.first_vertex - self.share.first_vertex:][:len(chunk.points)] = chunk.points
            tets[chunk.first_tet - self.share.first_tet:][:len(chunk.tets)] = chunk.tets
            for name, arrays in parts.items():
                arrays.append(getattr(chunk, name))
        columns = {name: np.concatenate(arrays) for name, arrays in parts.items()}
        if kinds is not None:
            columns["kinds"] = columns.pop(kinds)
        return _convert.Piece(points, tets, **columns)

    @property
    def statistics(self) -> Statistics:
        """What is told of the mesh after its last chunk. Errors: FailedPreconditionError (there are
        chunks to come)."""
        return Statistics._of(self._stream.statistics())

    def close(self) -> None:
        """Stops the work, unless it has ended. Any thread may call it, at any time."""
        self._stream.close()

    def __enter__(self) -> MeshStream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        h = self.header
        return (f"<tetstream.MeshStream: {h.vertex_count:,} vertices, {h.tet_count:,} tets "
                f"in {h.chunk_count} chunks>")
