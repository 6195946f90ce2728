"""Segmentations, meshed in this process and by a server."""

import numpy as np
import pytest

import tetstream as ts
from conftest import assert_same

EDGE = 20


def bone(dtype=np.int16):
    """Marrow (7) within bone (4), and a cap (1000) on top."""
    x, y, z = np.indices((EDGE, EDGE, EDGE)) - 9.5
    r = np.sqrt(x * x + y * y + z * z)
    return np.select([r > 8, z > 4, r <= 4], [0, 1000, 7], 4).astype(dtype)


def volume_of(mesh, value):
    a, b, c, d = (mesh.points[mesh.tets[mesh.label_values == value][:, i]] for i in range(4))
    return np.einsum("ij,ij->", np.cross(b - a, c - a), d - a) / 6


@pytest.fixture(scope="module")
def labels():
    return ts.Labels.from_array(bone())


@pytest.fixture(scope="module")
def made(labels):
    return ts.mesh(labels, label_names={4: "bone", 7: "marrow"}, faces=True)


def test_every_label_of_an_array_is_meshed(labels, made):
    assert labels.counts == dict(zip(*np.unique(bone(), return_counts=True)))
    assert made.header.labels == (ts.MeshLabel(4, "bone"), ts.MeshLabel(7, "marrow"), ts.MeshLabel(1000, ""))
    assert made.labels.dtype == np.uint16 and made.labels.shape == (len(made.tets),)
    assert made.regions is None
    for value in (4, 7, 1000):
        assert volume_of(made, value) == pytest.approx(labels.counts[value], rel=0.1)
    assert 9.3 < made.quality().min_dihedral_deg < made.quality().max_dihedral_deg < 157.6
    assert "4 labels" in repr(labels)


def test_faces_have_the_names_of_both_sides(made):
    names = [label.name for label in made.header.face_labels]
    assert {"bone_surface", "bone_marrow", "marrow_label_1000"} <= set(names)
    between = made.faces_of("bone_marrow")
    for value in (4, 7):
        assert np.isin(between, made.tets[made.label_values == value]).all()


@pytest.mark.parametrize("dtype", [np.uint16, np.int32, np.uint32, np.int64, np.uint64, ">i2"])
def test_labels_are_integers_of_any_type(made, dtype):
    assert_same(ts.mesh(ts.Labels.from_array(bone(dtype)), faces=True), made)


@pytest.mark.parametrize("wanted", ["4,7", [4, 7], [(4, 10)], "4:10", range(4, 8), np.array([4, 7]),
                                    np.array([4, 7]).tolist(), {np.int64(4), np.uint8(7)}, (value for value in (4, 7)),
                                    [(np.int64(4), np.int16(10))]],
                         ids=range(10))
def test_labels_are_chosen_in_several_ways(labels, wanted):
    some = ts.mesh(labels, labels=wanted)
    assert [label.value for label in some.header.labels] == [4, 7]


@pytest.mark.parametrize("options", [{"labels": [4, 7]}, {"merge": ["4,7", [1000]]}], ids=["labels", "merge"])
def test_iterators_of_a_request_are_there_at_each_use(labels, options):
    plain = ts.mesh(labels, **options)
    def read_once(values):
        return (read_once(one) if isinstance(one, list) else one for one in values)
    request = ts.Request(labels, **{name: read_once(values) for name, values in options.items()})
    for _ in range(2):
        assert_same(ts.mesh(request), plain)
    with ts.Client() as here:
        once = {name: read_once(values) for name, values in options.items()}
        job = here.jobs.wait(here.jobs.submit(ts.Request(labels, **once)))
        assert job.state == "succeeded", job.error
        assert_same(here.jobs.fetch(job), plain)
    with pytest.raises(ts.InvalidArgumentError, match="is given beside a Request"):
        ts.mesh(ts.Request(labels), **{name: read_once(values) for name, values in options.items()})


