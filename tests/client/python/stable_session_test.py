"""Meshes whose vertices and tets keep their ids, here and on a server."""

import asyncio
import gc

import numpy as np
import pytest

import tetstream as ts
from conftest import assert_same
from session_test import frames


def rows(ranges, array):
    return np.concatenate([array[first:end] for first, end in ranges] or [array[:0]])


@pytest.mark.parametrize("served", [False, True])
def test_changed_slots_are_all_that_has_to_be_read(client, served):
    first, *rest = frames(6)
    with (client if served else ts).stable_session(first) as session, ts.session(first) as whole:
        mesh = session.mesh
        assert mesh.renumbered
        points, tets = mesh.local_points.copy(), mesh.tets.copy()
        for frame in rest:
            mesh = session.update(frame)
            points.resize(mesh.local_points.shape, refcheck=False)
            tets.resize(mesh.tets.shape, refcheck=False)
            for begin, end in mesh.changed_vertices:
                points[begin:end] = mesh.local_points[begin:end]
            for begin, end in mesh.changed_tets:
                tets[begin:end] = mesh.tets[begin:end]
            assert np.array_equal(points, mesh.local_points) and np.array_equal(tets, mesh.tets)
            assert_same(session.in_order(), whole.update(frame))
            assert mesh.header.tet_count == whole.mesh.header.tet_count
            assert not rows(mesh.empty_tets, mesh.tets).any()
            assert len(rows(mesh.empty_tets, mesh.tets)) + mesh.header.tet_count == len(mesh.tets)
            assert session.tets_sent < mesh.header.tet_count
    assert "of them changed" in repr(session)


def test_ids_are_the_same_here_and_there(client):
    first, *rest = frames()
    with ts.stable_session(first) as here, client.stable_session(first) as there:
        for frame in rest:
            a, b = here.update(frame), there.update(frame)
            for name in ("local_points", "tets", "changed_vertices", "changed_tets", "empty_vertices", "empty_tets"):
                assert np.array_equal(getattr(a, name), getattr(b, name)), name
            assert a.renumbered == b.renumbered


def test_arrays_are_views_that_cannot_be_written():
    with ts.stable_session(ts.sphere(1), spacing=0.2) as session:
        mesh = session.mesh
        assert np.shares_memory(mesh.tets, mesh.tets)
        for array in (mesh.local_points, mesh.tets):
            assert not array.flags.writeable and not array.flags.owndata
        assert mesh.regions is None
        assert mesh.changed_tets.tolist() == [[0, len(mesh.tets)]]


def test_an_array_outlives_updates_and_the_session():
    session = ts.stable_session(ts.sphere(0.5), spacing=0.1)
    held = []
    for radius in (0.5, 1.5, 0.3, 2):  # which needs other memory, and renumbers
        mesh = session.update(ts.sphere(radius))
        held.append((mesh.local_points, mesh.tets))
    del mesh, session
    gc.collect()
    for points, tets in held:
        assert np.isfinite(points).all() and tets.max() > 0


def test_the_mesh_of_an_earlier_frame_says_so():
    session = ts.stable_session(ts.sphere(1), spacing=0.2)
    old = session.mesh
    assert session.update(ts.sphere(1.05)) is session.mesh
    for name in ("tets", "local_points", "regions", "header", "changed_tets", "empty_vertices", "renumbered"):
        with pytest.raises(ts.FailedPreconditionError, match="earlier frame"):
            getattr(old, name)
    assert "earlier" in repr(old)
    session.close()
    assert len(session.mesh.tets) > 0  # it stays
    with pytest.raises(ts.FailedPreconditionError, match="over"):
        session.update(ts.sphere(1))
    assert len(session.mesh.tets) > 0 and session.in_order().header.tet_count == session.mesh.header.tet_count


@pytest.mark.parametrize("served", [False, True])
def test_a_refused_frame_leaves_the_mesh(client, served):
    ball = ts.sphere(1)
    with (client if served else ts).stable_session(ball & ball.move(0.5), spacing=0.1) as session:
        before = session.mesh
        tets = before.tets.copy()
        with pytest.raises(ts.Error):
            session.update(ball & ball.move(3))  # nothing is within both balls
        assert not session.is_over and session.mesh is before
        assert np.array_equal(before.tets, tets)


