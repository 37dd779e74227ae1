"""Families of tilings and their beam structures.

A tiling's edges are beams of one width, which form the solid structure. Lengths are in millimetres, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Optional, Tuple

from ._arrays import Array, Numbers
from .answers import Cost
from .drawing import Area, Drawing
from .request import Deadline, FileRequest, Kind, Reported, Request, Timeout
from .shown import Drawn, Shown, short_text
from .units import LENGTH, Number
from .wire import At


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
        created: when it was added, RFC 3339 in UTC; None if it comes with the server.
        definition: the family as data, as in its file (schema `FamilyDefinition` of the contract); None for "square".
    """

    id: str
    description: str
    lower: Annotated[Array, At("/parameters/lower")]
    upper: Annotated[Array, At("/parameters/upper")]
    default: Annotated[Array, At("/parameters/default")]
    beam_width: float
    printed_beam_width: float
    scale: float
    tiles: Annotated[int, At("/cell/tiles")]
    lattice: Annotated[Array, At("/cell/lattice")]
    cell_area: Annotated[float, At("/cell/area")]
    relative_density: Annotated[float, At("/cell/relative_density")]
    definition: Optional[Dict[str, Any]] = None
    created: Optional[str] = None


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


@dataclass(frozen=True)
class StructureRequest(Request[Structure], path="/v1/structures"):
    """The beam structure of a tiling: one periodic cell.

    Attributes:
        family: id of the family.
        parameters: within the family's bounds; None takes its defaults. Raises `InvalidStructure` if they give no valid
            structure.
        beam_width: in mm; the whole structure scales with it. 0.3 by default.
        mesh_size: side length of the triangles over beam width. With any mesh option the cell is meshed, and the result
            has the mesh's statistics.
        corner_size: side length at re-entrant corners over that elsewhere, in (0, 1].
        mesh_region: whether single tiles or the whole cell are meshed at a time: "automatic", "tile" or "cell".
    """

    family: str
    parameters: Optional[Numbers] = None
    beam_width: Annotated[Optional[Number], LENGTH] = None
    mesh_size: Annotated[Optional[float], At("/mesh/")] = None
    corner_size: Annotated[Optional[float], At("/mesh/")] = None
    mesh_region: Annotated[Optional[str], At("/mesh/")] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class StructureFileRequest(FileRequest, path="/v1/structures"):
    """A structure as a file: `kind` is "svg", "dxf" or "stl" (binary, extruded by `height` mm). Lengths are in mm."""

    TYPES = {"svg": "image/svg+xml", "dxf": "image/vnd.dxf", "stl": "model/stl"}
    family: str
    parameters: Optional[Numbers] = None
    kind: Kind = "svg"
    cells: Tuple[int, int] = (2, 2)
    height: Annotated[Number, LENGTH] = 1.0
    beam_width: Annotated[Optional[Number], LENGTH] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
