"""Simulations of parts: what is sent, and what is read."""

from __future__ import annotations

import json
from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple.transport import Answer

BLOCK = supple.PartRequest(supple.parts.block(20, 30), "IH21", options=supple.PartOptions(beam_width=0.4, density=1.1), deadline=5)


def state(share: float, force: float, **more: Any) -> Dict[str, Any]:
    pressure = {"length": 1, "positions": [0.5], "values": [2.0]}
    supports = [{"force": [0, -force], "displacement": [0, 0], "touching": 3, "pressure": None},
                {"force": [0, force], "displacement": [0, -6 * share], "touching": 4, "pressure": pressure}]
    return {"share": share, "stopped": "converged", "residual": 1e-9, "iterations": 4, "load_steps": 1, "supports": supports, "energy": 2.0,
            "stable": True, "branch": 0, "contacts": 0, "largest_strain": 0.1, **more}


def answer(**more: Any) -> Dict[str, Any]:
    return {"part": {"size": [20, 32, 1], "lower": [0, 0], "upper": [20, 32], "outline_area": 640, "solid_area": 100,
                     "relative_density": 0.16, "missing_solids": [], "message": ""},
            "supports": [{"kind": "clamp", "box": [[0, 0], [20, 1]], "displacement": [0, 0]},
                         {"kind": "plate", "side": "top", "gap": 0, "friction": "none", "displacement": [0, -6]}],
            "states": [state(0.5, -10), state(1, -15)], "message": "", "fixed_translation": True,
            "accuracy": {"tolerance": 1e-8, "residual": 1e-9, "discretization_error": {"force": 0.01, "energy": 0.02}, "mesh_size": 0.5,
                         "corner_size": 0.1, "nodes": 6, "triangles": 1, "unknowns": 10},
            "effects": [], "cost": {"seconds": 1, "stages": [], "quantities": {}}, **more}


def read(document: Dict[str, Any]) -> supple.PartSimulation:
    return supple.PartSimulationRequest(BLOCK).decode(Answer(200, {}, json.dumps(document).encode()))


def test_the_part_is_sent_without_what_a_simulation_does_not_take() -> None:
    document = supple.PartSimulationRequest(BLOCK, strain="-5 %", material={"youngs_modulus": "1.2 GPa"}, mesh_size=1, contact="off").to_wire()
    assert document == {"part": {"outline": {"block": {"width": 20, "height": 30}}, "structure": {"family": "IH21"}, "beam_width": 0.4},
                        "strain": -0.05, "material": {"youngs_modulus": 1200}, "accuracy": {"mesh_size": 1}, "effects": {"contact": "off"},
                        "deformed": "none"}


def test_supports_may_have_units() -> None:
    supports = [supple.Plate("top", ("0 mm", "-2 mm"), "0.1 cm", "stick"), supple.Clamp([["0 mm", 0], ["2 cm", 1]], (0, 1))]
    assert supple.PartSimulationRequest(BLOCK, supports).to_wire()["supports"] == [
        {"kind": "plate", "side": "top", "displacement": [0, -2], "gap": 1, "friction": "stick"},
        {"kind": "clamp", "box": [[0, 0], [20, 1]], "displacement": [0, 1]}]


def test_a_support_that_means_nothing_is_refused_when_it_is_made() -> None:
    with pytest.raises(ValueError, match="side"):
        supple.Plate("above")
    with pytest.raises(ValueError, match="friction"):
        supple.Plate("top", friction="glue")
    with pytest.raises(ValueError, match="box"):
        supple.PartSimulationRequest(BLOCK, [supple.Clamp([[0, 0, 0], [1, 1, 1]])]).to_wire()


def test_states_are_arrays() -> None:
    result = read(answer())
    assert result.converged and result.share.tolist() == [0.5, 1]
    assert result.forces.shape == result.displacements.shape == (2, 2, 2)
    assert result.moving == 1 and result.displacement.tolist() == [3, 6]
    assert result.force.tolist() == [10, 15], "a plate that presses does work"
    assert result.discretization_error == supple.PartMeshError(0.01, 0.02)
    assert isinstance(result.supports[0], supple.Clamp) and isinstance(result.supports[1], supple.Plate)
    assert result.supports[1].side == "top"
    pressure = result.states[0].supports[1].pressure
    assert pressure is not None and pressure.values.tolist() == [2]
    assert result.states[0].supports[0].pressure is None and result.mesh is None and result.states[0].deformed is None


def test_a_path_that_ended_early_is_told() -> None:
    states = [state(0.3, -4, stopped="lost_support", residual=None)]
    result = read(answer(states=states, message="The path ended early."))
    assert not result.converged and result.states[0].stopped == "lost_support" and result.states[0].residual is None


def test_the_curve_is_drawn_from_rest() -> None:
    drawing = read(answer())._drawing()
    assert drawing is not None and drawing.lines[0].points.tolist() == [[0, 0], [3, 10], [6, 15]]
    assert drawing.x_label == "displacement / mm" and drawing.y_label == "force / N"
    assert "<svg" in (read(answer())._repr_svg_() or "")


def test_deformed_parts_are_drawn_where_they_were_asked_for() -> None:
    with pytest.raises(ValueError, match="json"):
        read(answer()).plot_state()
    mesh = {"points": [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], "triangles": [[0, 1, 2, 3, 4, 5]]}
    states = [state(1, -4, deformed={"points": mesh["points"], "strains": [0.1]})]
    result = read(answer(states=states, mesh=mesh))
    assert result.mesh is not None and result.mesh.triangles.dtype == np.int32 and result.states[0].deformed is not None
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    assert result.plot_state(0).get_title().startswith("strain from 0 to 10 %")


def test_a_file_is_of_the_kind_that_is_asked_for() -> None:
    assert supple.PartSimulationFileRequest(BLOCK, kind="vtu").accept == "application/x-vtu+xml"
    with pytest.raises(ValueError, match="kind"):
        supple.PartSimulationFileRequest(BLOCK, kind="stl")
