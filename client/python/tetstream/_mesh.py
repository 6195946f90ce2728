"""Meshes as numpy arrays: whole, or chunk by chunk."""

from __future__ import annotations

import base64
import functools
import html
import os
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _convert, _tetstream
from ._errors import invalid
from ._header import FieldArray, Header, Quality, Statistics
from ._names import Point
from ._picture import boundary_of, picture
from ._quality import measure
from ._request import Progress, options_of

_MOST_TETS_SHOWN = 1_000_000


class Arrays:
    """Vertices and tets as arrays; what a `Mesh` and a `Chunk` have in common."""

    def __init__(
        self,
        header: Header,
        local_points: NDArray[np.floating[Any]],
        tets: NDArray[np.unsignedinteger[Any]],
        regions: NDArray[np.uint8] | None,
        field_rows: NDArray[np.float32] | None,
        faces: NDArray[np.unsignedinteger[Any]] | None,
        face_tets: NDArray[np.unsignedinteger[Any]] | None,
        face_labels: NDArray[np.uint16] | None,
        labels: NDArray[np.uint16] | None,
    ) -> None:
        self.header = header
        self.local_points = local_points
        self.tets = tets
        self.regions = regions
        self._field_rows = field_rows
        self.faces = faces
        self.face_tets = face_tets
        self.face_labels = face_labels
        self.labels = labels

    header: Header
    """The whole mesh's totals, origin and spacing."""
    local_points: NDArray[np.floating[Any]]
    """Shape (n, 3): coordinates relative to `header.origin`, float32 or float64, as they are stored."""
    tets: NDArray[np.unsignedinteger[Any]]
    """Shape (m, 4): vertex ids, uint32 or uint64. det(b - a, c - a, d - a) is positive."""
    regions: NDArray[np.uint8] | None
    """Shape (m,): 1 inside, 2 outside; None unless both sides are meshed."""
    faces: NDArray[np.unsignedinteger[Any]] | None
    """Shape (f, 3): vertex ids of the boundary triangles, counter-clockwise seen from outside, in the
    order of their tets; None unless asked for with `faces=True`."""
    face_tets: NDArray[np.unsignedinteger[Any]] | None
    """Shape (f,): the tet that each face belongs to, as the whole mesh counts."""
    face_labels: NDArray[np.uint16] | None
    """Shape (f,): places in `header.face_labels`."""
    labels: NDArray[np.uint16] | None
    """Shape (m,): places in `header.labels`; None unless a segmentation is meshed."""

    @functools.cached_property
    def points(self) -> NDArray[np.float64]:
        """Shape (n, 3): world coordinates, float64. Computed when it is asked for the first time
        (`header.origin + local_points`), and kept; read-only."""
        points = np.add(self.local_points, self.header.origin, dtype=np.float64)
        points.setflags(write=False)
        return points

    @functools.cached_property
    def fields(self) -> Mapping[str, NDArray[np.float32]]:
        """{name: values at the vertices}, each of shape (n,), or (n, 3) of a vector; views, float32."""
        return {field.name: self._field(field) for field in self.header.fields}

    @functools.cached_property
    def label_values(self) -> NDArray[np.int64] | None:
        """Shape (m,): of each tet the value that its label has in the image; None unless a segmentation
        is meshed. Computed when it is asked for the first time, and kept; read-only."""
        if self.labels is None:
            return None
        values = np.array([label.value for label in self.header.labels], dtype=np.int64)[self.labels]
        values.setflags(write=False)
        return values

    def faces_of(self, name: str) -> NDArray[np.unsignedinteger[Any]]:
        """The faces with one label, shape (n, 3). Errors: InvalidArgumentError (no such label)."""
        tag = self.header.face_tag(name)
        assert self.faces is not None and self.face_labels is not None
        named: NDArray[np.unsignedinteger[Any]] = self.faces[self.face_labels == tag - 1]
        return named

    def _field(self, field: FieldArray) -> NDArray[np.float32]:
        assert self._field_rows is not None
        if field.components == 1:
            return self._field_rows[:, field.offset]
        return self._field_rows[:, field.offset:field.offset + field.components]


