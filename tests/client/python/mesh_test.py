"""Meshes that are made in this process."""

import gc
import pickle
import sys
import threading

import numpy as np
import pytest

import tetstream as ts
from conftest import assert_same, distances, fixture_file, make_ball

TETRAHEDRON = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def volumes_of(mesh):
    a, b, c, d = (mesh.points[mesh.tets[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def test_meshes_an_array(mesh):
    assert mesh.points.shape == (mesh.header.vertex_count, 3)
    assert mesh.tets.shape == (mesh.header.tet_count, 4)
    assert np.linalg.norm(mesh.points, axis=1).max() < 1.01
    assert (volumes_of(mesh) > 0).all()
    assert volumes_of(mesh).sum() == pytest.approx(4 / 3 * np.pi, rel=0.01)


def test_tells_what_it_knows_of_a_mesh(mesh):
    quality = mesh.quality()
    assert quality.volume == pytest.approx(volumes_of(mesh).sum())
    assert 11.2 < quality.min_dihedral_deg < quality.max_dihedral_deg < 154.8
    assert quality.histogram.sum() == 6 * mesh.header.tet_count
    assert mesh.statistics.boundary.euler_characteristic == 2
    assert mesh.statistics.improvement is None
    low, high = np.array(mesh.header.bounds)
    assert (mesh.points >= low).all() and (mesh.points <= high).all()
    assert f"{mesh.header.tet_count:,} tets" in repr(mesh)


@pytest.mark.parametrize("change", [
    np.asfortranarray,
    np.float32,
    lambda values: np.repeat(values, 2, axis=1)[:, ::2],
    np.ndarray.tolist,
], ids=["fortran", "float32", "strided", "lists"])
def test_takes_an_array_however_it_lies_in_memory(mesh, change):
    values, place = distances()
    assert_same(ts.mesh(ts.Volume.from_array(change(values), **place)), mesh)


def test_points_are_world_coordinates_computed_once():
    values, place = distances()
    volume = ts.Volume.from_array(values, **place | {"origin": (1e6, -7, 0.125)})
    made = ts.mesh(volume)
    assert made.local_points.dtype == np.float32
    assert np.array_equal(made.points, made.local_points.astype(np.float64) + np.array(made.header.origin))
    assert made.points is made.points
    assert np.abs(made.points.mean(axis=0) - (1e6 + 1.25, -7 + 1.25, 0.125 + 1.25)).max() < 0.01


@pytest.mark.parametrize("name", ["local_points", "tets", "regions", "_field_rows"])
def test_arrays_are_read_only_views_without_a_copy(ball, name):
    made = ts.mesh(ball, preset="both_sides", box=((-1.5,) * 3, (1.5,) * 3), fields={"distance": ball})
    array = getattr(made, name)
    again = getattr(made._mesh, {"local_points": "points", "_field_rows": "field_rows"}.get(name, name))
    assert array is not again and np.shares_memory(array, again)
    assert array.base is made._mesh
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 0
    with pytest.raises(ValueError):
        array.setflags(write=True)


def test_points_are_read_only(mesh):
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0] = 0


def test_arrays_outlive_their_mesh(ball):
    made = ts.mesh(ball)
    expected, tets = made.tets.copy(), made.tets[5:]
    del made
    gc.collect()
    others = [ts.mesh(ball, levels=levels) for levels in range(3)]
    assert np.array_equal(tets, expected[5:])
    del others


def test_makes_the_same_bytes_on_any_number_of_threads(ball, mesh):
    for threads in (1, 3):
        assert_same(ts.mesh(ball, threads=threads), mesh)


def test_meshes_a_mask():
    mask = np.zeros((12, 12, 12), dtype=bool)
    mask[2:10, 2:10, 2:10] = True
    made = ts.mesh(ts.Volume.from_mask(mask, spacing=0.5))
    assert made.quality().volume == pytest.approx(4 ** 3, rel=0.07)
    assert made.points.mean(axis=0) == pytest.approx([2.75] * 3, abs=0.05)


def test_meshes_a_density():
    values, place = distances()
    made = ts.mesh(ts.Volume.from_density(-values, **place), iso=0)
    assert made.quality().volume == pytest.approx(4 / 3 * np.pi, rel=0.01)


def test_meshes_triangles():
    volume = ts.Volume.from_triangles(*TETRAHEDRON, voxel_size=0.05)
    assert (volume.kind, volume.voxel_size) == ("level_set", 0.05)
    assert ts.mesh(volume).quality().volume == pytest.approx(1 / 6, abs=0.01)


def test_meshes_a_surface_file(tmp_path):
    points, triangles = TETRAHEDRON
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    (tmp_path / "solid.obj").write_text("\n".join(lines))
    from_file = ts.Volume.from_surface_file(tmp_path / "solid.obj", voxel_size=0.05)
    assert_same(ts.mesh(from_file), ts.mesh(ts.Volume.from_triangles(points, triangles, voxel_size=0.05)))


@pytest.mark.parametrize("trusted", [False, True])
def test_meshes_a_vdb_file_that_it_wrote(ball, mesh, tmp_path, trusted):
    ball.write_vdb(tmp_path / "ball.vdb")
    assert_same(ts.mesh(ts.Volume.from_vdb(tmp_path / "ball.vdb", trusted=trusted)), mesh)
    assert_same(ts.mesh(tmp_path / "ball.vdb"), mesh)


def test_gives_vertices_the_values_of_fields(tmp_path):
    file = fixture_file("fields", 0.1, tmp_path / "fields.vdb")
    made = ts.mesh(ts.Volume.from_vdb(file, "sphere"), fields={
        "heat": ts.Volume.values_from_vdb(file, "heat"), "flow": ts.Volume.values_from_vdb(file, "velocity")})
    n = made.header.vertex_count
    assert {name: values.shape for name, values in made.fields.items()} == {"heat": (n,), "flow": (n, 3)}
    assert all(np.shares_memory(values, made._field_rows) for values in made.fields.values())
    assert np.ptp(made.fields["heat"]) > 0
    assert "fields heat, flow" in repr(made)


def test_samples_an_array_at_the_vertices(ball):
    values, place = distances()
    x = np.broadcast_to(np.arange(values.shape[0])[:, None, None] * place["spacing"] + place["origin"][0],
                        values.shape)
    made = ts.mesh(ball, fields={"x": ts.Volume.from_array(x, kind="values", **place)})
    assert made.fields["x"] == pytest.approx(made.points[:, 0], abs=1e-5)


def test_meshes_both_sides(ball):
    made = ts.mesh(ball, preset="both_sides", box=((-1.5,) * 3, (1.5,) * 3))
    inside = made.regions == 1
    assert set(np.unique(made.regions)) == {1, 2}
    assert volumes_of(made)[inside].sum() == pytest.approx(4 / 3 * np.pi, rel=0.01)


def test_asks_for_what_the_options_say(ball, mesh):
    assert ts.mesh(ball, spacing=0.125).header.spacing == 0.125
    assert ts.mesh(ball, levels=0).header.levels == 0
    assert ts.mesh(ball, iso=-0.25).quality().volume == pytest.approx(4 / 3 * np.pi * 0.75 ** 3, rel=0.02)
    assert ts.mesh(ball, coordinates="float64").local_points.dtype == np.float64
    assert ts.mesh(ball, sizing={"coarsest": 0.0625}).header.tet_count > mesh.header.tet_count
    assert_same(ts.mesh(ball, sizing='{"coarsest": 0.1}'), ts.mesh(ball, sizing={"coarsest": 0.1}))
    lowest = ts.mesh(ball, box=((-2, -2, 0), (2, 2, 2))).points[:, 2].min()
    assert -0.5 < lowest <= 0  # the box grows to whole cells
    assert ts.mesh(ball, preset="min_angle").quality().min_dihedral_deg > 11.7
    better = ts.mesh(ball, improve=True)
    assert better.quality().min_dihedral_deg > better.statistics.improvement.min_dihedral_before_deg


def test_measures_the_quality_that_nobody_has_told(ball, mesh):
    made = ts.mesh(ball, statistics=False)
    assert made.statistics.quality is None
    told, measured = mesh.quality(), made.quality()
    for name in ("min_dihedral_deg", "max_dihedral_deg", "volume"):
        assert getattr(measured, name) == pytest.approx(getattr(told, name), rel=1e-5)
    assert measured.histogram.sum() == told.histogram.sum() == 6 * len(made.tets)
    # By tens that have 45, 60, 90 and 120 degrees in their middles: many angles are just these.
    tens = [np.asarray(one.histogram, int)[3:173].reshape(17, 10).sum(axis=1) for one in (measured, told)]
    assert np.abs(tens[0] - tens[1]).max() < 10


def test_estimates_what_it_makes(ball, mesh):
    counted = ts.estimate(ball)
    assert (counted.vertex_count, counted.tet_count) == (mesh.header.vertex_count, mesh.header.tet_count)
    assert counted.bytes >= mesh.local_points.nbytes + mesh.tets.nbytes


REFUSED = {
    "flat": (lambda: ts.Volume.from_array(np.zeros((3, 4)), spacing=1), r"shape \(3, 4\)"),
    "booleans": (lambda: ts.Volume.from_array(np.zeros((2, 2, 2), bool), spacing=1), "from_mask"),
    "no booleans": (lambda: ts.Volume.from_mask(np.zeros((2, 2, 2)), spacing=1), "float64"),
    "spacing": (lambda: ts.Volume.from_array(np.zeros((2, 2, 2)), spacing=0), "spacing 0 is not positive"),
    "spacings": (lambda: ts.Volume.from_array(np.zeros((2, 2, 2)), spacing=(1, 1, 2)), "resample"),
    "origin": (lambda: ts.Volume.from_array(np.zeros((2, 2, 2)), spacing=1, origin=(0, 0)), "2 coordinates"),
    "kind": (lambda: ts.Volume.from_array(np.zeros((2, 2, 2)), spacing=1, kind="fog"), "'level_set', 'density'"),
    "no vertex": (lambda: ts.Volume.from_triangles([[0, 0, 0]], [[0, 0, 1]], voxel_size=1), "vertex 1"),
    "below zero": (lambda: ts.Volume.from_triangles([[0, 0, 0]], [[0, 0, -1]], voxel_size=1), "vertex -1"),
    "pairs": (lambda: ts.Volume.from_triangles([[0, 0]], [[0, 0, 0]], voxel_size=1), r"points have the shape \(1, 2\)"),
    "preset": (lambda: ts.mesh(make_ball(4), preset="best"), "'best' is none of 'default', 'min_angle'"),
    "request": (lambda: ts.mesh(make_ball(4), spacing=-1), "spacing -1 is not a positive number"),
    "sizing": (lambda: ts.mesh(make_ball(4), sizing={"growth": "a lot"}), "^sizing:"),
    "timeout": (lambda: ts.mesh(make_ball(4), timeout=-1), "timeout -1"),
    "ending": (lambda: ts.mesh(make_ball(4)).write("ball.med"), "med"),
}


@pytest.mark.parametrize("call, text", REFUSED.values(), ids=REFUSED.keys())
def test_refuses_in_words(call, text):
    with pytest.raises(ts.InvalidArgumentError, match=text) as raised:
        call()
    assert isinstance(raised.value, ValueError)
    assert raised.value.code is ts.StatusCode.INVALID_ARGUMENT


def test_errors_say_of_what_kind_they_are(tmp_path, ball):
    with pytest.raises(ts.NotFoundError) as raised:
        ts.Volume.from_vdb(tmp_path / "nothing.vdb")
    assert "nothing.vdb" in str(raised.value) and raised.value.code is ts.StatusCode.NOT_FOUND
    with pytest.raises(ts.FailedPreconditionError, match="finite"):
        ts.Volume.from_array(np.full((2, 2, 2), np.nan), spacing=1)
    with pytest.raises(ts.FailedPreconditionError):
        ts.mesh(ball, iso=-5)
    with pytest.raises(TimeoutError) as late:
        ts.mesh(ball, timeout=0)
    assert isinstance(late.value, ts.DeadlineExceededError)


def test_errors_travel_between_processes():
    error = pickle.loads(pickle.dumps(ts.DeadlineExceededError("late", ts.StatusCode.DEADLINE_EXCEEDED, "WHY")))
    assert (str(error), error.code, error.reason) == ("late", ts.StatusCode.DEADLINE_EXCEEDED, "WHY")


def test_tells_progress_that_only_grows(ball):
    told = []
    ts.mesh(ball, progress=told.append)
    assert told == sorted(set(told)) and told[-1] == 1


def test_what_progress_raises_stops_the_work():
    class Enough(Exception):
        pass

    def give_up(fraction):
        raise Enough

    with pytest.raises(Enough):
        ts.mesh(make_ball(40), levels=0, spacing=1 / 160, progress=give_up)


def test_runs_beside_other_threads(ball, mesh):
    made = []
    threads = [threading.Thread(target=lambda: made.append(ts.mesh(ball))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 4
    for one in made:
        assert_same(one, mesh)


def test_writes_the_mesh_that_it_hands_to_meshio(tmp_path, ball):
    meshio = pytest.importorskip("meshio")
    made = ts.mesh(ball, preset="both_sides", box=((-1.5,) * 3, (1.5,) * 3), fields={"distance": ball})
    made.write(tmp_path / "ball.vtu")
    read, handed = meshio.read(tmp_path / "ball.vtu"), made.to_meshio()
    assert np.array_equal(handed.cells_dict["tetra"], read.cells_dict["tetra"])
    assert handed.points == pytest.approx(read.points, abs=1e-6)
    assert np.array_equal(handed.point_data["distance"], read.point_data["distance"])
    assert np.array_equal(handed.cell_data_dict["region"]["tetra"], read.cell_data_dict["region"]["tetra"])


def test_writes_a_format_that_is_named(tmp_path, mesh):
    mesh.write(tmp_path / "mesh.inp")
    mesh.write(tmp_path / "deck", format="inp")
    assert (tmp_path / "deck").read_bytes() == (tmp_path / "mesh.inp").read_bytes()
    with pytest.raises(ts.InvalidArgumentError, match="no mesh format med"):
        mesh.write(tmp_path / "mesh.inp", format="med")


def test_hands_the_mesh_to_pyvista(mesh):
    pyvista = pytest.importorskip("pyvista")
    grid = mesh.to_pyvista()
    assert isinstance(grid, pyvista.UnstructuredGrid)
    assert grid.n_cells == mesh.header.tet_count
    assert grid.volume == pytest.approx(mesh.quality().volume)


@pytest.mark.parametrize("name", ["meshio", "pyvista"])
def test_says_which_package_is_missing(mesh, name, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match=f"pip install {name}"):
        getattr(mesh, f"to_{name}")()


def resident_bytes():
    with open("/proc/self/status", encoding="utf-8") as status:
        return next(int(line.split()[1]) << 10 for line in status if line.startswith("VmRSS"))


def test_keeps_nothing_of_meshes_that_are_gone():
    volume = make_ball(6)

    def make(count):
        for _ in range(count):
            made = ts.mesh(volume, threads=1, fields={"x": volume}, progress=lambda fraction: None)
            made.points, made.fields["x"], made.statistics
        return made.local_points.nbytes + made.tets.nbytes + made.points.nbytes

    make(200)
    gc.collect()
    before, objects = resident_bytes(), len(gc.get_objects())
    size = make(1000)
    gc.collect()
    assert len(gc.get_objects()) - objects < 200
    assert resident_bytes() - before < 1000 * size / 4, f"each mesh has {size} bytes"


def test_has_faces_as_views_where_they_are_asked_for(mesh):
    assert mesh.faces is mesh.face_tets is mesh.face_labels is None and mesh.header.face_labels == ()
    values, place = distances()
    made = ts.mesh(ts.Volume.from_array(values, **place), faces=True)
    assert made.header.face_labels == (ts.FaceLabel("surface", "surface", 0),)
    assert made.faces.shape == (made.header.face_count, 3) and made.faces.dtype == made.tets.dtype
    assert not made.faces.flags.writeable and not made.faces.flags.owndata
    assert made.face_labels.dtype == np.uint16 and (made.face_labels == 0).all()
    of_tets = made.tets[made.face_tets]
    assert (made.faces[:, :, None] == of_tets[:, None, :]).any(axis=2).all()
    assert np.array_equal(made.faces_of("surface"), made.faces)
    a, b, c = (made.points[made.faces[:, i]] for i in range(3))
    assert np.einsum("ij,ij->", np.cross(a, b), c) / 6 == pytest.approx(volumes_of(made).sum())
    with pytest.raises(ts.InvalidArgumentError, match="no faces are named 'rim'; there are surface"):
        made.faces_of("rim")
    with pytest.raises(ts.InvalidArgumentError, match="mesh with faces=True"):
        mesh.faces_of("surface")


def test_names_regions_of_the_surface(mesh):
    values, place = distances()
    volume = ts.Volume.from_array(values, **place)
    top = {"facing": {"direction": [0, 0, 1], "angle_deg": 40}}
    made = ts.mesh(volume, face_regions={"top": top, "ends": [
        {"half_space": {"normal": [1, 0, 0], "offset": -0.4}}, {"half_space": {"normal": [-1, 0, 0], "offset": -0.4}}]})
    assert [(label.name, label.kind) for label in made.header.face_labels] == [
        ("surface", "surface"), ("top", "region"), ("ends", "region")]
    middles = made.points[made.faces].mean(axis=1)
    named = made.face_labels == 2
    assert named.any() and (abs(middles[named, 0]) > 0.4 - 1e-5).all()
    a, b, c = (made.points[made.faces_of("top")[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    assert (normals[:, 2] >= np.linalg.norm(normals, axis=1) * np.cos(np.radians(40)) - 1e-6).all()
    assert made.statistics.empty_face_regions == ()
    as_list = ts.mesh(volume, face_regions=[{"name": "top", **top}])
    assert (as_list.face_labels == 1).sum() == (made.face_labels == 1).sum()
    with pytest.warns(UserWarning, match="no face is in region 'far'"):
        far = ts.mesh(volume, face_regions={"far": {"ball": {"centre": [9, 9, 9], "radius": 1}}})
    assert far.statistics.empty_face_regions == ("far",)
    divided = ts.mesh(volume, face_regions={"top": top, "side": {"creases": {"angle_deg": 70}}})
    # The top's border is ragged, and single faces along it are too few to be a patch.
    assert [label.name for label in divided.header.face_labels] == ["surface", "top", "side.1", "side"]
    assert 100 * len(divided.faces_of("side")) < len(divided.faces_of("side.1"))
    assert sum(len(divided.faces_of(name)) for name in ("top", "side.1", "side")) == divided.header.face_count
    with pytest.raises(ts.InvalidArgumentError, match=r"face_regions\[0\].ball.radius 0"):
        ts.mesh(volume, face_regions={"far": {"ball": {"centre": [9, 9, 9]}}})
    with pytest.raises(ts.InvalidArgumentError, match="not a list of face regions"):
        ts.mesh(volume, face_regions="[")


def test_a_guess_of_the_inside_is_told(tmp_path, client):
    fixture_file("raw-density", 0.1, tmp_path / "density.vdb")
    guess = ts.mesh(tmp_path / "density.vdb").header.inside_guess
    assert "density" in guess
    assert client.mesh(tmp_path / "density.vdb").header.inside_guess == guess
    assert ts.stream(tmp_path / "density.vdb").header.inside_guess == guess
    assert ts.mesh(tmp_path / "density.vdb", inside="above", iso=0.5).header.inside_guess == ""
