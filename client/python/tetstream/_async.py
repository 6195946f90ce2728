"""The same calls for asyncio: each works on a thread, and is stopped where its task is cancelled.

Calls of one kind never wait for threads that calls of another have, so that whatever waits can be ended.
"""

from __future__ import annotations

import asyncio
import contextvars
import functools
import os
from collections.abc import Awaitable, Callable, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Any, Concatenate, Generic, Literal, ParamSpec, Self, TypeVar

from numpy.typing import ArrayLike

from ._client import LOCAL, Client
from ._errors import DeadlineExceededError, StatusCode
from ._header import Header, Statistics
from ._job import JobEvent
from ._job_watch import JobWatch
from ._jobs import Jobs
from ._mesh import Chunk, Mesh
from ._request import Stop, stop_of_context, time_left
from ._session import Session
from ._share import Share
from ._stable import StableMesh, StableSession
from ._stream import MeshStream

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")
W = TypeVar("W")
S = TypeVar("S", bound=Session | StableSession)

Kind = Literal["work", "wait", "watch", "ask"]

_MOST_THREADS: dict[Kind, int] = {
    "work": 64,  # makes or carries a mesh or a volume, which takes memory
    # These may do nothing, for as long as nothing happens. A server has 64 of both together for a client, and refuses more.
    "wait": 48,
    "watch": 64,
    "ask": 64,  # is answered at once
}


@functools.lru_cache(maxsize=None)
def _threads(kind: Kind) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(_MOST_THREADS[kind], thread_name_prefix=f"tetstream {kind}")


os.register_at_fork(after_in_child=_threads.cache_clear)  # they are not there


class _Telling:
    """Has the event loop call `progress` for a thread. What it raises stops the work, and is raised where that is awaited."""

    def __init__(self, tell: Callable[[float], object]) -> None:
        self._tell = tell
        self._loop = asyncio.get_running_loop()
        self._raised: Exception | None = None
        self.stop: Callable[[], object] = _nothing

    @classmethod
    def of(cls, named: dict[str, Any]) -> _Telling | None:
        """Takes the place of the `progress` of a call, where there is any."""
        tell = named.get("progress")
        if tell is None:
            return None
        telling = tell if isinstance(tell, cls) else cls(tell)
        named["progress"] = telling
        return telling

    def __call__(self, fraction: float) -> None:
        self._loop.call_soon_threadsafe(self._tell_now, fraction)

    def _tell_now(self, fraction: float) -> None:
        if self._raised is not None:
            return
        try:
            self._tell(fraction)
        except Exception as error:
            self._raised = error
            self.stop()

    def check(self) -> None:
        """Raises what was raised."""
        if self._raised is not None:
            raise self._raised from None


def _nothing() -> None:
    pass


async def _run(
    kind: Kind, on_cancel: Callable[[], object] | None, call: Callable[..., R], /, *given: Any, **named: Any
) -> R:
    """Has a thread make the call. Whoever cancels the task has the work stopped, and waits for that. A `timeout` is also
    for the time until there is a thread."""
    stop = Stop()
    context = contextvars.copy_context()
    context.run(stop_of_context.set, stop)
    telling = _Telling.of(named)
    if telling is not None:
        telling.stop = stop.request
    timeout: float | None = named.get("timeout")
    left = time_left(timeout)

    def work() -> R:
        if timeout is not None:
            named["timeout"] = left()
        return call(*given, **named)

    queued = _threads(kind).submit(lambda: context.run(work))
    done = asyncio.wrap_future(queued)
    try:
        await asyncio.wait([done], timeout=left())
        if not done.done() and queued.cancel():
            raise DeadlineExceededError(
                f"the call was not begun within {timeout} s; at most {_MOST_THREADS[kind]} like it are under way",
                StatusCode.DEADLINE_EXCEEDED)
        await asyncio.wait([done])
    except asyncio.CancelledError:
        stop.request()  # for calls within the work, which `on_cancel` does not know
        if on_cancel is not None:
            on_cancel()
        if not queued.cancel():
            await asyncio.wait([done])
            done.exception()  # of a work that was stopped: nobody else will ask
        raise
    return await _told(telling, done)


