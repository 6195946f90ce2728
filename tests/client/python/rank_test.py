"""Shares of a mesh for the ranks of a parallel program."""

import numpy as np
import pytest

import tetstream as ts
from conftest import make_ball
from tetstream._share import SharedStream

COLUMNS = ("local_points", "tets", "regions", "_field_rows", "faces", "face_tets", "face_labels", "labels")


def joined(streams):
    """The columns of all ranks, one behind the other."""
    chunks = [chunk for stream in streams for chunk in stream]
    return {name: None if getattr(chunks[0], name) is None else
            np.concatenate([getattr(chunk, name) for chunk in chunks]) for name in COLUMNS}


@pytest.fixture(scope="module")
def large_ball():
    return make_ball(28)


@pytest.mark.parametrize("served", [False, True])
@pytest.mark.parametrize("size", [1, 2, 3, 7])
def test_shares_together_are_the_mesh(client, large_ball, served, size):
    maker = client if served else ts
    request = ts.Request(large_ball, levels=0, faces=True, fields={"distance": make_ball(8)})
    whole = ts.mesh(request)
    assert whole.header.chunk_count > 10
    streams = [maker.stream(request, rank=i, size=size) for i in range(size)]
    got = joined(streams)
    for name in COLUMNS:
        expected = getattr(whole, name)
        assert (got[name] is None) == (expected is None), name
        assert expected is None or got[name].tobytes() == expected.tobytes(), name
    counts = [(stream.share.vertex_count, stream.share.tet_count) for stream in streams]
    assert max(np.ptp(np.array(counts), axis=0)) <= 1
    assert all(stream.header.tet_count == whole.header.tet_count for stream in streams)


def test_a_rank_is_sent_little_more_than_its_share(server, client, large_ball):
    def sent(**options):
        before = server.samples()["tetstream_sent_chunks_total"]
        for _ in client.stream(large_ball, levels=0, **options):
            pass
        return server.samples()["tetstream_sent_chunks_total"] - before

    whole = sent()
    assert sent(rank=1, size=4) < whole / 4 + 6


class Uneven:
    """A stream of some chunks of a mesh, each of which is as many single tets as `SIZES` says, and nothing else."""

    SIZES = [1] * 40 + [30, 1, 2] + [1] * 20 + [60] + [1] * 30

    def __init__(self, first, end):
        self.left = iter(range(first, end))

    def next(self, alone):
        index = next(self.left, None)
        if index is None:
            return None
        begin = sum(self.SIZES[:index])
        tets = np.arange(begin, begin + self.SIZES[index])
        return (index, 0, begin, np.empty((0, 3)), tets, *[None] * 6)

    def close(self):
        self.left = iter(())


@pytest.mark.parametrize("size", [1, 2, 3, 7, 50])
def test_shares_are_whole_wherever_chunks_of_many_sizes_lie(size):
    total = sum(Uneven.SIZES)
    counted = {"vertex_count": 0, "tet_count": total, "chunk_count": len(Uneven.SIZES)}
    shares = [SharedStream(Uneven, counted, rank, size) for rank in range(size)]
    tets = [np.concatenate([chunk[4] for chunk in iter(share.next, None)]) for share in shares]
    assert [len(one) for one in tets] == [share.share.tet_count for share in shares]
    assert np.array_equal(np.concatenate(tets), np.arange(total))


class Even(Uneven):
    SIZES = [10] * 100


def test_a_rank_asks_for_few_chunks_beside_its_share():
    asked = []

    def open_range(first, end):
        asked.append((first, end))
        return Even(first, end)

    counted = {"vertex_count": 0, "tet_count": 1000, "chunk_count": 100}
    for rank in range(4):
        assert len(list(iter(SharedStream(open_range, counted, rank, 4).next, None))) == 25
    assert all(25 * rank - 5 <= first and end <= 25 * rank + 30 for rank, (first, end) in enumerate(asked))


def test_more_ranks_than_tets_leave_some_empty():
    solid = ts.sphere(1)
    total = ts.mesh(solid, spacing=1).header.tet_count
    shares = [list(ts.stream(solid, spacing=1, rank=i, size=total + 5)) for i in (0, total + 4)]
    assert [sum(len(chunk.tets) for chunk in share) for share in shares] == [0, 1]


def test_says_what_a_rank_is(ball):
    with pytest.raises(ts.InvalidArgumentError, match="rank 2 of size 2"):
        ts.stream(ball, rank=2, size=2)
    with pytest.raises(ts.FailedPreconditionError, match="share has no statistics"):
        ts.stream(ball, rank=0, size=2).statistics


@pytest.mark.parametrize("share", [{}, {"rank": 1, "size": 2}])
def test_no_mesh_is_made_of_what_is_left_of_a_stream(large_ball, share):
    read = ts.stream(large_ball, levels=0, **share)
    next(read)
    ended = ts.stream(large_ball, levels=0, **share)
    whole = ended._collected()  # as dolfinx gets it
    assert np.array_equal(whole.tets, joined([ts.stream(large_ball, levels=0, **share)])["tets"])
    for stream in (read, ended):
        with pytest.raises(ts.FailedPreconditionError, match="have been read"):
            stream.to_dolfinx(None)
