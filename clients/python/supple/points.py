"""Points on a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Dict, List, Sequence, Tuple, Union

from .wire import At


@dataclass(frozen=True)
class SurfacePoint:
    """A point in a face.

    Attributes:
        face: index of the face, from 0.
        barycentric: three coordinates, nonnegative and with the sum 1, in the order of the face's corners.
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
    """A point in space, mesh units. It stands for the nearest point of the surface, which answers return in `points_in_space`
    with its distance."""

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
    """The nearest point on the surface of a request's point in space.

    Attributes:
        pointer: JSON pointer to the point in the request, such as "/pairs/3/from" or "/sources/0".
        point: the nearest point of the surface; `position` is its position in space, mesh units.
        distance: distance of the point in space from the surface, mesh units.
    """

    pointer: str
    point: Annotated[SurfacePoint, At("")]
    position: Tuple[float, float, float]
    distance: float


PointLike = Union[SurfacePoint, Vertex, SpacePoint, int, Tuple[int, Sequence[float]]]
"""A point as an argument: a `SurfacePoint`, a `Vertex`, a `SpacePoint`, the index of a vertex, or `(face, (a, b, c))`."""


def point_to_wire(point: PointLike, name: str = "") -> Dict[str, Any]:
    """The JSON form of a point. Raises `TypeError` or `ValueError` if it is none."""
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


def points_to_wire(points: Sequence[PointLike], name: str = "") -> List[Dict[str, Any]]:
    return [point_to_wire(point) for point in points]


OnePoint = Annotated[PointLike, At(write=point_to_wire)]
Points = Annotated[Sequence[PointLike], At(write=points_to_wire)]
"""Points in a request."""