async def _told(telling: _Telling | None, work: Awaitable[R]) -> R:
    """What the work comes to, unless its progress has raised something."""
    try:
        done = await work
    except Exception:
        if telling is not None:
            telling.check()
        raise
    if telling is not None:
        telling.check()
    return done


def _next(items: Iterator[R]) -> R | None:
    return next(items, None)


class _Wrapped(Generic[T]):
    """Has the calls of an object of the package that knows nothing of asyncio."""

    def __init__(self, sync: T) -> None:
        self._sync = sync

    def __repr__(self) -> str:
        return repr(self._sync).replace("tetstream.", "tetstream.Async", 1)


def _call(
    call: Callable[Concatenate[T, P], R], kind: Kind = "work"
) -> Callable[Concatenate[_Wrapped[T], P], Coroutine[Any, Any, R]]:
    @functools.wraps(call)
    async def method(self: _Wrapped[T], /, *given: P.args, **named: P.kwargs) -> R:
        return await _run(kind, None, call, self._sync, *given, **named)

    return method


def _call_for(
    wrap: Callable[[R], W], call: Callable[Concatenate[T, P], R], kind: Kind = "work"
) -> Callable[Concatenate[_Wrapped[T], P], Coroutine[Any, Any, W]]:
    @functools.wraps(call)
    async def method(self: _Wrapped[T], /, *given: P.args, **named: P.kwargs) -> W:
        return wrap(await _run(kind, None, call, self._sync, *given, **named))

    return method


class AsyncMeshStream(_Wrapped[MeshStream]):
    """A `MeshStream` for asyncio: `async for chunk in stream`, and `async with` to stop it early."""

    def __init__(self, sync: MeshStream, telling: _Telling | None = None) -> None:
        super().__init__(sync)
        self._telling = telling

    @property
    def header(self) -> Header:
        """The mesh's totals: enough to allocate all of it."""
        return self._sync.header

    @property
    def share(self) -> Share:
        """Which of the mesh's vertices and tets come."""
        return self._sync.share

    @property
    def statistics(self) -> Statistics:
        """What is told of the mesh after its last chunk."""
        return self._sync.statistics

    def __aiter__(self) -> AsyncMeshStream:
        return self

    async def __anext__(self) -> Chunk:
        chunk: Chunk | None = await _told(self._telling, _run("work", self._sync.close, _next, self._sync))
        if chunk is None:
            raise StopAsyncIteration
        return chunk

    def close(self) -> None:
        """Stops the work, unless it has ended."""
        self._sync.close()

    async def __aenter__(self) -> AsyncMeshStream:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _call_for_stream(
    call: Callable[Concatenate[T, P], MeshStream]
) -> Callable[Concatenate[_Wrapped[T], P], Coroutine[Any, Any, AsyncMeshStream]]:
    @functools.wraps(call)
    async def method(self: _Wrapped[T], /, *given: P.args, **named: P.kwargs) -> AsyncMeshStream:
        telling = _Telling.of(named)
        return AsyncMeshStream(await _run("work", None, call, self._sync, *given, **named), telling)

    return method


class _AsyncFollowing(_Wrapped[S]):
    """What sessions for asyncio have in common."""

    @property
    def tets_sent(self) -> int:
        """Tets of the last frame that were sent, or made here."""
        return self._sync.tets_sent

    @property
    def is_over(self) -> bool:
        """Whether it takes no more frames."""
        return self._sync.is_over

    async def close(self) -> None:
        """Tells the server that this was all."""
        await _run("work", self._sync._session.stop, self._sync.close)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            await self.close()
        else:
            self._sync._abandon()


class AsyncSession(_AsyncFollowing[Session]):
    """A `Session` for asyncio. A task that is cancelled in `update` ends it."""

    @property
    def mesh(self) -> Mesh:
        """As it is now."""
        return self._sync.mesh

    @functools.wraps(Session.update)
    async def update(self, frame: Any) -> Mesh:
        return await _run("work", self._sync._session.stop, self._sync.update, frame)