_VIEWS: dict[str, Callable[[_tetstream.Mesh], Any]] = {
    "header": lambda mesh: Header._of(mesh.header),
    "local_points": lambda mesh: mesh.points,
    "tets": lambda mesh: mesh.tets,
    "regions": lambda mesh: mesh.regions,
    "_field_rows": lambda mesh: mesh.field_rows,
    "faces": lambda mesh: mesh.faces,
    "face_tets": lambda mesh: mesh.face_tets,
    "face_labels": lambda mesh: mesh.face_labels,
    "labels": lambda mesh: mesh.labels,
}


class Mesh(Arrays):
    """A whole tetrahedral mesh.

    Its arrays are views of the library's memory, without a copy and read-only; each keeps that memory
    alive, so they outlive the mesh. `points` alone is computed. Take a copy (`mesh.tets.copy()`) to
    write to it.

    points         (n, 3) float64, world coordinates
    local_points   (n, 3) float32 or float64, relative to header.origin
    tets           (m, 4) uint32 or uint64, vertex ids
    regions        (m,) uint8, 1 inside and 2 outside; None unless both sides are meshed
    fields         {name: (n,) or (n, 3) float32}
    faces          (f, 3) uint32 or uint64, vertex ids of boundary triangles; None unless asked for
    face_tets, face_labels   (f,) uint32 or uint64, and uint16
    header, statistics, quality()   what is known of it
    """

    def __init__(self, mesh: _tetstream.Mesh) -> None:
        if not isinstance(mesh, _tetstream.Mesh):
            raise TypeError("a Mesh is made by tetstream.mesh, or by Client.mesh")
        self._mesh = mesh

    def __getattr__(self, name: str) -> Any:
        """Views are made when they are asked for the first time: few of them are of most meshes."""
        view = _VIEWS.get(name)
        if view is None or "_mesh" not in self.__dict__:
            raise AttributeError(f"a tetstream.Mesh has no {name}")
        made = self.__dict__[name] = view(self._mesh)
        return made

    @functools.cached_property
    def statistics(self) -> Statistics:
        """Angles, volume, the boundary's topology, thin walls."""
        return Statistics._of(self._mesh.statistics)

    def quality(self) -> Quality:
        """Dihedral angles and volume: as they were told with the mesh, or else measured now."""
        return self.statistics.quality or self._measured

    @functools.cached_property
    def _measured(self) -> Quality:
        return Quality(*measure(self.local_points, self.tets))

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        format: str | None = None,
        progress: Progress | None = None,
        timeout: float | None = None,
    ) -> None:
        """Writes world coordinates, and regions, boundary faces and fields as far as the format has room for
        them. The path's ending chooses it: .vtu, .msh or another of docs/formats.md; `format` names it
        ("vtu", "msh") where that does not. The file is whole or not there.

        Errors: InvalidArgumentError (another ending or format), FailedPreconditionError (a format that
        cannot count so far), UnavailableError and ResourceExhaustedError (the disk), DeadlineExceededError.
        """
        self._mesh.write(os.fspath(path), format or "", options_of(progress=progress, timeout=timeout))

    def to_meshio(self) -> Any:
        """The mesh as a `meshio.Mesh`, with fields as point data and `region` as cell data; with boundary faces
        as triangles, where it has them, whose `face_label` is a place in `header.face_labels`, from 1 on."""
        return _convert.to_meshio(self)

    def to_pyvista(self) -> Any:
        """The mesh as a `pyvista.UnstructuredGrid`, with fields as point data and `region` as cell data."""
        return _convert.to_pyvista(self)

    def to_vtk(self) -> Any:
        """The mesh as a `vtkUnstructuredGrid`, with fields as point data and `region` as cell data."""
        return _convert.to_vtk(self)

    def to_dolfinx(self, comm: Any, *, tags: bool = False) -> Any:
        """The mesh as a `dolfinx.mesh.Mesh`, for finite elements of first order.

        comm   of mpi4py, such as MPI.COMM_WORLD. Every rank has made the same mesh, and gives its share of it;
               `MeshStream.to_dolfinx` spares each rank the rest.
        tags   also what its cells and facets are: (mesh, cell_tags, facet_tags), each a `MeshTags` of dolfinx, or
               None where the mesh has no regions or no faces. A cell's tag is its region, or of a segmentation
               its label's value, and a facet's is the place of its name in `header.face_labels`, from 1 on:
               `header.face_tag("clamped")` finds it

        Errors: FailedPreconditionError (a label whose value has more than 32 bits, which is no tag).
        """
        if tags:
            _convert.check_tags(self.header)
        piece = _convert.share_of(self, comm)
        return _convert.tagged_dolfinx(piece, comm) if tags else _convert.to_dolfinx(piece, comm)

    def picture(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        values: str | ArrayLike | None = None,
        size: tuple[int, int] = (640, 480),
        view: Point = (1, -2, 1),
    ) -> bytes:
        """Draws the mesh's surface: a PNG, which is returned, and written to `path` where one is given.

        values   what colours it, from low (blue) to high (yellow): a field of one component, or an array with
                 one value for each point; grey where values are not finite, or masked
        size     pixels, width and height
        view     from the mesh towards the eye
        """
        shown = self.fields.get(values) if isinstance(values, str) else values
        if isinstance(values, str) and shown is None:
            raise invalid(f"no field is named {values!r}; there are {', '.join(self.fields) or 'none'}")
        surface = self.faces if self.faces is not None else boundary_of(self.tets)
        png = picture(self.points, surface, shown, size, view)
        if path is not None:
            with open(path, "wb") as file:
                file.write(png)
        return png

    def _repr_html_(self) -> str:
        """What notebooks show: a picture, unless the mesh is very large."""
        text = html.escape(repr(self))
        if len(self.tets) > _MOST_TETS_SHOWN:
            return f"<pre>{text}</pre>"
        image = base64.b64encode(self.picture(size=(320, 240))).decode()
        return f'<img src="data:image/png;base64,{image}" alt="{text}"><pre>{text}</pre>'

    def __repr__(self) -> str:
        h = self.header
        arrays = (self.local_points, self.tets, self.regions, self._field_rows, self.faces, self.face_tets,
                  self.face_labels, self.labels)
        megabytes = sum(array.nbytes for array in arrays if array is not None) / 1e6
        named = f", fields {', '.join(self.fields)}" if self.fields else ""
        return (f"<tetstream.Mesh: {h.vertex_count:,} vertices, {h.tet_count:,} tets, "
                f"spacing {h.spacing:g}, {megabytes:.1f} MB{named}>")


class Chunk(Arrays):
    """A contiguous run of a mesh's vertices and tets, with arrays of its own.

    Chunks come in order and leave no gaps. Vertex ids count in the whole mesh, and a tet may refer to
    vertices of chunks before it and after it.

    index                       from 0 to header.chunk_count - 1
    first_vertex, first_tet     how many the chunks before it hold
    points, local_points, tets, regions, fields, faces, face_tets, face_labels   as those of a `Mesh`
    """

    def __init__(self, header: Header, index: int, first_vertex: int, first_tet: int, *arrays: Any) -> None:
        super().__init__(header, *arrays)
        self.index = index
        self.first_vertex = first_vertex
        self.first_tet = first_tet

    def __repr__(self) -> str:
        return (f"<tetstream.Chunk {self.index} of {self.header.chunk_count}: "
                f"{len(self.local_points):,} vertices, {len(self.tets):,} tets>")
