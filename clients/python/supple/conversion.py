"""Conversion of meshes from and to trimesh, meshio and pyvista, none of which this package requires. Their meshes are
recognized by their attributes; conversion to them needs the library."""

from __future__ import annotations

import importlib
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import Array

Faces = NDArray[np.int64]


def arrays_of(mesh: Any) -> Optional[Tuple[Array, Faces]]:
    """Vertices, shape (n, 3), and triangles, shape (m, 3), of a mesh of trimesh, meshio or pyvista; None for other objects.

    Raises `ValueError` if it has faces that are no triangles, or no faces.
    """
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh.Trimesh
        return _positions(mesh.vertices), _triangles(mesh.faces)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):  # meshio.Mesh
        others = sorted(set(mesh.cells_dict) - {"triangle", "line", "vertex"})
        if "triangle" not in mesh.cells_dict or others:
            raise ValueError(f"the mesh has cells of the kinds {', '.join(sorted(mesh.cells_dict)) or 'none'}; expected triangles")
        return _positions(mesh.points), _triangles(mesh.cells_dict["triangle"])
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):  # pyvista.PolyData: 3, a, b, c, 3, ...
        flat = np.asarray(mesh.faces)
        if flat.size == 0 or flat.size % 4 or (flat[::4] != 3).any():
            raise ValueError("the mesh has faces that are no triangles, or none; pyvista's triangulate() divides them")
        return _positions(mesh.points), _triangles(flat.reshape(-1, 4)[:, 1:])
    return None


def _positions(values: Any) -> Array:
    positions = np.asarray(values, dtype=np.float64)
    if positions.ndim == 2 and positions.shape[1] == 2:
        positions = np.column_stack([positions, np.zeros(len(positions))])
    return positions


def _triangles(values: Any) -> Faces:
    faces = np.asarray(values, dtype=np.int64)
    if faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0:
        raise ValueError(f"the mesh has faces of the shape {faces.shape}; expected triangles, (m, 3)")
    return faces


def _library(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"a mesh of {name} needs the library {name}, which is not installed (pip install {name})") from error


def to_trimesh(vertices: Array, faces: NDArray[np.int32]) -> Any:
    # The clean-up of trimesh (process=True) would renumber vertices.
    return _library("trimesh").Trimesh(vertices=vertices, faces=faces, process=False)


def to_meshio(vertices: Array, faces: NDArray[np.int32]) -> Any:
    return _library("meshio").Mesh(vertices, [("triangle", faces)])


def to_pyvista(vertices: Array, faces: NDArray[np.int32]) -> Any:
    corners = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    return _library("pyvista").PolyData(vertices, corners)
