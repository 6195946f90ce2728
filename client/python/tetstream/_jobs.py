"""Jobs: meshes that are made while nobody waits."""

from __future__ import annotations

import dataclasses
import datetime
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Literal, Protocol

from ._errors import Error
from ._header import Header
from ._mesh import Mesh
from ._names import member
from ._request import Progress, Request, VolumeLike, time_left
from ._stream import MeshStream

JobState = Literal["queued", "running", "succeeded", "failed", "cancelled", "expired"]
JobChange = Literal["created", "started", "planned", "shard_done", "shard_dead", "finished", "retried",
                    "determinism_alarm", "deleted", "replanned"]
STATES: dict[str, JobState] = {
    "queued": "queued", "running": "running", "succeeded": "succeeded", "failed": "failed",
    "cancelled": "cancelled", "expired": "expired"}
FINAL = ("succeeded", "failed", "cancelled", "expired")


@dataclasses.dataclass(frozen=True)
class JobProgress:
    """How far a job is: its mesh is counted, then made in shards, which are runs of chunks.

    fraction            that is done, 0 to 1
    chunk_count         0 until the mesh is counted
    chunks_per_second, eta   the rate, and the seconds that are left at it; 0 and None where unknown
    """

    fraction: float = 0
    chunk_count: int = 0
    done_chunks: int = 0
    shard_count: int = 0
    done_shards: int = 0
    running_shards: int = 0
    dead_shards: int = 0
    chunks_per_second: float = 0
    eta: float | None = None


@dataclasses.dataclass(frozen=True)
class Job:
    """A job as it stood when it was asked for; `client.jobs.get(job)` asks again.

    name         "jobs/{id}"; ids sort by time of creation
    state        "queued", "running", or how it ended: "succeeded", "failed", "cancelled", "expired"
    ttl, run_timeout   seconds from its creation, and from when it runs, to its end; None: for ever
    version      one more with each change
    created, started, finished   in UTC; None where it has not come so far
    queue_position   how many jobs come before it; None in lists, and where nobody counts so far
    error        why it has failed, was cancelled or has expired, as an exception that was not raised
    cached       its result was stored before it was made
    header       of its mesh, once that is counted; None in lists
    """

    name: str
    state: JobState
    display_name: str = ""
    labels: Mapping[str, str] = dataclasses.field(default_factory=dict)
    priority: int = 0
    ttl: float | None = None
    run_timeout: float | None = None
    version: int = 1
    created: datetime.datetime | None = None
    started: datetime.datetime | None = None
    finished: datetime.datetime | None = None
    queue_position: int | None = None
    progress: JobProgress = JobProgress()
    error: Error | None = None
    cached: bool = False
    header: Header | None = None

    @property
    def done(self) -> bool:
        """Whether it is at its end, however that is."""
        return self.state in FINAL


@dataclasses.dataclass(frozen=True)
class JobEvent:
    """A change of a job, and how the job stood after it. `revision` grows from event to event."""

    revision: int
    name: str
    version: int
    change: JobChange
    state: JobState
    progress: JobProgress
    time: datetime.datetime | None


@dataclasses.dataclass(frozen=True)
class JobOrder:
    """What `Jobs.submit` is given beside the request."""

    display_name: str
    labels: Mapping[str, str]
    priority: int
    ttl: float | None
    run_timeout: float | None
    max_attempts: int | None
    skip_cache: bool
    request_id: str


@dataclasses.dataclass(frozen=True)
class JobFilter:
    """What `Jobs.list` is given."""

    labels: Mapping[str, str]
    states: Sequence[JobState]
    display_name_prefix: str
    most: int


JobList = list[Job]
JobPage = tuple[list[Job], int]  # and the revision that it is of


class EventSource(Protocol):
    def next(self) -> JobEvent | None: ...
    def close(self) -> None: ...


