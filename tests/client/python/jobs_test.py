"""Jobs, on a server and in this process: the same calls with the same ends."""

import asyncio
import contextlib
import datetime
import itertools
import math
import sqlite3
import threading
import time

import pytest

import running_server
import tetstream as ts
from conftest import assert_same
from tetstream._local_jobs import LocalJobs
from tetstream._request import options_of

PART = ts.box((2, 2, 1), rounding=0.1) - ts.cylinder(0.4, 2)


@pytest.fixture(params=["here", "served"])
def client(request, tmp_path):
    if request.param == "here":
        with ts.Client(":local:") as here:
            yield here
    else:
        with running_server.RunningServer(tmp_path / "store") as server, ts.Client(server.address) as there:
            yield there


def test_a_jobs_mesh_is_the_one_that_is_made_here(client, ball):
    for request in (ts.Request(ball, levels=0), ts.Request(PART, spacing=0.1, faces=True)):
        job = client.jobs.submit(request, display_name="a part", labels={"study": "one"}, priority=3)
        assert job.name.startswith("jobs/") and job.display_name == "a part" and job.priority == 3
        told = []
        ended = client.jobs.wait(job, progress=told.append)
        assert ended.done and ended.state == "succeeded" and ended.error is None
        assert told == sorted(told) and told[-1] == 1 == ended.progress.fraction
        here = ts.mesh(request)
        assert ended.header.tet_count == here.header.tet_count
        assert_same(client.jobs.fetch(job), here)
        assert sum(len(chunk.tets) for chunk in client.jobs.stream(job.name)) == here.header.tet_count
        now = datetime.datetime.now(datetime.timezone.utc)
        assert ended.created <= ended.started <= ended.finished <= now + datetime.timedelta(seconds=5)


def test_many_are_found_by_their_labels(client):
    jobs = [client.jobs.submit(PART, spacing=0.3 + 0.01 * i, labels={"night": "1", "half": str(i % 2)})
            for i in range(6)]
    ended = client.jobs.wait_all(jobs)
    assert [job.name for job in ended] == [job.name for job in jobs]
    assert {job.state for job in ended} == {"succeeded"}
    listed = client.jobs.list(labels={"night": "1", "half": "1"}, states=["succeeded"])
    assert [job.name for job in listed] == [job.name for job in reversed(jobs[1::2])]
    assert client.jobs.list(states=(state for state in ["failed", "expired"])) == []
    assert len(client.jobs.list(most=2)) == 2 and client.jobs.list(labels={"night": "2"}) == []
    assert client.jobs.list(display_name="nobody") == []


def test_changes_are_watched_until_the_end(client):
    jobs = [client.jobs.submit(PART, spacing=spacing) for spacing in (0.3, 0.2)]
    with client.jobs.watch(jobs, after=0) as watch:
        seen = list(watch)
    for job in jobs:
        changes = [event.change for event in seen if event.name == job.name]
        assert changes[0] == "created" and changes[-1] == "finished" and "started" in changes
    assert [event.revision for event in seen] == sorted({event.revision for event in seen})
    assert list(client.jobs.watch(jobs)) == []  # nothing comes of what has ended


def seen_of(client, jobs, **options):
    """The changes that are told of each job, until the watch ends."""
    seen = {}
    with client.jobs.watch(jobs, timeout=running_server.GENEROUS_END, **options) as watch:
        for event in watch:
            seen.setdefault(event.name, []).append(event.change)
    return seen


def test_a_watch_ends_where_a_job_had_finished_before_it(client):
    first, other = (client.jobs.submit(PART, spacing=spacing) for spacing in (0.3, 0.2))
    client.jobs.wait_all([first, other])
    with client.jobs.watch([first, other], after=0) as watch:
        last = max(event.revision for event in watch)
    assert seen_of(client, first, after=last) == seen_of(client, [first, other], after=last) == {}
    second = client.jobs.submit(PART, spacing=0.3, display_name="later")
    seen = seen_of(client, [first, second, first], after=last)
    assert seen.keys() == {second.name} and seen[second.name][-1] == "finished"


def test_a_watch_tells_of_all_tries_of_a_job(client):
    job = client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))
    client.jobs.cancel(job)
    client.jobs.retry(job)
    client.jobs.cancel(job)
    other = client.jobs.wait(client.jobs.submit(PART, spacing=0.3))
    seen = seen_of(client, [job, other], after=0)
    told = [change for change in seen[job.name] if change not in ("started", "planned", "shard_done")]
    assert told == ["created", "finished", "retried", "finished"]
    client.jobs.delete(job)
    seen = seen_of(client, [job, other], after=0)
    assert seen[job.name][-1] == "deleted" and seen[other.name][-1] == "finished"


