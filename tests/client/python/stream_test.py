"""Meshes chunk by chunk, in this process."""

import numpy as np
import pytest

import tetstream as ts
from conftest import assert_same, make_ball

OPTIONS = {
    "plain": {},
    "both sides": {"preset": "both_sides", "box": ((-1.5,) * 3, (1.5,) * 3)},
    "fields": {"fields": {"distance": make_ball(8)}, "levels": 0},
    "improved": {"improve": True},
    "float64": {"coordinates": "float64"},
}


class Gathered:
    """What chunks hold together, with the arrays of a mesh."""

    def __init__(self, stream):
        self.header = stream.header
        chunks = list(stream)
        vertices = np.cumsum([0] + [len(chunk.points) for chunk in chunks])
        tets = np.cumsum([0] + [len(chunk.tets) for chunk in chunks])
        assert [chunk.index for chunk in chunks] == list(range(self.header.chunk_count))
        assert [chunk.first_vertex for chunk in chunks] == list(vertices[:-1])
        assert [chunk.first_tet for chunk in chunks] == list(tets[:-1])
        for name in ("local_points", "points", "tets", "regions", "_field_rows", "labels"):
            arrays = [getattr(chunk, name) for chunk in chunks]
            setattr(self, name, None if arrays[0] is None else np.concatenate(arrays))


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS.keys())
def test_chunks_together_are_the_mesh(options):
    ball = make_ball(32)
    whole = ts.mesh(ball, **options)
    gathered = Gathered(ts.stream(ball, **options))
    assert gathered.header.chunk_count > 1 or options == OPTIONS["plain"]
    assert_same(gathered, whole)
    assert np.array_equal(gathered.points, whole.points)


def test_tells_statistics_at_the_end(ball, mesh):
    stream = ts.stream(ball)
    with pytest.raises(ts.FailedPreconditionError, match="chunks to come"):
        stream.statistics
    list(stream)
    assert stream.statistics == mesh.statistics
    assert list(stream) == []


def test_chunks_are_the_readers_own():
    stream = ts.stream(make_ball(32), levels=0)
    first = next(stream)
    expected = first.tets.copy()
    others = list(stream)
    assert len(others) > 1
    assert np.array_equal(first.tets, expected)
    first.tets[:] = 0
    assert "Chunk 0 of" in repr(first)


def test_stops_where_its_reader_leaves_it():
    with ts.stream(make_ball(32), levels=0) as stream:
        for chunk in stream:
            break
    with pytest.raises(ts.CancelledError, match="closed"):
        next(stream)
    stream.close()
    assert f"{stream.header.tet_count:,} tets" in repr(stream)


def test_raises_errors_before_it_begins(ball):
    with pytest.raises(ts.InvalidArgumentError):
        ts.stream(ball, spacing=-1)
    with pytest.raises(ts.DeadlineExceededError):
        ts.stream(ball, timeout=0)


def test_tells_progress_while_it_is_read():
    told = []
    for _ in ts.stream(make_ball(32), levels=0, progress=told.append):
        pass
    assert told == sorted(set(told)) and told[-1] == 1


def test_tells_progress_of_chunks_that_come_at_once():
    """Nobody waits for them as long as it takes to look how far they are."""
    told = []
    with ts.stream(make_ball(32), levels=0, progress=told.append) as stream:
        for chunk in stream:
            assert told and told[-1] >= (chunk.index + 1) / stream.header.chunk_count - 1e-9
    assert told == sorted(set(told)) and told[-1] == 1


def test_is_stopped_by_what_progress_raises():
    told = []

    def stop_once(fraction):
        if fraction > 0:  # while the header is waited for, 0 may be told
            told.append(fraction)
        if len(told) == 1:
            raise RuntimeError("enough")

    stream = ts.stream(make_ball(32), levels=0, progress=stop_once)
    with pytest.raises(RuntimeError, match="enough"):
        next(stream)
    with pytest.raises(ts.CancelledError):
        list(stream)
