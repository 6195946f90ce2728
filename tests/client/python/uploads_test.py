"""Volumes that travel to a server by themselves: once, however many threads mesh them."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

import running_server
import tetstream as ts
from conftest import assert_same, make_ball
from tetstream import _backends, _tetstream


class Uploading:
    """A client that only counts its uploads, each of which waits for `may_end`."""

    def __init__(self):
        self.began, self.may_end, self.uploads = threading.Event(), threading.Event(), []

    def upload(self, volume, options):
        self.uploads.append(_tetstream.StoredVolume("grids/" + 64 * "0", "", []))
        self.began.set()
        uploaded = self.uploads[-1]
        assert len(self.uploads) == 1 or self.may_end.is_set(), "uploaded by two at a time"
        assert self.may_end.wait(running_server.GENEROUS_END)
        return uploaded


@pytest.fixture
def served():
    served = _backends.Served("127.0.0.1:1", _tetstream.ClientOptions())
    served.client = Uploading()
    return served


def within(seconds):
    from tetstream._request import options_of
    return options_of(timeout=seconds)


def test_a_thread_waits_for_the_upload_of_another(served):
    ball, client = make_ball(4), served.client
    with ThreadPoolExecutor(1) as other:
        first = other.submit(served.stored, ball, within(None), lambda stored: stored)
        try:
            assert client.began.wait(running_server.GENEROUS_END)
            with pytest.raises(ts.DeadlineExceededError):
                served.stored(ball, within(0.1), lambda stored: stored)
            stopped = within(None)
            stopped.stop.request()
            with pytest.raises(ts.CancelledError):
                served.stored(ball, stopped, lambda stored: stored)
        finally:
            client.may_end.set()
        assert first.result() is served.stored(ball, within(None), lambda stored: stored)
    assert len(client.uploads) == 1


def test_an_evicted_volume_is_sent_once_to_all_that_miss_it(served):
    """Two threads learn at the same time that the server has it no longer."""
    ball, client, both = make_ball(4), served.client, threading.Barrier(2)
    client.may_end.set()
    solids = [ball, ts.grid(ball) | ts.sphere(1)]

    def miss(tries):
        tries.append(None)
        if len(tries) == 1:
            both.wait(running_server.GENEROUS_END)
            raise ts.NotFoundError("evicted", ts.StatusCode.NOT_FOUND, "GRID_NOT_FOUND")
        return True

    def work(solid):
        tries = []
        return served.stored(solid, within(None), lambda stored: miss(tries))

    with ThreadPoolExecutor(2) as threads:
        assert list(threads.map(work, solids)) == [True, True]
    assert len(client.uploads) == 2


def test_fields_are_sent_once(server, client, tmp_path):
    ball, values = make_ball(16), make_ball(12)
    wanted = {"distance": values}
    here = ts.mesh(ball, levels=0, fields=wanted)
    assert_same(client.mesh(ball, levels=0, fields=wanted), here)
    uploads = []
    client._backend.client = Noting(client._backend.client, uploads)
    assert_same(client.mesh(ball, levels=0, fields=wanted), here)
    assert not uploads
    for maker in (client, ts.Client(":local:")):
        assert_same(maker.mesh(ball, levels=0, fields={"distance": maker.upload(values)}), here)
    values.write_vdb(tmp_path / "values.vdb")
    for maker in (client, ts.Client(":local:")):
        stored = maker.upload_file(tmp_path / "values.vdb")
        assert_same(maker.mesh(ball, levels=0, fields={"distance": ts.StoredVolume(stored.name)}), here)
    with pytest.raises(ts.InvalidArgumentError, match="that server's Client"):
        ts.mesh(ball, fields={"distance": client.upload(values)})


class Noting:
    """A client that notes what is uploaded."""

    def __init__(self, client, uploads):
        self._client, self._uploads = client, uploads

    def __getattr__(self, name):
        return getattr(self._client, name)

    def upload(self, volume, options):
        self._uploads.append(volume)
        return self._client.upload(volume, options)


def test_many_threads_bring_a_volume_once(server, client):
    client.mesh(make_ball(16))
    size = server.samples()["tetstream_upload_bytes_total"]
    ball, threads = make_ball(17), 4
    together = threading.Barrier(threads)

    def mesh(_):
        together.wait(running_server.GENEROUS_END)
        return client.mesh(ball)

    with ThreadPoolExecutor(threads) as pool:
        made = list(pool.map(mesh, range(threads)))
    assert server.samples()["tetstream_upload_bytes_total"] < 3 * size
    for one in made:
        assert_same(one, ts.mesh(ball))