def opened(store):
    """The jobs' database of a server, which may be writing to it."""
    return contextlib.closing(sqlite3.connect(store / "jobs.sqlite", isolation_level=None,
                                              timeout=running_server.GENEROUS_END))


def test_what_is_known_is_told_once_a_job_is_forgotten(tmp_path):
    """As a server forgets those that ended long ago, with what was to be told of them."""
    store = tmp_path / "store"
    with running_server.RunningServer(store) as server, ts.Client(server.address) as client:
        jobs = client.jobs.wait_all([client.jobs.submit(PART, spacing=spacing) for spacing in (0.3, 0.2)])
        whole = seen_of(client, jobs, after=0)
        with opened(store) as rows:
            rows.execute("UPDATE counters SET value = 1 + (SELECT min(revision) FROM events) WHERE name = 'compacted'")
        assert seen_of(client, jobs, after=0) == whole
        with client.jobs.watch(after=0) as watch:
            told = [next(watch) for _ in range(sum(map(len, whole.values())))]
        assert [event.revision for event in told] == sorted(event.revision for event in told)
        with pytest.raises(ts.Error) as forgotten:
            next(client.jobs.watch(after=1))
        assert forgotten.value.reason == "REVISION_COMPACTED"


def test_a_watch_of_a_job_that_was_purged_ends(tmp_path):
    """A purge takes the job before its events, and tells of no end."""
    store = tmp_path / "store"
    with running_server.RunningServer(store) as server, ts.Client(server.address) as client:
        jobs = client.jobs.wait_all([client.jobs.submit(PART, spacing=spacing) for spacing in (0.3, 0.2)])
        whole = seen_of(client, jobs, after=0)
        with opened(store) as rows:
            rows.execute("DELETE FROM jobs WHERE id = ?", [jobs[0].name.removeprefix("jobs/")])
        assert seen_of(client, jobs[0], after=0) == {jobs[0].name: whole[jobs[0].name]}
        assert seen_of(client, jobs, after=0) == whole


class Played:
    """Two jobs whose first changes are forgotten while they are watched together, after `told` of them were told, and
    `again` so often when the watch goes on. The last one comes when all others are known."""

    def __init__(self, told, again=0):
        self.told = told
        self.again = again
        self.now = 1
        self.sources = []
        self.asked, self.answers = threading.Event(), threading.Event()
        self.answers.set()
        self.events = [self._event(2, "jobs/1", 1, "queued"), self._event(3, "jobs/2", 1, "queued"),
                       self._event(4, "jobs/1", 2, "succeeded"), self._event(5, "jobs/2", 2, "running"),
                       self._event(6, "jobs/2", 3, "succeeded")]

    @staticmethod
    def _event(revision, name, version, state):
        return ts.JobEvent(revision, name, version, "started", state, ts.JobProgress(), None)

    def known(self, name=""):
        return [event for event in self.events if event.revision <= self.now and name in ("", event.name)]

    def get(self, name, timeout):
        return ts.Job(name, "running", version=len(self.known(name)))

    def list(self, jobs, timeout):
        self.asked.set()
        self.answers.wait(running_server.GENEROUS_END)
        return [self.get(name, timeout) for name in ("jobs/1", "jobs/2")], self.now

    def watch(self, name, after, timeout):
        self.sources.append(PlayedSource(self, name, after))
        return self.sources[-1]


class PlayedSource:
    def __init__(self, played, name, after):
        self.played, self.name, self.after = played, name, after
        self.left = played.told if not played.sources else None
        if played.sources and after > 0 and played.again > 0:
            played.again -= 1
            self.left = 0
        self.closed = False

    def next(self):
        if self.played.now < 5:
            self.played.now = 5
        if self.left == 0:
            raise ts.Error("forgotten", ts.StatusCode.OUT_OF_RANGE, "REVISION_COMPACTED")
        event = self._next()
        if event is None and not self.closed and self.played.now < 6:
            self.played.now = 6
            event = self._next()
        if event is not None:
            self.after = event.revision
            self.left = None if self.left is None else self.left - 1
        return event

    def _next(self):
        return next((event for event in self.played.known(self.name) if event.revision > self.after), None)

    def close(self):
        self.closed = True


@pytest.mark.parametrize("again", (0, 2))
def test_a_watch_of_several_jobs_goes_on_behind_what_is_forgotten(again):
    played = Played(1, again)
    watch = ts.Jobs(played).watch(["jobs/1", "jobs/2"])
    assert [event.revision for event in watch] == [2, 3, 4, 5, 6]
    assert played.again == 0
    assert all(source.closed or source.left == 0 for source in played.sources)