class AsyncStableSession(_AsyncFollowing[StableSession]):
    """A `StableSession` for asyncio. A task that is cancelled in `update` or `in_order` ends it."""

    @property
    def mesh(self) -> StableMesh:
        """As it is now."""
        return self._sync.mesh

    @functools.wraps(StableSession.update)
    async def update(self, frame: Any, *, replaced: ArrayLike | None = None) -> StableMesh:
        update = functools.partial(self._sync.update, replaced=replaced)
        return await _run("work", self._sync._session.stop, update, frame)

    @functools.wraps(StableSession.in_order)
    async def in_order(self) -> Mesh:
        return await _run("work", self._sync._session.stop, self._sync.in_order)


class AsyncJobWatch(_Wrapped[JobWatch]):
    """A `JobWatch` for asyncio: `async for event in watch`, which may be left at any time."""

    def __aiter__(self) -> AsyncJobWatch:
        return self

    async def __anext__(self) -> JobEvent:
        event: JobEvent | None = await _run("watch", self._sync.close, _next, self._sync)
        if event is None:
            raise StopAsyncIteration
        return event

    def close(self) -> None:
        """Ends it."""
        self._sync.close()

    async def __aenter__(self) -> AsyncJobWatch:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class AsyncJobs(_Wrapped[Jobs]):
    """The jobs of an `AsyncClient`: the calls of `Jobs`, each to be awaited."""

    submit = _call(Jobs.submit)
    get = _call(Jobs.get, "ask")
    list = _call(Jobs.list, "ask")
    wait = _call(Jobs.wait, "wait")
    wait_all = _call(Jobs.wait_all, "wait")
    watch = _call_for(AsyncJobWatch, Jobs.watch, "ask")
    cancel = _call(Jobs.cancel, "ask")
    retry = _call(Jobs.retry, "ask")
    delete = _call(Jobs.delete, "ask")
    fetch = _call(Jobs.fetch)
    stream = _call_for_stream(Jobs.stream)


class AsyncClient(_Wrapped[Client]):
    """A `Client` for asyncio: the same calls, each to be awaited.

        async with ts.AsyncClient("localhost:7447") as client:
            meshes = await asyncio.gather(*(client.mesh(ball, spacing=s) for s in (0.2, 0.1, 0.05)))
            async for chunk in await client.stream(ball):
                use(chunk)

    A task that is cancelled stops its work, here or on the server. `progress` is called in the event loop,
    and what it raises stops the work and is raised where that is awaited. The arguments are those of `Client`.

    Of the calls of all clients in this process 64 work at a time, 48 wait for jobs, and 64 for the next event of a
    watch; more are begun one by one as these end. That takes of their `timeout`, and they can be cancelled before.
    Whatever asks about jobs, or cancels them, waits for none of these.
    """

    def __init__(
        self,
        address: str = LOCAL,
        *,
        token: str = "",
        token_in_plain: bool = False,
        tls: bool = False,
        tls_ca: str | os.PathLike[str] = "",
        tls_cert: str | os.PathLike[str] = "",
        tls_key: str | os.PathLike[str] = "",
        attempts: int = 8,
        shared_memory: bool = True,
    ) -> None:
        super().__init__(Client(address, token=token, token_in_plain=token_in_plain, tls=tls, tls_ca=tls_ca,
                                tls_cert=tls_cert, tls_key=tls_key, attempts=attempts,
                                shared_memory=shared_memory))

    mesh = _call(Client.mesh)
    estimate = _call(Client.estimate)
    stream = _call_for_stream(Client.stream)
    sample = _call(Client.sample)
    session = _call_for(AsyncSession, Client.session)
    stable_session = _call_for(AsyncStableSession, Client.stable_session)
    upload = _call(Client.upload)
    upload_file = _call(Client.upload_file)
    capabilities = _call(Client.capabilities, "ask")
    check_health = _call(Client.check_health, "ask")

    @property
    def jobs(self) -> AsyncJobs:
        """Meshes that are made while nobody waits."""
        return AsyncJobs(self._sync.jobs)

    def close(self) -> None:
        """Forgets the connection. Streams that were begun go on; jobs of this process are cancelled."""
        self._sync.close()

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
