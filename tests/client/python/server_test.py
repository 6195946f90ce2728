"""Meshes that a server makes."""

import dataclasses
import threading

import pytest

import running_server
import tetstream as ts
from conftest import assert_same, fixture_file, make_ball
from stream_test import OPTIONS, Gathered


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS.keys())
def test_makes_the_mesh_that_is_made_here(client, options):
    ball = make_ball(33)
    here, there = ts.mesh(ball, **options), client.mesh(ball, **options)
    assert_same(there, here)
    assert there.header.id and not here.header.id
    assert there.statistics == here.statistics
    assert_same(Gathered(client.stream(ball, **options)), here)


@pytest.mark.parametrize("encoding", ["plain", "packed", "compact"])
def test_is_the_same_in_every_encoding(client, ball, mesh, encoding):
    assert_same(client.mesh(ball, encoding=encoding), mesh)
    assert_same(Gathered(client.stream(ball, encoding=encoding)), mesh)


@pytest.mark.parametrize("encoding", ["plain", "compact"])
def test_tells_the_same_fidelity_as_here(client, ball, encoding):
    here = ts.mesh(ball, fidelity=True)
    there = client.mesh(ball, fidelity=True, encoding=encoding)
    (fidelity,) = here.statistics.fidelity
    assert 0 < fidelity.hausdorff < 0.1 * fidelity.spacing
    assert abs(fidelity.enclosed_volume - 4.18879) < 0.02
    assert there.statistics.fidelity == here.statistics.fidelity
    assert there.statistics.shapes == here.statistics.shapes
    assert here.statistics.shapes.scaled_jacobian.histogram.sum() == len(here.tets)
    assert (there.statistics.shapes.edge_ratio.histogram == here.statistics.shapes.edge_ratio.histogram).all()
    assert here.faces is not None
    assert client.mesh(ball, encoding=encoding).statistics.shapes is None


def test_is_sent_a_volume_once(server, client, ball):
    client.mesh(ball)
    brought = server.samples()["tetstream_upload_bytes_total"]
    client.mesh(ball, levels=0)
    client.estimate(ball)
    assert server.samples()["tetstream_upload_bytes_total"] == brought > 0


def test_takes_files(client, tmp_path):
    file = fixture_file("sphere", 0.1, tmp_path / "sphere.vdb")
    told = []
    stored = client.upload_file(file, progress=told.append)
    assert told[-1] == 1 and stored.name.startswith("grids/")
    here = ts.mesh(file)
    assert_same(client.mesh(file), here)
    assert_same(client.mesh(ts.StoredVolume(stored.name)), here)
    assert client.estimate(stored).tet_count == here.header.tet_count
    with pytest.raises(ts.InvalidArgumentError, match="that server's Client"):
        ts.mesh(stored)


def test_the_same_calls_need_no_server(ball, mesh, tmp_path):
    with ts.Client(":local:") as here:
        here.check_health()
        assert here.capabilities().server_version == ts.version()
        assert_same(here.mesh(here.upload(ball)), mesh)
        ball.write_vdb(tmp_path / "ball.vdb")
        stored = here.upload_file(tmp_path / "ball.vdb")
        assert_same(here.mesh(stored), mesh)
        assert here.estimate(stored) == ts.estimate(ball) or here.estimate(stored).tet_count == mesh.header.tet_count
    with pytest.raises(ts.CancelledError, match="closed"):
        here.mesh(ball)
    assert repr(here) == "tetstream.Client(':local:')"


