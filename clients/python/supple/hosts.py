"""Hosts of networks that are not rigid: shells and solids, which deform, and surfaces that move."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import IndexList, Vector3Like
from .wire import At, Sent, Shape, numbers


def _moves(moved: Mapping[int, ArrayLike], name: str) -> List[Dict[str, Any]]:
    wire = []
    for vertex, positions in moved.items():
        places = np.asarray(positions, dtype=np.float64)
        if places.ndim == 1:
            places = places[np.newaxis]
        if places.ndim != 2 or places.shape[1] != 3 or len(places) == 0:
            raise ValueError(f"vertex {vertex} is moved to positions of shape {np.shape(positions)}; expected (3,) or (k, 3)")
        wire.append({"vertex": int(vertex), "positions": places.tolist()})
    return wire


@dataclass(frozen=True)
class Shell(Sent, kind="shell"):
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
    fixed_vertices: IndexList = ()
    moved_vertices: Annotated[Mapping[int, ArrayLike], At(write=_moves)] = field(default_factory=dict)


@dataclass(frozen=True)
class SolidRegion(Sent):
    """A box in which a `Solid` has a Young's modulus of its own.

    Attributes:
        lower, upper: its corners, mesh units; it contains the tetrahedra whose centres at rest are inside.
        youngs_modulus: energy per cubed mesh unit, positive.
    """

    lower: Vector3Like
    upper: Vector3Like
    youngs_modulus: float


@dataclass(frozen=True)
class Solid(Sent, kind="solid"):
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
    gravity: Optional[Vector3Like] = None
    fixed_vertices: IndexList = ()
    moved_vertices: Annotated[Mapping[int, ArrayLike], At(write=_moves)] = field(default_factory=dict)


def _sets(positions: Sequence[ArrayLike], name: str) -> List[Any]:
    return [numbers(vertices, name, Shape(-1, 3)) for vertices in positions]


@dataclass(frozen=True)
class Moving(Sent, kind="moving"):
    """The mesh as a surface that moves through given positions, whatever the network. The network first reaches equilibrium on
    the mesh and then follows the surface from equilibrium to equilibrium.

    Attributes:
        positions: sets of positions of all vertices, arrays of shape (vertices, 3), mesh units. They are reached one after the
            other on straight lines that begin at the mesh.
    """

    positions: Annotated[Sequence[ArrayLike], At(write=_sets)]


Host = Union[Shell, Solid, Moving]
"""A host of a network other than a rigid surface."""
