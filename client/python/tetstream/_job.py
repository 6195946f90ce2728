"""What a job is, what happens to it, and who keeps it."""

from __future__ import annotations

import dataclasses
import datetime
from collections.abc import Mapping, Sequence
from typing import Literal, Protocol

from ._errors import Error
from ._header import Header
from ._mesh import Mesh
from ._request import Progress, Request
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