@pytest.mark.parametrize("served", [False, True])
def test_a_file_of_several_level_sets_is_stored(client, tmp_path, served):
    """Which of them are meshed is said afterwards, also by the name alone."""
    taken, path, names = client if served else ts.Client(":local:"), tmp_path / "parts.vdb", ("ring", "ball")
    fixture_file("parts", 0.1, path)
    stored = taken.upload_file(path)
    grids = {name: ts.Volume.from_vdb(path, name) for name in names}
    parts = ts.mesh(ts.Labels.from_level_sets(list(grids.values())))
    assert_same(taken.mesh(ts.StoredVolume(stored.name, grids=names)), parts)
    for name in names:
        assert_same(taken.mesh(ts.StoredVolume(stored.name, name)), ts.mesh(grids[name]))
    with pytest.raises(ts.FailedPreconditionError):
        taken.mesh(stored)  # which of them?
    with pytest.raises(ts.NotFoundError):
        taken.upload_file(tmp_path / "none.vdb")
    (tmp_path / "no.vdb").write_text("no grids")
    with pytest.raises(ts.InvalidArgumentError):
        taken.mesh(taken.upload_file(tmp_path / "no.vdb"))


@pytest.mark.parametrize("served", [False, True])
def test_which_grid_of_a_file_is_meant_is_said_afterwards(client, ball, tmp_path, served):
    """That one of them can be meshed says nothing of which has the values of a field."""
    taken, path = client if served else ts.Client(":local:"), tmp_path / "flow.vdb"
    fixture_file("flow", 0.1, path)
    stored = taken.upload_file(path)
    with pytest.raises(ts.FailedPreconditionError):
        taken.mesh(ball, fields={"flow": stored})
    flow = dataclasses.replace(stored, grid="velocity")
    made = taken.mesh(ball, fields={"flow": flow})
    values = ts.Volume.values_from_vdb(path, "velocity")
    assert_same(made, ts.mesh(ball, fields={"flow": values}))
    assert made.fields["flow"].shape == (made.header.vertex_count, 3)
    for meshed in (flow, ts.grid(flow)):
        with pytest.raises(ts.FailedPreconditionError):
            taken.mesh(meshed, spacing=0.2)
    assert_same(taken.mesh(dataclasses.replace(stored, grid="sphere")), ts.mesh(ts.Volume.from_vdb(path)))


@pytest.mark.parametrize("served", [False, True])
def test_solids_are_of_the_grids_that_are_named(client, tmp_path, served):
    taken, path = client if served else ts.Client(":local:"), tmp_path / "parts.vdb"
    fixture_file("parts", 0.1, path)
    stored = taken.upload_file(path)
    volumes = {name: ts.Volume.from_vdb(path, name) for name in ("ball", "ring")}
    both = ts.mesh(ts.grid(volumes["ball"]) | ts.grid(volumes["ring"]), spacing=0.2)
    for leaf in (path, stored):
        assert_same(taken.mesh(ts.grid(leaf, "ball") | ts.grid(leaf, "ring"), spacing=0.2), both)
    ring = ts.mesh(ts.grid(volumes["ring"]), spacing=0.2)
    for leaf in (dataclasses.replace(stored, grid="ring"), taken.upload_file(path, "ring")):
        assert_same(taken.mesh(ts.grid(leaf), spacing=0.2), ring)
    assert_same(taken.mesh(ts.grid(taken.upload_file(path, "ball"), "ring"), spacing=0.2), ring)


@pytest.mark.parametrize("served", [False, True])
def test_an_uploaded_volume_has_no_other_grid(client, ball, served):
    taken = client if served else ts.Client(":local:")
    stored = dataclasses.replace(taken.upload(ball), grid="other")
    for request in (ts.Request(stored), ts.Request(ts.grid(stored), spacing=0.2), ts.Request(ball, fields={"other": stored})):
        with pytest.raises(ts.NotFoundError):
            taken.mesh(request)


def test_a_name_of_this_process_is_for_this_process(client, ball):
    kept = ts.StoredVolume(ts.Client(":local:").upload(ball).name)
    with pytest.raises(ts.InvalidArgumentError, match="kept with it"):
        ts.mesh(kept)
    with pytest.raises(ts.InvalidArgumentError, match="is in this process"):
        client.mesh(kept)


