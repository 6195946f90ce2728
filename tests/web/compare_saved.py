"""Whether a file that the page saved holds what the command line wrote: both are read by readers that know nothing of
tetstream.

    compare_saved.py SAVED WRITTEN
"""

import pathlib
import sys

import meshio
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "core" / "files"))

from boundary_readers import read_obj, read_ply, read_stl  # noqa: E402
from samples import Read, sorted_triangles, volumes  # noqa: E402
from text_readers import read_inp, read_mfem, read_msh  # noqa: E402


def read_vtu(path):
    mesh = meshio.read(path)
    labels = next(iter(mesh.cell_data.values()), [None])[0]
    return Read(mesh.points, mesh.cells[0].data, labels, fields=mesh.point_data)


READERS = {".vtu": read_vtu, ".msh": read_msh, ".inp": read_inp, ".mesh": read_mfem, ".stl": read_stl, ".ply": read_ply,
           ".obj": read_obj}


def main():
    saved, written = map(pathlib.Path, sys.argv[1:])
    read = READERS[saved.suffix]
    one, other = read(saved), read(written)
    numpy.testing.assert_array_equal(one.points, other.points)
    assert (one.tets is None) == (other.tets is None)
    if one.tets is not None:
        numpy.testing.assert_array_equal(one.tets, other.tets)
        one_volume, other_volume = (volumes(each.points, each.tets).sum() for each in (one, other))
        assert one_volume == other_volume > 0, (one_volume, other_volume)
    assert (one.labels is None) == (other.labels is None)
    if one.labels is not None:
        numpy.testing.assert_array_equal(one.labels, other.labels)
    assert set(one.faces) == set(other.faces), (set(one.faces), set(other.faces))
    for name, triangles in one.faces.items():
        numpy.testing.assert_array_equal(sorted_triangles(triangles), sorted_triangles(other.faces[name]))
    assert set(one.fields) == set(other.fields)
    for name, values in one.fields.items():
        numpy.testing.assert_array_equal(values, other.fields[name])
    print(f"{saved.suffix}: {len(one.points)} points, {0 if one.tets is None else len(one.tets)} tets, "
          f"{sum(map(len, one.faces.values()))} faces called {', '.join(sorted(one.faces)) or 'nothing'}, "
          f"{saved.stat().st_size} bytes against {written.stat().st_size}")


if __name__ == "__main__":
    main()
