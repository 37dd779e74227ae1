"""Parts to print or cut: outlines that structures fill. Lengths are in millimetres, angles in radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Numbers
from .answers import Cost
from .checks import one_of, warn
from .design_answers import Design
from .request import FileRequest, Kind, Reported, Request, Timeout
from .transport import Answer
from .wire import At, Sent, given


def coupon(width: float, length: float, grip_length: Optional[float] = None) -> Dict[str, Any]:
    """The outline of a tensile coupon: `length` of the structure along y between two solid grips (15 mm each)."""
    return {"coupon": given(width=width, length=length, grip_length=grip_length)}


def block(width: float, height: float, plate: Optional[float] = None) -> Dict[str, Any]:
    """The outline of a compression block: `height` of the structure along y between two solid plates (1 mm each)."""
    return {"block": given(width=width, height=height, plate=plate)}


def rectangle(width: float, height: float) -> Dict[str, Any]:
    """A rectangle as an outline."""
    return {"rectangle": [float(width), float(height)]}


def polygons(outlines: Sequence[ArrayLike]) -> Dict[str, Any]:
    """Polygons of shape (n, 2) as an outline. A place belongs to the part if it is within an odd number of them."""
    return {"polygons": [_polygon(outline) for outline in outlines]}


def regions_only() -> Dict[str, Any]:
    """The union of the regions in `PartOptions.regions` as the outline. They must make one piece; the part's own family fills
    nothing."""
    return {"regions": True}


def _polygon(outline: ArrayLike, name: str = "") -> Any:
    array = np.asarray(outline, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 3:
        raise ValueError(f"an outline has the shape {array.shape}; expected (n, 2) with at least 3 corners")
    return array.tolist()


@dataclass(frozen=True)
class PartRegion(Sent):
    """A region of a part with its own structure.

    Attributes:
        outline: corners of a simple polygon, shape (n, 2), mm.
        family, parameters: the structure; None takes the family's default parameters.
        beam_width: width of the beams, with which the structure scales. 0.3 mm by default.
        orientation: angle by which the tiling is rotated counterclockwise. 0 by default.
        name: name of the region, and of its object in a 3MF file.
        direction: direction of the region's own design along which the part is loaded, radians; by default that of the part.
    """

    outline: Annotated[ArrayLike, At(write=_polygon)]
    family: Annotated[str, At("/structure/")]
    parameters: Annotated[Optional[Numbers], At("/structure/")] = None
    beam_width: Optional[float] = None
    orientation: Optional[float] = None
    name: Optional[str] = None
    direction: Optional[float] = None


@dataclass(frozen=True)
class PartOptions(Sent):
    """How a part is made. None stands for the server's default.

    Attributes:
        beam_width: width of the beams, with which the structure scales. 0.3 mm.
        orientation: angle by which the tiling is rotated counterclockwise. 0.
        direction: direction of the design along which the part is loaded, radians. All structures are also rotated so that it is
            along the axis of the part, which is y for a coupon or a block. By default nothing is rotated.
        regions: regions of the outline with their own structures; a later one replaces earlier ones where they overlap.
        frame: width of a solid rim. 0.
        seam: width of solid strips along the outlines of regions. By default the width of the finest beams.
        rim: "clipped" to cut beams at the outline, "whole" for only those tiles that are inside it. "clipped".
        smallest_wall: least width of walls: narrower walls and tips are omitted, and narrower necks are widened. Two thirds of
            the finest beams' width.
        thickness: thickness of the part. 1 mm.
        density: density of the material for `Part.mass`, g/cm^3. 1.2.
        axis: direction in an outline other than a coupon or a block along which the part will be loaded, radians. None.
    """

    beam_width: Optional[float] = None
    orientation: Optional[float] = None
    direction: Optional[float] = None
    regions: Sequence[PartRegion] = ()
    frame: Optional[float] = None
    seam: Optional[float] = None
    rim: Optional[str] = None
    smallest_wall: Optional[float] = None
    thickness: Optional[float] = None
    density: Annotated[Optional[float], At("/material/")] = None
    axis: Optional[float] = None

    @classmethod
    def of_design(cls, design: Design, **further: Any) -> "PartOptions":
        """Options for a coupon or a block of a design, or for another outline with an `axis`: its beam width, density and
        orientation, and the direction of its load if there is only one. `further` are options that replace these."""
        directions = {profile.direction for profile in (design.profile, *design.also)}
        options: Dict[str, Any] = {
            "beam_width": design.size.beam_width,
            "orientation": design.orientation,
            "direction": directions.pop() if len(directions) == 1 else None,
            "density": design.material.density,
        }
        return cls(**{**options, **further})

    def __post_init__(self) -> None:
        one_of(self.rim, "rim", ("clipped", "whole"))


@dataclass(frozen=True)
class Part:
    """The solid of a part.

    Attributes:
        size: width, height and thickness of the whole part, with grips or plates, mm.
        outline_area, solid_area: mm^2; `relative_density` is their ratio.
        volume: mm^3.
        mass: g.
        holes: number of holes of the solid.
        orientation: angle by which the tiling is rotated in the part, radians.
        tested_direction: direction of the design along the axis of the load, radians; None for a part without an axis.
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
    smallest_wall: Annotated[float, At("/checks/")]
    smallest_neck: Annotated[Optional[float], At("/checks/")]
    widened_necks: Annotated[int, At("/checks/")]
    cut_necks: Annotated[int, At("/checks/")]
    trimmed_area: Annotated[float, At("/checks/")]
    crumbs: Annotated[int, At("/checks/")]
    missing_solids: Annotated[Tuple[str, ...], At("/checks/")]
    message: str
    cost: Cost


@dataclass(frozen=True)
class _PartFields:
    """The fields of both requests."""

    outline: Mapping[str, Any]
    family: Annotated[str, At("/structure/")]
    parameters: Annotated[Optional[Numbers], At("/structure/")] = None
    options: Annotated[Optional[PartOptions], At("")] = None
    deadline: Optional[float] = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class PartRequest(_PartFields, Request[Part], path="/v1/parts"):
    """The properties of a part: an outline that a structure fills, for printing or cutting. `outline` comes from
    `parts.coupon`, `block`, `rectangle`, `polygons` or `Drawing.outline`."""


@dataclass(frozen=True)
class PartFileRequest(_PartFields, FileRequest, path="/v1/parts"):
    """The same part as a file: `kind` is "step", "stl", "3mf", "dxf" or "svg". Lengths are in mm.

    Warns with the `message` of `Part` if a grip or a plate is missing.
    """

    TYPES = {"svg": "image/svg+xml", "dxf": "image/vnd.dxf", "step": "model/step", "stl": "model/stl", "3mf": "model/3mf"}
    kind: Kind = "stl"

    def decode(self, answer: Answer) -> bytes:
        message = answer.headers.get("Supple-Message")
        if message:
            warn(message)
        return answer.content
