"""Solids as expressions: primitives and volumes, put together by operators."""

from __future__ import annotations

import json
import math
import numbers
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ._errors import invalid
from ._names import Point, point
from ._volume import Volume

_LEAF_KEY = "name"


class Solid:
    """A solid as a formula, which is meshed like a volume but sampled nowhere: docs/scenes.md.

        plate = ts.box((4, 4, 1), rounding=0.1)
        part = plate - ts.cylinder(0.5, 2) - ts.sphere(1).move(z=1)
        mesh = ts.mesh(part, spacing=0.05)

    Made by `sphere`, `box` and the others, which are centred at the origin with their axis along z, and by
    operators: `a | b` (or `a + b`) is the union, `a & b` the intersection, `a - b` what is left of a. The
    functions `union`, `intersection` and `difference` take several at once and blend their seams. A Volume
    is taken wherever a solid is. Solids are never changed, and may be used any number of times.

    Lengths are world units. What cannot be, as a radius that is not positive, is said when it is meshed.
    """

    __slots__ = ("_fields", "_kind", "_leaf", "_parts")

    def __init__(
        self, kind: str, fields: Mapping[str, Any], parts: Sequence[Solid] = (), leaf: Any = None
    ) -> None:
        self._kind = kind
        self._fields = dict(fields)
        self._parts = tuple(parts)
        self._leaf = leaf

    def __or__(self, other: Solid | Volume) -> Solid:
        return union(self, other)

    def __ror__(self, other: Volume) -> Solid:
        return union(other, self)

    __add__, __radd__ = __or__, __ror__

    def __and__(self, other: Solid | Volume) -> Solid:
        return intersection(self, other)

    def __rand__(self, other: Volume) -> Solid:
        return intersection(other, self)

    def __sub__(self, other: Solid | Volume) -> Solid:
        return difference(self, other)

    def __rsub__(self, other: Volume) -> Solid:
        return difference(other, self)

    def move(self, x: float = 0, y: float = 0, z: float = 0) -> Solid:
        """The solid, moved by world units along the axes."""
        return self._transformed(translation=[float(x), float(y), float(z)])

    def rotate(self, degrees: float, axis: Point = (0, 0, 1)) -> Solid:
        """The solid, turned around an axis through the origin; counter-clockwise, seen from its tip."""
        return self._transformed(axis=list(point("axis", axis)), angle_deg=float(degrees))

    def scale(self, factor: float | Point) -> Solid:
        """The solid, scaled about the origin by a number, or by three along the axes."""
        return self._transformed(scale=_three("factor", factor))

    def offset(self, distance: float) -> Solid:
        """The solid, grown by a distance on all sides; shrunk where that is negative."""
        return Solid("offset", {"distance": float(distance)}, [self])

    def shell(self, thickness: float) -> Solid:
        """A wall along the solid's surface, half of it on either side."""
        return Solid("shell", {"thickness": float(thickness)}, [self])

    def repeat(self, count: Sequence[int], step: Point) -> Solid:
        """The union of count[0] * count[1] * count[2] copies, moved by 0, 1, ... steps along each axis."""
        if len(count) != 3:
            raise invalid(f"count has {len(count)} numbers; three are needed")
        return Solid("repeat", {"count": [int(n) for n in count], "step": list(point("step", step))}, [self])

    def to_json(self) -> str:
        """The text of a scene file, as `tetstream mesh` takes it. Errors: InvalidArgumentError (a volume of
        this process is in it, which such a file cannot name)."""
        def name(leaf: Any, grid: str) -> str:
            if isinstance(leaf, (str, os.PathLike)):
                return os.fspath(leaf)
            if hasattr(leaf, "grid"):  # a StoredVolume: a server's, or a file that this process has taken
                named = leaf._path if leaf._is_here else leaf.name
                if named is not None:
                    return str(named)
            raise invalid("a scene file cannot hold a Volume: write it (write_vdb), and use ts.grid(path)")

        return json.dumps({"nodes": self._nodes(name)}, indent=1)

    @classmethod
    def from_json(cls, text: str) -> Solid:
        """Reads the text of a scene file. Grids are named by the paths of .vdb files, from here on. Errors:
        InvalidArgumentError (no such text; says where)."""
        return _read(text)

    def _transformed(self, **fields: Any) -> Solid:
        return Solid("transform", fields, [self])

    def _leaves(self) -> list[Any]:
        """What the grids of it are: volumes, stored ones and paths; each once."""
        leaves: dict[int, Any] = {id(node._leaf): node._leaf for node in self._walk() if node._kind == "grid"}
        return list(leaves.values())

    def _nodes(self, name_of: Any) -> list[dict[str, Any]]:
        """The list of nodes that scene files have. `name_of` gives a leaf its name, and may ask which grid of it is meant."""
        names: dict[int, str] = {}
        nodes = []
        for node in self._walk():
            names[id(node)] = f"n{len(names)}"
            fields = dict(node._fields)
            if node._kind == "grid":
                fields[_LEAF_KEY] = name_of(node._leaf, fields.get("grid_name", ""))
            elif node._kind in _COMBINATIONS:
                fields["of"] = [names[id(part)] for part in node._parts]
            elif node._parts:
                fields["of"] = names[id(node._parts[0])]
            nodes.append({"name": names[id(node)], node._kind: fields})
        return nodes

    def _walk(self) -> Iterator[Solid]:
        """Every node once, each after its parts."""
        seen: set[int] = set()
        ahead: list[tuple[Solid, bool]] = [(self, False)]
        while ahead:
            node, parts_done = ahead.pop()
            if id(node) in seen:
                continue
            if parts_done:
                seen.add(id(node))
                yield node
            else:
                ahead.append((node, True))
                ahead.extend((part, False) for part in reversed(node._parts))

    def __repr__(self) -> str:
        kinds = [node._kind for node in self._walk()]
        of = f" of {len(kinds) - 1} parts" if len(kinds) > 1 else ""
        return f"<tetstream.Solid: {self._kind}{of}>"


