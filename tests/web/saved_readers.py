"""Readers of the files that the page saves, which know nothing of tetstream: those of tests/core/files."""

import pathlib
import sys
import tempfile
import zipfile

import meshio
import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "core" / "files"))

from binary_readers import read_exodus, read_polymesh, read_xdmf  # noqa: E402
from boundary_readers import read_obj, read_ply, read_stl  # noqa: E402
from read_back import read_with_vtk  # noqa: E402
from samples import Read  # noqa: E402
from text_readers import read_inp, read_mfem, read_msh, read_usd  # noqa: E402
from vtkmodules.vtkIOHDF import vtkHDFReader  # noqa: E402


def read_vtu(path):
    mesh = meshio.read(path)
    labels = next(iter(mesh.cell_data.values()), [None])[0]
    return Read(mesh.points, mesh.cells[0].data, labels, fields=mesh.point_data)


def read_vtkhdf(path):
    points, tets, labels, fields = read_with_vtk(vtkHDFReader(), path)
    return Read(points, tets, labels, fields=fields)


def read_foam(path):
    """Its cells have their corners in no order: they are sorted."""
    read = read_polymesh(path)
    read.tets = numpy.array(read.tets)
    return read


READERS = {".vtu": read_vtu, ".vtkhdf": read_vtkhdf, ".msh": read_msh, ".inp": read_inp, ".xdmf": read_xdmf, ".exo": read_exodus,
           ".polyMesh": read_foam, ".mesh": read_mfem, ".usda": read_usd, ".stl": read_stl, ".ply": read_ply, ".obj": read_obj}
# What is in the .zip of a format that is several files: where readers begin.
ZIPPED = {".xdmf": "mesh.xdmf", ".polyMesh": "polyMesh"}


def saved_name(stem, ending):
    return f"{stem}{ending}{'.zip' if ending in ZIPPED else ''}"


def unpacked(path, ending):
    """Where a saved file's reader begins; what was in a .zip goes beside it."""
    if ending not in ZIPPED:
        return path
    folder = pathlib.Path(tempfile.mkdtemp(dir=path.parent))
    with zipfile.ZipFile(path) as content:
        assert content.testzip() is None
        content.extractall(folder)
    return folder / ZIPPED[ending]
