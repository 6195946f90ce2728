"""Solids as expressions, here and on a server."""

import json
import subprocess

import numpy as np
import pytest

import tetstream as ts
from conftest import ROOT, assert_same, fixture_file, make_ball

EVERY_KIND = {
    "sphere": ts.sphere(1),
    "ellipsoid": ts.ellipsoid((1, 2, 1)),
    "box": ts.box((1, 2, 1), rounding=0.1),
    "cylinder": ts.cylinder(1, 2),
    "cone": ts.cone(1, 0, 2),
    "torus": ts.torus(1, 0.4),
    "capsule": ts.capsule(0.5, 1),
    "half_space": ts.sphere(1) & ts.half_space((1, 1, 0), 0.2),
    "gyroid": ts.sphere(1) & ts.gyroid(1, 0.2),
    "schwarz_p": ts.sphere(1) & ts.schwarz_p(1),
    "diamond": ts.sphere(1) & ts.diamond(1, 0.3),
    "offset": ts.box(1).offset(0.2),
    "shell": ts.sphere(1).shell(0.3),
    "repeat": ts.sphere(0.4).repeat((2, 1, 2), (1, 0, 1)),
    "turned": ts.box((1, 2, 3)).rotate(30, axis=(1, 1, 0)).move(y=1),
    "scaled": ts.sphere(1).scale((1, 2, 1)) | ts.box(1).scale(0.5),
    "blended": ts.union(ts.sphere(1), ts.sphere(1, center=(1.2, 0, 0)), smoothing=0.3),
}


def volume_of(solid, **options):
    return ts.mesh(solid, **options).quality().volume


@pytest.mark.parametrize("solid", EVERY_KIND.values(), ids=EVERY_KIND.keys())
def test_is_read_as_it_was_written(solid):
    read = ts.Solid.from_json(solid.to_json())
    assert read.to_json() == solid.to_json()
    assert_same(ts.mesh(read, spacing=0.15), ts.mesh(solid, spacing=0.15))


def test_operators_are_those_of_sets():
    ball, cube = ts.sphere(1), ts.box(1.5)
    both = volume_of(ball & cube, spacing=0.05)
    assert volume_of(ball | cube, spacing=0.05) == pytest.approx(4.18879 + 3.375 - both, rel=0.01)
    assert volume_of(ball - cube, spacing=0.05) == pytest.approx(4.18879 - both, rel=0.03)
    assert_same(ts.mesh(ball + cube, spacing=0.1), ts.mesh(ts.union(cube, ball), spacing=0.1))


def test_a_blend_adds_to_its_parts():
    parts = ts.sphere(1), ts.sphere(1, center=(1.6, 0, 0))
    assert (volume_of(ts.union(*parts, smoothing=0.5), spacing=0.05)
            > volume_of(ts.union(*parts), spacing=0.05) + 0.1)


def test_a_chain_of_operators_is_one_node():
    beads = ts.sphere(0.4)
    for i in range(1, 200):
        beads = beads | ts.sphere(0.4, center=(0.7 * i, 0, 0))
    nodes = json.loads(beads.to_json())["nodes"]
    assert len(nodes) == 200 + 199 + 1 and len(nodes[-1]["union"]["of"]) == 200
    assert ts.mesh(beads, spacing=0.2).statistics.boundary.components == 1
    less = ts.box(4) - ts.sphere(1) - ts.sphere(2)
    assert json.loads(less.to_json())["nodes"][-1]["difference"]["of"] == ["n0", "n1", "n2"]
    kept = ts.box(4) - (ts.box(2) - ts.sphere(1))
    assert volume_of(kept, spacing=0.1) == pytest.approx(64 - 8 + 4.18879 * 1, rel=0.02)


def test_a_part_that_is_used_twice_is_written_once():
    pin = ts.cylinder(0.1, 1)
    pair = pin | pin.move(x=1)
    assert json.dumps(json.loads(pair.to_json())).count('"cylinder"') == 1
    assert repr(pair) == "<tetstream.Solid: union of 2 parts>"


def test_volumes_are_solids(ball, mesh, client):
    bored = ball - ts.cylinder(0.3, 3)
    here = ts.mesh(bored, spacing=0.1)
    assert here.quality().volume < mesh.quality().volume - 0.4
    assert here.statistics.boundary.euler_characteristic == 0
    assert_same(client.mesh(bored, spacing=0.1), here)
    assert_same(ts.mesh(ts.cylinder(0.3, 3) | ball, spacing=0.1), ts.mesh(ts.union(ts.cylinder(0.3, 3), ball),
                                                                       spacing=0.1))


def test_grids_of_files_are_solids(client, tmp_path, monkeypatch):
    monkeypatch.chdir(fixture_file("sphere", 0.1, tmp_path / "ball.vdb").parent)
    solid = ts.grid("ball.vdb", "sphere") - ts.box(1)
    here = ts.mesh(solid, spacing=0.1)
    assert_same(client.mesh(solid, spacing=0.1), here)
    stored = client.upload_file("ball.vdb")
    assert_same(client.mesh(ts.grid(stored, "sphere") - ts.box(1), spacing=0.1), here)
    again = ts.Solid.from_json((ts.grid(stored, "sphere") - ts.box(1)).to_json())
    assert_same(client.mesh(again, spacing=0.1), here)
    with pytest.raises(ts.InvalidArgumentError, match="that server's Client"):
        ts.mesh(again)