_COMBINATIONS = ("union", "intersection", "difference")


def sphere(radius: float, center: Point = (0, 0, 0)) -> Solid:
    """A ball."""
    return _placed(Solid("sphere", {"radius": float(radius)}), center)


def ellipsoid(semi_axes: Point, center: Point = (0, 0, 0)) -> Solid:
    """An ellipsoid with three semi-axes along x, y and z."""
    return _placed(Solid("ellipsoid", {"semi_axes": list(point("semi_axes", semi_axes))}), center)


def box(size: float | Point, *, rounding: float = 0, center: Point = (0, 0, 0)) -> Solid:
    """A box of three edges along x, y and z, or a cube; `rounding` is the radius of edges and corners."""
    return _placed(Solid("rounded_box", {"size": _three("size", size), "rounding": float(rounding)}), center)


def cylinder(radius: float, height: float, center: Point = (0, 0, 0)) -> Solid:
    """A cylinder along z."""
    return _placed(Solid("cylinder", {"radius": float(radius), "height": float(height)}), center)


def cone(bottom_radius: float, top_radius: float, height: float, center: Point = (0, 0, 0)) -> Solid:
    """A cone along z, cut off at a radius at its bottom and its top; one of them may be 0."""
    fields = {"bottom_radius": float(bottom_radius), "top_radius": float(top_radius), "height": float(height)}
    return _placed(Solid("cone", fields), center)


def torus(major_radius: float, minor_radius: float, center: Point = (0, 0, 0)) -> Solid:
    """A torus around z: the radius of its circle, and that of the tube around it."""
    fields = {"major_radius": float(major_radius), "minor_radius": float(minor_radius)}
    return _placed(Solid("torus", fields), center)


def capsule(radius: float, length: float, center: Point = (0, 0, 0)) -> Solid:
    """A capsule along z; `length` is from centre to centre of its half balls."""
    return _placed(Solid("capsule", {"radius": float(radius), "length": float(length)}), center)


def half_space(normal: Point, offset: float = 0) -> Solid:
    """All that lies behind a plane at `offset` along its normal. It has no end: cut it, or mesh it in a `box`."""
    return Solid("half_space", {"normal": list(point("normal", normal)), "offset": float(offset)})


def gyroid(period: float, thickness: float | None = None) -> Solid:
    """A gyroid: a sheet at least so thick, or all on its inner side. It has no end."""
    return _periodic("gyroid", period, thickness)


def schwarz_p(period: float, thickness: float | None = None) -> Solid:
    """A Schwarz P surface: a sheet at least so thick, or all on its inner side. It has no end."""
    return _periodic("schwarz_p", period, thickness)


def diamond(period: float, thickness: float | None = None) -> Solid:
    """A diamond surface: a sheet at least so thick, or all on its inner side. It has no end."""
    return _periodic("diamond", period, thickness)


