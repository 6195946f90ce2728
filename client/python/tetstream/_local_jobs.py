"""Jobs of this process: made one after the other by a thread of it."""

from __future__ import annotations

import dataclasses
import datetime
import itertools
import math
import threading
import time
import uuid

from . import _tetstream
from ._backends import Backend
from ._errors import (CancelledError, DeadlineExceededError, Error, FailedPreconditionError, InternalError,
                      NotFoundError, StatusCode)
from ._job import EventSource, Job, JobChange, JobEvent, JobFilter, JobOrder, JobPage, JobProgress
from ._mesh import Mesh
from ._request import Progress, Request, options_of, stop_of_context
from ._stream import MeshStream


_EXPIRED = "JOB_EXPIRED"


@dataclasses.dataclass
class _Entry:
    """A job, and what nobody else sees of it."""

    job: Job
    request: Request
    order: JobOrder
    number: int
    stop: _tetstream.Stop
    expires: float = math.inf  # as time.monotonic has it
    mesh: Mesh | None = None


Entries = list[_Entry]


class LocalJobs:
    """Keeps jobs and their meshes for as long as it lives. Any thread may call any member."""

    def __init__(self, backend: Backend) -> None:
        self._backend = backend
        self._changed = threading.Condition()
        self._entries: dict[str, _Entry] = {}
        self._events: list[JobEvent] = []
        self._numbers = itertools.count(1)
        self._next_end = math.inf  # before which `_expire` has nothing to do
        self._works = False

    def submit(self, request: Request, order: JobOrder, timeout: float | None) -> Job:
        request._wire()  # what is wrong with it is said now
        with self._changed:
            for entry in self._entries.values():
                if order.request_id and entry.order.request_id == order.request_id:
                    return entry.job
            number = next(self._numbers)
            name = f"jobs/{number:08x}{uuid.uuid4().hex[:16]}"
            job = Job(name, "queued", order.display_name, dict(order.labels), order.priority, order.ttl,
                      order.run_timeout, created=_now())
            entry = _Entry(job, request, order, number, _tetstream.Stop())
            self._entries[name] = entry
            self._limit(entry)
            self._note(name, "created")
            self._start()
            return job

    def get(self, name: str, timeout: float | None) -> Job:
        with self._changed:
            self._expire()
            entry = self._entry(name)
            if entry.job.state != "queued":
                return entry.job
            before = sum(self._place(other) < self._place(entry) for other in self._queued())
            return dataclasses.replace(entry.job, queue_position=before)

    def list(self, jobs: JobFilter, timeout: float | None) -> JobPage:
        with self._changed:
            self._expire()
            newest = sorted(self._entries.values(), key=lambda entry: -entry.number)
            chosen = [dataclasses.replace(entry.job, header=None) for entry in newest
                      if jobs.labels.items() <= entry.job.labels.items()
                      and (not jobs.states or entry.job.state in jobs.states)
                      and entry.job.display_name.startswith(jobs.display_name_prefix)]
            return chosen[:jobs.most or None], len(self._events)

    def wait(self, name: str, progress: Progress | None, timeout: float | None) -> Job:
        patience = _Patience(timeout)
        told = -1.0
        while True:
            with self._changed:
                self._expire()
                job = self._entry(name).job
                if not job.done:
                    patience.wait(self._changed, self._next_end)
                    job = self._entry(name).job
            if progress is not None and job.progress.fraction > told:
                told = job.progress.fraction
                progress(told)
            if job.done:
                return job

    def watch(self, name: str, after: int, timeout: float | None) -> EventSource:
        with self._changed:
            if name and not any(event.name == name for event in self._events):
                self._entry(name)
        return _Events(self, name, after, timeout)

    def cancel(self, name: str, timeout: float | None) -> Job:
        patience = _Patience(timeout)
        with self._changed:
            self._expire()
            entry = self._entry(name)
            entry.stop.request()
            if entry.job.state == "queued":
                self._finish(entry, None, _cancelled())
            while not entry.job.done:  # which a file that is being read does not heed
                patience.wait(self._changed, math.inf)
            return entry.job

    def retry(self, name: str, timeout: float | None) -> Job:
        with self._changed:
            self._expire()
            entry = self._entry(name)
            if not entry.job.done:
                raise _refusal(f"{name} is {entry.job.state}: cancel it first, or wait", "JOB_ACTIVE")
            if entry.job.state == "succeeded":
                raise _refusal(f"{name} has succeeded: there is nothing to retry", "JOB_SUCCEEDED")
            entry.stop = _tetstream.Stop()
            self._limit(entry)
            entry.number = next(self._numbers)
            self._change(entry, "retried", state="queued", error=None, started=None, finished=None,
                         progress=JobProgress())
            self._start()
            return entry.job

    def delete(self, name: str, timeout: float | None) -> None:
        with self._changed:
            self._expire()
            entry = self._entry(name)
            if not entry.job.done:
                raise _refusal(f"{name} is {entry.job.state}: cancel it first", "JOB_ACTIVE")
            self._note(name, "deleted")
            del self._entries[name]

    def fetch(self, name: str, progress: Progress | None, timeout: float | None) -> Mesh:
        with self._changed:
            mesh, _ = self._made(name)
        if progress is not None:
            progress(1.0)
        return mesh

    def stream(self, name: str, progress: Progress | None, timeout: float | None) -> MeshStream:
        with self._changed:
            _, request = self._made(name)
        return MeshStream(self._backend.stream(request, options_of(progress=progress, timeout=timeout)))

    def close(self) -> None:
        """Cancels all that is not at its end."""
        with self._changed:
            for entry in list(self._entries.values()):
                entry.stop.request()
                if entry.job.state == "queued":
                    self._finish(entry, None, _cancelled())

    # What follows is called with the lock, but for `_work` and `_make`.

    def _entry(self, name: str) -> _Entry:
        if name not in self._entries:
            raise NotFoundError(f"{name} is no job of this client", StatusCode.NOT_FOUND, "JOB_NOT_FOUND")
        return self._entries[name]

    def _made(self, name: str) -> tuple[Mesh, Request]:
        entry = self._entry(name)
        if entry.mesh is None:
            raise _refusal(f"{name} is {entry.job.state}, and has no mesh", "JOB_NOT_SUCCEEDED")
        return entry.mesh, entry.request

    def _queued(self) -> Entries:
        return [entry for entry in self._entries.values() if entry.job.state == "queued"]

    def _expire(self) -> None:
        """Ends what has waited for too long. Whoever looks at jobs calls it, so that nobody has to watch the clock."""
        now = time.monotonic()
        if now < self._next_end:
            return
        for entry in self._queued():
            if entry.expires <= now:
                self._finish(entry, None, _expired(entry))
        self._next_end = min((entry.expires for entry in self._queued()), default=math.inf)

    def _limit(self, entry: _Entry) -> None:
        """Its time begins."""
        if entry.order.ttl is not None:
            entry.expires = time.monotonic() + entry.order.ttl
            self._next_end = min(self._next_end, entry.expires)

    @staticmethod
    def _place(entry: _Entry) -> tuple[int, int]:
        return -entry.job.priority, entry.number

    def _change(self, entry: _Entry, change: JobChange, **changes: object) -> None:
        entry.job = dataclasses.replace(entry.job, version=entry.job.version + 1, **changes)
        self._note(entry.job.name, change)

    def _note(self, name: str, change: JobChange) -> None:
        job = self._entries[name].job
        self._events.append(JobEvent(len(self._events) + 1, name, job.version, change, job.state, job.progress,
                                     _now()))
        self._changed.notify_all()

    def _start(self) -> None:
        if not self._works:
            self._works = True
            threading.Thread(target=self._work, name="tetstream jobs").start()

    def _work(self) -> None:
        """Makes jobs until none is queued."""
        while True:
            with self._changed:
                self._expire()
                queue = sorted(self._queued(), key=self._place)
                if not queue:
                    self._works = False
                    return
                entry = queue[0]
                self._change(entry, "started", state="running", started=_now())
            mesh, error = self._make(entry)
            with self._changed:
                self._finish(entry, mesh, error)

    def _make(self, entry: _Entry) -> tuple[Mesh | None, Error | None]:
        timeout, left = entry.order.run_timeout, max(0.0, entry.expires - time.monotonic())
        try:
            options = options_of(progress=lambda fraction: self._tell(entry, fraction),
                                 timeout=left if timeout is None else min(timeout, left))
            options.stop = entry.stop
            return Mesh(self._backend.mesh(entry.request, options)), None
        except DeadlineExceededError as error:
            if entry.expires <= time.monotonic():
                return None, _expired(entry)
            return None, error if timeout is None else _timed_out(entry)
        except Error as error:
            return None, error
        except Exception as error:  # of a file that is not there, for instance
            return None, InternalError(str(error), StatusCode.INTERNAL)

    def _tell(self, entry: _Entry, fraction: float) -> None:
        with self._changed:
            entry.job = dataclasses.replace(entry.job, progress=JobProgress(fraction))
            self._changed.notify_all()

    def _finish(self, entry: _Entry, mesh: Mesh | None, error: Error | None) -> None:
        entry.mesh = mesh
        if mesh is not None:
            chunks = mesh.header.chunk_count
            self._change(entry, "finished", state="succeeded", finished=_now(), header=mesh.header,
                         progress=JobProgress(1.0, chunks, chunks, 1, 1))
        else:
            expired = error is not None and error.reason == _EXPIRED
            state = "expired" if expired else "cancelled" if isinstance(error, CancelledError) else "failed"
            self._change(entry, "finished", state=state, finished=_now(), error=error)


