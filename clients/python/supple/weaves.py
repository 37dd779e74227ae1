"""Digital weaves, their supports and loads, and their requests.

Lengths are in millimetres, forces in newtons, moduli of strands in MPa, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from .jobs import Computation
from .transport import Answer
from .weave_answers import (
    WeaveDeformation,
    WeaveHomogenization,
    WeaveLayout,
    WeaveSimulation,
    deformation_from_wire,
    homogenization_from_wire,
    layout_from_wire,
    weave_simulation_from_wire,
)


def given(**fields: Any) -> Dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None}


def vector_of(value: Optional[ArrayLike], size: int, name: str) -> Optional[List[float]]:
    if value is None:
        return None
    vector = np.asarray(value, dtype=np.float64)
    if vector.shape != (size,):
        raise ValueError(f"{name} has the shape {vector.shape}; expected ({size},)")
    return [float(component) for component in vector]


@dataclass(frozen=True)
class Strand:
    """A strand of a layout: a smooth curve through points.

    Attributes:
        points: shape (n, 2), mm; at least 2 (open), 3 (closed) or 1 (periodic).
        ends: "open", "closed" or "periodic".
        translation: period of a periodic strand, shape (2,), mm: a lattice vector.
        radius: mm; None takes that of the weave.
    """

    points: ArrayLike
    ends: str = "open"
    translation: Optional[ArrayLike] = None
    radius: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        points = np.asarray(self.points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2:
            raise ValueError(f"points have the shape {points.shape}; expected (n, 2)")
        return {
            "points": points.tolist(),
            "ends": self.ends,
            **given(translation=vector_of(self.translation, 2, "translation"), radius=self.radius),
        }


@dataclass(frozen=True)
class Weave:
    """A weave in the JSON form of the contract. The functions below create it. None stands for the server's default.

    `radius` is that of the strands, and `material` has "youngs_modulus" (MPa) and "poisson_ratio". `sliding_share` is how far
    strands slide, as a fraction of the distance to the next crossing. `sheet` is (columns, rows) of a finite sheet; without it
    a pattern is a periodic cell.
    """

    document: Mapping[str, Any]

    @staticmethod
    def regular(
        connections: Union[str, Sequence[Sequence[str]], None] = None,
        *,
        pitch: Optional[float] = None,
        sheet: Optional[Tuple[int, int]] = None,
        fused_border: Optional[int] = None,
        **more: Any,
    ) -> "Weave":
        """Straight strands at right angles. `connections` is "fused", "slides_x" or "slides_y", or a 2 x 2 block of them with the
        lower row first. Crossings of the outermost `fused_border` strands of a sheet are always fused."""
        finite = _sheet(sheet)
        if finite is not None and fused_border is not None:
            finite["fused_border"] = fused_border
        block = connections if connections is None or isinstance(connections, str) else [list(row) for row in connections]
        return Weave(given(pattern="regular", connections=block, pitch=pitch, sheet=finite, **more))

    @staticmethod
    def squares(
        kind: int,
        *,
        side: Optional[float] = None,
        overlap: Optional[float] = None,
        sheet: Optional[Tuple[int, int]] = None,
        **more: Any,
    ) -> "Weave":
        """Interlacing squares of type 1 (fused), 2 (sliding in x), 3 (sliding in x and y) or 4 (one corner fused)."""
        return Weave(
            given(pattern="interlacing_squares", type=kind, side=side, overlap=overlap, sheet=_sheet(sheet), **more)
        )

    @staticmethod
    def circles(
        kind: int,
        *,
        circle_radius: Optional[float] = None,
        distance: Optional[float] = None,
        sheet: Optional[Tuple[int, int]] = None,
        **more: Any,
    ) -> "Weave":
        """Interlacing circles of type 1 (fused) or 2 (sliding)."""
        return Weave(
            given(
                pattern="interlacing_circles",
                type=kind,
                circle_radius=circle_radius,
                distance=distance,
                sheet=_sheet(sheet),
                **more,
            )
        )

    @staticmethod
    def rings(**more: Any) -> "Weave":
        """Rings that rise out of the plane when the last strand is pushed at its end."""
        return Weave(given(pattern="actuated_rings", **more))

    @staticmethod
    def printed_sample(sample: str, **more: Any) -> "Weave":
        """One of nine sheets that have been printed and tested: "fused_grid", "sliding_grid", "squares_1" to "squares_4",
        "circles_fused", "circles_sliding" or "actuation". `Client.weave_toolpath` prints it in the same way."""
        return Weave(given(pattern="printed_sample", sample=sample, **more))

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
        rows = None if lattice is None else np.asarray(lattice, dtype=np.float64).tolist()
        return Weave(
            given(
                strands=[strand.to_wire() for strand in strands],
                crossings=None if crossings is None else [dict(crossing) for crossing in crossings],
                lattice=rows,
                **more,
            )
        )

    def fuse(self, *crossings: int) -> "Weave":
        """The same weave with these crossings fused."""
        return self._with([{"crossing": int(crossing), "slides": []} for crossing in crossings])

    def slide(
        self, crossing: int, *members: int, backward: Optional[float] = None, forward: Optional[float] = None
    ) -> "Weave":
        """The same weave, in which these members of a crossing slide by at most `backward` and `forward` mm; see `WeaveLayout`."""
        return self._with([{"crossing": int(crossing), "slides": list(members), **given(backward=backward, forward=forward)}])

    def _with(self, changes: Sequence[Mapping[str, Any]]) -> "Weave":
        return Weave({**self.document, "overrides": [*self.document.get("overrides", []), *changes]})


def _sheet(size: Optional[Tuple[int, int]]) -> Optional[Dict[str, int]]:
    return None if size is None else {"columns": int(size[0]), "rows": int(size[1])}


@dataclass(frozen=True)
class Place:
    """The place of a support or a force. The functions below create it."""

    document: Mapping[str, Any]

    @staticmethod
    def crossing(index: int) -> "Place":
        return Place({"crossing": int(index)})

    @staticmethod
    def strand(index: int, *, coordinate: Optional[float] = None, share: Optional[float] = None) -> "Place":
        """A place `coordinate` mm along a strand, or at a fraction `share` of its length: 0 and 1 are its ends."""
        if (coordinate is None) == (share is None):
            raise ValueError("a place of a strand is given by either its coordinate or its share of the length")
        return Place(given(strand=int(index), coordinate=coordinate, share=share))

    @staticmethod
    def box(lower: ArrayLike, upper: ArrayLike) -> "Place":
        """All crossings and free ends of strands between two corners, mm."""
        return Place({"box": [vector_of(lower, 2, "lower"), vector_of(upper, 2, "upper")]})


@dataclass(frozen=True)
class Support:
    """A support, which may move.

    Attributes:
        at: its place.
        displacement: its displacement at the end of the path, shape (3,), mm; None for a support that does not move.
        held: whether x, y and z are fixed; None fixes all.
        clamped: whether the direction of the strand is fixed too.
        rotation: rotation of a clamped direction, a rotation vector of shape (3,), radians.
    """

    at: Place
    displacement: Optional[ArrayLike] = None
    held: Optional[Sequence[bool]] = None
    clamped: bool = False
    rotation: Optional[ArrayLike] = None

    def to_wire(self) -> Dict[str, Any]:
        return given(
            at=dict(self.at.document),
            displacement=vector_of(self.displacement, 3, "displacement"),
            held=None if self.held is None else [bool(component) for component in self.held],
            clamped=self.clamped or None,
            rotation=vector_of(self.rotation, 3, "rotation"),
        )


@dataclass(frozen=True)
class Force:
    """A dead load, shape (3,), N. It is distributed over the places of a box."""

    at: Place
    force: ArrayLike

    def to_wire(self) -> Dict[str, Any]:
        return {"at": dict(self.at.document), "force": vector_of(self.force, 3, "force")}


@dataclass(frozen=True)
class WeaveOptions:
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
    """

    segments: Optional[int] = None
    tolerance: Optional[float] = None
    max_iterations: Optional[int] = None
    load_steps: Optional[int] = None
    least_distance: Optional[float] = None
    barrier_range: Optional[float] = None
    regularization: Optional[float] = None
    out_of_plane: Optional[str] = None
    buckling: Optional[str] = None
    limit_tolerance: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        groups = {
            "accuracy": given(
                segments=self.segments,
                tolerance=self.tolerance,
                max_iterations=self.max_iterations,
                load_steps=self.load_steps,
                limit_tolerance=self.limit_tolerance,
            ),
            "sliding": given(
                least_distance=self.least_distance,
                barrier_range=self.barrier_range,
                regularization=self.regularization,
            ),
            "effects": given(out_of_plane=self.out_of_plane, buckling=self.buckling),
        }
        return {name: group for name, group in groups.items() if group}


