"""Points on a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Sequence, Tuple, Union


@dataclass(frozen=True)
class SurfacePoint:
    """A point in a face.

    Attributes:
        face: index of the face, from 0.
        barycentric: three coordinates, nonnegative and of sum 1, in the order of the face's corners.
    """

    face: int
    barycentric: Tuple[float, float, float]

    def to_wire(self) -> Dict[str, Any]:
        return {"face": int(self.face), "barycentric": [float(b) for b in self.barycentric]}


@dataclass(frozen=True)
class Vertex:
    """A vertex of the mesh as a point; `index` counts from 0."""

    index: int

    def to_wire(self) -> Dict[str, Any]:
        return {"vertex": int(self.index)}


@dataclass(frozen=True)
class SpacePoint:
    """A point in space, in mesh units; the point of the surface that is nearest to it is meant. Answers say in
    `points_in_space` which that is, and how far away."""

    x: float
    y: float
    z: float

    def to_wire(self) -> Dict[str, Any]:
        coordinates = [float(self.x), float(self.y), float(self.z)]
        if not all(math.isfinite(coordinate) for coordinate in coordinates):
            raise ValueError(f"the coordinates {tuple(coordinates)} are not finite")
        return {"position": coordinates}


@dataclass(frozen=True)
class PlacedPoint:
    """Where a point in space of a request lies on the surface.

    Attributes:
        pointer: to the point in the request, such as "/pairs/3/from" or "/sources/0".
        point: the nearest point of the surface; `position` is the same in space, mesh units.
        distance: from the point in space to the surface, mesh units.
    """

    pointer: str
    point: SurfacePoint
    position: Tuple[float, float, float]
    distance: float


PointLike = Union[SurfacePoint, Vertex, SpacePoint, int, Tuple[int, Sequence[float]]]
"""What the calls accept as a point: a `SurfacePoint`, a `Vertex`, a `SpacePoint`, a plain vertex index, or
`(face, (a, b, c))`."""


def point_to_wire(point: PointLike) -> Dict[str, Any]:
    """The JSON form of a point. Raises `TypeError` or `ValueError` where it is none."""
    if isinstance(point, (SurfacePoint, Vertex, SpacePoint)):
        return point.to_wire()
    if isinstance(point, bool):
        raise TypeError("a surface point is not a bool")
    if isinstance(point, tuple):
        if len(point) != 2:
            raise ValueError(f"a surface point as a tuple is (face, (a, b, c)), not {point!r}")
        face, barycentric = point
        coordinates = [float(b) for b in barycentric]
        if len(coordinates) != 3:
            raise ValueError(f"a surface point has three barycentric coordinates, not {len(coordinates)}")
        if not all(math.isfinite(b) for b in coordinates):
            raise ValueError(f"the barycentric coordinates {tuple(coordinates)} are not finite")
        return {"face": int(face), "barycentric": coordinates}
    if hasattr(point, "__index__"):
        return {"vertex": point.__index__()}
    raise TypeError(f"{point!r} is not a surface point")


def point_from_wire(document: Dict[str, Any]) -> SurfacePoint:
    """The point that an answer holds; answers always name a face."""
    a, b, c = document["barycentric"]
    return SurfacePoint(int(document["face"]), (float(a), float(b), float(c)))


def placed_points_from_wire(document: Mapping[str, Any]) -> Tuple[PlacedPoint, ...]:
    """The points in space of a request, as its answer tells of them; none where it has none."""
    placed = []
    for entry in document.get("points_in_space", ()):
        x, y, z = entry["position"]
        position = (float(x), float(y), float(z))
        placed.append(PlacedPoint(entry["pointer"], point_from_wire(entry), position, float(entry["distance"])))
    return tuple(placed)
