"""What a mesh of tetrahedra is worth: counts, dihedral angles, volume, distance from the surface."""
import dataclasses

import numpy as np

SAMPLES = 20000  # places of the boundary that are looked at
# Opposite edges of a tet's six: (ends of the edge, the other two corners).
EDGES = [(0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1)]
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


@dataclasses.dataclass
class Verdict:
    """min_deg, max_deg   dihedral angles
    flat                tets without volume, or of the other orientation than most
    loose               faces that more than two tets share, and edges at which not just two faces
                        of a label's boundary meet in a mesh of one label: where it is no solid
    volume              of all tets
    rms, worst          distance of the boundary's vertices and of its faces' middles from the true
                        surface, where that is known; else None
    labels              that some tet has
    """
    tets: int
    min_deg: float
    max_deg: float
    flat: int
    loose: int
    volume: float
    rms: float = None
    worst: float = None
    labels: int = 1


def dihedral_angles(corners):
    """corners (n, 4, 3) -> degrees (n, 6); of a flat tet 0."""
    angles = np.empty((len(corners), len(EDGES)))
    for i, (a, b, c, d) in enumerate(EDGES):
        along = corners[:, b] - corners[:, a]
        along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
        one, other = (corners[:, x] - corners[:, a] for x in (c, d))
        one, other = (x - np.einsum("ij,ij->i", x, along)[:, None] * along for x in (one, other))
        angles[:, i] = np.degrees(np.arctan2(
            np.linalg.norm(np.cross(one, other), axis=1), np.einsum("ij,ij->i", one, other)))
    return angles


def six_volumes(corners):
    a, b, c = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
    return np.einsum("ij,ij->i", a, np.cross(b, c))


def counted_rows(rows):
    """Rows of small integers: (each once, how often it is there)."""
    return np.unique(rows, axis=0, return_counts=True)


def judge(vertices, tets, labels=None, distance=None):
    """The Verdict on tets (n, 4) of vertices (m, 3); labels (n) where each has one."""
    if len(tets) == 0:
        raise ValueError("a mesh without tets")
    if not np.isfinite(vertices).all():
        raise ValueError("a mesh with vertices that are not finite")
    corners = vertices[tets]
    volumes = six_volumes(corners)
    turned = np.sign(np.median(np.sign(volumes))) or 1
    scale = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2).max(axis=1) ** 3
    angles = dihedral_angles(corners)
    faces, shared = counted_rows(np.sort(tets[:, FACES].reshape(-1, 3), axis=1))
    boundary = faces[shared == 1]
    _, meeting = counted_rows(boundary[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2))
    verdict = Verdict(len(tets), angles.min(), angles.max(),
                      int(np.count_nonzero(turned * volumes <= 1e-12 * scale)),
                      int(np.count_nonzero(shared > 2) + np.count_nonzero(meeting != 2)),
                      np.abs(volumes).sum() / 6,
                      labels=1 if labels is None else len(np.unique(labels)))
    if distance is not None:
        at = np.concatenate([vertices[np.unique(boundary)], vertices[boundary].mean(axis=1)])
        if len(at) > SAMPLES:
            at = np.random.default_rng(0).choice(at, SAMPLES, replace=False)
        far = np.abs(distance(at))
        verdict.rms, verdict.worst = np.sqrt((far ** 2).mean()), far.max()
    return verdict


def read_mesh(path):
    """(vertices, tets, labels or None) of a file that meshio or VTK reads."""
    import meshio
    mesh = meshio.read(path)
    tets = np.concatenate([block.data for block in mesh.cells if block.type == "tetra"] or
                          [np.empty((0, 4), np.int64)]).astype(np.int64)
    labels = None
    for name in ("label", "medit:ref"):
        if name in mesh.cell_data:
            labels = np.concatenate([values for values, block in zip(mesh.cell_data[name], mesh.cells)
                                     if block.type == "tetra"])
            break
    return np.asarray(mesh.points, dtype=np.float64), tets, labels