def request_document(weave: Weave, options: Optional[WeaveOptions], **fields: Any) -> Dict[str, Any]:
    return {"weave": dict(weave.document), **given(**fields), **({} if options is None else options.to_wire())}


def layout(weave: Weave, deadline: Optional[float]) -> Computation[WeaveLayout]:
    document = request_document(weave, None, deadline=deadline)
    return Computation("/v1/weave-layouts", document, lambda answer: layout_from_wire(answer.json()))


def picture(weave: Weave) -> Computation[bytes]:
    def decode(answer: Answer) -> bytes:
        return answer.content

    return Computation("/v1/weave-layouts", request_document(weave, None), decode, accept="image/svg+xml")


def homogenization(
    weave: Weave,
    strain: Optional[float],
    directions: Union[int, ArrayLike, None],
    shear: Optional[str],
    thickness: Optional[float],
    deformed: Sequence[int],
    options: Optional[WeaveOptions],
    deadline: Optional[float],
) -> Computation[WeaveHomogenization]:
    wanted: Union[int, List[float], None]
    if directions is None or isinstance(directions, (int, np.integer)):
        wanted = None if directions is None else int(directions)
    else:
        wanted = [float(angle) for angle in np.atleast_1d(np.asarray(directions, dtype=np.float64))]
    document = request_document(
        weave,
        options,
        strain=strain,
        directions=wanted,
        shear=shear,
        thickness=thickness,
        deformed=[int(index) for index in deformed] or None,
        deadline=deadline,
    )
    return Computation("/v1/weave-homogenizations", document, lambda answer: homogenization_from_wire(answer.json()))


