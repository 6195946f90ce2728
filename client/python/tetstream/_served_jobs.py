"""The jobs of a server."""

from __future__ import annotations

import datetime
from typing import Any

from . import _tetstream
from ._backends import Served
from ._errors import error_of
from ._job import EventSource, Job, JobEvent, JobFilter, JobOrder, JobPage, JobProgress
from ._header import Header
from ._mesh import Mesh
from ._request import Progress, Request, options_of
from ._stream import MeshStream


class ServedJobs:
    """Asks the server."""

    def __init__(self, served: Served) -> None:
        self._served = served
        self._jobs = _tetstream.Jobs(served.client)

    def submit(self, request: Request, order: JobOrder, timeout: float | None) -> Job:
        options = options_of(timeout=timeout)
        wire_order = _wire_order(order)
        return _job(self._served.asked(request, options,
                                       lambda what, wire: self._jobs.submit(what, wire, wire_order, options)))

    def get(self, name: str, timeout: float | None) -> Job:
        return _job(self._jobs.get(name, options_of(timeout=timeout)))

    def list(self, jobs: JobFilter, timeout: float | None) -> JobPage:
        wanted = _tetstream.JobFilter()
        wanted.labels = dict(jobs.labels)
        wanted.states = [_tetstream.JobState.__members__[state] for state in jobs.states]
        wanted.display_name_prefix = jobs.display_name_prefix
        wanted.most = jobs.most
        told, revision = self._jobs.list(wanted, options_of(timeout=timeout))
        return [_job(one) for one in told], revision

    def wait(self, name: str, progress: Progress | None, timeout: float | None) -> Job:
        return _job(self._jobs.wait(name, options_of(progress=progress, timeout=timeout)))

    def watch(self, name: str, after: int, timeout: float | None) -> EventSource:
        return _Events(self._jobs.watch(name, after, options_of(timeout=timeout)))

    def cancel(self, name: str, timeout: float | None) -> Job:
        return _job(self._jobs.cancel(name, options_of(timeout=timeout)))

    def retry(self, name: str, timeout: float | None) -> Job:
        return _job(self._jobs.retry(name, options_of(timeout=timeout)))

    def delete(self, name: str, timeout: float | None) -> None:
        self._jobs.remove(name, options_of(timeout=timeout))

    def fetch(self, name: str, progress: Progress | None, timeout: float | None) -> Mesh:
        return Mesh(self._jobs.fetch(name, options_of(progress=progress, timeout=timeout)))

    def stream(self, name: str, progress: Progress | None, timeout: float | None) -> MeshStream:
        return MeshStream(self._jobs.stream(name, options_of(progress=progress, timeout=timeout)))


class _Events:
    def __init__(self, events: _tetstream.JobEvents) -> None:
        self._events = events

    def next(self) -> JobEvent | None:
        told = self._events.next()
        if told is None:
            return None
        told.update(change=told["change"].name, state=told["state"].name, time=_time(told["time"]),
                    progress=_progress(told["progress"]))
        return JobEvent(**told)

    def close(self) -> None:
        self._events.close()


def _wire_order(order: JobOrder) -> _tetstream.JobOrder:
    wire = _tetstream.JobOrder()
    wire.display_name = order.display_name
    wire.labels = dict(order.labels)
    wire.priority = order.priority
    wire.max_attempts = order.max_attempts
    wire.skip_cache = order.skip_cache
    wire.request_id = order.request_id
    wire.set_times(order.ttl, order.run_timeout)
    return wire


def _job(told: dict[str, Any]) -> Job:
    error = told["error"]
    told.update(
        state=told["state"].name,
        run_timeout=told.pop("timeout"),
        created=_time(told["created"]), started=_time(told["started"]), finished=_time(told["finished"]),
        progress=_progress(told["progress"]),
        error=None if error is None else error_of(*error),
        header=None if told["header"] is None else Header._of(told["header"]))
    return Job(**told)


def _progress(told: tuple[Any, ...]) -> JobProgress:
    chunks, done = told[:2]
    return JobProgress(done / chunks if chunks else 0.0, *told)


def _time(seconds: float | None) -> datetime.datetime | None:
    return None if seconds is None else datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc)
