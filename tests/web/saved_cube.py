"""Whether the files that mesh_columns_test.mjs saved hold its cube: a volume of 1 between x = 10 and 11, in two halves.

    saved_cube.py FOLDER plain|regions|labels|parts...
"""

import pathlib
import sys

import numpy
from saved_readers import READERS, saved_name, unpacked
from samples import LABELS as NUMBERS, volumes  # found by saved_readers

BOX = {f"box_{axis}_{side}": 1 for axis in "xyz" for side in ("min", "max")}
# Areas of faces by their names, and labels of the halves.
FACES = {"plain": {"surface": 6}, "regions": {"interface": 1, **BOX},
         "labels": {"bone_surface": 3, "label_7_surface": 3, "bone_label_7": 1},
         "parts": {"low_surface": 3, "high_surface": 3}}
LABELS = {"plain": None, "regions": (1, 2), "labels": (4, 7), "parts": (1, 2)}
NUMBERS.update(low=1, high=2)
WITH_FIELDS = {".vtu", ".vtkhdf", ".msh", ".xdmf", ".exo", ".usda", ".ply"}
WITHOUT_FACES = {".vtu", ".vtkhdf", ".stl"}


def area(points, triangles):
    corners = points[numpy.asarray(triangles)].astype(float)
    return numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2


def check(path, ending, kind):
    read = READERS[ending](unpacked(path, ending))
    assert read.points[:, 0].min() == 10 and read.points[:, 0].max() == 11
    if read.tets is not None:
        assert len(read.tets) == 6000
        found = volumes(read.points, read.tets)
        # A polyMesh has cells by their faces, and no order of their corners.
        numpy.testing.assert_allclose(abs(found) if ending == ".polyMesh" else found, 1 / 6000, rtol=1e-3)
        # Parts lie one above the other, the other halves side by side.
        middles = read.points[read.tets, 2].mean(axis=1) + 10 if kind == "parts" else read.points[read.tets, 0].mean(axis=1)
        if LABELS[kind]:
            numpy.testing.assert_array_equal(read.labels, numpy.where(middles < 10.5, *LABELS[kind]))
        else:
            assert read.labels is None
    wanted = FACES[kind] if ending not in WITHOUT_FACES else {}
    if ending == ".stl":
        wanted = {"": sum(FACES[kind].values())}
    areas = {name: area(read.points, triangles) for name, triangles in read.faces.items()}
    assert set(areas) == set(wanted), areas
    for name, expected in wanted.items():
        assert abs(areas[name] - expected) < 1e-4, (name, areas[name])
    assert set(read.fields) == ({"heat", "flow"} if ending in WITH_FIELDS else set())
    if read.fields:
        numpy.testing.assert_array_equal(read.fields["flow"] - read.fields["heat"][:, None],
                                         numpy.tile([0.25, 0.5, 0.75], (len(read.points), 1)))


def main():
    folder = pathlib.Path(sys.argv[1])
    for kind in sys.argv[2:]:
        for ending in READERS:
            try:
                check(folder / saved_name(kind, ending), ending, kind)
            except AssertionError as error:
                raise AssertionError(f"{kind}{ending}: {error}") from error


if __name__ == "__main__":
    main()
