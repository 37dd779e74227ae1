"""Hosts of networks that are not rigid: shells and solids, which deform, and surfaces that move."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from .answers import Vector3
from .weaves import given, vector_of


def _indices(vertices: Sequence[int]) -> Optional[List[int]]:
    return [int(vertex) for vertex in vertices] or None


def _moves(moved: Mapping[int, ArrayLike]) -> Optional[List[Dict[str, Any]]]:
    wire = []
    for vertex, positions in moved.items():
        places = np.asarray(positions, dtype=np.float64)
        if places.ndim == 1:
            places = places[np.newaxis]
        if places.ndim != 2 or places.shape[1] != 3 or len(places) == 0:
            raise ValueError(f"vertex {vertex} is moved to positions of shape {np.shape(positions)}; expected (3,) or (k, 3)")
        wire.append({"vertex": int(vertex), "positions": places.tolist()})
    return wire or None


@dataclass(frozen=True)
class Shell:
    """The mesh as a thin elastic shell, which is at rest in the mesh's shape: neo-Hookean faces under plane stress, and edges
    that resist bending.

    Attributes:
        thickness: mesh units, positive.
        youngs_modulus: energy per cubed mesh unit, positive.
        poisson_ratio: in [-0.99, 0.4999]; 0.3 by default.
        volume_weight: energy per cubed mesh unit, at least 0; adds volume_weight / 2 * (V - volume_scale V0)^2 / V0 for the
            enclosed volume V, V0 that of the mesh, which must then be closed. 0 by default: the volume is free.
        volume_scale: ratio of the volume aimed at to that of the mesh, positive: above 1 the shell is inflated. 1 by default.
        fixed_vertices: indices of fixed vertices.
        moved_vertices: positions to which vertices move once network and host are in equilibrium, by their indices: one of
            shape (3,), or several of shape (k, 3), reached one after the other on straight lines and together with the other
            vertices; mesh units. All else follows from equilibrium to equilibrium. None of them is fixed; together with the
            fixed ones they are three vertices or more, not all on one line.
    """

    thickness: float
    youngs_modulus: float
    poisson_ratio: Optional[float] = None
    volume_weight: Optional[float] = None
    volume_scale: Optional[float] = None
    fixed_vertices: Sequence[int] = ()
    moved_vertices: Mapping[int, ArrayLike] = field(default_factory=dict)

    def to_wire(self) -> Dict[str, Any]:
        return {"kind": "shell", "thickness": float(self.thickness), "youngs_modulus": float(self.youngs_modulus),
                **given(poisson_ratio=self.poisson_ratio, volume_weight=self.volume_weight, volume_scale=self.volume_scale,
                        fixed_vertices=_indices(self.fixed_vertices), moved_vertices=_moves(self.moved_vertices))}


@dataclass(frozen=True)
class SolidRegion:
    """A box in which a `Solid` has a Young's modulus of its own.

    Attributes:
        lower, upper: its corners, mesh units; it contains the tetrahedra whose centres at rest are inside.
        youngs_modulus: energy per cubed mesh unit, positive.
    """

    lower: Vector3
    upper: Vector3
    youngs_modulus: float

    def to_wire(self) -> Dict[str, Any]:
        return {"lower": vector_of(self.lower, 3, "lower"), "upper": vector_of(self.upper, 3, "upper"),
                "youngs_modulus": float(self.youngs_modulus)}


@dataclass(frozen=True)
class Solid:
    """The closed mesh as the surface of an elastic solid, which is at rest in the mesh's shape: neo-Hookean linear tetrahedra.

    Attributes:
        youngs_modulus: energy per cubed mesh unit, positive.
        poisson_ratio: in [-0.99, 0.4999]; 0.3 by default. From 0.49 on linear tetrahedra are too stiff.
        element_size: length of inner edges, mesh units, positive; None takes the mean edge of the mesh.
        regions: boxes with a modulus of their own; where several overlap, the last one applies.
        gravity: force per volume at rest, energy per mesh unit to the fourth; needs three fixed vertices that are not on one
            line. None for none.
        fixed_vertices: indices of fixed vertices of the mesh.
        moved_vertices: positions to which vertices move once network and host are in equilibrium, by their indices: one of
            shape (3,), or several of shape (k, 3), reached one after the other on straight lines and together with the other
            vertices; mesh units. All else follows from equilibrium to equilibrium. None of them is fixed; together with the
            fixed ones they are three vertices or more, not all on one line.
    """

    youngs_modulus: float
    poisson_ratio: Optional[float] = None
    element_size: Optional[float] = None
    regions: Sequence[SolidRegion] = ()
    gravity: Optional[Vector3] = None
    fixed_vertices: Sequence[int] = ()
    moved_vertices: Mapping[int, ArrayLike] = field(default_factory=dict)

    def to_wire(self) -> Dict[str, Any]:
        return {"kind": "solid", "youngs_modulus": float(self.youngs_modulus),
                **given(poisson_ratio=self.poisson_ratio, element_size=self.element_size,
                        regions=[region.to_wire() for region in self.regions] or None,
                        gravity=vector_of(self.gravity, 3, "gravity"),
                        fixed_vertices=_indices(self.fixed_vertices), moved_vertices=_moves(self.moved_vertices))}


@dataclass(frozen=True)
class Moving:
    """The mesh as a surface that moves through given positions, whatever the network. The network first reaches equilibrium on
    the mesh and then follows the surface from equilibrium to equilibrium.

    Attributes:
        positions: sets of positions of all vertices, arrays of shape (vertices, 3), mesh units. They are reached one after the
            other on straight lines that begin at the mesh.
    """

    positions: Sequence[ArrayLike]

    def to_wire(self) -> Dict[str, Any]:
        sets = [np.asarray(vertices, dtype=np.float64) for vertices in self.positions]
        for vertices in sets:
            if vertices.ndim != 2 or vertices.shape[1] != 3:
                raise ValueError(f"positions of the vertices have the shape {vertices.shape}; expected (vertices, 3)")
        return {"kind": "moving", "positions": [vertices.tolist() for vertices in sets]}


Host = Union[Shell, Solid, Moving]
"""A host of a network other than a rigid surface."""
