"""Meshes as other packages have them."""

from __future__ import annotations

import dataclasses
import importlib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import FailedPreconditionError, StatusCode
from ._header import Header
from ._share import Share

if TYPE_CHECKING:
    from ._mesh import Arrays

_VTK_TETRA = 10


def imported(name: str) -> Any:
    """A module that need not be installed."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.split(".")[0].replace("vtkmodules", "vtk")
        raise ImportError(f"this needs the package {package}, which is not installed: pip install {package}") from error


def cell_arrays(mesh: Arrays) -> list[tuple[str, NDArray[Any]]]:
    """What each tet has, beside its corners."""
    named = {"region": mesh.regions, "label": mesh.label_values}
    return [(name, values) for name, values in named.items() if values is not None]


def to_meshio(mesh: Arrays) -> Any:
    cells: list[tuple[str, NDArray[Any]]] = [("tetra", mesh.tets)]
    cell_data: dict[str, list[NDArray[Any]]] = {}
    for name, values in cell_arrays(mesh):
        cell_data[name] = [values]
    if mesh.faces is not None and mesh.face_labels is not None:
        cells.append(("triangle", mesh.faces))
        for arrays in cell_data.values():
            arrays.append(np.zeros(len(mesh.faces), arrays[0].dtype))
        cell_data["face_label"] = [np.zeros(len(mesh.tets), np.int32), mesh.face_labels.astype(np.int32) + 1]
    return imported("meshio").Mesh(mesh.points, cells, point_data=dict(mesh.fields), cell_data=cell_data)


def to_pyvista(mesh: Arrays) -> Any:
    pyvista = imported("pyvista")
    grid = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: mesh.tets.astype(np.int64)}, mesh.points)
    for name, values in mesh.fields.items():
        grid.point_data[name] = values
    for name, values in cell_arrays(mesh):
        grid.cell_data[name] = values
    return grid


def to_vtk(mesh: Arrays) -> Any:
    model, core = imported("vtkmodules.vtkCommonDataModel"), imported("vtkmodules.vtkCommonCore")
    arrays = imported("vtkmodules.util.numpy_support")
    points = core.vtkPoints()
    points.SetData(arrays.numpy_to_vtk(mesh.points))
    cells = model.vtkCellArray()
    offsets = np.arange(0, 4 * len(mesh.tets) + 1, 4, dtype=np.int64)
    cells.SetData(arrays.numpy_to_vtkIdTypeArray(offsets, deep=True),
                  arrays.numpy_to_vtkIdTypeArray(mesh.tets.astype(np.int64).ravel(), deep=True))
    grid = model.vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.SetCells(_VTK_TETRA, cells)
    for name, values in mesh.fields.items():
        _add(grid.GetPointData(), arrays, name, values)
    for name, values in cell_arrays(mesh):
        _add(grid.GetCellData(), arrays, name, values)
    return grid


def _add(data: Any, arrays: Any, name: str, values: NDArray[Any]) -> None:
    array = arrays.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.AddArray(array)


@dataclasses.dataclass(frozen=True)
class Piece:
    """What one rank has of a mesh. Ids count in the whole mesh."""

    points: NDArray[np.float64]
    tets: NDArray[Any]
    kinds: NDArray[Any] | None = None  # regions, or of a segmentation the labels' values
    faces: NDArray[Any] | None = None
    face_labels: NDArray[Any] | None = None


def to_dolfinx(piece: Piece, comm: Any) -> Any:
    dolfinx, ufl = imported("dolfinx.mesh"), imported("ufl")
    cell = ufl.Cell("tetrahedron", geometric_dimension=3)
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", cell, 1))
    return dolfinx.create_mesh(comm, np.ascontiguousarray(piece.tets, dtype=np.int64), piece.points, domain)


def check_tags(header: Header) -> None:
    """Asks the header, as all ranks have the same, so that none is left alone in what they do together."""
    most = np.iinfo(np.int32)
    for label in header.labels:
        if not most.min <= label.value <= most.max:
            raise FailedPreconditionError(
                f"label {label.value} is no tag of dolfinx, which has {most.min} to {most.max}: give the label another "
                "value, or hand the mesh on without tags", StatusCode.FAILED_PRECONDITION)


def tagged_dolfinx(piece: Piece, comm: Any) -> tuple[Any, Any, Any]:
    """(mesh, tags of cells, tags of facets); None for tags of which the mesh has no column."""
    domain = to_dolfinx(piece, comm)
    cells = None if piece.kinds is None else _tags(domain, piece.tets, piece.kinds)
    facets = None
    if piece.faces is not None and piece.face_labels is not None:
        facets = _tags(domain, piece.faces, piece.face_labels.astype(np.int32) + 1)
    return domain, cells, facets


def _tags(domain: Any, entities: NDArray[Any], values: NDArray[Any]) -> Any:
    """Tags of cells or facets, each of which any rank may name by its vertices."""
    dolfinx, cpp = imported("dolfinx.mesh"), imported("dolfinx.cpp")
    dimension = entities.shape[1] - 1
    domain.topology.create_connectivity(dimension, 0)
    domain.topology.create_connectivity(dimension, domain.topology.dim)
    own, own_values = cpp.io.distribute_entity_data(
        getattr(domain, "_mesh", domain), dimension, np.ascontiguousarray(entities, dtype=np.int64),
        np.ascontiguousarray(values, dtype=np.int32))
    return dolfinx.meshtags_from_entities(domain, dimension, cpp.graph.AdjacencyList_int32(own), own_values)


def share_of(mesh: Arrays, comm: Any) -> Piece:
    """The share of this rank in a mesh that every rank has whole."""
    kinds = mesh.regions if mesh.labels is None else mesh.label_values
    share = Share.of(len(mesh.local_points), len(mesh.tets), comm.rank, comm.size)
    tets = slice(share.first_tet, share.end_tet)
    piece = Piece(mesh.points[share.first_vertex:share.end_vertex], mesh.tets[tets],
                  None if kinds is None else kinds[tets])
    if mesh.faces is None or mesh.face_tets is None or mesh.face_labels is None:
        return piece
    begin, end = mesh.face_tets.searchsorted([share.first_tet, share.end_tet])
    return dataclasses.replace(piece, faces=mesh.faces[begin:end], face_labels=mesh.face_labels[begin:end])