def test_a_watch_of_all_jobs_says_what_is_forgotten():
    watch = ts.Jobs(Played(1)).watch(after=0)
    assert next(watch).revision == 2
    with pytest.raises(ts.Error, match="forgotten"):
        next(watch)


class PlayedPurge(Played):
    """One of the jobs is purged as soon as it was listed."""

    def watch(self, name, after, timeout):
        if name == "jobs/1":
            raise ts.NotFoundError("there is no job jobs/1", ts.StatusCode.NOT_FOUND, "JOB_NOT_FOUND")
        return super().watch(name, after, timeout)


def test_a_watch_of_all_jobs_goes_on_without_one_that_is_purged_meanwhile():
    watch = ts.Jobs(PlayedPurge(0)).watch(after=0)
    assert [next(watch).revision for _ in range(3)] == [3, 5, 6]


def test_a_watch_is_closed_while_it_begins_again():
    played, rest = Played(0), []
    watch = ts.Jobs(played).watch(after=0)
    played.answers.clear()
    reads = threading.Thread(target=lambda: rest.extend(watch))
    reads.start()
    assert played.asked.wait(running_server.GENEROUS_END)
    watch.close()
    played.answers.set()
    reads.join(running_server.GENEROUS_END)
    assert not reads.is_alive() and rest == []
    assert all(source.closed for source in played.sources)


def test_a_cancelled_job_is_tried_again(client):
    long = client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))
    cancelled = client.jobs.cancel(long)
    assert client.jobs.wait(long).state == "cancelled"
    assert isinstance(client.jobs.get(cancelled).error, ts.CancelledError)
    with pytest.raises(ts.FailedPreconditionError) as refused:
        client.jobs.fetch(long)
    assert refused.value.reason == "JOB_NOT_SUCCEEDED"
    assert not client.jobs.retry(long).done
    client.jobs.cancel(long)
    client.jobs.wait(long)
    client.jobs.delete(long)
    with pytest.raises(ts.NotFoundError) as gone:
        client.jobs.get(long)
    assert gone.value.reason == "JOB_NOT_FOUND"


def test_a_job_says_why_it_failed(client):
    nothing = ts.sphere(1) & ts.sphere(1, center=(5, 0, 0))
    ended = client.jobs.wait(client.jobs.submit(nothing, spacing=0.1))
    assert ended.state == "failed" and isinstance(ended.error, ts.FailedPreconditionError)
    with pytest.raises(ts.FailedPreconditionError) as refused:
        client.jobs.retry(client.jobs.wait(client.jobs.submit(PART, spacing=0.3)))
    assert refused.value.reason == "JOB_SUCCEEDED"


def test_asking_twice_makes_one_job(client):
    one, other = (client.jobs.submit(PART, spacing=0.3, request_id="the same") for _ in range(2))
    assert one.name == other.name


def test_what_is_wrong_with_an_order_is_said_at_once(client):
    with pytest.raises(ts.InvalidArgumentError):
        client.jobs.submit(ts.Request(PART, preset="best"))
    with pytest.raises(ts.InvalidArgumentError, match="give it to the Request"):
        client.jobs.submit(ts.Request(PART), spacing=0.1)
    with pytest.raises(ts.InvalidArgumentError, match="state 'asleep'"):
        client.jobs.list(states=["asleep"])


def test_a_wait_ends_at_its_deadline(client):
    long = client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))
    with pytest.raises(ts.DeadlineExceededError):
        client.jobs.wait(long, timeout=0.2)
    client.jobs.cancel(long)


def test_a_job_is_stopped_when_it_has_lived_long_enough(client):
    long = client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002), ttl=0.3)
    assert seen_of(client, long, after=0)[long.name][-1] == "finished"
    ended = client.jobs.get(long)
    assert ended.state == "expired" and ended.ttl == pytest.approx(0.3)
    assert isinstance(ended.error, ts.DeadlineExceededError) and ended.error.reason == "JOB_EXPIRED"
    long = client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002), run_timeout=0.3)
    stopped = client.jobs.wait(long)
    assert stopped.state == "failed" and stopped.run_timeout == pytest.approx(0.3)
    assert isinstance(stopped.error, ts.DeadlineExceededError) and stopped.error.reason == "JOB_TIMEOUT"


@pytest.mark.parametrize("time", ["ttl", "run_timeout"])
def test_the_times_of_a_job_are_positive(client, time):
    for seconds in (-1, 0, math.nan, -math.inf):
        with pytest.raises(ts.InvalidArgumentError, match=time):
            client.jobs.submit(PART, **{time: seconds})
    for endless in (math.inf, 1e300):
        assert client.jobs.wait(client.jobs.submit(PART, spacing=0.3, **{time: endless})).state == "succeeded"


