"""What is said of points, here and by a server."""

import numpy as np
import pytest

import tetstream as ts
from conftest import distances


def some_points(count=30_000):
    return np.random.default_rng(4).uniform(-1.4, 1.4, (count, 3))


def values_volume(radius=16):
    values, place = distances(radius)
    return ts.Volume.from_array(np.sin(5 * values), kind="values", **place)


def assert_same_samples(one, other):
    for a, b in ((one.phi, other.phi), (one.slopes, other.slopes),
                 *((one.fields[name], other.fields[name]) for name in other.fields)):
        assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    assert one.fields.keys() == other.fields.keys() and one.inside_guess == other.inside_guess


def test_tells_the_distance_and_the_way_out(ball):
    points = some_points(1000)
    points = points[np.linalg.norm(points, axis=1) < 1.1]
    at = ts.sample(ball, points)
    radius = np.linalg.norm(points, axis=1)
    np.testing.assert_allclose(at.phi, radius - 1, atol=0.02)
    far = radius > 0.3
    np.testing.assert_allclose(at.slopes[far], points[far] / radius[far, None], atol=0.2)


def test_tells_the_same_bytes_on_a_server(client, ball):
    points, heat = some_points(), values_volume()
    told = []
    there = client.sample(ball, points, fields={"heat": heat}, progress=told.append)
    assert_same_samples(there, ts.sample(ball, points, fields={"heat": heat}))
    assert told[-1] == 1 and told == sorted(told)
    part = ts.sphere(1) - ts.box(1) - ts.grid(ball).move(x=1.5)
    assert_same_samples(client.sample(part, points), ts.sample(part, points))


def test_tells_of_a_mesh_s_own_vertices(mesh, ball):
    at = ts.sample(ball, mesh.points)
    assert (at.phi < 0.02).all() and (abs(at.phi) < 0.02).sum() > 1000


def test_needs_no_points(client, ball):
    for call in (ts.sample, client.sample):
        none = call(ball, np.empty((0, 3)), fields={"heat": values_volume()})
        assert none.phi.shape == (0,) and none.slopes.shape == (0, 3) and none.fields["heat"].shape == (0,)


@pytest.mark.parametrize("points, said", [
    ([(0, 0, np.nan)], "point 0 .* is not finite"),
    ([(0, 0, 0), (np.inf, 0, 0)], "point 1 .* is not finite"),
    ([(1e300, 0, 0)], "farther than"),
    ([0, 0, 0], r"\(n, 3\)"),
    ([(0, 0)], r"\(n, 3\)"),
])
def test_refuses_what_is_no_place(client, ball, points, said):
    for call in (ts.sample, client.sample):
        with pytest.raises(ts.InvalidArgumentError, match=said):
            call(ball, points)


def test_refuses_labels(client):
    labels = ts.Labels.from_array(np.ones((3, 3, 3), np.uint8))
    for call in (ts.sample, client.sample):
        with pytest.raises(ts.InvalidArgumentError, match="labels have no distances"):
            call(labels, [(0, 0, 0)])


def test_is_stopped_by_what_progress_raises(client):
    def stop(fraction):
        raise RuntimeError("enough")
    for call in (ts.sample, client.sample):
        with pytest.raises(RuntimeError, match="enough"):
            call(ts.sphere(1), some_points(300_000), progress=stop)
