"""Points on a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, Sequence, Tuple, Union


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


PointLike = Union[SurfacePoint, Vertex, int, Tuple[int, Sequence[float]]]
"""What the calls accept as a point: a `SurfacePoint`, a `Vertex`, a plain vertex index, or `(face, (a, b, c))`."""


def point_to_wire(point: PointLike) -> Dict[str, Any]:
    """The JSON form of a point. Raises `TypeError` or `ValueError` where it is none."""
    if isinstance(point, (SurfacePoint, Vertex)):
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
