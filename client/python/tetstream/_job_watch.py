"""Changes of jobs, one after the other: what has happened since a revision, then what happens."""

from __future__ import annotations

import collections
from collections.abc import Callable, Iterable, Iterator
from types import TracebackType

from ._errors import Error, NotFoundError
from ._job import FINAL, EventSource, Job, JobBackend, JobEvent, JobFilter

Left = Callable[[], float | None]
Again = Callable[[int], tuple[list[JobEvent], EventSource | None, int] | None]


class JobWatch:
    """Changes of jobs, as they happen: an iterator of `JobEvent`s, which may be left at any time.

        with client.jobs.watch(jobs) as watch:
            for event in watch:
                print(event.name, event.state, f"{event.progress.fraction:.0%}")
    """

    def __init__(
        self,
        source: EventSource | None,
        pending: set[str] | None,
        past: Iterable[JobEvent] = (),
        again: Again | None = None,
        seen: int = 0,
    ) -> None:
        """`past` comes before the source, which begins behind the revision `seen`. `again` has both where the source's
        past is forgotten in part, and the revision up to which that is: what came behind a revision, or nothing where
        that cannot be had."""
        self._source = source
        self._names = None if pending is None else frozenset(pending)
        self._pending = pending
        self._past = collections.deque(past)
        self._again = again
        self._seen = seen
        self._closed = False

    def __iter__(self) -> Iterator[JobEvent]:
        return self

    def __next__(self) -> JobEvent:
        while not self._closed:
            if self._past:
                return self._past.popleft()
            if self._source is None or (self._pending is not None and not self._pending):
                break
            try:
                event = self._source.next()
            except Error as error:
                if error.reason != "REVISION_COMPACTED" or not self._begin_again():
                    raise
                continue
            if event is None:
                break
            self._seen = event.revision
            if self._names is not None and event.name not in self._names:
                continue
            if self._pending is not None and _is_over(event):
                self._pending.discard(event.name)
            return event
        self.close()
        raise StopIteration

    def _begin_again(self) -> bool:
        """Goes on behind what was seen last, where that can be."""
        begun = None if self._again is None else self._again(self._seen)
        if begun is None:
            return False
        past, self._source, self._seen = begun
        self._past.extend(past)
        if self._closed and self._source is not None:  # while the source was not there to be closed
            self._source.close()
        return True

    def close(self) -> None:
        """Ends it. Any thread may call it."""
        self._closed = True
        if self._source is not None:
            self._source.close()

    def __enter__(self) -> JobWatch:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def watch_all(backend: JobBackend, after: int | None, left: Left) -> JobWatch:
    """Of all jobs, without an end. From the first revision on it has what is known of the jobs that there are."""
    if after is None:
        after = _newest(backend, left)

    def again(seen: int) -> tuple[list[JobEvent], EventSource | None, int] | None:
        if seen > 0:
            return None  # what came since then, of jobs that are gone
        jobs, now = backend.list(JobFilter({}, (), "", 0), left())
        told = [event for job in jobs for event in _still_told(backend, job, left)]
        return _between(0, told, now), backend.watch("", now, left()), now

    return JobWatch(backend.watch("", after, left()), None, again=again, seen=after)


def watch_some(backend: JobBackend, names: Iterable[str], after: int | None, left: Left) -> JobWatch:
    """Of these jobs, until all are at their ends. What has happened to a job is asked of it alone: that is known for as
    long as there is the job, and says whether its end comes or has come before."""
    now = _newest(backend, left)
    begin = now if after is None else after
    each = dict.fromkeys(names)
    past: list[JobEvent] = []
    if begin >= now:
        pending = {name for name in each if not backend.get(name, left()).done}
    else:
        past, pending = _past_of(backend, each, begin, now, left)

    def again(seen: int) -> tuple[list[JobEvent], EventSource | None, int]:
        now = _newest(backend, left)
        missed, still = _past_of(backend, sorted(pending), seen, now, left)
        pending.intersection_update(still)
        return missed, _source(backend, pending, now, left), now

    begin = max(begin, now)
    return JobWatch(_source(backend, pending, begin, left), pending, past, again, begin)


def _source(backend: JobBackend, pending: set[str], after: int, left: Left) -> EventSource | None:
    """Of all jobs where several are waited for."""
    if not pending:
        return None
    return backend.watch(next(iter(pending)) if len(pending) == 1 else "", after, left())


def _past_of(
    backend: JobBackend, names: Iterable[str], begin: int, now: int, left: Left
) -> tuple[list[JobEvent], set[str]]:
    """What has happened to jobs behind one revision and up to another, and which of them are not at their ends then."""
    past: list[JobEvent] = []
    pending: set[str] = set()
    for name in names:
        version = _version(backend, name, left)
        told = _told(backend, name, version, left)
        known = _between(0, told, now)
        past += _between(begin, known, now)
        # A job that is gone may have nothing to tell of its end. Where it has, that may have come after `now`.
        more_comes = version is not None or len(told) > len(known)
        if more_comes and not (known and _is_over(known[-1])):
            pending.add(name)
    return _between(begin, past, now), pending


def _newest(backend: JobBackend, left: Left) -> int:
    """The revision of the last change. Whoever asks for a job now sees all that led to it."""
    return backend.list(JobFilter({}, (), "", 1), left())[1]


def _version(backend: JobBackend, name: str, left: Left) -> int | None:
    """Nothing where the job was deleted: what happened to it may be known still."""
    try:
        return backend.get(name, left()).version
    except NotFoundError:
        return None


def _told(backend: JobBackend, name: str, version: int | None, left: Left) -> list[JobEvent]:
    """All that has happened to a job of this version, and maybe more; without a version, until it was deleted."""
    told: list[JobEvent] = []
    source = backend.watch(name, 0, left())
    try:
        while (event := source.next()) is not None:
            told.append(event)
            if event.change == "deleted" or (version is not None and event.version >= version):
                break
    finally:
        source.close()
    return told


def _still_told(backend: JobBackend, job: Job, left: Left) -> list[JobEvent]:
    """As `_told`; nothing of a job that was purged, with its changes, since it was listed."""
    try:
        return _told(backend, job.name, job.version, left)
    except NotFoundError as error:
        if error.reason != "JOB_NOT_FOUND":
            raise
        return []


def _is_over(event: JobEvent) -> bool:
    return event.state in FINAL or event.change == "deleted"


def _between(after: int, events: Iterable[JobEvent], now: int) -> list[JobEvent]:
    """Those behind one revision and up to another, in their order."""
    wanted = (event for event in events if after < event.revision <= now)
    return sorted(wanted, key=lambda event: event.revision)