class JobBackend(Protocol):
    """Keeps jobs: a server, or this process."""

    def submit(self, request: Request, order: JobOrder, timeout: float | None) -> Job: ...
    def get(self, name: str, timeout: float | None) -> Job: ...
    def list(self, jobs: JobFilter, timeout: float | None) -> JobPage: ...
    def wait(self, name: str, progress: Progress | None, timeout: float | None) -> Job: ...
    def watch(self, name: str, after: int, timeout: float | None) -> EventSource: ...
    def cancel(self, name: str, timeout: float | None) -> Job: ...
    def retry(self, name: str, timeout: float | None) -> Job: ...
    def delete(self, name: str, timeout: float | None) -> None: ...
    def fetch(self, name: str, progress: Progress | None, timeout: float | None) -> Mesh: ...
    def stream(self, name: str, progress: Progress | None, timeout: float | None) -> MeshStream: ...


class JobWatch:
    """Changes of jobs, as they happen: an iterator of `JobEvent`s, which may be left at any time.

        with client.jobs.watch(jobs) as watch:
            for event in watch:
                print(event.name, event.state, f"{event.progress.fraction:.0%}")
    """

    def __init__(self, source: EventSource | None, pending: set[str] | None) -> None:
        self._source = source
        self._names = None if pending is None else frozenset(pending)
        self._pending = pending

    def __iter__(self) -> Iterator[JobEvent]:
        return self

    def __next__(self) -> JobEvent:
        while self._source is not None and (self._pending is None or self._pending):
            event = self._source.next()
            if event is None:
                break
            if self._names is not None and event.name not in self._names:
                continue
            if self._pending is not None and (event.state in FINAL or event.change == "deleted"):
                self._pending.discard(event.name)
            return event
        self.close()
        raise StopIteration

    def close(self) -> None:
        """Ends it. Any thread may call it."""
        if self._source is not None:
            self._source.close()

    def __enter__(self) -> JobWatch:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Jobs:
    """The jobs of a client: `client.jobs`. A job outlives whoever asked for it; its mesh is stored until the
    job is deleted.

        jobs = [client.jobs.submit(scan, spacing=s, labels={"study": "knee"}) for s in (1, 0.5, 0.25)]
        for job in client.jobs.wait_all(jobs):
            print(job.name, job.state, job.error or client.jobs.fetch(job))

    A job is given as the `Job` or by its name. Errors of every call are those of `Client.mesh`, with the
    reasons that docs/errors.md lists; NotFoundError (JOB_NOT_FOUND). The jobs of `Client(":local:")` are made
    one after the other in this process, which waits for them at its end; `client.close()` cancels them.
    """

    def __init__(self, backend: JobBackend) -> None:
        self._backend = backend

    def submit(
        self,
        volume: VolumeLike,
        *,
        spacing: float | None = None,
        display_name: str = "",
        labels: Mapping[str, str] | None = None,
        priority: int = 0,
        ttl: float | None = None,
        run_timeout: float | None = None,
        max_attempts: int | None = None,
        skip_cache: bool = False,
        request_id: str = "",
        timeout: float | None = None,
    ) -> Job:
        """Queues a mesh, and returns when the job is kept.

        volume        what is meshed, with the defaults of `Client.mesh`; or a `Request`, which has all options
        spacing       as of `Client.mesh`
        display_name  for people, at most 256 bytes
        labels        to find it by, at most 32: keys [a-z][a-z0-9_./-]*, values ASCII, of at most 63 bytes
        priority      -100 to 100; higher ones come first
        ttl, run_timeout   seconds from its creation, and from when it runs, after which it is stopped
        max_attempts  at each of its shards, 1 to 100; 3 unless given
        skip_cache    make it even where its result is stored
        request_id    who asks again with the same one gets the job that is there
        timeout       seconds, for this call
        """
        request = Request._of(volume, spacing=spacing)
        order = JobOrder(display_name, dict(labels or {}), priority, ttl, run_timeout, max_attempts, skip_cache,
                         request_id)
        return self._backend.submit(request, order, timeout)

    def get(self, job: Job | str, *, timeout: float | None = None) -> Job:
        """The job as it stands."""
        return self._backend.get(_name(job), timeout)

    def list(
        self,
        *,
        labels: Mapping[str, str] | None = None,
        states: Iterable[JobState] = (),
        display_name: str = "",
        most: int = 0,
        timeout: float | None = None,
    ) -> JobList:
        """Jobs, the newest first: those that have all these labels, one of the states, and a display name
        that begins so. At most `most`; 0 lists all."""
        wanted = tuple(states)  # which may be an iterator
        for state in wanted:
            member("state", state, STATES)
        return self._backend.list(JobFilter(dict(labels or {}), wanted, display_name, most), timeout)[0]

    def wait(self, job: Job | str, *, progress: Progress | None = None, timeout: float | None = None) -> Job:
        """Waits until a job is at its end, and returns it: `job.state` says how it ended."""
        return self._backend.wait(_name(job), progress, timeout)

    def wait_all(
        self, jobs: Iterable[Job | str], *, progress: Progress | None = None, timeout: float | None = None
    ) -> JobList:
        """Waits until all of them are at their ends, and returns them in this order. `progress` is told of
        all together, and `timeout` is for all of them."""
        left = time_left(timeout)
        names = [_name(job) for job in jobs]
        ended = []
        for i, name in enumerate(names):
            tell = None if progress is None else _part_of(progress, i, len(names))
            ended.append(self._backend.wait(name, tell, left()))
        return ended

    def watch(
        self,
        jobs: Job | str | Iterable[Job | str] | None = None,
        *,
        after: int | None = None,
        timeout: float | None = None,
    ) -> JobWatch:
        """Changes of these jobs, until all of them are at their ends; of all jobs, without an end, where none
        are given. `after` is a revision to begin behind, 0 for all that is known; unless given from now on. `timeout` is
        for all of the watch."""
        left = time_left(timeout)
        given = [jobs] if isinstance(jobs, (Job, str)) else jobs
        names = None if given is None else {_name(job) for job in given}
        if after is None:
            after = self._backend.list(JobFilter({}, (), "", 1), left())[1]
            names = None if names is None else {name for name in names if not self._backend.get(name, left()).done}
        if names is not None and not names:
            return JobWatch(None, set())
        only = next(iter(names)) if names is not None and len(names) == 1 else ""
        return JobWatch(self._backend.watch(only, after, left()), names)

    def cancel(self, job: Job | str, *, timeout: float | None = None) -> Job:
        """Stops a job; one that is at its end stays as it is."""
        return self._backend.cancel(_name(job), timeout)

    def retry(self, job: Job | str, *, timeout: float | None = None) -> Job:
        """Tries again what failed or was stopped. Errors: FailedPreconditionError (JOB_ACTIVE, JOB_SUCCEEDED)."""
        return self._backend.retry(_name(job), timeout)

    def delete(self, job: Job | str, *, timeout: float | None = None) -> None:
        """Forgets a job, and its mesh. Errors: FailedPreconditionError (JOB_ACTIVE: cancel it first)."""
        self._backend.delete(_name(job), timeout)

    def fetch(self, job: Job | str, *, progress: Progress | None = None, timeout: float | None = None) -> Mesh:
        """The mesh of a job that has succeeded. Errors: FailedPreconditionError (JOB_NOT_SUCCEEDED)."""
        return self._backend.fetch(_name(job), progress, timeout)

    def stream(
        self, job: Job | str, *, progress: Progress | None = None, timeout: float | None = None
    ) -> MeshStream:
        """The mesh of a job that has succeeded, chunk by chunk."""
        return self._backend.stream(_name(job), progress, timeout)


def _name(job: Job | str) -> str:
    return job if isinstance(job, str) else job.name


def _part_of(progress: Progress, part: int, parts: int) -> Progress:
    return lambda fraction: progress((part + fraction) / parts)
