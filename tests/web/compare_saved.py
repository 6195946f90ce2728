"""Whether files that the page saved hold what the command line wrote: both are read by readers that know nothing of
tetstream.

    compare_saved.py SAVED WRITTEN [SAVED WRITTEN ...]
"""

import pathlib
import sys

import numpy

from saved_readers import READERS, unpacked
from samples import sorted_triangles, volumes  # found by saved_readers

# These are the same byte for byte.
SAME_BYTES = {".exo", ".polyMesh"}


def contents(path):
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    return {file.name if path.is_dir() else "": file.read_bytes() for file in files}


def compare(packed, written):
    ending = written.suffix
    saved, read = unpacked(packed, ending), READERS[ending]
    one, other = read(saved), read(written)
    numpy.testing.assert_array_equal(one.points, other.points)
    assert (one.tets is None) == (other.tets is None)
    if one.tets is not None:
        numpy.testing.assert_array_equal(one.tets, other.tets)
        one_volume, other_volume = (volumes(each.points, each.tets).sum() for each in (one, other))
        assert one_volume == other_volume and (one_volume > 0 or ending == ".polyMesh"), (one_volume, other_volume)
    assert (one.labels is None) == (other.labels is None)
    if one.labels is not None:
        numpy.testing.assert_array_equal(one.labels, other.labels)
    assert set(one.faces) == set(other.faces), (set(one.faces), set(other.faces))
    for name, triangles in one.faces.items():
        numpy.testing.assert_array_equal(sorted_triangles(triangles), sorted_triangles(other.faces[name]))
    assert set(one.fields) == set(other.fields)
    for name, values in one.fields.items():
        numpy.testing.assert_array_equal(values, other.fields[name])
    if ending in SAME_BYTES:
        assert contents(saved) == contents(written)
    bytes_written = sum(map(len, contents(written).values()))
    print(f"{ending}: {len(one.points)} points, {0 if one.tets is None else len(one.tets)} tets, "
          f"{sum(map(len, one.faces.values()))} faces called {', '.join(sorted(one.faces)) or 'nothing'}, "
          f"{packed.stat().st_size} bytes against {bytes_written}")


def main():
    paths = [pathlib.Path(path) for path in sys.argv[1:]]
    for packed, written in zip(paths[::2], paths[1::2], strict=True):
        try:
            compare(packed, written)
        except AssertionError as error:
            raise AssertionError(f"{packed.name}: {error}") from error


if __name__ == "__main__":
    main()