def test_a_job_of_this_process_may_expire_before_its_turn():
    with ts.Client() as here:
        first = here.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))
        behind = [here.jobs.submit(PART, spacing=0.3, ttl=ttl) for ttl in (0.05, 0.1, 0.15)]
        assert here.jobs.wait(behind[2]).state == "expired"
        assert [event.state for event in here.jobs.watch(behind[1], after=0)] == ["queued", "expired"]
        assert {job.name for job in here.jobs.list(states=["expired"])} == {job.name for job in behind}
        assert here.jobs.get(behind[0]).error.reason == "JOB_EXPIRED" and not here.jobs.get(first).done
        assert not here.jobs.retry(behind[0]).done  # it lives anew


class Clocked:
    """Jobs that are done as soon as some time has passed, and the time that each call was left."""

    def __init__(self):
        self.left = []

    def _call(self, result, timeout):
        self.left.append(timeout)
        began = time.monotonic()
        while time.monotonic() == began:
            pass
        return result

    def wait(self, name, progress, timeout):
        return self._call(ts.Job(name, "succeeded"), timeout)

    def get(self, name, timeout):
        return self._call(ts.Job(name, "running"), timeout)

    def list(self, jobs, timeout):
        return self._call(([], 0), timeout)

    def watch(self, name, after, timeout):
        return self._call(None, timeout)


@pytest.mark.parametrize("call", [ts.Jobs.wait_all, ts.Jobs.watch])
def test_a_timeout_is_for_all_jobs_together(call):
    clocked = Clocked()
    call(ts.Jobs(clocked), ["jobs/1", "jobs/2"], timeout=60)
    assert len(clocked.left) > 1
    assert 60 >= clocked.left[0] and all(one > next for one, next in itertools.pairwise(clocked.left))
    with pytest.raises(ts.InvalidArgumentError, match="timeout -1"):
        call(ts.Jobs(clocked), ["jobs/1"], timeout=-1)


def test_jobs_of_this_process_are_made_in_their_order():
    with ts.Client() as here:
        first = here.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))
        running_server.wait_until(lambda: here.jobs.get(first).state == "running")
        low = here.jobs.submit(PART, spacing=0.3, priority=-1)
        high = here.jobs.submit(PART, spacing=0.3, priority=1)
        assert here.jobs.get(high).queue_position in (0, 1)
        assert here.jobs.get(low).queue_position > here.jobs.get(high).queue_position
        here.jobs.cancel(first)
        done = here.jobs.wait_all([low, high])
        assert done[1].finished <= done[0].started


class Deaf:
    """Makes meshes, and heeds nobody who wants that stopped: as a large file is read."""

    def __init__(self):
        self.reads, self.has_read = threading.Event(), threading.Event()

    def mesh(self, request, options):
        self.reads.set()
        self.has_read.wait(running_server.GENEROUS_END)
        raise ts.CancelledError("the call was cancelled", ts.StatusCode.CANCELLED)


def test_who_cancels_a_job_of_this_process_waits_no_longer_than_they_want():
    backend = Deaf()
    jobs = LocalJobs(backend)
    job = ts.Jobs(jobs).submit(PART, spacing=0.3)
    assert backend.reads.wait(running_server.GENEROUS_END)
    with pytest.raises(ts.DeadlineExceededError):
        ts.Jobs(jobs).cancel(job, timeout=0.05)

    async def cancel_and_leave():
        cancelling = asyncio.create_task(ts.AsyncJobs(ts.Jobs(jobs)).cancel(job))
        await asyncio.wait([cancelling], timeout=0.05)
        cancelling.cancel()
        with pytest.raises(asyncio.CancelledError):
            await cancelling

    asyncio.run(cancel_and_leave())
    assert not ts.Jobs(jobs).get(job).done
    backend.has_read.set()
    assert ts.Jobs(jobs).cancel(job).state == "cancelled"


def test_all_threads_have_the_same_jobs(monkeypatch):
    here = ts.Client()
    with monkeypatch.context() as patch:
        patch.setattr("tetstream._client.LocalJobs", None)  # of which two threads could make one each
        assert here.jobs._backend is here.jobs._backend


def test_a_job_may_be_deleted_while_its_stream_begins(monkeypatch):
    with ts.Client() as here:
        job = here.jobs.wait(here.jobs.submit(PART, spacing=0.3))

        def delete_first(**options):
            here.jobs.delete(job)
            return options_of(**options)

        monkeypatch.setattr("tetstream._local_jobs.options_of", delete_first)
        assert sum(len(chunk.tets) for chunk in here.jobs.stream(job)) == job.header.tet_count
