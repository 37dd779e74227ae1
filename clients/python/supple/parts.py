"""Parts to print or cut: outlines that structures fill. Lengths are in millimetres, angles in radians."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import checks
from .answers import Cost, cost_from_wire
from .jobs import Computation
from .transport import Answer

if TYPE_CHECKING:
    from .design_answers import Design

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
    """Polygons of shape (n, 2) as an outline. A place belongs to the part if it is within an odd number of them."""
    return {"polygons": [_polygon(outline) for outline in outlines]}


@dataclass(frozen=True)
class PartRegion:
    """A region of a part with its own structure.

    Attributes:
        outline: corners of a simple polygon, shape (n, 2), mm.
        family, parameters: the structure; None takes the family's default parameters.
        beam_width: width of the beams, with which the structure scales. 0.3 mm by default.
        orientation: angle by which the tiling is rotated counterclockwise. 0 by default.
        name: name of the region.
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
    """How a part is made. None stands for the server's default.

    Attributes:
        beam_width: width of the beams, with which the structure scales. 0.3 mm.
        orientation: angle by which the tiling is rotated counterclockwise. 0.
        direction: direction of the design along which a coupon or a block is loaded, radians. All structures are also rotated
            by pi/2 - direction, so that it is along y, the axis of the part. pi/2.
        regions: regions of the outline with their own structures; a later one replaces earlier ones where they overlap.
        frame: width of a solid rim. 0.
        seam: width of solid strips along the outlines of regions. By default the width of the finest beams.
        rim: "clipped" to cut beams at the outline, "whole" for only those tiles that are inside it. "clipped".
        smallest_wall: least width of walls: narrower walls and tips are omitted, and narrower necks are widened. Two thirds of
            the finest beams' width.
        thickness: thickness of the part. 1 mm.
        density: density of the material for `Part.mass`, g/cm^3. 1.2.
    """

    beam_width: Optional[float] = None
    orientation: Optional[float] = None
    direction: Optional[float] = None
    regions: Sequence[PartRegion] = field(default_factory=tuple)
    frame: Optional[float] = None
    seam: Optional[float] = None
    rim: Optional[str] = None
    smallest_wall: Optional[float] = None
    thickness: Optional[float] = None
    density: Optional[float] = None

    @classmethod
    def of_design(cls, design: "Design", **further: Any) -> "PartOptions":
        """Options for a coupon or a block of a design: its beam width, density and orientation, and the direction of its load if
        there is only one. `further` are options that replace these."""
        directions = {profile.direction for profile in (design.profile, *design.also)}
        options: Dict[str, Any] = {
            "beam_width": design.size.beam_width,
            "orientation": design.orientation,
            "direction": directions.pop() if len(directions) == 1 else None,
            "density": design.material.density,
        }
        return cls(**{**options, **further})

    def to_wire(self) -> Dict[str, Any]:
        checks.one_of(self.rim, "rim", ("clipped", "whole"))
        return _given(
            {
                "beam_width": self.beam_width,
                "orientation": self.orientation,
                "direction": self.direction,
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
        outline_area, solid_area: mm^2; `relative_density` is their ratio.
        volume: mm^3.
        mass: g.
        holes: number of holes of the solid.
        orientation: angle by which the tiling is rotated in the part, radians.
        tested_direction: direction of the design along y, the load axis of a coupon or a block, radians; None for other
            outlines.
        smallest_wall: the least width of walls that was used, mm.
        smallest_neck: width of the narrowest neck, measured on the finished outline, mm; None if there is no neck.
        widened_necks, cut_necks: numbers of necks narrower than the smallest wall that were widened or cut.
        trimmed_area: area of narrower walls and tips that were omitted, mm^2.
        crumbs: number of pieces that were omitted since they are not connected to the largest one.
        missing_solids: those of "lower_grip", "upper_grip", "lower_plate" and "upper_plate" that the part lacks.
        message: what the part lacks of the request, and what helps; may be empty.
        cost: the bill of the computation.
    """

    size: Tuple[float, float, float]
    outline_area: float
    solid_area: float
    relative_density: float
    volume: float
    mass: float
    holes: int
    orientation: float
    tested_direction: Optional[float]
    smallest_wall: float
    smallest_neck: Optional[float]
    widened_necks: int
    cut_necks: int
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
        orientation=answer["orientation"],
        tested_direction=answer["tested_direction"],
        smallest_wall=checked["smallest_wall"],
        smallest_neck=checked["smallest_neck"],
        widened_necks=checked["widened_necks"],
        cut_necks=checked["cut_necks"],
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
