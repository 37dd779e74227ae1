"""Digital weaves, their supports and loads, and their requests.

Lengths are in millimetres, forces in newtons, moduli of strands in MPa, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import IndexList, Vector2Like, Vector3Like
from .request import Deadline, FileRequest, Kind, Reported, Request, Timeout
from .weave_answers import WeaveDeformation, WeaveHomogenization, WeaveLayout, WeaveSimulation
from .units import ANGLE, FORCE, LENGTH, RATIO, Number, members_without_units, without_unit
from .wire import ACCURACY, EFFECT, At, Sent, Shape, given, numbers


@dataclass(frozen=True)
class Strand(Sent):
    """A strand of a layout: a smooth curve through points.

    Attributes:
        points: shape (n, 2), mm; at least 2 (open), 3 (closed) or 1 (periodic).
        ends: "open", "closed" or "periodic".
        translation: period of a periodic strand, shape (2,), mm: a lattice vector.
        radius: mm; None takes that of the weave.
    """

    points: Annotated[ArrayLike, Shape(-1, 2), LENGTH]
    ends: str = "open"
    translation: Annotated[Optional[Vector2Like], LENGTH] = None
    radius: Annotated[Optional[Number], LENGTH] = None


@dataclass(frozen=True)
class Weave(Sent):
    """A weave in the JSON form of the contract. The functions below create it. None stands for the server's default.

    `radius` is that of the strands, and `material` has "youngs_modulus" (MPa) and "poisson_ratio". `sliding_share` is how far
    strands slide, as a fraction of the distance to the next crossing. `sheet` is (columns, rows) of a finite sheet; without it
    a pattern is a periodic cell.
    """

    document: Annotated[Mapping[str, Any], At("")]

    @staticmethod
    def regular(
        connections: Union[str, Sequence[Sequence[str]], None] = None,
        *,
        pitch: Optional[Number] = None,
        sheet: Optional[Tuple[int, int]] = None,
        fused_border: Optional[int] = None,
        **more: Any,
    ) -> "Weave":
        """Straight strands at right angles. `connections` is "fused", "slides_x" or "slides_y", or a 2 x 2 block of them with the
        lower row first. Crossings of the outermost `fused_border` strands of a sheet are always fused."""
        finite = _sheet(sheet)
        if finite is not None and fused_border is not None:
            finite["fused_border"] = fused_border
        return Weave(_woven(pattern="regular", connections=connections, pitch=pitch, sheet=finite, **more))

    @staticmethod
    def squares(
        kind: int,
        *,
        side: Optional[Number] = None,
        overlap: Optional[Number] = None,
        sheet: Optional[Tuple[int, int]] = None,
        **more: Any,
    ) -> "Weave":
        """Interlacing squares of type 1 (fused), 2 (sliding in x), 3 (sliding in x and y) or 4 (one corner fused)."""
        return Weave(
            _woven(pattern="interlacing_squares", type=kind, side=side, overlap=overlap, sheet=_sheet(sheet), **more)
        )

    @staticmethod
    def circles(
        kind: int,
        *,
        circle_radius: Optional[Number] = None,
        distance: Optional[Number] = None,
        sheet: Optional[Tuple[int, int]] = None,
        **more: Any,
    ) -> "Weave":
        """Interlacing circles of type 1 (fused) or 2 (sliding)."""
        size = {"circle_radius": circle_radius, "distance": distance}
        return Weave(_woven(pattern="interlacing_circles", type=kind, sheet=_sheet(sheet), **size, **more))

    @staticmethod
    def rings(**more: Any) -> "Weave":
        """Rings that rise out of the plane when the last strand is pushed at its end."""
        return Weave(_woven(pattern="actuated_rings", **more))

    @staticmethod
    def printed_sample(sample: str, **more: Any) -> "Weave":
        """One of nine sheets that have been printed and tested: "fused_grid", "sliding_grid", "squares_1" to "squares_4",
        "circles_fused", "circles_sliding" or "actuation". `Client.weave_toolpath` prints it in the same way."""
        return Weave(_woven(pattern="printed_sample", sample=sample, **more))

    @staticmethod
    def layout(
        strands: Sequence[Strand],
        *,
        crossings: Optional[Sequence[Mapping[str, Any]]] = None,
        lattice: Optional[ArrayLike] = None,
        **more: Any,
    ) -> "Weave":
        """A weave of the given strands. Crossings that are not given are found and fused. `lattice` has the cell's translations
        as rows, shape (2, 2)."""
        return Weave(_woven(strands=strands, crossings=crossings, lattice=lattice, **more))

    def fuse(self, *crossings: int) -> "Weave":
        """The same weave with these crossings fused."""
        return self._with([{"crossing": int(crossing), "slides": []} for crossing in crossings])

    def slide(
        self, crossing: int, *members: int, backward: Optional[Number] = None, forward: Optional[Number] = None
    ) -> "Weave":
        """The same weave, in which these members of a crossing slide by at most `backward` and `forward` mm; see `WeaveLayout`."""
        limits = given(backward=without_unit(backward, "backward", "length"), forward=without_unit(forward, "forward", "length"))
        return self._with([{"crossing": int(crossing), "slides": list(members), **limits}])

    def _with(self, changes: Sequence[Mapping[str, Any]]) -> "Weave":
        return Weave({**self.document, "overrides": [*self.document.get("overrides", []), *changes]})


_LENGTHS = ("radius", "pitch", "side", "overlap", "circle_radius", "distance", "lattice")


def _woven(**members: Any) -> Dict[str, Any]:
    """The JSON of those members of a weave that are given, in which texts with units are numbers."""
    material = members.get("material")
    if isinstance(material, dict):
        members["material"] = members_without_units(material, {"youngs_modulus": "stress"})
    return given(**members_without_units(members, {name: "length" for name in _LENGTHS}))


def _sheet(size: Optional[Tuple[int, int]]) -> Optional[Dict[str, int]]:
    return None if size is None else {"columns": int(size[0]), "rows": int(size[1])}


@dataclass(frozen=True)
class Place(Sent):
    """The place of a support or a force. The functions below create it."""

    document: Annotated[Mapping[str, Any], At("")]

    @staticmethod
    def crossing(index: int) -> "Place":
        return Place({"crossing": int(index)})

    @staticmethod
    def strand(index: int, *, coordinate: Optional[Number] = None, share: Optional[float] = None) -> "Place":
        """A place `coordinate` mm along a strand, or at a fraction `share` of its length: 0 and 1 are its ends."""
        if (coordinate is None) == (share is None):
            raise ValueError("a place of a strand is given by either its coordinate or its share of the length")
        return Place(given(strand=int(index), coordinate=without_unit(coordinate, "coordinate", "length"), share=share))

    @staticmethod
    def box(lower: ArrayLike, upper: ArrayLike) -> "Place":
        """All crossings and free ends of strands between two corners, mm."""
        corners = (without_unit(corner, name, "length") for name, corner in (("lower", lower), ("upper", upper)))
        return Place({"box": [numbers(corner, name, Shape(2)) for name, corner in zip(("lower", "upper"), corners)]})


@dataclass(frozen=True)
class Support(Sent):
    """A support, which may move.

    Attributes:
        at: its place.
        displacement: its displacement at the end of the path, shape (3,), mm; None for a support that does not move.
        held: whether x, y and z are fixed; None fixes all.
        clamped: whether the direction of the strand is fixed too.
        rotation: rotation of a clamped direction, a rotation vector of shape (3,), radians.
    """

    at: Place
    displacement: Annotated[Optional[Vector3Like], LENGTH] = None
    held: Optional[Sequence[bool]] = None
    clamped: bool = False
    rotation: Annotated[Optional[Vector3Like], ANGLE] = None


@dataclass(frozen=True)
class Force(Sent):
    """A dead load, shape (3,), N. It is distributed over the places of a box."""

    at: Place
    force: Annotated[Vector3Like, FORCE]


@dataclass(frozen=True)
class WeaveOptions(Sent):
    """How equilibria are found. None stands for the server's default.

    Attributes:
        segments: number of rod segments between crossings. 4 by default: bending is then a few percent too soft, and the shear
            of a fused weave of straight strands 11 %; with 8 it is 3 %.
        tolerance: relative residual. 1e-6 by default.
        max_iterations: Newton iterations for one load step before it is halved.
        load_steps: least number of load steps for a state; by default a step's strain is at most 4 %.
        least_distance: least distance along a strand between a sliding crossing and its neighbour, mm; by default that at which
            the strands that cross there touch.
        barrier_range: distance from a limit of sliding at which its barrier begins to act, mm; answers do not depend on it.
        regularization: stiffness of sliding, N/mm.
        out_of_plane, buckling: "on", "off" or "automatic".
        limit_tolerance: largest relative error of the energy because sliders do not quite reach their limits. 1e-6 by default.
        error_estimate: whether states are computed once more with half as many segments, to estimate their errors. "automatic" does
            so for at most 24 directions or gradients, and for no sheet; "on" for all, "off" for none.
    """

    segments: Annotated[Optional[int], ACCURACY] = None
    tolerance: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Annotated[Optional[int], ACCURACY] = None
    load_steps: Annotated[Optional[int], ACCURACY] = None
    least_distance: Annotated[Optional[Number], At("/sliding/"), LENGTH] = None
    barrier_range: Annotated[Optional[Number], At("/sliding/"), LENGTH] = None
    regularization: Annotated[Optional[float], At("/sliding/")] = None
    out_of_plane: Annotated[Optional[str], EFFECT] = None
    buckling: Annotated[Optional[str], EFFECT] = None
    limit_tolerance: Annotated[Optional[float], ACCURACY] = None
    error_estimate: Annotated[Optional[str], EFFECT] = None


@dataclass(frozen=True)
class WeaveLayoutRequest(Request[WeaveLayout], path="/v1/weave-layouts"):
    """Strands and crossings at rest, with warnings of likely mistakes. Raises `InvalidWeave`."""

    weave: Weave
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class WeavePictureRequest(FileRequest, path="/v1/weave-layouts"):
    """The weave at rest as an SVG file, lengths in mm."""

    TYPES = {"svg": "image/svg+xml"}
    weave: Weave
    kind: Kind = "svg"
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


def _directions_to_wire(directions: Union[int, ArrayLike], name: str) -> Union[int, List[float]]:
    if isinstance(directions, (int, np.integer)):
        return int(directions)
    return [float(angle) for angle in np.atleast_1d(np.asarray(directions, dtype=np.float64))]


@dataclass(frozen=True)
class WeaveHomogenizationRequest(Request[WeaveHomogenization], path="/v1/weave-homogenizations"):
    """Young's modulus and Poisson's ratio of a periodic weave in every direction.

    Attributes:
        weave: a cell: a pattern without a sheet, or a layout with a lattice.
        strain: stretch minus one, in [-0.5, 2], not 0. 0.1 by default.
        directions: number of directions over half a turn, or angles in radians, shape (n,). 200 by default.
        shear: "free", or "suppressed" relative to the direction. "free" by default.
        thickness: mm; with it moduli in MPa are returned too.
        deformed: indices of the directions for which deformed cells are returned.

    A direction whose path does not reach the strain raises no exception: its numbers are nan.
    """

    weave: Weave
    strain: Annotated[Optional[Number], RATIO] = None
    directions: Annotated[Union[int, ArrayLike, None], At(write=_directions_to_wire), ANGLE] = None
    shear: Optional[str] = None
    thickness: Annotated[Optional[Number], LENGTH] = None
    deformed: IndexList = ()
    options: Annotated[Optional[WeaveOptions], At("")] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


def _gradients_to_wire(gradients: ArrayLike, name: str) -> Any:
    array = np.asarray(gradients, dtype=np.float64)
    if array.shape[-2:] != (2, 2) or array.ndim > 3:
        raise ValueError(f"{name} must have the shape (n, 2, 2) or (2, 2), not {array.shape}")
    return array.reshape(-1, 2, 2).tolist()


@dataclass(frozen=True)
class WeaveDeformationRequest(Request[WeaveDeformation], path="/v1/weave-deformations"):
    """Stress and energy of a periodic weave under given deformation gradients. The path to each one begins at rest.

    Attributes:
        weave: a cell: a pattern without a sheet, or a layout with a lattice.
        deformation_gradients: F of positive determinant, shape (n, 2, 2), or (2, 2) for one.
        deformed: indices of the gradients for which deformed cells are returned.

    A gradient that is not reached raises no exception: see `WeaveDeformation.stopped`.
    """

    weave: Weave
    deformation_gradients: Annotated[ArrayLike, At(write=_gradients_to_wire)]
    deformed: IndexList = ()
    options: Annotated[Optional[WeaveOptions], At("")] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class WeaveSimulationRequest(Request[WeaveSimulation], path="/v1/weave-simulations"):
    """Equilibria of a sheet along a load path from rest.

    Attributes:
        weave: a sheet: a pattern with `sheet`, or a layout without a lattice.
        supports: supports of the sheet, which may move.
        forces: forces on the sheet.
        states: number of states that are returned, evenly along the path. 1 by default.
        deformed: "json" for polylines, "obj" or "vtu" for files, "none". "json" by default.

    A path that cannot be followed to its end raises no exception: see `WeaveSimulation.message`.
    """

    weave: Weave
    supports: Sequence[Support]
    forces: Sequence[Force] = ()
    states: Optional[int] = None
    deformed: Optional[str] = None
    options: Annotated[Optional[WeaveOptions], At("")] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