def test_numbers_and_arrays_of_numpy_are_taken(labels, ball):
    for only in (np.int64(7), np.array(7)):
        assert [label.value for label in ts.mesh(labels, labels=only).header.labels] == [7]
    merged = ts.mesh(labels, merge=np.array([[4, 7]]))
    assert [label.value for label in merged.header.labels] == [4, 1000]
    plain = ts.mesh(labels, smooth=1, label_sizes={4: 2})
    assert_same(ts.mesh(labels, smooth=np.float32(1), label_sizes={np.int64(4): np.float32(2)}), plain)
    assert_same(ts.mesh(ball, sizing={"growth": np.float32(0.25)}), ts.mesh(ball, sizing={"growth": 0.25}))
    with pytest.raises(ts.InvalidArgumentError, match="labels is given beside a Request"):
        ts.mesh(ts.Request(labels), labels=np.array([4, 7]))


def test_what_is_empty_asks_for_no_labels(ball, mesh):
    """A program may hand on what it has been given."""
    assert_same(ts.mesh(ball, merge=[], label_sizes={}, label_names={}), mesh)
    assert_same(ts.mesh(ts.Request(ball), merge=np.array([])), mesh)


def test_labels_are_merged_and_the_background_is_meshed(labels):
    merged = ts.mesh(labels, merge=["4,7", [1000]])
    assert [label.value for label in merged.header.labels] == [4, 1000]
    whole = ts.mesh(labels, labels=7, background="meshed", background_label=0, smooth="thin")
    assert {label.value for label in whole.header.labels} == {0, 7}
    assert ts.mesh(labels, smooth=0).tets.shape != ts.mesh(labels).tets.shape


def test_axes_spacing_and_affine_say_where_voxels_lie(tmp_path):
    values = bone()[:, :, 6:]
    place = {"spacing": (0.5, 0.75, 1.5), "origin": (10, 20, 30)}
    expected = ts.mesh(ts.Labels.from_array(values, **place))
    affine = np.array([[0.5, 0, 0, 10], [0, 0.75, 0, 20], [0, 0, 1.5, 30], [0, 0, 0, 1]])
    assert_same(ts.mesh(ts.Labels.from_array(values, affine=affine)), expected)
    turned = ts.Labels.from_array(np.flip(values, 1).T, axes=("z", "-y", "x"), spacing=(0.5, 0.75, 1.5),
                                  origin=(10, 20 + 19 * 0.75, 30))
    assert turned.voxel_edges == (1.5, 0.75, 0.5)
    mesh = ts.mesh(turned)
    for value in (4, 7):
        assert volume_of(mesh, value) == pytest.approx(volume_of(expected, value), rel=0.02)
    for axis in range(3):
        assert mesh.points[:, axis].min() == pytest.approx(expected.points[:, axis].min(), abs=0.3)


def test_an_image_gives_the_same_mesh(tmp_path, labels, made):
    path = tmp_path / "bone.nrrd"
    labels.write_nrrd(path)
    for read in (ts.Labels.from_file(path), ts.Labels.from_file(path, trusted=True)):
        assert_same(ts.mesh(read, faces=True), made)
    assert_same(ts.mesh(path, labels="all", faces=True), made)
    local = ts.Client(":local:")
    assert_same(local.mesh(local.upload_file(path), labels="all", faces=True), made)
    assert_same(local.mesh(local.upload(labels), faces=True), made)


def test_labels_come_chunk_by_chunk(labels, made):
    with ts.stream(labels, faces=True) as stream:
        chunks = list(stream)
    assert np.array_equal(np.concatenate([chunk.labels for chunk in chunks]), made.labels)
    assert set(chunks[0].label_values) <= {4, 7, 1000}
    shares = [chunk.labels for rank in range(2) for chunk in ts.stream(labels, faces=True, rank=rank, size=2)]
    assert np.array_equal(np.concatenate(shares), made.labels)
    assert ts.estimate(labels).tet_count == len(made.tets)


