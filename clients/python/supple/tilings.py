"""Families of tilings and their beam structures.

A tiling's edges are beams of one width, which form the solid structure. Lengths are in millimetres, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .answers import Array, Cost, cost_from_wire
from .drawing import Area, Drawing
from .jobs import Computation
from .shown import Drawn, Shown, short_text
from .transport import Answer

FILE_TYPES = {"svg": "image/svg+xml", "dxf": "image/vnd.dxf", "stl": "model/stl"}


@dataclass(frozen=True, repr=False)
class Family(Shown):
    """A family of tilings.

    Attributes:
        id: its name, such as "IH21".
        description: its description.
        lower, upper, default: bounds and default of each parameter, shape (n,), dimensionless.
        beam_width: width of the beams in tiling units; `printed_beam_width` is the same in mm.
        scale: millimetres in one tiling unit.
        tiles: tiles in one periodic cell.
        lattice: the two translations of the cell with default parameters, as rows, shape (2, 2), mm.
        cell_area: area of this cell, holes included, mm^2.
        relative_density: fraction of this cell that is solid.
    """

    id: str
    description: str
    lower: Array
    upper: Array
    default: Array
    beam_width: float
    printed_beam_width: float
    scale: float
    tiles: int
    lattice: Array
    cell_area: float
    relative_density: float


@dataclass(frozen=True, repr=False)
class Tile(Shown):
    """A tile in its place in the cell: its corners counterclockwise, shape (n, 2), mm."""

    outline: Array
    holes: Tuple[Array, ...]


@dataclass(frozen=True, repr=False)
class CellMesh(Shown):
    """Statistics of the mesh of one cell: quadratic triangles, sides in mm, angles in radians."""

    nodes: int
    triangles: int
    smallest_angle: float
    shortest_side: float
    longest_side: float
    relative_density: float


@dataclass(frozen=True, repr=False)
class Structure(Drawn):
    """One periodic cell of a beam structure: its tiles minus their holes.

    Attributes:
        family, parameters: the family and parameters of its tiling.
        beam_width: mm.
        scale: millimetres in one tiling unit.
        lattice: the cell's two translations as rows, shape (2, 2), mm.
        tiles: the cell's tiles with their holes.
        cell_area, solid_area: mm^2; `relative_density` is their ratio.
        mesh: None if no mesh option was given.
    """

    family: str
    parameters: Array
    beam_width: float
    scale: float
    lattice: Array
    tiles: Tuple[Tile, ...]
    cell_area: float
    solid_area: float
    relative_density: float
    mesh: Optional[CellMesh]
    cost: Cost

    def _drawing(self) -> Drawing:
        shifts = [i * self.lattice[0] + j * self.lattice[1] for i in range(2) for j in range(2)]
        areas = tuple(
            Area(tuple(ring + shift for ring in (tile.outline, *tile.holes))) for shift in shifts for tile in self.tiles
        )
        title = f"{self.family} {short_text(self.parameters)}, {100 * self.relative_density:.3g} % solid, 2 x 2 cells"
        return Drawing("map", (), areas, title)


def _array(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


def family_from_wire(document: Mapping[str, Any]) -> Family:
    parameters, cell = document["parameters"], document["cell"]
    return Family(
        id=str(document["id"]),
        description=str(document["description"]),
        lower=_array(parameters["lower"]),
        upper=_array(parameters["upper"]),
        default=_array(parameters["default"]),
        beam_width=float(document["beam_width"]),
        printed_beam_width=float(document["printed_beam_width"]),
        scale=float(document["scale"]),
        tiles=int(cell["tiles"]),
        lattice=_array(cell["lattice"]),
        cell_area=float(cell["area"]),
        relative_density=float(cell["relative_density"]),
    )


def structure_from_wire(document: Mapping[str, Any]) -> Structure:
    mesh = document.get("mesh")
    return Structure(
        family=str(document["family"]),
        parameters=_array(document["parameters"]),
        beam_width=float(document["beam_width"]),
        scale=float(document["scale"]),
        lattice=_array(document["lattice"]),
        tiles=tuple(
            Tile(_array(tile["outline"]), tuple(_array(hole) for hole in tile["holes"])) for tile in document["tiles"]
        ),
        cell_area=float(document["cell_area"]),
        solid_area=float(document["solid_area"]),
        relative_density=float(document["relative_density"]),
        mesh=None
        if mesh is None
        else CellMesh(
            nodes=int(mesh["nodes"]),
            triangles=int(mesh["triangles"]),
            smallest_angle=float(mesh["smallest_angle"]),
            shortest_side=float(mesh["shortest_side"]),
            longest_side=float(mesh["longest_side"]),
            relative_density=float(mesh["relative_density"]),
        ),
        cost=cost_from_wire(document["cost"]),
    )


def structure_to_wire(family: str, parameters: Optional[Sequence[float]]) -> Dict[str, Any]:
    """The fields of a request that describe a structure."""
    document: Dict[str, Any] = {"family": family}
    if parameters is not None:
        document["parameters"] = [float(parameter) for parameter in parameters]
    return document


def structure(
    family: str,
    parameters: Optional[Sequence[float]],
    beam_width: Optional[float],
    mesh_size: Optional[float],
    corner_size: Optional[float],
    mesh_region: Optional[str],
    deadline: Optional[float],
) -> Computation[Structure]:
    document = structure_to_wire(family, parameters)
    if beam_width is not None:
        document["beam_width"] = float(beam_width)
    mesh = {"mesh_size": mesh_size, "corner_size": corner_size, "mesh_region": mesh_region}
    if any(value is not None for value in mesh.values()):
        document["mesh"] = {name: value for name, value in mesh.items() if value is not None}
    if deadline is not None:
        document["deadline"] = deadline
    return Computation("/v1/structures", document, lambda answer: structure_from_wire(answer.json()))


def structure_file(
    family: str,
    parameters: Optional[Sequence[float]],
    kind: str,
    cells: Tuple[int, int],
    height: float,
    beam_width: Optional[float],
) -> Computation[bytes]:
    if kind not in FILE_TYPES:
        raise ValueError(f"{kind!r} is no kind of file; there are {', '.join(FILE_TYPES)}")
    first, second = cells
    document = {**structure_to_wire(family, parameters), "cells": [int(first), int(second)], "height": float(height)}
    if beam_width is not None:
        document["beam_width"] = float(beam_width)

    def decode(answer: Answer) -> bytes:
        return answer.content

    return Computation("/v1/structures", document, decode, accept=FILE_TYPES[kind])


def families_from_wire(documents: List[Mapping[str, Any]]) -> List[Family]:
    return [family_from_wire(document) for document in documents]
