"""Which volumes of this process a server has, and under which names."""

from __future__ import annotations

import contextlib
import threading
import time
import weakref
from collections.abc import Callable, Iterator

from . import _tetstream
from ._errors import CancelledError, DeadlineExceededError, StatusCode
from ._labels import Labels
from ._volume import Volume

Local = Volume | Labels
Upload = Callable[[], _tetstream.StoredVolume]

_LOOK_UP = 0.03  # seconds, as the library's own calls look whether they are stopped


class _Entry:
    """What is known of one volume. A thread has its turn to upload it; a callback of that thread may mesh it."""

    def __init__(self) -> None:
        self.turn = threading.RLock()
        self.stored: _tetstream.StoredVolume | None = None


class Uploads:
    """Names of volumes that were uploaded. Any thread may call any member: of several that need a volume, one
    uploads it and the others wait for that."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._entries: weakref.WeakKeyDictionary[Local, _Entry] = weakref.WeakKeyDictionary()

    def known(self, volume: Local, options: _tetstream.Options, upload: Upload) -> _tetstream.StoredVolume:
        """Its name, after `upload` where it has none."""
        entry = self._entry(volume)
        with _turn(entry, options):
            if entry.stored is None:
                entry.stored = upload()
            return entry.stored

    def renewed(self, volume: Local, options: _tetstream.Options, upload: Upload) -> _tetstream.StoredVolume:
        """Its name after `upload`, whatever is known."""
        entry = self._entry(volume)
        with _turn(entry, options):
            entry.stored = upload()
            return entry.stored

    def forget(self, volume: Local, options: _tetstream.Options, stored: _tetstream.StoredVolume) -> None:
        """Has it uploaded again, unless another thread has done so since this name came."""
        entry = self._entry(volume)
        with _turn(entry, options):
            if entry.stored is stored:
                entry.stored = None

    def _entry(self, volume: Local) -> _Entry:
        with self._lock:
            entry = self._entries.get(volume)
            if entry is None:
                entry = self._entries[volume] = _Entry()
            return entry


@contextlib.contextmanager
def _turn(entry: _Entry, options: _tetstream.Options) -> Iterator[None]:
    """Waits for as long as the call may take, and until it is stopped."""
    while not entry.turn.acquire(timeout=_LOOK_UP):
        if options.stop.requested:
            raise CancelledError("the call was cancelled", StatusCode.CANCELLED)
        if options.deadline is not None and time.time() >= options.deadline:
            raise DeadlineExceededError("the volume was not uploaded in time", StatusCode.DEADLINE_EXCEEDED)
    try:
        yield
    finally:
        entry.turn.release()
