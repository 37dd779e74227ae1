"""Parts to print or cut: outlines that structures fill. Lengths are in millimetres, angles in radians."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import checks
from .answers import Cost, cost_from_wire
from .jobs import Computation
from .transport import Answer

PART_FILE_TYPES = {"svg": "image/svg+xml", "dxf": "image/vnd.dxf", "step": "model/step", "stl": "model/stl", "3mf": "model/3mf"}


def coupon(width: float, length: float, grip_length: Optional[float] = None) -> Dict[str, Any]:
    """The outline of a tensile coupon: `length` of the structure along y between two solid grips (15 mm each)."""
    return {"coupon": _given({"width": width, "length": length, "grip_length": grip_length})}


def block(width: float, height: float, plate: Optional[float] = None) -> Dict[str, Any]:
    """The outline of a compression block: `height` of the structure along y between two solid plates (1 mm each)."""
    return {"block": _given({"width": width, "height": height, "plate": plate})}


def rectangle(width: float, height: float) -> Dict[str, Any]:
    """A rectangle as an outline."""
    return {"rectangle": [float(width), float(height)]}


def polygons(outlines: Sequence[ArrayLike]) -> Dict[str, Any]:
    """Polygons of shape (n, 2) as an outline: what lies within an odd number of them belongs to the part."""
    return {"polygons": [_polygon(outline) for outline in outlines]}


@dataclass(frozen=True)
class PartRegion:
    """A region of a part with a structure of its own.

    Attributes:
        outline: corners of a simple polygon, shape (n, 2), mm.
        family, parameters: the structure; the family's defaults without parameters.
        beam_width: width of the beams, with which the structure scales. 0.3 mm on the server's side.
        orientation: angle by which the tiling is turned counterclockwise. 0 on the server's side.
        name: of the region.
    """

    outline: ArrayLike
    family: str
    parameters: Optional[ArrayLike] = None
    beam_width: Optional[float] = None
    orientation: Optional[float] = None
    name: Optional[str] = None

    def to_wire(self) -> Dict[str, Any]:
        return {
            "outline": _polygon(self.outline),
            "structure": _structure(self.family, self.parameters),
            **_given({"beam_width": self.beam_width, "orientation": self.orientation, "name": self.name}),
        }


@dataclass(frozen=True)
class PartOptions:
    """How a part is made. What is None is left to the server.

    Attributes:
        beam_width: width of the beams, with which the structure scales. 0.3 mm.
        orientation: angle by which the tiling is turned counterclockwise. 0.
        regions: parts of the outline with structures of their own; later ones lie over earlier ones.
        frame: width of a solid rim. 0.
        seam: width of solid strips along the outlines of regions. The width of the finest beams.
        rim: "clipped": beams are cut off at the outline; "whole": only tiles that lie within it. "clipped".
        smallest_wall: narrower walls and tips are left out. Two thirds of the finest beams' width.
        thickness: of the part. 1 mm.
        density: of the material, g/cm^3; of `Part.mass`. 1.2.
    """

    beam_width: Optional[float] = None
    orientation: Optional[float] = None
    regions: Sequence[PartRegion] = field(default_factory=tuple)
    frame: Optional[float] = None
    seam: Optional[float] = None
    rim: Optional[str] = None
    smallest_wall: Optional[float] = None
    thickness: Optional[float] = None
    density: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        checks.one_of(self.rim, "rim", ("clipped", "whole"))
        return _given(
            {
                "beam_width": self.beam_width,
                "orientation": self.orientation,
                "regions": [region.to_wire() for region in self.regions] or None,
                "frame": self.frame,
                "seam": self.seam,
                "rim": self.rim,
                "smallest_wall": self.smallest_wall,
                "thickness": self.thickness,
                "material": None if self.density is None else {"density": self.density},
            }
        )


@dataclass(frozen=True)
class Part:
    """The solid of a part.

    Attributes:
        size: width, height and thickness, mm.
        outline_area, solid_area: mm^2; `relative_density` is their quotient.
        volume: mm^3.
        mass: g.
        holes: of the solid.
        smallest_wall: no wall is narrower, mm.
        trimmed_area: of narrower walls and tips that were left out, mm^2.
        crumbs: pieces without connection to the largest one that were left out.
        missing_solids: of "lower_grip", "upper_grip", "lower_plate" and "upper_plate" those that the part has lost.
        message: what the part lacks of what was asked for, and what helps; empty where nothing is missing.
        cost: what it took.
    """

    size: Tuple[float, float, float]
    outline_area: float
    solid_area: float
    relative_density: float
    volume: float
    mass: float
    holes: int
    smallest_wall: float
    trimmed_area: float
    crumbs: int
    missing_solids: Tuple[str, ...]
    message: str
    cost: Cost


def part_from_wire(answer: Mapping[str, Any]) -> Part:
    width, height, thickness = answer["size"]
    checked = answer["checks"]
    return Part(
        size=(width, height, thickness),
        outline_area=answer["outline_area"],
        solid_area=answer["solid_area"],
        relative_density=answer["relative_density"],
        volume=answer["volume"],
        mass=answer["mass"],
        holes=answer["holes"],
        smallest_wall=checked["smallest_wall"],
        trimmed_area=checked["trimmed_area"],
        crumbs=checked["crumbs"],
        missing_solids=tuple(checked["missing_solids"]),
        message=answer["message"],
        cost=cost_from_wire(answer["cost"]),
    )


def part(
    outline: Mapping[str, Any],
    family: str,
    parameters: Optional[ArrayLike],
    options: Optional[PartOptions],
    deadline: Optional[float],
) -> Computation[Part]:
    document = _document(outline, family, parameters, options, deadline)
    return Computation("/v1/parts", document, lambda answer: part_from_wire(answer.json()))


def part_file(
    outline: Mapping[str, Any],
    family: str,
    parameters: Optional[ArrayLike],
    kind: str,
    options: Optional[PartOptions],
    deadline: Optional[float],
) -> Computation[bytes]:
    if kind not in PART_FILE_TYPES:
        raise ValueError(f"kind must be one of {', '.join(PART_FILE_TYPES)}, got {kind!r}")
    document = _document(outline, family, parameters, options, deadline)
    return Computation("/v1/parts", document, _file_from_wire, PART_FILE_TYPES[kind])


def _file_from_wire(answer: Answer) -> bytes:
    message = answer.headers.get("Supple-Message")
    if message:
        warnings.warn(message, stacklevel=4)
    return answer.content


def _document(
    outline: Mapping[str, Any],
    family: str,
    parameters: Optional[ArrayLike],
    options: Optional[PartOptions],
    deadline: Optional[float],
) -> Dict[str, Any]:
    return {
        "outline": dict(outline),
        "structure": _structure(family, parameters),
        **({} if options is None else options.to_wire()),
        **_given({"deadline": deadline}),
    }


def _structure(family: str, parameters: Optional[ArrayLike]) -> Dict[str, Any]:
    if parameters is None:
        return {"family": family}
    return {"family": family, "parameters": [float(value) for value in np.asarray(parameters, dtype=np.float64).ravel()]}


def _polygon(outline: ArrayLike) -> Any:
    array = np.asarray(outline, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 3:
        raise ValueError(f"an outline has the shape {array.shape}; expected (n, 2) with at least 3 corners")
    return array.tolist()


def _given(values: Mapping[str, Any]) -> Dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}
