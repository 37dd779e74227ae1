"""The calls of a client about weaves."""

from __future__ import annotations

from typing import Any, Mapping, Optional, Sequence, Union

from numpy.typing import ArrayLike

from . import weave_printing, weaves
from .jobs import Job, Progress, run, submit
from .transport import Transport
from .weave_answers import WeaveDeformation, WeaveHomogenization, WeaveLayout, WeaveSimulation
from .weave_print_answers import GcodeReport, WeaveToolpath
from .weave_printing import PrintOptions
from .weaves import Force, Support, Weave, WeaveOptions


class WeaveCalls:
    """A base class of `Client`: layouts, stiffness, sheets under load and printing of digital weaves."""

    _transport: Transport

    def weave_layout(self, weave: Weave, *, deadline: Optional[float] = None, timeout: Optional[float] = None) -> WeaveLayout:
        """Strands and crossings at rest, with warnings of likely mistakes. Raises `InvalidWeave`."""
        return run(self._transport, weaves.layout(weave, deadline), timeout, None)

    def weave_picture(self, weave: Weave, *, timeout: Optional[float] = None) -> bytes:
        """The weave at rest as an SVG file, lengths in mm."""
        return run(self._transport, weaves.picture(weave), timeout, None)

    def weave_homogenization(
        self,
        weave: Weave,
        *,
        strain: Optional[float] = None,
        directions: Union[int, ArrayLike, None] = None,
        shear: Optional[str] = None,
        thickness: Optional[float] = None,
        deformed: Sequence[int] = (),
        options: Optional[WeaveOptions] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> WeaveHomogenization:
        """Young's modulus and Poisson's ratio of a periodic weave in every direction.

        Args:
            weave: a cell: a pattern without a sheet, or a layout with a lattice.
            strain: stretch minus one, in [-0.5, 2], not 0. 0.1 by default.
            directions: number of directions over half a turn, or angles in radians, shape (n,). 200 by default.
            shear: "free", or "suppressed" relative to the direction. "free" by default.
            thickness: mm; with it moduli in MPa are returned too.
            deformed: indices of the directions for which deformed cells are returned.

            A direction whose path does not reach the strain raises no exception: its numbers are nan.
        """
        computation = weaves.homogenization(weave, strain, directions, shear, thickness, deformed, options, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_weave_homogenization(
        self,
        weave: Weave,
        *,
        strain: Optional[float] = None,
        directions: Union[int, ArrayLike, None] = None,
        shear: Optional[str] = None,
        thickness: Optional[float] = None,
        deformed: Sequence[int] = (),
        options: Optional[WeaveOptions] = None,
        deadline: Optional[float] = None,
    ) -> Job[WeaveHomogenization]:
        """`weave_homogenization` as a job."""
        computation = weaves.homogenization(weave, strain, directions, shear, thickness, deformed, options, deadline)
        return submit(self._transport, computation)

    def weave_deformation(
        self,
        weave: Weave,
        deformation_gradients: ArrayLike,
        *,
        deformed: Sequence[int] = (),
        options: Optional[WeaveOptions] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> WeaveDeformation:
        """Stress and energy of a periodic weave under given deformation gradients. The path to each one begins at rest.

        Args:
            weave: a cell: a pattern without a sheet, or a layout with a lattice.
            deformation_gradients: F of positive determinant, shape (n, 2, 2), or (2, 2) for one.
            deformed: indices of the gradients for which deformed cells are returned.

            A gradient that is not reached raises no exception: see `WeaveDeformation.stopped`.
        """
        computation = weaves.deformation(weave, deformation_gradients, deformed, options, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_weave_deformation(
        self,
        weave: Weave,
        deformation_gradients: ArrayLike,
        *,
        deformed: Sequence[int] = (),
        options: Optional[WeaveOptions] = None,
        deadline: Optional[float] = None,
    ) -> Job[WeaveDeformation]:
        """`weave_deformation` as a job."""
        return submit(self._transport, weaves.deformation(weave, deformation_gradients, deformed, options, deadline))

    def weave_simulation(
        self,
        weave: Weave,
        supports: Sequence[Support],
        forces: Sequence[Force] = (),
        *,
        states: Optional[int] = None,
        deformed: Optional[str] = None,
        options: Optional[WeaveOptions] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> WeaveSimulation:
        """Equilibria of a sheet along a load path from rest.

        Args:
            weave: a sheet: a pattern with `sheet`, or a layout without a lattice.
            supports: supports of the sheet, which may move.
            forces: forces on the sheet.
            states: number of states that are returned, evenly along the path. 1 by default.
            deformed: "json" for polylines, "obj" or "vtu" for files, "none". "json" by default.

        A path that cannot be followed to its end raises no exception: see `WeaveSimulation.message`.
        """
        computation = weaves.simulation(weave, supports, forces, states, deformed, options, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_weave_simulation(
        self,
        weave: Weave,
        supports: Sequence[Support],
        forces: Sequence[Force] = (),
        *,
        states: Optional[int] = None,
        deformed: Optional[str] = None,
        options: Optional[WeaveOptions] = None,
        deadline: Optional[float] = None,
    ) -> Job[WeaveSimulation]:
        """`weave_simulation` as a job."""
        computation = weaves.simulation(weave, supports, forces, states, deformed, options, deadline)
        return submit(self._transport, computation)

    def weave_toolpath(
        self,
        weave: Weave,
        options: Optional[PrintOptions] = None,
        *,
        printer: Optional[Mapping[str, Any]] = None,
        include: Optional[Sequence[str]] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> WeaveToolpath:
        """G-code that prints a sheet, and the report of an independent checker on it. Raises `InvalidWeave`.

        Args:
            weave: a sheet: a pattern with `sheet`, or a layout without a lattice.
            options: supports, overruns, order and place.
            printer: fields of the contract's PrinterProfile; None takes a Prusa i3 MK3S with PLA.
            include: parts of the answer: "gcode", "svg", "moves". ["gcode"] by default.
        """
        computation = weave_printing.toolpath(weave, options, printer, include, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_weave_toolpath(
        self,
        weave: Weave,
        options: Optional[PrintOptions] = None,
        *,
        printer: Optional[Mapping[str, Any]] = None,
        include: Optional[Sequence[str]] = None,
        deadline: Optional[float] = None,
    ) -> Job[WeaveToolpath]:
        """`weave_toolpath` as a job."""
        return submit(self._transport, weave_printing.toolpath(weave, options, printer, include, deadline))

    def gcode_report(
        self,
        gcode: Union[str, bytes],
        *,
        limits: Optional[Mapping[str, Any]] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> GcodeReport:
        """A check of G-code: what a printer would do with it, and its violations.

        Violations raise no exception: see `GcodeReport.violations`. `limits` has fields of the contract's GcodeLimits. Bytes
        that are not ASCII are read as question marks.
        """
        return run(self._transport, weave_printing.report(gcode, limits, deadline), timeout, None)

    def start_gcode_report(
        self,
        gcode: Union[str, bytes],
        *,
        limits: Optional[Mapping[str, Any]] = None,
        deadline: Optional[float] = None,
    ) -> Job[GcodeReport]:
        """`gcode_report` as a job."""
        return submit(self._transport, weave_printing.report(gcode, limits, deadline))