@pytest.mark.parametrize("served", [False, True])
def test_a_failure_that_ends_it_leaves_no_mesh(client, served):
    with (client if served else ts).stable_session(ts.sphere(1), spacing=0.1) as session:
        mesh, tets = session.mesh, session.mesh.tets
        session._session.stop()  # as a task of asyncio does that is cancelled
        with pytest.raises(ts.CancelledError):
            session.update(ts.sphere(1.1))
        assert session.is_over
        with pytest.raises(ts.FailedPreconditionError):
            mesh.tets
        with pytest.raises(ts.FailedPreconditionError):
            session.in_order()
        assert tets.max() < 2**32  # may be read


class Interrupted:
    """A session of the library where Ctrl-C comes when it has taken a frame."""

    def __init__(self, session):
        self._session = session

    def __getattr__(self, name):
        return getattr(self._session, name)

    def update(self, frame):
        self._session.update(frame)
        raise KeyboardInterrupt


def test_an_interrupted_update_leaves_the_mesh_that_there_is():
    with ts.stable_session(ts.sphere(1), spacing=0.2) as session, ts.session(ts.sphere(1.1), spacing=0.2) as expected:
        before, native = session.mesh, session._session
        session._session = Interrupted(native)
        with pytest.raises(KeyboardInterrupt):
            session.update(ts.sphere(1.1))
        session._session = native
        with pytest.raises(ts.FailedPreconditionError, match="earlier frame"):
            before.tets
        mesh = session.mesh
        assert mesh.header.tet_count == expected.mesh.header.tet_count and not session.is_over
        assert mesh.changed_tets.tolist() == [[0, len(mesh.tets)]]
        assert mesh.changed_vertices.tolist() == [[0, len(mesh.local_points)]]
        assert session.update(ts.sphere(1.1)).changed_tets.size == 0


def test_asyncio_has_it():
    async def follow():
        async with ts.AsyncClient() as client:
            async with await client.stable_session(ts.sphere(1), spacing=0.2) as session:
                mesh = await session.update(ts.sphere(1.1))
                assert mesh is session.mesh and not session.is_over and session.tets_sent > 0
                whole = await session.in_order()
                assert whole.header.tet_count == mesh.header.tet_count

    asyncio.run(follow())


def dented(depth):
    """A ball, and less or more of it in a block of samples."""
    grid = np.mgrid[:48, :48, :48].astype(np.float32)
    values = np.clip(np.sqrt(((grid - 23.5) ** 2).sum(axis=0)) - 17, -3, 3)
    values[38:42, 20:26, 20:26] += depth
    return ts.Volume.from_array(values, spacing=1)


@pytest.mark.parametrize("served", [False, True])
def test_frames_may_name_what_was_replaced(client, served):
    with (client if served else ts).stable_session(dented(0)) as session, ts.session(dented(0)) as whole:
        for depth, replaced in ((0.4, [((38, 20, 20), (42, 26, 26))]), (0, [[[0, 0, 0], [48, 48, 48]]]), (0, []),
                                (0.8, np.array([[[36, 0, 0], [44, 30, 30]], [[0, 0, 0], [1, 1, 1]]]))):
            session.update(dented(depth), replaced=replaced)
            assert_same(session.in_order(), whole.update(dented(depth)))


@pytest.mark.parametrize("served", [False, True])
def test_a_list_that_leaves_out_what_changed_is_refused(client, served):
    with (client if served else ts).stable_session(dented(0)) as session:
        before = session.in_order()
        for depth, replaced in ((0.4, []), (3, [((0, 0, 0), (8, 8, 8))]), (0.01, [((40, 16, 16), (48, 24, 24))])):
            with pytest.raises(ts.InvalidArgumentError, match="replaced"):
                session.update(dented(depth), replaced=replaced)
            assert_same(session.in_order(), before)
        session.update(dented(0.4), replaced=[((38, 20, 20), (42, 26, 26))])


def test_replaced_are_boxes_of_whole_samples():
    with ts.stable_session(dented(0)) as session:
        for replaced in ([(0, 0, 0)], [((0, 0, 0.5), (1, 1, 1))], [((5, 0, 0), (4, 9, 9))], [((0, 0, 0), (2**40, 1, 1))]):
            with pytest.raises(ts.InvalidArgumentError, match="replaced"):
                session.update(dented(0), replaced=replaced)
    with ts.stable_session(ts.sphere(1), spacing=0.2) as session:
        with pytest.raises(ts.InvalidArgumentError, match="volumes"):
            session.update(ts.sphere(1), replaced=[])
