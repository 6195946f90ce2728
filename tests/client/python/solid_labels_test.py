"""Level sets and unions of solids as labels of one mesh, in this process and by a server."""

import numpy as np
import pytest

import tetstream as ts
from conftest import assert_same, distances, fixture_file


def ball_at(x):
    values, place = distances(12)
    origin = np.add(place["origin"], (x, 0, 0))
    return ts.Volume.from_array(values, spacing=place["spacing"], origin=origin)


def volume_of(mesh, value):
    a, b, c, d = (mesh.points[mesh.tets[mesh.label_values == value][:, i]] for i in range(4))
    return np.einsum("ij,ij->", np.cross(b - a, c - a), d - a) / 6


def longest_edge(mesh, value):
    corners = mesh.points[mesh.tets[mesh.label_values == value]]
    return np.linalg.norm(corners[:, :, None] - corners[:, None, :], axis=3).max()


def test_level_sets_that_overlap_meet_half_way():
    drops = ts.Labels.from_level_sets([ball_at(0), ball_at(1.5)])
    assert drops.counts == {1: 0, 2: 0}
    mesh = ts.mesh(drops, label_names={1: "water", 2: "oil"}, faces=True)
    cap = np.pi * 0.25**2 * 2.75 / 3
    for value in (1, 2):
        assert volume_of(mesh, value) == pytest.approx(4 / 3 * np.pi - cap, rel=0.02)
    middle = mesh.points[np.unique(mesh.faces_of("water_oil"))]
    assert abs(middle[:, 0] - 0.75).max() < 0.06


def test_parts_of_a_union_are_labels_of_which_the_first_is_whole():
    planet = ts.sphere(0.5) | ts.sphere(0.8) | ts.sphere(1)
    mesh = ts.mesh(planet, spacing=0.05, labels="all", label_names={1: "core"})
    assert [label.value for label in mesh.header.labels] == [1, 2, 3]
    assert mesh.header.labels[0].name == "core"
    for value, (inner, outer) in {1: (0, 0.5), 2: (0.5, 0.8), 3: (0.8, 1)}.items():
        assert volume_of(mesh, value) == pytest.approx(4 / 3 * np.pi * (outer**3 - inner**3), rel=0.01)


def test_sizes_hold_within_labels():
    planet = ts.sphere(0.6) | ts.sphere(1.3)
    plain = ts.mesh(planet, spacing=0.05, labels="all", levels=24)
    sized = ts.mesh(planet, spacing=0.05, labels="all", label_sizes={1: 0.05, (2, 3): 0.11})
    assert longest_edge(plain, 1) > 0.15 and longest_edge(plain, 2) > 0.2
    # Where labels meet, nodes move by up to a quarter of the smallest edge.
    assert longest_edge(sized, 1) < 1.25 * 0.05 and longest_edge(sized, 2) < 0.1001
    everywhere = ts.estimate(planet, spacing=0.05, labels="all", label_sizes={"all": 0.05})
    assert everywhere.tet_count > len(sized.tets)


def test_refusals_name_the_option():
    ball = ts.sphere(1)
    with pytest.raises(ts.InvalidArgumentError, match="below the spacing"):
        ts.mesh(ball, spacing=0.1, labels="all", label_sizes={1: 0.01})
    with pytest.raises(ts.InvalidArgumentError, match="the scene has no such label"):
        ts.mesh(ball, spacing=0.1, labels=7)
    with pytest.raises(ts.InvalidArgumentError, match="smooth"):
        ts.mesh(ball, spacing=0.1, smooth=1)
    with pytest.raises(ts.InvalidArgumentError, match="smoothing"):
        ts.mesh(ts.union(ball, ts.sphere(2), smoothing=0.1), spacing=0.1, labels="all")
    with pytest.raises(ts.InvalidArgumentError, match="0 level sets"):
        ts.Labels.from_level_sets([])


def test_a_server_makes_the_same(client, tmp_path):
    planet = ts.sphere(0.5) | ts.sphere(1)
    options = {"labels": "all", "background": "meshed", "label_sizes": {"all": 0.2}}
    assert_same(client.mesh(planet, spacing=0.1, **options), ts.mesh(planet, spacing=0.1, **options))
    path = tmp_path / "parts.vdb"
    fixture_file("parts", 0.1, path)
    names = ("ring", "ball")
    stored = client.upload_file(path)
    here = ts.mesh(ts.Labels.from_level_sets([ts.Volume.from_vdb(path, name) for name in names]), **options)
    assert_same(client.mesh(ts.StoredVolume(stored.name, grids=names), **options), here)
