"""Energies of shells and solids from the positions of their vertices, by the definitions in the documents."""

from __future__ import annotations

import re
from typing import Dict, Tuple

import numpy as np

from _networks import neo_hookean_triangles
from _surface import Surface


def enclosed_volume(surface: Surface, positions: np.ndarray) -> float:
    a, b, c = (positions[surface.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


def _sides(surface: Surface, positions: np.ndarray) -> np.ndarray:
    corners = positions[surface.faces]
    return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)


def _hinges(surface: Surface) -> np.ndarray:
    """One halfedge of each inner edge."""
    return np.array([h for h, twin in enumerate(surface.twin) if twin > h], dtype=int)


def _fold_angles(surface: Surface, positions: np.ndarray, hinges: np.ndarray) -> np.ndarray:
    a, b, c = (positions[surface.faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    left, right = normals[hinges // 3], normals[surface.twin[hinges] // 3]
    edge = positions[surface.end[hinges]] - positions[surface.start[hinges]]
    edge /= np.linalg.norm(edge, axis=1)[:, None]
    return np.arctan2(np.einsum("ij,ij->i", edge, np.cross(left, right)), np.einsum("ij,ij->i", left, right))


def shell_energies(surface: Surface, host: Dict[str, float], positions: np.ndarray) -> Dict[str, float]:
    """The energy terms of a shell that is at rest in the shape of `surface`."""
    young, nu, thickness = host["youngs_modulus"], host["poisson_ratio"], host["thickness"]
    stretched = neo_hookean_triangles(_sides(surface, positions), _sides(surface, surface.vertices), young / (2 * (1 + nu)), young * nu / (1 - nu**2))
    hinges = _hinges(surface)
    change = _fold_angles(surface, positions, hinges) - _fold_angles(surface, surface.vertices, hinges)
    change = (change + np.pi) % (2 * np.pi) - np.pi
    areas = surface.face_areas[hinges // 3] + surface.face_areas[surface.twin[hinges] // 3]
    bending = young * thickness**3 / (12 * (1 - nu**2))
    terms = {"shell_membrane": thickness * float(stretched.sum()), "shell_bending": float((bending / 2 * surface.length[hinges] ** 2 / areas * change**2).sum())}
    if host.get("volume_weight", 0):
        at_rest = enclosed_volume(surface, surface.vertices)
        terms["shell_volume"] = host["volume_weight"] / 2 * (enclosed_volume(surface, positions) - host.get("volume_scale", 1) * at_rest) ** 2 / at_rest
    return terms


def tetrahedron_volumes(nodes: np.ndarray, tetrahedra: np.ndarray) -> np.ndarray:
    corners = nodes[tetrahedra]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6


def solid_energies(rest: np.ndarray, tetrahedra: np.ndarray, host: Dict[str, object], nodes: np.ndarray) -> Dict[str, float]:
    """The energy with the density mu / 2 (tr C - 3) - mu log J + lambda / 2 log(J)^2 per volume at rest, and that of gravity. It is infinite
    if a tetrahedron is inverted."""
    young, nu = float(host["youngs_modulus"]), float(host["poisson_ratio"])  # type: ignore[arg-type]
    mu, lame = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
    before, after = (np.swapaxes(at[tetrahedra][:, 1:] - at[tetrahedra][:, :1], 1, 2) for at in (rest, nodes))
    deformation = after @ np.linalg.inv(before)
    j, volumes = np.linalg.det(deformation), tetrahedron_volumes(rest, tetrahedra)
    with np.errstate(invalid="ignore", divide="ignore"):
        log_j = np.log(j)
        density = mu / 2 * (np.einsum("kij,kij->k", deformation, deformation) - 3) - mu * log_j + lame / 2 * log_j**2
    terms = {"solid": float((volumes * np.where(j > 0, density, np.inf)).sum())}
    if "gravity" in host:
        way = (nodes - rest)[tetrahedra].mean(axis=1)
        terms["gravity"] = -float((volumes[:, None] * way * np.array(host["gravity"])).sum())
    return terms


def host_of_vtu(text: str) -> Tuple[np.ndarray, np.ndarray]:
    """The nodes and the tetrahedra of a solid in a VTK file; the first nodes are the vertices of the mesh."""

    def numbers(name: str) -> np.ndarray:
        found = re.search(rf'Name="{name}"[^>]*>(.*?)</DataArray>', text, re.DOTALL)
        assert found, name
        return np.array(found[1].split(), dtype=float)

    points, types, ends = numbers("Points").reshape(-1, 3), numbers("types"), numbers("offsets").astype(int)
    connectivity, begins = numbers("connectivity").astype(int), np.concatenate([[0], ends[:-1]])
    tetrahedra = np.array([connectivity[begin:end] for begin, end, kind in zip(begins, ends, types) if kind == 10])
    first = int(tetrahedra.min())  # the springs' paths come before the host's nodes, and vertex 0 belongs to a tetrahedron
    return points[first:], tetrahedra - first
