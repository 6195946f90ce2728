"""Meshes that follow their shapes, here and on a server."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import running_server
import tetstream as ts
from conftest import assert_same, distances


def frames(count=4, radius=20):
    """A ball that a bump travels over: most of it stays as it is."""
    values, place = distances(radius)
    edge = place["origin"][0]
    axis = np.linspace(edge, -edge, len(values))
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    for i in range(count):
        bump = np.sqrt((x - 1) ** 2 + (y - 0.05 * i) ** 2 + z**2) - 0.15
        yield ts.Volume.from_array(np.minimum(values, bump), **place)


def test_volumes_make_the_same_bytes_here_and_there(client):
    first, *rest = frames()
    with ts.session(first) as here, client.session(first) as there:
        assert_same(there.mesh, here.mesh)
        for frame in rest:
            assert_same(there.update(frame), here.update(frame))
            assert 0 < there.tets_sent < here.tets_sent == here.mesh.header.tet_count
            assert there.mesh.quality().volume == pytest.approx(here.mesh.quality().volume, rel=1e-6)
    assert "of them new" in repr(there)


def test_solids_make_the_same_bytes_here_and_there(client):
    solids = [ts.sphere(1) | ts.sphere(0.2, center=(1, 0.02 * i, 0)) for i in range(4)]
    with ts.session(solids[0], spacing=0.05) as here, client.session(solids[0], spacing=0.05) as there:
        for frame in solids[1:]:
            assert_same(there.update(frame), here.update(frame))
            assert there.tets_sent < there.mesh.header.tet_count


class Forgetful:
    """A session whose server has evicted a volume of the first frame that it is given."""

    def __init__(self, session):
        self._session, self.frames = session, []

    def __getattr__(self, name):
        return getattr(self._session, name)

    def update(self, frame):
        self.frames.append(frame)
        if len(self.frames) == 1:
            raise ts.NotFoundError("it is evicted", ts.StatusCode.NOT_FOUND, "GRID_NOT_FOUND")
        return self._session.update(frame)


@pytest.mark.parametrize("begin", [ts.Client.session, ts.Client.stable_session])
def test_an_update_sends_a_volume_again_that_the_server_has_lost(client, ball, begin):
    solid = ts.grid(ball) | ts.sphere(1, center=(1, 0, 0))
    with begin(client, ts.sphere(1), spacing=0.2) as session:
        session._session = Forgetful(session._session)
        assert session.update(solid).header.tet_count == ts.mesh(solid, spacing=0.2).header.tet_count
        assert len(session._session.frames) == 2
        session._session.frames.clear()
        with pytest.raises(ts.NotFoundError):
            session.update(ts.sphere(1))  # of which nothing was sent


def test_meshes_of_earlier_frames_stay_as_they_were(client):
    first, second, *_ = frames()
    with client.session(first) as session:
        mesh = session.mesh
        tets = mesh.tets.copy()
        session.update(second)
        assert np.array_equal(mesh.tets, tets)
        assert session.mesh is not mesh


def test_nothing_that_changed_is_a_frame_too(client):
    first = next(frames())
    with client.session(ts.Request(first, spacing=0.1)) as session:
        before = session.mesh
        assert_same(session.update(first), before)
        assert session.tets_sent == 0


@pytest.mark.parametrize("served", [False, True])
def test_says_what_is_no_frame(client, served):
    maker = client if served else ts
    first = next(frames())
    with pytest.raises(ts.InvalidArgumentError, match="began with a volume"):
        maker.session(first).update(ts.sphere(1))
    with pytest.raises(ts.InvalidArgumentError, match="began with a scene"):
        maker.session(ts.sphere(1), spacing=0.2).update(first)
    session = maker.session(first)
    session.close()
    with pytest.raises(ts.FailedPreconditionError, match="over"):
        session.update(first)


@pytest.mark.parametrize("served", [False, True])
def test_outlives_a_frame_that_cannot_be_meshed(client, served):
    ball = ts.sphere(1)
    lens = [ball & ball.move(x) for x in (0.5, 3, 0.6)]
    with (client if served else ts).session(lens[0], spacing=0.1) as session:
        before = session.mesh
        with pytest.raises(ts.Error):
            session.update(lens[1])  # nothing is within both balls
        assert not session.is_over
        assert session.mesh is before
        assert session.update(lens[2]).header.tet_count < before.header.tet_count
    assert session.is_over


def test_a_frame_may_be_larger_than_a_message(client):
    values, place = distances(100)
    band = 3 * place["spacing"]
    place["background"] = band
    first, second = (ts.Volume.from_array(np.clip(np.roll(values, shift, axis=0), -band, band), **place)
                     for shift in (0, 3))
    with ts.session(first, spacing=0.1) as here, client.session(first, spacing=0.1) as there:
        assert_same(there.update(second), here.update(second))


def test_a_frame_elsewhere_needs_another_session(client):
    values, place = distances(12)
    session = client.session(ts.Volume.from_array(values, **place))
    moved = ts.Volume.from_array(values, spacing=place["spacing"], origin=(0, 0, 0))
    with pytest.raises(ts.InvalidArgumentError, match="place of the voxels"):
        session.update(moved)


def refuses(call):
    """Whether it says that another thread is in the session."""
    try:
        call()
    except ts.FailedPreconditionError as error:
        return "another thread" in str(error)
    return False


@pytest.mark.parametrize("begin", [ts.session, ts.stable_session])
def test_one_thread_at_a_time_is_in_a_session(begin):
    session = begin(ts.sphere(0.03), spacing=0.002)
    before, sent = session.mesh, session.tets_sent
    with ThreadPoolExecutor(1) as other:
        long = other.submit(session.update, ts.sphere(1))  # it takes minutes
        try:
            running_server.wait_until(lambda: refuses(lambda: session._session.mesh))
            calls = [lambda: session.update(ts.sphere(0.04)), session.close]
            if begin == ts.stable_session:
                calls.append(session.in_order)
            assert all(refuses(call) for call in calls)
            assert session.mesh is before and session.tets_sent == sent and not session.is_over
        finally:
            session._session.stop()
        with pytest.raises(ts.CancelledError):
            long.result()
    assert session.is_over


class Left(Exception):
    """Of somebody who has seen enough."""


@pytest.mark.parametrize("begin", ["session", "stable_session"])
def test_a_session_that_an_exception_leaves_is_ended(server, client, begin):
    async def leave():
        async with ts.AsyncClient(server.address) as asynchronous:
            async with await getattr(asynchronous, begin)(ts.sphere(1), spacing=0.2) as session:
                sessions.append(session)
                raise Left

    sessions = []
    with pytest.raises(Left):
        with getattr(client, begin)(ts.sphere(1), spacing=0.2) as session:
            sessions.append(session)
            assert server.samples()["tetstream_calls_running"] == 1
            raise Left
    with pytest.raises(Left):
        asyncio.run(leave())
    running_server.wait_until(lambda: server.samples()["tetstream_calls_running"] == 0)
    assert all(session.is_over for session in sessions)
