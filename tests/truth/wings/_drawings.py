"""The suite's own drawings of tilings: where a tiling lies in a part, and the beams along the sides of its tiles."""

from __future__ import annotations

from typing import Any, Dict, List

import numpy as np
from shapely.affinity import affine_transform
from shapely.geometry import LinearRing, Polygon
from shapely.ops import unary_union

from _tilings import turned


def placed(pattern: Any, structure: Dict[str, Any], outline: Any, turn: float) -> Any:
    """The copies of one cell's pattern that meet an outline. A lattice point is in the centre of the outline's bounding box, and the tiling is rotated about it."""
    low, high = np.array(outline.bounds[:2]), np.array(outline.bounds[2:])
    middle, reach = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    lattice = np.array(structure["lattice"])
    size = max(float(np.linalg.norm(corner)) for piece in getattr(pattern, "geoms", [pattern]) for corner in piece.exterior.coords)
    rotation = turned(turn)
    copies: List[Any] = []
    count = int(np.ceil(np.max(np.linalg.norm(np.linalg.inv(lattice), axis=0)) * (reach + size))) + 1
    for i in range(-count, count + 1):
        for j in range(-count, count + 1):
            shift = np.array([i, j]) @ lattice
            if np.linalg.norm(shift) <= reach + size:
                copy = affine_transform(pattern, [*rotation.ravel(), *(rotation @ shift + middle)])
                if copy.intersects(outline):
                    copies.append(copy)
    return unary_union(copies)


def holes(structure: Dict[str, Any]) -> Any:
    """The holes of one cell as the server answers them."""
    return unary_union([Polygon(hole).buffer(0) for tile in structure["tiles"] for hole in tile["holes"]])


def beams(structure: Dict[str, Any]) -> Any:
    """The beams of one cell, drawn from the sides of its tiles alone: what lies within half the width of a beam of a side. Joints are square, and cut off by the tangent
    to the circle around the corner."""
    half = structure["beam_width"] / 2
    drawn: List[Any] = []
    for tile in structure["tiles"]:
        inside = Polygon(tile["outline"])
        if inside.is_valid:
            drawn.append(inside.difference(inside.buffer(-half, join_style=2, mitre_limit=1)))
        else:  # The tile crosses itself.
            drawn.append(LinearRing(tile["outline"]).buffer(half, join_style=2, mitre_limit=1))
    return unary_union(drawn)


def differing(part: Any, solid: Any, checks: Dict[str, Any], outline: Any) -> float:
    """The area between a part and its drawing over that of the outline, less what `checks` says was left out or added."""
    strips = 6 * (checks["widened_necks"] + checks["cut_necks"]) * checks["smallest_wall"] ** 2
    allowed = checks["trimmed_area"] + checks["crumb_area"] + strips
    return float(max(0.0, solid.symmetric_difference(part).area - allowed) / outline.area)
