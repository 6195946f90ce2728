"""What is told of a mesh beside its arrays: before its first vertex, and after its last tet."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import invalid

_Box = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclasses.dataclass(frozen=True)
class FieldArray:
    """A named array of values at the vertices, of 1 or 3 components."""

    name: str
    components: int
    offset: int  # of its first component in a vertex's row of values


@dataclasses.dataclass(frozen=True)
class MeshPart:
    """One grid's mesh within a mesh of several grids: runs of the vertices and of the tets."""

    name: str
    first_vertex: int
    vertex_count: int
    first_tet: int
    tet_count: int


@dataclasses.dataclass(frozen=True)
class FaceLabel:
    """A name that boundary faces have; each face has one.

    kind   "surface"; "interface" between inside and outside; "box", in a face of the box that the mesh
           ends at; "region", a piece of one of them that the request names
    part   of a mesh of several grids, from 1 on; else 0
    """

    name: str
    kind: str
    part: int


@dataclasses.dataclass(frozen=True)
class MeshLabel:
    """A label of a segmentation: its value in the image, and its name or nothing."""

    value: int
    name: str


@dataclasses.dataclass(frozen=True)
class Header:
    """What is known of a mesh before its first vertex.

    vertex_count, tet_count, chunk_count   totals
    float64, uint64   stored coordinates have 64 bits, else 32; vertex ids likewise
    has_regions       both sides are meshed: every tet has a region
    origin            to be added to stored coordinates, world units
    bounds            (lowest, highest) corner of a box that holds every vertex
    spacing           edge of the finest leaves, world units
    levels            coarser octree levels that the mesh uses
    fields            arrays that every vertex has values in
    parts             of a mesh of several grids; else empty
    id                from a server: the same id is the same bytes; else empty
    face_labels       with `faces=True` the names that faces have; else empty
    face_count        boundary faces
    labels            of a segmentation's mesh: what its tets are of, by ascending value, and last the background
                      where it is meshed; else empty
    inside_guess      for people: which side of a volume's surface was taken for the inside, and why, where nothing
                      says it; else empty
    """

    vertex_count: int
    tet_count: int
    chunk_count: int
    float64: bool
    uint64: bool
    has_regions: bool
    origin: tuple[float, float, float]
    bounds: _Box
    spacing: float
    levels: int
    fields: tuple[FieldArray, ...]
    parts: tuple[MeshPart, ...]
    id: str
    face_labels: tuple[FaceLabel, ...]
    face_count: int
    labels: tuple[MeshLabel, ...]
    inside_guess: str

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Header:
        told["fields"] = tuple(FieldArray(*field) for field in told["fields"])
        told["parts"] = tuple(MeshPart(*part) for part in told["parts"])
        told["face_labels"] = tuple(FaceLabel(*label) for label in told["face_labels"])
        told["labels"] = tuple(MeshLabel(*label) for label in told["labels"])
        return cls(**told)

    def face_tag(self, name: str) -> int:
        """The tag of the faces of this name, as meshio and dolfinx have it: its place in `face_labels`, from 1 on.
        Errors: InvalidArgumentError (no such label)."""
        names = [label.name for label in self.face_labels]
        if name not in names:
            raise invalid(f"no faces are named {name!r}; there are {', '.join(names) or 'none: mesh with faces=True'}")
        return names.index(name) + 1


@dataclasses.dataclass(frozen=True)
class Quality:
    """Dihedral angles in degrees, and volume in world units cubed.

    histogram   shape (180,): how many of the six angles of each tet lie in each whole degree
    """

    min_dihedral_deg: float
    max_dihedral_deg: float
    volume: float
    histogram: NDArray[np.uint64] = dataclasses.field(repr=False, compare=False)


@dataclasses.dataclass(frozen=True)
class Boundary:
    """Topology of the boundary of the inside."""

    triangles: int
    vertices: int
    components: int
    euler_characteristic: int
    non_manifold_edges: int
    non_manifold_vertices: int