def grid(
    volume: Any, name: str = "", *, iso: float | None = None, inside: str | None = None
) -> Solid:
    """What is inside of a volume, as a solid.

    volume   a Volume, the path of a .vdb file, or what `upload` returned
    name     of the grid within the file; unless given that of the upload, or the only one that can be meshed
    iso      the surface's value; unless given 0 for level sets and 0.5 for densities
    inside   "above" or "below" the iso value; unless given what the grid says
    """
    fields: dict[str, Any] = {}
    chosen = name or getattr(volume, "grid", "")  # a StoredVolume has one
    if chosen:
        fields["grid_name"] = chosen
    if iso is not None:
        fields["iso"] = float(iso)
    if inside is not None:
        fields["inside"] = inside
    return Solid("grid", fields, leaf=volume)


def union(*parts: Solid | Volume, smoothing: float = 0) -> Solid:
    """What is in any of the parts. Surfaces that are less than `smoothing` apart are blended."""
    return _combined("union", parts, smoothing)


def intersection(*parts: Solid | Volume, smoothing: float = 0) -> Solid:
    """What is in all of the parts. Surfaces that are less than `smoothing` apart are blended."""
    return _combined("intersection", parts, smoothing)


def difference(*parts: Solid | Volume, smoothing: float = 0) -> Solid:
    """The first part without all others. Surfaces that are less than `smoothing` apart are blended."""
    return _combined("difference", parts, smoothing)


def read_scene(path: str | os.PathLike[str]) -> Solid:
    """Reads a scene file (docs/scenes.md). Paths of grids are seen from its folder, or else from here.

    Errors: OSError (the file), InvalidArgumentError (what it holds; says where).
    """
    folder = os.path.dirname(os.fspath(path))
    with open(path, encoding="utf-8") as file:
        return _read(file.read(), folder)


def _as_solid(thing: Solid | Volume) -> Solid:
    if isinstance(thing, Solid):
        return thing
    if isinstance(thing, Volume):
        return grid(thing)
    raise TypeError(f"a solid or a Volume is needed, and this is {type(thing).__name__}")


def _placed(solid: Solid, center: Point) -> Solid:
    x, y, z = point("center", center)
    return solid.move(x, y, z) if (x, y, z) != (0, 0, 0) else solid


def _three(name: str, value: float | Point) -> list[float]:
    if isinstance(value, (int, float, numbers.Real)):
        return [float(value)] * 3
    return list(point(name, value))


def _periodic(kind: str, period: float, thickness: float | None) -> Solid:
    fields = {"period": float(period)}
    if thickness is not None:
        fields["thickness"] = float(thickness)
    return Solid(kind, fields)


def _combined(kind: str, parts: Sequence[Solid | Volume], smoothing: float) -> Solid:
    """Without blends a | b | c is one node: long chains are no deep ones."""
    if not parts:
        raise invalid(f"{kind} of no parts; one or more are needed")
    if not math.isfinite(smoothing):
        raise invalid(f"smoothing {smoothing} is not finite")
    solids: list[Solid] = []
    for i, solid in enumerate(map(_as_solid, parts)):
        alike = solid._kind == kind and not solid._fields.get("smoothing") and not smoothing
        solids.extend(solid._parts if alike and (i == 0 or kind != "difference") else [solid])
    return Solid(kind, {"smoothing": float(smoothing)} if smoothing else {}, solids)


def _read(text: str, folder: str = "") -> Solid:
    try:
        nodes = json.loads(text)["nodes"]
        made: dict[str, Solid] = {}
        solid = None
        for node in nodes:
            solid = _read_node(node, made, folder)
            made[node.get("name", "")] = solid
    except (ValueError, TypeError, LookupError, AttributeError) as error:
        raise invalid(f"the text is not a scene: {error!r}") from None
    if solid is None:
        raise invalid("the text is not a scene: it has no nodes")
    return solid


def _read_node(node: Mapping[str, Any], made: Mapping[str, Solid], folder: str) -> Solid:
    kinds = [key for key in node if key != "name"]
    if len(kinds) != 1:
        raise ValueError(f"a node is of {len(kinds)} kinds")
    fields = dict(node[kinds[0]])
    parts = fields.pop("of", [])
    solids = [made[name] for name in ([parts] if isinstance(parts, str) else parts)]
    leaf = fields.pop(_LEAF_KEY) if kinds[0] == "grid" else None
    if leaf is not None and not leaf.startswith("grids/"):
        beside = os.path.join(folder, leaf)
        leaf = beside if os.path.exists(beside) else leaf
    return Solid(kinds[0], fields, solids, leaf)
