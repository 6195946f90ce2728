"""The calls of AsyncClient: those of Client, awaited."""

import asyncio
import inspect
import threading
import time

import pytest

import running_server
import tetstream as ts
from conftest import assert_same, make_ball
from jobs_test import Played
from stream_test import Gathered
from tetstream import _async
from tetstream._request import stop_of_context


@pytest.fixture(params=["here", "served"])
def address(request, tmp_path):
    if request.param == "here":
        yield ":local:"
    else:
        with running_server.RunningServer(tmp_path / "store") as server:
            yield server.address


def test_makes_the_meshes_that_are_made_here(address, ball, mesh):
    async def work():
        async with ts.AsyncClient(address) as client:
            await client.check_health()
            assert (await client.capabilities()).server_version == ts.version()
            told = []
            stored = await client.upload(ball, progress=told.append)
            made = await asyncio.gather(*(client.mesh(stored, levels=levels) for levels in (0, 1)))
            estimate = await client.estimate(ball)
            async with await client.stream(ball, levels=0) as stream:
                chunks = [chunk async for chunk in stream]
            await asyncio.sleep(0)
            return made, estimate, stream, chunks, told

    made, estimate, stream, chunks, told = asyncio.run(work())
    assert_same(made[1], mesh)
    assert estimate.tet_count == mesh.header.tet_count and told[-1] == 1
    assert_same(Gathered(Came(stream.header, chunks)), made[0])


class Came:
    def __init__(self, header, chunks):
        self.header, self._chunks = header, chunks

    def __iter__(self):
        return iter(self._chunks)


def test_a_task_that_is_cancelled_stops_its_work(address):
    ball = make_ball(40)

    async def work():
        client = ts.AsyncClient(address)
        began = asyncio.Event()
        long = asyncio.create_task(client.mesh(ball, spacing=0.002, progress=lambda fraction: began.set()))
        stored = asyncio.create_task(client.upload(ball))
        await stored
        long.cancel()
        with pytest.raises(asyncio.CancelledError):
            await long
        stream = await client.stream(ball, levels=0)
        await stream.__anext__()
        stream.close()
        with pytest.raises(ts.CancelledError):
            await stream.__anext__()

    asyncio.run(work())


class Enough(Exception):
    """Of somebody who was told of progress."""


def test_what_progress_raises_stops_the_work_and_is_raised(address):
    def stop(fraction):
        told.append(fraction)
        raise Enough

    async def work():
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: lost.append(context))
        client = ts.AsyncClient(address)
        job = await client.jobs.submit(ts.sphere(1), spacing=0.2)
        stored = await client.upload(make_ball(40))
        with pytest.raises(Enough):
            await client.mesh(stored, spacing=0.002, progress=stop)  # it takes minutes
        with pytest.raises(Enough):
            await client.upload(make_ball(8), progress=stop)
        with pytest.raises(Enough):
            await client.jobs.wait(job, progress=stop)
        stream = await client.stream(stored, levels=0, progress=lambda fraction: fraction > 0 and stop(fraction))
        with pytest.raises(Enough):
            async for _ in stream:
                pass
        assert len(told) == 4

    told, lost = [], []
    asyncio.run(asyncio.wait_for(work(), running_server.GENEROUS_END))
    assert not lost


def test_jobs_and_sessions_are_awaited(address):
    async def work():
        async with ts.AsyncClient(address) as client:
            job = await client.jobs.submit(ts.sphere(1), spacing=0.2, labels={"a": "b"})
            async with await client.jobs.watch(job, after=0) as watch:
                changes = [event.change async for event in watch]
            assert changes[0] == "created" and changes[-1] == "finished"
            assert [one.name for one in await client.jobs.list(labels={"a": "b"})] == [job.name]
            fetched = await client.jobs.fetch(await client.jobs.wait(job))
            async with await client.session(ts.sphere(1), spacing=0.2) as session:
                assert_same(session.mesh, fetched)
                moved = await session.update(ts.sphere(1.05))
                assert moved is session.mesh and session.tets_sent > 0
            assert "AsyncSession" in repr(session)

    asyncio.run(work())


def test_a_wait_that_is_cancelled_ends(address):
    async def work():
        client = ts.AsyncClient(address)
        job = await client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))
        waiting = asyncio.create_task(client.jobs.wait(job))
        await client.jobs.get(job)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        await client.jobs.cancel(job)

    asyncio.run(work())


