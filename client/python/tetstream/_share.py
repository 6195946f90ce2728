"""Ranks: the parts of a mesh that several processes read side by side."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

from . import _tetstream
from ._errors import FailedPreconditionError, StatusCode, invalid
from ._request import Progress

# The chunks from one on, to before another.
Open = Callable[[int, int], _tetstream.Stream]


@dataclasses.dataclass(frozen=True)
class Share:
    """One rank's runs of a mesh's vertices and tets: nearly as long as any other's, and one behind the other."""

    first_vertex: int
    vertex_count: int
    first_tet: int
    tet_count: int

    @classmethod
    def of(cls, vertex_count: int, tet_count: int, rank: int, size: int) -> Share:
        """The share of `rank`, 0 to size - 1."""
        if size < 1 or not 0 <= rank < size:
            raise invalid(f"rank {rank} of size {size}: a rank is 0 to size - 1")
        vertex, tet = vertex_count * rank // size, tet_count * rank // size
        return cls(vertex, vertex_count * (rank + 1) // size - vertex, tet, tet_count * (rank + 1) // size - tet)

    @property
    def end_vertex(self) -> int:
        """One past its last vertex."""
        return self.first_vertex + self.vertex_count

    @property
    def end_tet(self) -> int:
        """One past its last tet."""
        return self.first_tet + self.tet_count


class SharedStream:
    """Reads no more of a mesh's chunks than a rank's share lies in, and cuts them to it.

    Where in a mesh a chunk lies is known when it has come: chunks are nearly of one size, so that the first and the last
    are guessed, an earlier one taken where the share begins before, and more where it ends behind.
    """

    def __init__(self, open_range: Open, counted: dict[str, Any], rank: int, size: int) -> None:
        self.share = Share.of(int(counted["vertex_count"]), int(counted["tet_count"]), rank, size)
        self._open = open_range
        self._count = int(counted["chunk_count"])
        self._margin = 1 + self._count // 50
        self._first = max(0, self._count * rank // size - self._margin)
        # An end keeps the server from making, and sending, what the share's last chunk would be followed by.
        self._end = min(self._count, -(-self._count * (rank + 1) // size) + self._margin)
        self._stream = open_range(self._first, self._end)
        self._ahead = self._find_begin()
        self._covered = (0, 0)  # vertices and tets of the mesh that lie before what comes next

    @property
    def header(self) -> dict[str, Any]:
        return self._stream.header

    def next(self) -> tuple[Any, ...] | None:
        """The next chunk that has some of the share, cut to that."""
        while True:
            chunk, self._ahead = self._ahead or self._more(), None
            if chunk is None:
                self._stream.close()
                return None
            self._covered = (chunk[1] + len(chunk[3]), chunk[2] + len(chunk[4]))
            cut = self._cut(chunk)
            if len(cut[3]) or len(cut[4]):
                return cut

    def statistics(self) -> dict[str, Any]:
        raise FailedPreconditionError("a rank's share has no statistics: they are of whole meshes",
                                      StatusCode.FAILED_PRECONDITION)

    def close(self) -> None:
        self._stream.close()

    def _more(self) -> tuple[Any, ...] | None:
        vertices, tets = self._covered
        if vertices >= self.share.end_vertex and tets >= self.share.end_tet:
            return None
        chunk = self._stream.next(alone=True)
        if chunk is None and self._end < self._count:
            self._margin *= 2
            self._begin(self._end, min(self._count, self._end + self._margin))
            return self._stream.next(alone=True)
        return chunk

    def _begin(self, first: int, end: int) -> None:
        self._stream.close()
        self._first, self._end = first, end
        self._stream = self._open(first, end)

    def _find_begin(self) -> tuple[Any, ...] | None:
        if self.share.vertex_count == 0 and self.share.tet_count == 0:
            return None
        while True:
            chunk = self._stream.next(alone=True)
            if chunk is None or self._first == 0 or (
                    chunk[1] <= self.share.first_vertex and chunk[2] <= self.share.first_tet):
                return chunk
            self._margin *= 2
            self._begin(max(0, self._first - self._margin), self._end)

    def _cut(self, chunk: tuple[Any, ...]) -> tuple[Any, ...]:
        index, first_vertex, first_tet, points, tets, regions, rows, faces, face_tets, face_labels, labels = chunk
        vertices = _run(first_vertex, len(points), self.share.first_vertex, self.share.end_vertex)
        cells = _run(first_tet, len(tets), self.share.first_tet, self.share.end_tet)
        if faces is not None:
            begin, end = face_tets.searchsorted([first_tet + cells.start, first_tet + cells.stop])
            faces, face_tets, face_labels = faces[begin:end], face_tets[begin:end], face_labels[begin:end]
        return (index, first_vertex + vertices.start, first_tet + cells.start, points[vertices], tets[cells],
                None if regions is None else regions[cells], None if rows is None else rows[vertices],
                faces, face_tets, face_labels, None if labels is None else labels[cells])


def growing(progress: Progress) -> Progress:
    """`progress` as several streams tell it, each from 0 on, one behind the other: it is told no less than before."""
    most = 0.0

    def tell(fraction: float) -> None:
        nonlocal most
        most = max(most, fraction)
        progress(most)

    return tell


def _run(first: int, count: int, begin: int, end: int) -> slice:
    """What lies in [begin, end) of a run of `count` that begins at `first`."""
    low = min(max(begin - first, 0), count)
    return slice(low, max(low, min(end - first, count)))
