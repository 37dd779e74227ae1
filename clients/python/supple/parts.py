"""Parts to print or cut: outlines that structures fill. Lengths are in millimetres, angles in radians; texts may have other units,
such as "6 cm" or "30 deg"."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Numbers
from .answers import Cost
from .checks import one_of, warn
from .design_answers import Design
from .request import Deadline, FileRequest, Kind, Reported, Request, Timeout
from .transport import Answer
from .units import ANGLE, DENSITY, LENGTH, Number, without_unit
from .wire import At, Sent, given


def _lengths(**lengths: Optional[Number]) -> Dict[str, Any]:
    """The JSON of those lengths that are given; texts with units become numbers of mm."""
    return given(**{name: without_unit(length, name, "length") for name, length in lengths.items()})


def coupon(width: Number, length: Number, grip_length: Optional[Number] = None) -> Dict[str, Any]:
    """The outline of a tensile coupon: `length` of the structure along y between two solid grips (15 mm each)."""
    return {"coupon": _lengths(width=width, length=length, grip_length=grip_length)}


def block(width: Number, height: Number, plate: Optional[Number] = None) -> Dict[str, Any]:
    """The outline of a compression block: `height` of the structure along y between two solid plates (1 mm each)."""
    return {"block": _lengths(width=width, height=height, plate=plate)}


def rectangle(width: Number, height: Number) -> Dict[str, Any]:
    """A rectangle as an outline."""
    return {"rectangle": list(map(float, _lengths(width=width, height=height).values()))}


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
    beam_width: Annotated[Optional[Number], LENGTH] = None
    orientation: Annotated[Optional[Number], ANGLE] = None
    name: Optional[str] = None
    direction: Annotated[Optional[Number], ANGLE] = None


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

    beam_width: Annotated[Optional[Number], LENGTH] = None
    orientation: Annotated[Optional[Number], ANGLE] = None
    direction: Annotated[Optional[Number], ANGLE] = None
    regions: Sequence[PartRegion] = ()
    frame: Annotated[Optional[Number], LENGTH] = None
    seam: Annotated[Optional[Number], LENGTH] = None
    rim: Optional[str] = None
    smallest_wall: Annotated[Optional[Number], LENGTH] = None
    thickness: Annotated[Optional[Number], LENGTH] = None
    density: Annotated[Optional[Number], At("/material/"), DENSITY] = None
    axis: Annotated[Optional[Number], ANGLE] = None

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
        super().__post_init__()
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


def _options_of(design: Design, outline: Mapping[str, Any], given_options: Optional[PartOptions]) -> PartOptions:
    """The options for a part of a design, in which given ones take their place. Only a part with an axis of load takes the
    direction of the design's load: a coupon, a block, or one with `axis`. Warns if it needs one and the design has no single one."""
    further = {} if given_options is None else {
        one.name: getattr(given_options, one.name) for one in fields(given_options)
        if getattr(given_options, one.name) not in (None, ())}
    has_load_axis = "coupon" in outline or "block" in outline or "axis" in further
    options = PartOptions.of_design(design, **{**({} if has_load_axis else {"direction": None}), **further})
    if has_load_axis and options.direction is None:
        tested = "pi/2" if options.axis is None else f"{options.axis:.4g} rad"
        warn(f"the design has no single direction of load: the part is loaded along its direction {tested}, unless direction says another one")
    return options


@dataclass(frozen=True)
class _PartFields(Sent):
    """The fields of both requests.

    With a `Design` as `family`, the part has its structure, width of beams, orientation and density. A coupon, a block or a
    part with an `axis` is loaded along the direction of the design's load. `options` take the place of these.
    """

    outline: Mapping[str, Any]
    family: Annotated[Union[str, Design], At("/structure/")]
    parameters: Annotated[Optional[Numbers], At("/structure/")] = None
    options: Annotated[Optional[PartOptions], At("")] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def __post_init__(self) -> None:
        if isinstance(self.family, Design):
            if self.parameters is not None:
                raise ValueError("a design has parameters of its own: give them with the id of a family")
            design = self.family
            for name, value in (("family", design.family), ("parameters", design.parameters),
                                ("options", _options_of(design, self.outline, self.options))):
                object.__setattr__(self, name, value)
        super().__post_init__()


@dataclass(frozen=True)
class PartRequest(_PartFields, Request[Part], path="/v1/parts"):
    """The properties of a part: an outline that a structure fills, for printing or cutting. `outline` comes from
    `parts.coupon`, `block`, `rectangle`, `polygons` or `Drawing.outline`. `family` is the id of a family or a `Design`, whose
    structure, width of beams, orientation, density and direction of load the part then has:
    `client.part(supple.parts.coupon(12, 30), design)`."""


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