def test_tells_what_the_server_says(client):
    client.check_health()
    told = client.capabilities()
    assert told.server_version == ts.version() and told.max_tets > 0 and told.algorithm_version
    with pytest.raises(ts.NotFoundError) as missing:
        client.mesh(ts.StoredVolume("grids/" + 64 * "0"))
    assert missing.value.reason == "GRID_NOT_FOUND"
    with pytest.raises(ts.InvalidArgumentError, match="spacing"):
        client.mesh(make_ball(4), spacing=-1)
    with pytest.raises(ts.DeadlineExceededError):
        client.mesh(client.upload(make_ball(4)), timeout=0)


def test_says_that_nobody_answers():
    address = f"127.0.0.1:{running_server.unused_port()}"
    with pytest.raises(ts.UnavailableError) as nobody:
        ts.Client(address, attempts=1).capabilities()
    assert address in str(nobody.value)


def test_does_not_show_a_token_to_everybody(server):
    with pytest.raises(ts.FailedPreconditionError, match="token"):
        ts.Client("192.0.2.1:443", token="secret")
    with pytest.raises(ts.NotFoundError, match="none.pem"):
        ts.Client(server.address, tls_ca="none.pem")


def work_ends(server):
    running_server.wait_until(lambda: server.samples()["tetstream_meshes_running"] == 0)


def test_lets_the_server_go_when_a_stream_is_left(server, client):
    with client.stream(make_ball(40), levels=0) as stream:
        next(stream)
        assert server.samples()["tetstream_meshes_running"] == 1
    work_ends(server)


def test_lets_the_server_go_when_another_thread_closes_the_stream(server, client):
    stream = client.stream(make_ball(40), levels=0)
    next(stream)
    closing = threading.Thread(target=stream.close)
    closing.start()
    with pytest.raises(ts.CancelledError):
        for _ in stream:
            closing.join()
    work_ends(server)


def test_goes_on_where_it_was_when_the_server_comes_back(tmp_path):
    address = f"127.0.0.1:{running_server.unused_port()}"
    ball, here = make_ball(40), None
    with running_server.RunningServer(tmp_path / "store", listen=address) as first:
        stream = ts.Client(address).stream(ball, levels=0)
        chunks = [next(stream)]
        assert first.samples()["tetstream_meshes_running"] == 1
        first.kill()
    with running_server.RunningServer(tmp_path / "store", listen=address) as second:
        whole = Gathered(Resumed(stream, chunks))
        assert second.samples()["tetstream_sent_chunks_total"] > 0
    here = ts.mesh(ball, levels=0)
    assert_same(whole, here)
    assert stream.statistics.quality is None  # of a part it would be another one
    assert stream.statistics.boundary == here.statistics.boundary


class Resumed:
    """A stream with the chunks that came before."""

    def __init__(self, stream, before):
        self.header, self._stream, self._before = stream.header, stream, before

    def __iter__(self):
        return iter([*self._before, *self._stream])


def test_sends_a_volume_again_that_the_server_has_lost(tmp_path, ball, mesh):
    address = f"127.0.0.1:{running_server.unused_port()}"
    client = ts.Client(address)
    for store in ("one", "two"):
        with running_server.RunningServer(tmp_path / store, listen=address):
            assert_same(client.mesh(ball), mesh)


@pytest.mark.parametrize("begin", [ts.Client.session, ts.Client.stable_session])
def test_a_session_sends_a_volume_again_that_the_server_has_lost(tmp_path, ball, begin):
    address = f"127.0.0.1:{running_server.unused_port()}"
    client, solid = ts.Client(address), ts.grid(ball) | ts.sphere(1, center=(1, 0, 0))
    for store in ("one", "two"):
        with running_server.RunningServer(tmp_path / store, listen=address):
            client.check_health()  # by a connection of its own
            with begin(client, solid, spacing=0.2) as session:
                assert session.mesh.header.tet_count == ts.estimate(solid, spacing=0.2).tet_count
