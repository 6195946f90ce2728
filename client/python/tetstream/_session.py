"""Meshes that follow their shapes."""

from __future__ import annotations

import contextlib
from types import TracebackType
from typing import Generic, Self, TypeVar

from . import _tetstream
from ._backends import Backend
from ._errors import Error
from ._mesh import Mesh
from ._request import Meshable, options_of


Native = TypeVar("Native", bound=_tetstream.Session | _tetstream.StableSession)


class Following(Generic[Native]):
    """What sessions have in common, whatever mesh follows the shape."""

    def __init__(self, session: Native, backend: Backend) -> None:
        self._session = session
        self._backend = backend

    @property
    def tets_sent(self) -> int:
        """Tets of the last frame that were sent, or made here; the others were kept."""
        return self._session.tets_sent

    @property
    def is_over(self) -> bool:
        """Whether it takes no more frames."""
        return self._session.is_over

    def close(self) -> None:
        """Tells the server that this was all. The mesh stays as it is."""
        self._session.end()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self._abandon()

    def _abandon(self) -> None:
        """Ends it at once, and raises nothing: an exception is on its way already."""
        self._session.stop()
        with contextlib.suppress(Error):
            self._session.end()


class Session(Following[_tetstream.Session]):
    """A mesh and the shape that it is of, which may change: frames in, changed meshes out.

        with client.session(ball, spacing=0.1) as session:
            for frame in frames:
                mesh = session.update(frame)

    Every frame's mesh lies on the lattice of the first, so that what did not change keeps its vertices. Of a
    volume only the blocks of 8 x 8 x 8 samples that changed travel to a server, and of the mesh only the
    tets that did. The same frames make the same bytes here and there.

    A frame that cannot be meshed leaves the mesh as it was, and the next may fare better. After any other error, of the
    connection for instance, the session is over: begin another. One thread at a time may be in it.
    """

    def __init__(self, session: _tetstream.Session, backend: Backend) -> None:
        super().__init__(session, backend)
        self.mesh = Mesh(session.mesh)

    mesh: Mesh
    """As it is now."""

    def update(self, frame: Meshable) -> Mesh:
        """The mesh of the next frame: a Volume of the same place, spacing, kind and background as the first,
        or a solid where the session began with one.

        Errors: those of `Client.mesh`; InvalidArgumentError (a frame of another kind),
        FailedPreconditionError (the session is over, or another thread is in it), Error (the server ended it).
        """
        made = Mesh(self._backend.with_frame(frame, options_of(), self._session.update))
        self.mesh = made
        return made

    def __repr__(self) -> str:
        return f"<tetstream.Session: {self.mesh.header.tet_count:,} tets, {self.tets_sent:,} of them new>"
