"""Meshes that follow their shapes under ids that do not move."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _tetstream
from ._backends import Backend
from ._errors import Error, FailedPreconditionError, StatusCode, invalid
from ._header import Header
from ._mesh import Mesh
from ._request import Meshable, options_of
from ._session import Following


def _boxes(replaced: ArrayLike) -> NDArray[np.int32]:
    """Rows of six, as the library has them."""
    boxes = np.asarray(replaced)
    if boxes.size == 0:
        return np.empty((0, 6), np.int32)
    if boxes.ndim != 3 or boxes.shape[1:] != (2, 3):
        raise invalid(f"replaced has the shape {boxes.shape}; (k, 2, 3) is needed: the first sample of each box, and its end")
    if not np.issubdtype(boxes.dtype, np.integer):
        raise invalid(f"replaced has numbers of type {boxes.dtype}; samples are counted by integers")
    most = np.iinfo(np.int32)
    if boxes.min() < most.min or boxes.max() > most.max:
        raise invalid(f"replaced goes from {boxes.min()} to {boxes.max()}: samples lie within {most.min} and {most.max}")
    return np.ascontiguousarray(boxes, dtype=np.int32).reshape(-1, 6)


def _every_row(array: NDArray[Any]) -> NDArray[np.int64]:
    return np.array([(0, len(array))], np.int64)


class StableMesh:
    """A frame of a `StableSession`, by slots: a vertex or tet that is kept keeps its slot, which is its id.

    Arrays have a row for each slot. In an empty one a vertex lies at the header's origin and belongs to no tet, and a
    tet is four times vertex 0, of volume 0, with region 0. New vertices and tets get the lowest empty slots.

    local_points     (n, 3) float32 or float64, relative to header.origin
    tets             (m, 4) uint32 or uint64, slots of vertices
    regions          (m,) uint8, 1 inside and 2 outside; None unless both sides are meshed
    empty_vertices, empty_tets       (k, 2) int64: rows of the first slot of a run, and the one behind its last
    changed_vertices, changed_tets   (k, 2) int64, such runs: all that is not what it was in the frame before
    renumbered       whether the ids are new ones, those of the mesh in its own order
    header           totals, origin, spacing; `vertex_count` and `tet_count` leave empty slots out

    The first three are views of the session's memory, without a copy and read-only. An update writes to that memory,
    unless it needs other: then it leaves this where it is. So an array that was taken before an update may always be
    read, and keeps its memory alive, but shows the frame before, the next, or some of either. Ask the mesh of each frame
    for its arrays, and copy what has to stay. The mesh itself is that of one frame: after the next, and after a failure
    that ends the session, it raises FailedPreconditionError.
    """

    def __init__(self, mesh: _tetstream.StableMesh, all_changed: bool = False) -> None:
        """`all_changed`: nobody was told what the frame before was."""
        self._mesh: _tetstream.StableMesh | None = mesh
        self._all_changed = all_changed

    @property
    def header(self) -> Header:
        """Of the mesh in its own order."""
        return Header._of(self._now.header)

    @property
    def local_points(self) -> NDArray[np.floating[Any]]:
        """Shape (n, 3): coordinates relative to `header.origin`."""
        return self._now.points

    @property
    def tets(self) -> NDArray[np.unsignedinteger[Any]]:
        """Shape (m, 4): slots of vertices. det(b - a, c - a, d - a) is positive, but of empty slots."""
        return self._now.tets

    @property
    def regions(self) -> NDArray[np.uint8] | None:
        """Shape (m,): 1 inside, 2 outside, 0 in empty slots; None unless both sides are meshed."""
        return self._now.regions

    @property
    def empty_vertices(self) -> NDArray[np.int64]:
        """Shape (k, 2): runs of slots without a vertex, sorted and apart."""
        return self._now.empty_vertices

    @property
    def empty_tets(self) -> NDArray[np.int64]:
        """Shape (k, 2): runs of slots without a tet, sorted and apart."""
        return self._now.empty_tets

    @property
    def changed_vertices(self) -> NDArray[np.int64]:
        """Shape (k, 2): runs of slots that have another vertex than before or none any more; all of
        them where the mesh is renumbered."""
        return _every_row(self.local_points) if self._all_changed else self._now.changed_vertices

    @property
    def changed_tets(self) -> NDArray[np.int64]:
        """Shape (k, 2): runs of slots that have another tet than before or none any more; all of them
        where the mesh is renumbered."""
        return _every_row(self.tets) if self._all_changed else self._now.changed_tets

    @property
    def renumbered(self) -> bool:
        """Whether ids of the frame before mean nothing here: in the first frame, where nothing could
        be kept, and where more than an eighth of the slots would be empty."""
        return self._now.renumbered

    @property
    def _now(self) -> _tetstream.StableMesh:
        if self._mesh is None:
            raise FailedPreconditionError(
                "this is the mesh of an earlier frame, which was patched in place: ask the session for the one "
                "that it has now (or copy arrays before the update)", StatusCode.FAILED_PRECONDITION)
        return self._mesh

    def __repr__(self) -> str:
        if self._mesh is None:
            return "<tetstream.StableMesh: of an earlier frame>"
        return (f"<tetstream.StableMesh: {self.header.tet_count:,} tets in {len(self.tets):,} slots, "
                f"{sum(end - first for first, end in self.changed_tets.tolist()):,} of them changed>")


class StableSession(Following[_tetstream.StableSession]):
    """A mesh that follows its shape and is patched in place: frames in, changed slots out.

        with client.stable_session(ball, spacing=0.1) as session:
            for frame in frames:
                mesh = session.update(frame)
                for first, end in mesh.changed_tets:
                    upload(mesh.tets[first:end])

    An update takes time in proportion to what is new, and copies nothing else. The same frames give the same ids here
    and on a server; they depend on all of the frames, in their order. `in_order()` is the mesh that a `Session` has.

    A frame that cannot be meshed leaves the mesh as it was, and the next may fare better. After any other error the
    session is over, and has no mesh: begin another. Where Ctrl-C comes when the frame was taken already, `session.mesh` is of
    that frame, with all of its slots changed. One thread at a time may be in it.
    """

    def __init__(self, session: _tetstream.StableSession, backend: Backend) -> None:
        super().__init__(session, backend)
        self.mesh = StableMesh(session.mesh)

    mesh: StableMesh
    """As it is now."""

    def update(self, frame: Meshable, *, replaced: ArrayLike | None = None) -> StableMesh:
        """The mesh of the next frame. The one before is patched in place, and its `StableMesh` raises from now on.

        replaced  shape (k, 2, 3), integers: boxes of samples, first and end along x, y and z, as in
                  values[x0:x1, y0:y1, z0:z1] of a `Volume.from_array`. Outside of them the volume has the samples of the
                  frame before. Then the two are not compared, which is a part of an update's time; boxes that are
                  too large, or too many, do no harm.

        A list that leaves out what has changed raises InvalidArgumentError, and the mesh stays, where it is noticed: other
        samples in the blocks of 8 x 8 x 8 samples (from multiples of 8 on) around those that the boxes touch; further away,
        blocks whose least or greatest sample is another, or that were constant and are no longer, or have another
        constant. That nothing else has changed there is your word: of a block far from all boxes whose samples
        change between the same bounds, the mesh would stay what it was.

        Errors: those of `Session.update`; InvalidArgumentError (of `replaced`: another shape, a box that ends before
        it begins, a frame that is no volume, and the above).
        """
        was_over = self.is_over
        boxes = None if replaced is None else _boxes(replaced)
        began = False

        def take(shape: _tetstream.Volume | _tetstream.Scene) -> _tetstream.StableMesh:
            nonlocal began
            began = boxes is None or isinstance(shape, _tetstream.Volume)
            if boxes is None:
                return self._session.update(shape)
            if not isinstance(shape, _tetstream.Volume):
                raise invalid("a solid has no samples that are replaced: give `replaced` with volumes alone")
            return self._session.update_replaced(shape, boxes)

        try:
            made = StableMesh(self._backend.with_frame(frame, options_of(), take))
            self.mesh._mesh = None
            self.mesh = made
        except Error:
            if self.is_over and not was_over:
                self.mesh._mesh = None
            raise
        except BaseException:  # Ctrl-C, for instance, which may have come when the frame was taken
            if began:
                self._take_what_there_is()
            raise
        return made

    def _take_what_there_is(self) -> None:
        """The session's mesh, whichever frame it is of."""
        self.mesh._mesh = None
        if not self.is_over:
            with contextlib.suppress(Error):  # where another thread has the session, which takes the mesh
                self.mesh = StableMesh(self._session.mesh, all_changed=True)

    def in_order(self) -> Mesh:
        """The mesh in its own order, as a copy, with all of its arrays: byte for byte the one that is made as a whole.

        Errors: FailedPreconditionError (a failure has ended the session, or another thread is in it), ResourceExhaustedError (no memory).
        """
        return Mesh(self._session.in_order())

    def __repr__(self) -> str:
        return f"<tetstream.StableSession: {self.mesh!r}>"