def deformation(
    weave: Weave,
    deformation_gradients: ArrayLike,
    deformed: Sequence[int],
    options: Optional[WeaveOptions],
    deadline: Optional[float],
) -> Computation[WeaveDeformation]:
    gradients = np.asarray(deformation_gradients, dtype=np.float64)
    if gradients.shape[-2:] != (2, 2) or gradients.ndim > 3:
        raise ValueError(f"deformation_gradients must have the shape (n, 2, 2) or (2, 2), not {gradients.shape}")
    document = request_document(
        weave,
        options,
        deformation_gradients=gradients.reshape(-1, 2, 2).tolist(),
        deformed=[int(index) for index in deformed] or None,
        deadline=deadline,
    )
    return Computation("/v1/weave-deformations", document, lambda answer: deformation_from_wire(answer.json()))


def simulation(
    weave: Weave,
    supports: Sequence[Support],
    forces: Sequence[Force],
    states: Optional[int],
    deformed: Optional[str],
    options: Optional[WeaveOptions],
    deadline: Optional[float],
) -> Computation[WeaveSimulation]:
    document = request_document(
        weave,
        options,
        supports=[support.to_wire() for support in supports],
        forces=[force.to_wire() for force in forces] or None,
        states=states,
        deformed=deformed,
        deadline=deadline,
    )
    return Computation("/v1/weave-simulations", document, lambda answer: weave_simulation_from_wire(answer.json()))
