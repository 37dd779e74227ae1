"""Areas and surfaces in the server's drawings, for the tests of structures."""

from __future__ import annotations

import struct
from typing import Any, Dict, Iterator, List, Tuple

import numpy as np


def polygon_area(points: Any) -> float:
    """Signed area, positive if the corners are counterclockwise."""
    x, y = np.asarray(points, dtype=float).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def perimeter(points: Any) -> float:
    corners = np.asarray(points, dtype=float)
    return float(np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1).sum())


def svg_polygons(path: str) -> List[np.ndarray]:
    """The closed polygons of an SVG path that consists of M, L and Z with absolute coordinates."""
    polygons: List[np.ndarray] = []
    for part in path.replace("z", "Z").split("Z"):
        numbers = [float(word) for word in part.replace("M", " ").replace("L", " ").replace(",", " ").split()]
        if numbers:
            polygons.append(np.array(numbers).reshape(-1, 2))
    return polygons


def dxf_pairs(text: str) -> Iterator[Tuple[int, str]]:
    """(group code, value) of each pair of lines."""
    lines = text.splitlines()
    assert len(lines) % 2 == 0, "a DXF file is pairs of lines"
    for code, value in zip(lines[::2], lines[1::2]):
        yield int(code), value.strip()


def dxf_polylines(text: str) -> List[Dict[str, Any]]:
    """The LWPOLYLINE entities: their points, their flag and the number of vertices that they declare."""
    found: List[Dict[str, Any]] = []
    entity = ""
    for code, value in dxf_pairs(text):
        if code == 0:
            entity = value
            if entity == "LWPOLYLINE":
                found.append({"x": [], "y": [], "flag": 0, "count": 0})
        elif entity == "LWPOLYLINE" and code in (10, 20, 70, 90):
            if code in (10, 20):
                found[-1]["xy"[code == 20]].append(float(value))
            else:
                found[-1]["flag" if code == 70 else "count"] = int(value)
    return found


def stl_triangles(content: bytes) -> np.ndarray:
    """Corners of a binary STL, shape (n, 3, 3)."""
    (count,) = struct.unpack_from("<I", content, 80)
    assert len(content) == 84 + 50 * count
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(content, facet, offset=84)["corners"].astype(float)


def unmatched_edges(triangles: np.ndarray) -> int:
    """Directed edges that no other triangle has in the opposite direction; 0 for a closed, oriented surface."""
    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = corner.reshape(-1, 3)
    edges: Dict[Tuple[int, int], int] = {}
    for a, b in np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).tolist():
        edges[(a, b)] = edges.get((a, b), 0) + 1
    return sum(abs(count - edges.get((b, a), 0)) for (a, b), count in edges.items())


def enclosed_volume(triangles: np.ndarray) -> float:
    return float(np.einsum("ij,ij->i", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])).sum()) / 6
