"""Changes of jobs, one after the other: what has happened since a revision, then what happens."""

from __future__ import annotations

import collections
from collections.abc import Callable, Iterable, Iterator
from types import TracebackType

from ._errors import Error, NotFoundError
from ._job import FINAL, EventSource, JobBackend, JobEvent, JobFilter

Left = Callable[[], float | None]
Again = Callable[[], tuple[list[JobEvent], EventSource]]


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
    ) -> None:
        """`past` comes before the source. `again` has both for a source whose past is forgotten in part."""
        self._source = source
        self._names = None if pending is None else frozenset(pending)
        self._pending = pending
        self._past = collections.deque(past)
        self._again = again

    def __iter__(self) -> Iterator[JobEvent]:
        return self

    def __next__(self) -> JobEvent:
        if self._past:
            return self._past.popleft()
        while self._source is not None and (self._pending is None or self._pending):
            try:
                event = self._source.next()
            except Error as error:
                if self._again is None or error.reason != "REVISION_COMPACTED":
                    raise
                self._begin_again(self._again)
                return next(self)
            if event is None:
                break
            self._again = None  # what came does not come twice
            if self._names is not None and event.name not in self._names:
                continue
            if self._pending is not None and _is_over(event):
                self._pending.discard(event.name)
            return event
        self.close()
        raise StopIteration

    def _begin_again(self, again: Again) -> None:
        self._again = None
        past, self._source = again()
        self._past.extend(past)

    def close(self) -> None:
        """Ends it. Any thread may call it."""
        self._past.clear()
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

    def again() -> tuple[list[JobEvent], EventSource]:
        jobs, now = backend.list(JobFilter({}, (), "", 0), left())
        told = [event for job in jobs for event in _told(backend, job.name, job.version, now, left)]
        return _sorted(told), backend.watch("", now, left())

    return JobWatch(backend.watch("", after, left()), None, again=again if after == 0 else None)


def watch_some(backend: JobBackend, names: Iterable[str], after: int | None, left: Left) -> JobWatch:
    """Of these jobs, until all are at their ends. What has happened to a job is asked of it alone: that is known for as
    long as there is the job, and says whether its end comes or has come before."""
    now = _newest(backend, left)
    begin = now if after is None else after
    past: list[JobEvent] = []
    pending: set[str] = set()
    for name in dict.fromkeys(names):
        if begin >= now:
            is_over = backend.get(name, left()).done
        else:
            told = _told(backend, name, _version(backend, name, left), now, left)
            past += [event for event in told if event.revision > begin]
            is_over = bool(told) and _is_over(told[-1])
        if not is_over:
            pending.add(name)
    if not pending:
        return JobWatch(None, pending, _sorted(past))
    only = next(iter(pending)) if len(pending) == 1 else ""
    return JobWatch(backend.watch(only, max(begin, now), left()), pending, _sorted(past))


def _newest(backend: JobBackend, left: Left) -> int:
    """The revision of the last change. Whoever asks for a job now sees all that led to it."""
    return backend.list(JobFilter({}, (), "", 1), left())[1]


def _version(backend: JobBackend, name: str, left: Left) -> int | None:
    """Nothing where the job was deleted: what happened to it may be known still."""
    try:
        return backend.get(name, left()).version
    except NotFoundError:
        return None


def _told(backend: JobBackend, name: str, version: int | None, now: int, left: Left) -> list[JobEvent]:
    """All that has happened until now to a job of this version; without one, until it was deleted."""
    told: list[JobEvent] = []
    source = backend.watch(name, 0, left())
    try:
        while (event := source.next()) is not None:
            told.append(event)
            if event.change == "deleted" or (version is not None and event.version >= version):
                break
    finally:
        source.close()
    return [event for event in told if event.revision <= now]


def _is_over(event: JobEvent) -> bool:
    return event.state in FINAL or event.change == "deleted"


def _sorted(events: list[JobEvent]) -> list[JobEvent]:
    return sorted(events, key=lambda event: event.revision)
