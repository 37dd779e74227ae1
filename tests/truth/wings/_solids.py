"""The suite's own readers for files of plane parts: SVG paths and DXF polylines as polygons with holes, STL and 3MF as triangles."""

from __future__ import annotations

import io
import re
import zipfile
from typing import Any, Iterable, List, Tuple
from xml.etree import ElementTree

import numpy as np
from shapely.geometry import Polygon

Array = Any


def of_rings(rings: Iterable[Any]) -> Any:
    """The region that lies within an odd number of rings. Rings neither cross nor touch, so that each is an outline or a hole by the number of rings
    around it."""
    polygons = sorted((Polygon(ring) for ring in rings), key=lambda polygon: -polygon.area)
    outlines: List[Tuple[Any, List[Any]]] = []
    depths: List[Tuple[Any, int]] = []
    for polygon in polygons:
        inside = polygon.representative_point()
        depth = sum(other.contains(inside) for other, _ in depths)
        depths.append((polygon, depth))
        if depth % 2 == 0:
            outlines.append((polygon, []))
        else:
            next(holes for outline, holes in reversed(outlines) if outline.contains(inside)).append(polygon.exterior.coords)
    parts = [Polygon(outline.exterior.coords, holes) for outline, holes in outlines]
    assert len(parts) == 1, f"{len(parts)} pieces"
    return parts[0]


def svg_rings(text: str) -> List[Array]:
    """The closed curves of all paths, which must have straight sides; y points upwards."""
    rings = []
    for path in re.findall(r' d="([^"]*)"', text):
        assert not set(re.findall(r"[A-Za-z]", path)) - set("MLZ"), "a path of more than straight sides"
        for ring in path.split("Z"):
            numbers = [float(number) for number in re.findall(r"-?\d*\.?\d+(?:e[-+]?\d+)?", ring)]
            if numbers:
                rings.append(np.array(numbers).reshape(-1, 2) * [1, -1])
    return rings


def dxf_rings(text: str) -> List[Array]:
    """The LWPOLYLINE entities of a DXF file."""
    lines = [line.strip() for line in text.splitlines()]
    pairs = list(zip(lines[::2], lines[1::2]))
    start = pairs.index(("2", "ENTITIES"))
    rings: List[List[List[float]]] = []
    inside = False
    for code, value in pairs[start:]:
        if code == "0":
            inside = value == "LWPOLYLINE"
            if inside:
                rings.append([])
        elif inside and code == "10":
            rings[-1].append([float(value)])
        elif inside and code == "20":
            rings[-1][-1].append(float(value))
        elif inside and code == "42":
            assert float(value) == 0, "an arc"
    return [np.array(ring) for ring in rings]


def stl_triangles(data: bytes) -> Array:
    """The triangles of a binary STL file as an array over triangles, corners and axes."""
    count = int(np.frombuffer(data[80:84], dtype="<u4")[0])
    assert len(data) == 84 + 50 * count, "the count does not fit the length"
    facets = np.frombuffer(data[84:], dtype=np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")]))
    return facets["corners"].astype(float)


def package_triangles(data: bytes) -> Array:
    """The triangles of a 3MF package as such an array."""
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        model = ElementTree.fromstring(package.read(next(name for name in package.namelist() if name.endswith(".model"))))
    space = model.tag.split("}")[0] + "}"
    corners = np.array([[float(vertex.get(axis, "nan")) for axis in "xyz"] for vertex in model.iter(space + "vertex")])
    triangles = np.array([[int(triangle.get(corner, "-1")) for corner in ("v1", "v2", "v3")] for triangle in model.iter(space + "triangle")])
    return corners[triangles]


def open_edges(triangles: Array) -> int:
    """Number of edges that do not belong to two triangles in opposite directions. Corners are equal if all their bits are."""
    _, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    sides = index.reshape(-1, 3)
    ahead = np.concatenate([sides[:, [0, 1]], sides[:, [1, 2]], sides[:, [2, 0]]])
    count = int(index.max()) + 1
    keys, times = np.unique(ahead[:, 0] * count + ahead[:, 1], return_counts=True)
    back = np.isin(ahead[:, 1] * count + ahead[:, 0], keys)
    return int(np.sum(times > 1) + np.sum(~back))


def volume(triangles: Array) -> float:
    middle = triangles.reshape(-1, 3).mean(axis=0)
    a, b, c = np.moveaxis(triangles - middle, 1, 0)
    return float(np.sum(np.einsum("ij,ij->i", a, np.cross(b, c))) / 6)