def test_a_scene_file_names_the_files_of_this_process_by_their_paths(client, tmp_path):
    path = fixture_file("sphere", 0.1, tmp_path / "ball.vdb")
    here = ts.Client(":local:")
    stored = here.upload_file(path)
    for file in (stored, ts.StoredVolume(stored.name)):  # and one that was kept as text
        solid = ts.grid(file, "sphere") - ts.box(1)
        text = solid.to_json()
        assert json.loads(text)["nodes"][0]["grid"]["name"] == str(path)
        for maker in (ts, client):
            assert_same(maker.mesh(ts.Solid.from_json(text), spacing=0.1), here.mesh(solid, spacing=0.1))
    uploaded = here.upload(make_ball(4))
    for volume in (uploaded, ts.StoredVolume(uploaded.name)):
        with pytest.raises(ts.InvalidArgumentError, match="write_vdb"):
            ts.grid(volume).to_json()


@pytest.mark.parametrize("options", [{}, {"faces": True, "improve": True}, {"levels": 0, "fields": True}])
def test_a_server_makes_the_mesh_that_is_made_here(client, options, ball):
    if options.get("fields"):
        options = {**options, "fields": {"distance": ball}}
    part = ts.box((2, 2, 1), rounding=0.1) - ts.cylinder(0.4, 2)
    here = ts.mesh(part, spacing=0.08, **options)
    assert_same(client.mesh(part, spacing=0.08, **options), here)
    assert client.estimate(part, spacing=0.08).tet_count == ts.estimate(part, spacing=0.08).tet_count


def test_scene_files_are_read_and_written(tmp_path):
    file = ROOT / "docs/scenes/bracket.json"
    bracket = ts.read_scene(file)
    again = tmp_path / "again.json"
    again.write_text(bracket.to_json())
    assert_same(ts.mesh(ts.read_scene(again), spacing=0.2), ts.mesh(bracket, spacing=0.2))
    import running_server
    subprocess.run([running_server.binaries() / "tetstream", "mesh", again, "-o", tmp_path / "again.vtu",
                    "--spacing", "0.2"], check=True, stdout=subprocess.DEVNULL)


def test_grids_of_a_scene_file_are_beside_it(tmp_path):
    fixture_file("sphere", 0.2, tmp_path / "ball.vdb")
    (tmp_path / "scene.json").write_text('{"nodes": [{"grid": {"name": "ball.vdb"}}]}')
    assert ts.mesh(ts.read_scene(tmp_path / "scene.json"), spacing=0.2).header.tet_count > 100


def test_says_what_cannot_be(client):
    for maker in (ts, client):
        with pytest.raises(ts.InvalidArgumentError) as refused:
            maker.mesh(ts.torus(1, 0.2) | ts.sphere(-1))
        assert str(refused.value).startswith("scene.nodes[1].sphere.radius -1 is not from 1e-15")
        with pytest.raises(ts.Error, match="end"):
            maker.mesh(ts.gyroid(1), spacing=0.2)
    with pytest.raises(ts.InvalidArgumentError, match="size has 2 coordinates"):
        ts.box((1, 2))
    with pytest.raises(ts.InvalidArgumentError, match="not a scene"):
        ts.Solid.from_json('{"nodes": [{"union": {"of": ["nobody"]}}]}')
    with pytest.raises(ts.InvalidArgumentError, match="no parts"):
        ts.union()
    with pytest.raises(ts.InvalidArgumentError, match="write_vdb"):
        ts.grid(make_ball(4)).to_json()
    with pytest.raises(TypeError, match="solid or a Volume"):
        ts.sphere(1) | 3


def test_sends_a_scenes_volume_once(server, client, ball):
    bored = ball - ts.cylinder(0.3, 3)
    client.mesh(bored, spacing=0.2)
    brought = server.samples()["tetstream_upload_bytes_total"]
    client.mesh(bored | ts.sphere(0.2, center=(2, 0, 0)), spacing=0.2)
    assert server.samples()["tetstream_upload_bytes_total"] == brought > 0


def test_arrays_may_lie_along_other_axes(ball):
    values = np.random.default_rng(7).normal(size=(9, 10, 11)).astype(np.float32)
    given = {"spacing": 0.5, "origin": (1, 2, 3), "background": 3}
    plain = ts.mesh(ts.Volume.from_array(values, **given))
    turned = ts.Volume.from_array(values.transpose(2, 1, 0), axes="zyx", **given)
    assert_same(ts.mesh(turned), plain)
    given["origin"] = (1 + 0.5 * 8, 2, 3)
    assert_same(ts.mesh(ts.Volume.from_array(values[::-1], axes=("-x", "y", "z"), **given)), plain)
    with pytest.raises(ts.InvalidArgumentError, match="axes 'xyy'"):
        ts.Volume.from_array(values, axes="xyy", **given)


def test_sizes_are_numbers_of_numpy_too():
    assert ts.box(np.int64(2)).scale(np.float32(1.5)).to_json() == ts.box(2).scale(1.5).to_json()