@dataclasses.dataclass(frozen=True)
class Improvement:
    """What `improve` did: the angles before it, and how many vertices it moved."""

    min_dihedral_before_deg: float
    max_dihedral_before_deg: float
    moved_vertices: int


@dataclasses.dataclass(frozen=True)
class ThinWalls:
    """Places where the lattice is too coarse for walls and gaps, and the spacing that would resolve
    most of them (0 where there are none)."""

    inside: int
    outside: int
    suggested_spacing: float


@dataclasses.dataclass(frozen=True)
class SurfaceDistance:
    """Distances from points on one surface to another one, world units.

    at        where the largest was found
    samples   how many points were looked at
    """

    max: float
    rms: float
    at: tuple[float, float, float]
    samples: int


@dataclasses.dataclass(frozen=True)
class Fidelity:
    """How far a mesh's surface is from the surface that was meshed, and back; world units. docs/report.md
    tells what is measured.

    spacing           of the finest leaves
    mesh_volume       of the tets inside
    enclosed_volume   what the true surface encloses; None where a box was given
    """

    spacing: float
    mesh_to_surface: SurfaceDistance
    surface_to_mesh: SurfaceDistance
    mesh_area: float
    surface_area: float
    mesh_volume: float
    enclosed_volume: float | None

    @property
    def hausdorff(self) -> float:
        """The larger of the two largest distances."""
        return max(self.mesh_to_surface.max, self.surface_to_mesh.max)

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Fidelity:
        ways: dict[str, Any] = {
            name: SurfaceDistance(**told.pop(name)) for name in ("mesh_to_surface", "surface_to_mesh")}
        return cls(**told, **ways)


@dataclasses.dataclass(frozen=True)
class Ratio:
    """A ratio that is 1 for the regular tet, of all tets.

    histogram   shape (50,): how many lie in each fiftieth of 0 to 1; what is below counts in the first
    """

    min: float
    mean: float
    max: float
    histogram: NDArray[np.uint64] = dataclasses.field(repr=False, compare=False)


@dataclasses.dataclass(frozen=True)
class Shapes:
    """Shapes of all tets, as docs/report.md defines them; edges in world units.

    not_positive   tets whose volume is zero or less
    """

    scaled_jacobian: Ratio
    radius_ratio: Ratio
    edge_ratio: Ratio
    shortest_edge: float
    longest_edge: float
    not_positive: int

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Shapes:
        ratios: dict[str, Any] = {
            name: Ratio(**told.pop(name)) for name in ("scaled_jacobian", "radius_ratio", "edge_ratio")}
        return cls(**told, **ratios)


@dataclasses.dataclass(frozen=True)
class Statistics:
    """What is told of a whole mesh beside itself. None: left out (`statistics=False`), or not told, as
    the quality of a stream that was taken up again after its connection broke.

    fidelity, shapes     with `fidelity=True`, else empty and None: one fidelity of a mesh, or of several grids one
                         a part; and the shapes of all tets
    empty_face_regions   names among `face_regions` that no face has; not told of a stream
    """

    quality: Quality | None
    boundary: Boundary | None
    improvement: Improvement | None
    thin_walls: ThinWalls
    empty_face_regions: tuple[str, ...] = ()
    fidelity: tuple[Fidelity, ...] = ()
    shapes: Shapes | None = None

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Statistics:
        kinds: dict[str, Callable[..., Any]] = {
            "quality": Quality, "boundary": Boundary, "improvement": Improvement}
        parts = {name: kind(**told[name]) if told[name] else None for name, kind in kinds.items()}
        return cls(**parts, thin_walls=ThinWalls(*told["thin_walls"]),
                   empty_face_regions=told["empty_face_regions"],
                   fidelity=tuple(Fidelity._of(part) for part in told["fidelity"]),
                   shapes=Shapes._of(told["shapes"]) if told["shapes"] else None)