class _Events:
    """Reads the list of events, one after the other."""

    def __init__(self, jobs: LocalJobs, name: str, after: int, timeout: float | None) -> None:
        self._jobs = jobs
        self._name = name
        self._next = after
        self._patience = _Patience(timeout)
        self._closed = False

    def next(self) -> JobEvent | None:
        with self._jobs._changed:
            while not self._closed:
                self._jobs._expire()
                for event in itertools.islice(self._jobs._events, self._next, None):
                    self._next = event.revision
                    if not self._name or event.name == self._name:
                        return event
                self._patience.wait(self._jobs._changed, self._jobs._next_end)
        return None

    def close(self) -> None:
        with self._jobs._changed:
            self._closed = True
            self._jobs._changed.notify_all()


class _Patience:
    """How long somebody waits for changes: until a deadline, or until another thread stops it."""

    def __init__(self, timeout: float | None) -> None:
        self._end = None if timeout is None else time.monotonic() + timeout
        self._stop = stop_of_context.get()

    def wait(self, changed: threading.Condition, until: float) -> None:
        """For a change, or until that time."""
        if self._stop is not None:
            self._stop.wakes(changed)
            if self._stop.requested:
                raise CancelledError("the call was cancelled", StatusCode.CANCELLED)
        left = None if self._end is None else self._end - time.monotonic()
        if left is not None and left <= 0:
            raise DeadlineExceededError("no change came in time", StatusCode.DEADLINE_EXCEEDED)
        if until < math.inf:
            rest = max(0.0, until - time.monotonic())
            left = rest if left is None else min(left, rest)
        changed.wait(None if left is None else min(left, threading.TIMEOUT_MAX))


def _now() -> datetime.datetime:
    return datetime.datetime.now(datetime.timezone.utc)


def _cancelled() -> CancelledError:
    return CancelledError("the job was cancelled", StatusCode.CANCELLED, "JOB_CANCELLED")


def _expired(entry: _Entry) -> DeadlineExceededError:
    return DeadlineExceededError(f"{entry.job.name} was not finished within its ttl of {entry.order.ttl:g} s",
                                 StatusCode.DEADLINE_EXCEEDED, _EXPIRED)


def _timed_out(entry: _Entry) -> DeadlineExceededError:
    return DeadlineExceededError(f"{entry.job.name} ran for longer than its run_timeout of {entry.order.run_timeout:g} s",
                                 StatusCode.DEADLINE_EXCEEDED, "JOB_TIMEOUT")


def _refusal(message: str, reason: str) -> FailedPreconditionError:
    return FailedPreconditionError(message, StatusCode.FAILED_PRECONDITION, reason)
