"""Jobs: meshes that are made while nobody waits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ._errors import invalid
from ._job import STATES, Job, JobBackend, JobFilter, JobList, JobOrder, JobState
from ._job_watch import JobWatch, watch_all, watch_some
from ._mesh import Mesh
from ._names import member
from ._request import Progress, Request, VolumeLike, time_left
from ._stream import MeshStream


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
        for time, seconds in (("ttl", ttl), ("run_timeout", run_timeout)):
            if seconds is not None and not seconds > 0:
                raise invalid(f"{time} {seconds} is not positive")
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
        for all of the watch.

        Errors: Error (REVISION_COMPACTED, of all jobs: what came after `after` is forgotten in part, with jobs that were
        deleted; list the jobs, and watch from now on)."""
        left = time_left(timeout)
        if jobs is None:
            return watch_all(self._backend, after, left)
        given = [jobs] if isinstance(jobs, (Job, str)) else jobs
        return watch_some(self._backend, [_name(job) for job in given], after, left)

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