def test_calls_that_wait_hold_up_no_others(address):
    async def work():
        client = ts.AsyncClient(address)
        job = await client.jobs.submit(ts.Request(ts.sphere(1), spacing=0.002))  # it takes minutes
        waits = [asyncio.create_task(client.jobs.wait(job)) for _ in range(90)]
        watch = await client.jobs.watch(job, after=0)
        assert (await watch.__anext__()).change == "created"
        await client.capabilities()
        await client.mesh(ts.sphere(1), spacing=0.3)
        assert not (await client.jobs.get(job)).done and not any(wait.done() for wait in waits)
        await client.jobs.cancel(job)
        assert [event async for event in watch][-1].state == "cancelled"
        assert {job.state for job in await asyncio.gather(*waits)} == {"cancelled"}

    asyncio.run(work())


@pytest.fixture
def one_thread(monkeypatch):
    """For the calls that make meshes."""
    monkeypatch.setitem(_async._MOST_THREADS, "work", 1)
    _async._threads.cache_clear()
    yield
    _async._threads.cache_clear()


def test_a_call_that_waits_for_a_thread_is_cancelled_and_has_its_deadline(address, one_thread):
    async def work():
        client = ts.AsyncClient(address)
        has_thread = asyncio.Event()
        long = asyncio.create_task(
            client.mesh(ts.sphere(1), spacing=0.002, progress=lambda fraction: has_thread.set()))
        await has_thread.wait()
        with pytest.raises(ts.DeadlineExceededError, match="not begun within 0.1 s"):
            await client.mesh(ts.sphere(1), spacing=0.3, timeout=0.1)
        waiting = asyncio.create_task(client.mesh(ts.sphere(1), spacing=0.3))
        done, _ = await asyncio.wait([waiting, long], timeout=0.1)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        assert not done and not long.done()
        long.cancel()
        with pytest.raises(asyncio.CancelledError):
            await long

    asyncio.run(work())


def test_the_time_that_a_call_waits_for_a_thread_is_of_its_timeout(one_thread):
    async def work():
        jobs = ts.AsyncJobs(ts.Jobs(held))
        calls = [asyncio.create_task(jobs.fetch(name, timeout=60)) for name in ("one", "other")]
        await asyncio.sleep(0)  # both are made, and one has the thread
        made = time.monotonic()
        while (now := time.monotonic()) == made:
            pass
        held.goes_on.set()
        await asyncio.gather(*calls)
        return now - made

    held = Held()
    waited = asyncio.run(work())
    assert 0 < held.left[1] <= 60 - waited


class Held:
    """Jobs that are not fetched before all may be, and what time each call was left."""

    def __init__(self):
        self.left, self.goes_on = [], threading.Event()

    def fetch(self, name, progress, timeout):
        self.left.append(timeout)
        self.goes_on.wait(running_server.GENEROUS_END)


class Unlisted(Played):
    """Jobs that are listed only once the call is stopped."""

    stopped = False

    def list(self, jobs, timeout):
        self.asked.set()
        running_server.wait_until(lambda: stop_of_context.get().requested)
        self.stopped = True
        raise ts.CancelledError("the call was cancelled", ts.StatusCode.CANCELLED)


def test_a_watch_that_is_cancelled_while_it_begins_again_ends():
    played = Unlisted(0)

    async def work():
        watch = ts.AsyncJobWatch(ts.Jobs(played).watch(after=0))
        reading = asyncio.create_task(watch.__anext__())
        assert await asyncio.to_thread(played.asked.wait, running_server.GENEROUS_END)
        reading.cancel()
        with pytest.raises(asyncio.CancelledError):
            await reading

    asyncio.run(work())
    assert played.stopped


def test_errors_are_raised_where_they_are_awaited(address):
    async def work():
        with pytest.raises(ts.InvalidArgumentError, match="sphere.radius"):
            await ts.AsyncClient(address).mesh(ts.sphere(-1))

    asyncio.run(work())


@pytest.mark.parametrize("plain,asynchronous", [(ts.Client, ts.AsyncClient), (ts.Jobs, ts.AsyncJobs)])
def test_has_every_call_with_the_same_arguments(plain, asynchronous):
    for name, call in vars(plain).items():
        if name.startswith("_") or name == "address":
            continue
        other = getattr(asynchronous, name)
        assert inspect.getdoc(other), name
        if inspect.isfunction(call):
            assert str(inspect.signature(other)) == str(inspect.signature(call)), name