def test_a_server_makes_the_same_mesh(tmp_path, client, labels, made):
    for encoding in ("plain", "packed"):
        assert_same(client.mesh(labels, faces=True, encoding=encoding), made)
    assert_same(client.mesh(client.upload(labels), faces=True), made)
    options = {"labels": [4, 7], "label_names": {4: "bone"}, "background": "meshed", "smooth": "thin", "levels": 2,
               "improve": True}
    there = client.mesh(labels, **options)
    assert_same(there, ts.mesh(labels, **options))
    assert set(there.header.labels) == {ts.MeshLabel(4, "bone"), ts.MeshLabel(7, ""), ts.MeshLabel(0, "")}
    job = client.jobs.submit(ts.Request(labels, faces=True), labels={"study": "bone"})
    assert client.jobs.wait(job).state == "succeeded"
    assert_same(client.jobs.fetch(job), made)
    labels.write_nrrd(tmp_path / "bone.nrrd")
    assert_same(client.mesh(tmp_path / "bone.nrrd", labels="all", faces=True), made)


def test_labels_are_told_to_other_packages(made):
    meshio = pytest.importorskip("meshio")
    told = made.to_meshio()
    assert isinstance(told, meshio.Mesh)
    assert np.array_equal(told.cell_data["label"][0], made.label_values)
    assert len(told.cell_data["label"][1]) == len(made.faces)


def test_names_come_from_a_table(tmp_path, labels):
    (tmp_path / "names.txt").write_text('7 255 0 0 1 1 1 "red marrow"\n')
    named = ts.mesh(labels, label_names=tmp_path / "names.txt")
    assert named.header.labels[1] == ts.MeshLabel(7, "red marrow")


@pytest.mark.parametrize("call, said", [
    (lambda s: ts.Labels.from_array(np.zeros((2, 2))), "three axes"),
    (lambda s: ts.Labels.from_array(np.zeros((2, 2, 2))), "integers are needed"),
    (lambda s: ts.Labels.from_array(bone(), spacing=(1, 2)), "spacing"),
    (lambda s: ts.Labels.from_array(bone(), axes="xxz"), "axes 'xxz'"),
    (lambda s: ts.Labels.from_array(bone(), affine=np.eye(3)), "4 x 4"),
    (lambda s: ts.mesh(s, labels="4,x"), "'x', which names no labels"),
    (lambda s: ts.mesh(s, labels=[4, "x"]), "labels has 'x'"),
    (lambda s: ts.mesh(s, labels=[]), "names no label"),
    (lambda s: ts.mesh(s, labels=4.5), "labels has 4.5"),
    (lambda s: ts.mesh(s, labels=[(4, 7.5)]), "labels has \\(4, 7.5"),
    (lambda s: ts.mesh(s, labels=np.eye(2)), "labels has array"),
    (lambda s: ts.mesh(s, smooth=[1]), "neither a width"),
    (lambda s: ts.mesh(s, labels=5), "5"),
    (lambda s: ts.mesh(s, smooth="flat"), "neither a width"),
    (lambda s: ts.mesh(s, smooth=9), "0 to 4 voxels"),
    (lambda s: ts.mesh(s, background="kept"), "background 'kept'"),
    (lambda s: ts.session(s), "do not go with a session"),
    (lambda s: ts.sample(s, [(0, 0, 0)]), "labels have no distances"),
    (lambda s: ts.sample(ts.Client().upload(s), [(0, 0, 0)]), "labels have no distances"),
    (lambda s: ts.Labels.from_array(bone(), affine=np.eye(4), spacing=1), "affine says where voxels lie"),
    (lambda s: ts.Labels.from_array(bone(), affine=np.eye(4), origin=(0, 0, 0)), "affine says where voxels lie"),
    (lambda s: ts.Labels.from_array(bone(), affine=np.eye(4), axes="xyz"), "affine says where voxels lie"),
], ids=range(22))
def test_what_is_wrong_is_said(labels, call, said):
    with pytest.raises(ts.InvalidArgumentError, match=said):
        call(labels)


def test_flat_voxels_are_refused():
    with pytest.raises(ts.FailedPreconditionError, match="voxels"):
        ts.Labels.from_array(bone(), affine=np.diag([1.0, 1.0, 0.0, 1.0]))
