"""The JSON of requests about weaves and of their answers."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple.errors import problem_from
from supple.weave_printing import GcodeReportRequest, WeaveToolpathRequest
from supple.weaves import WeaveHomogenizationRequest, WeaveLayoutRequest, WeavePictureRequest, WeaveSimulationRequest
from supple.wire import decode

BILL: Dict[str, Any] = {"effects": [], "cost": {"seconds": 0.1, "stages": [], "quantities": {}}}


def test_patterns_become_what_the_contract_says() -> None:
    assert supple.Weave.regular().document == {"pattern": "regular"}
    assert supple.Weave.regular([("fused", "slides_x"), ("slides_y", "fused")], pitch=3, sheet=(5, 4), fused_border=1,
                                radius=0.4).document == {
        "pattern": "regular", "connections": [["fused", "slides_x"], ["slides_y", "fused"]], "pitch": 3,
        "sheet": {"columns": 5, "rows": 4, "fused_border": 1}, "radius": 0.4}
    assert supple.Weave.squares(3, overlap=2).document == {"pattern": "interlacing_squares", "type": 3, "overlap": 2}
    assert supple.Weave.circles(2, circle_radius=6).document == {"pattern": "interlacing_circles", "type": 2, "circle_radius": 6}
    assert supple.Weave.rings(sliding_share=0.5).document == {"pattern": "actuated_rings", "sliding_share": 0.5}


def test_a_layout_of_strands_becomes_what_the_contract_says() -> None:
    strands = [supple.Strand(np.array([[0, 0], [4, 0]])), supple.Strand([(1, 1)], "periodic", (8, 0), 0.5)]
    assert supple.Weave.layout(strands, lattice=[[8, 0], [0, 8]]).document == {
        "strands": [{"points": [[0.0, 0.0], [4.0, 0.0]], "ends": "open"},
                    {"points": [[1.0, 1.0]], "ends": "periodic", "translation": [8.0, 0.0], "radius": 0.5}],
        "lattice": [[8.0, 0.0], [0.0, 8.0]]}
    with pytest.raises(ValueError, match="shape"):
        supple.Strand([1, 2]).to_wire()


def test_overrides_add_up_and_leave_the_weave_as_it_was() -> None:
    weave = supple.Weave.regular()
    changed = weave.fuse(1, 2).slide(3, 0, forward=1.5)
    assert weave.document == {"pattern": "regular"}
    assert changed.document["overrides"] == [{"crossing": 1, "slides": []}, {"crossing": 2, "slides": []},
                                             {"crossing": 3, "slides": [0], "forward": 1.5}]


def test_what_is_not_given_is_left_to_the_server() -> None:
    weave = supple.Weave.regular()
    assert WeaveLayoutRequest(weave).to_wire() == {"weave": {"pattern": "regular"}}
    assert WeavePictureRequest(weave).accept == "image/svg+xml"
    assert WeaveHomogenizationRequest(weave).to_wire() == {"weave": {"pattern": "regular"}}
    supports = [supple.Support(supple.Place.crossing(3))]
    assert WeaveSimulationRequest(weave, supports, options=supple.WeaveOptions()).to_wire() == {
        "weave": {"pattern": "regular"}, "supports": [{"at": {"crossing": 3}}]}


def test_everything_that_is_given_is_sent() -> None:
    options = supple.WeaveOptions(8, 1e-8, 9, 2, 0.2, 0.05, 1e-5, "off", "on", 1e-4)
    groups = {"accuracy": {"segments": 8, "tolerance": 1e-8, "max_iterations": 9, "load_steps": 2, "limit_tolerance": 1e-4},
              "sliding": {"least_distance": 0.2, "barrier_range": 0.05, "regularization": 1e-5},
              "effects": {"out_of_plane": "off", "buckling": "on"}}
    request = WeaveHomogenizationRequest(supple.Weave.rings(), 0.2, np.array([0, 1]), "suppressed", 0.5, [1], options, 7.0)
    assert request.to_wire() == {"weave": {"pattern": "actuated_rings"}, "strain": 0.2, "directions": [0.0, 1.0], "shear": "suppressed",
                        "thickness": 0.5, "deformed": [1], "deadline": 7.0, **groups}
    assert WeaveHomogenizationRequest(supple.Weave.rings(), directions=12).to_wire()["directions"] == 12
    support = supple.Support(supple.Place.box((0, 1), (2, 3)), (1, 2, 3), (True, False, True), True, (0, 0, 0.5))
    force = supple.Force(supple.Place.strand(2, share=0.5), (0, -1, 0))
    document = WeaveSimulationRequest(supple.Weave.rings(), [support], [force], 4, "vtu", options, 7.0).to_wire()
    assert document == {"weave": {"pattern": "actuated_rings"}, "states": 4, "deformed": "vtu", "deadline": 7.0, **groups,
                        "supports": [{"at": {"box": [[0.0, 1.0], [2.0, 3.0]]}, "displacement": [1.0, 2.0, 3.0],
                                      "held": [True, False, True], "clamped": True, "rotation": [0.0, 0.0, 0.5]}],
                        "forces": [{"at": {"strand": 2, "share": 0.5}, "force": [0.0, -1.0, 0.0]}]}


def test_a_place_of_a_strand_is_given_in_one_way() -> None:
    assert supple.Place.strand(1, coordinate=2.5).document == {"strand": 1, "coordinate": 2.5}
    for fields in ({}, {"coordinate": 1.0, "share": 0.5}):
        with pytest.raises(ValueError, match="either"):
            supple.Place.strand(1, **fields)
    with pytest.raises(ValueError, match="shape"):
        supple.Support(supple.Place.crossing(0), displacement=(1, 2)).to_wire()


def test_a_layout_is_read() -> None:
    member = {"strand": 1, "coordinate": 2.0, "shift": [1, 0], "slides": True, "backward": None, "forward": 0.5}
    laid = decode(supple.WeaveLayout, {
        "strands": [{"ends": "open", "translation": [0, 0], "length": 4, "radius": 0.25, "polyline": [[0, 0], [4, 0]]}],
        "crossings": [{"position": [2, 0], "members": [{**member, "slides": False}, member]}], "lattice": None,
        "material": {}, "warnings": ["w"], **BILL})
    assert laid.strands[0].polyline.shape == (2, 2) and laid.lattice is None and laid.warnings == ("w",)
    assert laid.crossings[0].slides and laid.crossings[0].members[1].forward == 0.5
    assert laid.crossings[0].members[1].shift == (1, 0) and laid.crossings[0].members[1].backward is None


def test_missing_moduli_are_no_numbers() -> None:
    matrices = [np.eye(2).tolist()] * 2
    result = decode(supple.WeaveHomogenization, {
        "strain": 0.1, "directions": [0, 1], "youngs_modulus": [5, None], "poisson_ratio": [0.3, None],
        "youngs_modulus_error": [0.5, None], "poisson_ratio_error": [0.02, None],
        "deformation_gradient": matrices, "nominal_stress": matrices, "cauchy_stress": matrices, "energy_density": [1, 2],
        "stopped": ["converged", "step_too_small"], "residual": [0, None], "out_of_plane": [False, True],
        "stable": [True, True], "iterations": [1, 2], "load_steps": [1, 2], "branches": [0, 0],
        "limit_error": [1e-8, None], "message": "1 of 2",
        "sliders": [], "cells": [{"direction": 1, "lattice": [[1, 0], [0, 1]], "strands": [[[0, 0, 0], [1, 0, 0]]],
                                  "sliding": []}],
        "accuracy": {"segments": 4, "tolerance": 1e-6, "residual": None, "limit_tolerance": 1e-6, "limit_error": None,
                     "discretization_error": {"youngs_modulus": 0.1, "poisson_ratio": 0.02}}, **BILL})
    assert result.youngs_modulus_error[0] == 0.5 and np.isnan(result.poisson_ratio_error[1])
    assert result.discretization_error is not None and result.discretization_error.youngs_modulus == 0.1
    assert result.limit_tolerance == 1e-6 and result.limit_error is None
    assert result.limit_errors[0] == 1e-8 and np.isnan(result.limit_errors[1])
    assert result.youngs_modulus[0] == 5 and np.isnan(result.youngs_modulus[1]) and np.isnan(result.poisson_ratio[1])
    assert result.youngs_modulus_mpa is None and not result.converged and result.residual is None
    assert result.out_of_plane.tolist() == [False, True] and result.cells[0].strands[0].shape == (2, 3)


def test_reactions_of_a_box_add_up() -> None:
    state = {"share": 1, "energy": 2, "crossings": [[0, 0, 0]], "sliding": [0.5], "reactions": [[1, 0, 0], [2, 0, 0], [0, 3, 0]],
             "out_of_plane": False, "stable": True, "stopped": "converged", "residual": 1e-9, "limit_error": 2e-8, "energy_error": 0.1,
             "reaction_error": None, "iterations": 3,
             "load_steps": 1, "branches": 0, "obj": "v"}
    places = [{"support": support, "strand": 0, "coordinate": 0, "position": [0, 0]} for support in (0, 0, 1)]
    result = decode(supple.WeaveSimulation, {
        "supports": places, "sliders": [{"crossing": 2, "member": 1}], "states": [state], "message": "",
        "accuracy": {"segments": 4, "tolerance": 1e-6, "residual": 0.1, "limit_tolerance": 1e-6, "limit_error": 2e-8,
                     "discretization_error": None, "unknowns": 9}, **BILL})
    assert result.limit_error == result.states[0].limit_error == 2e-8
    assert result.converged and result.sliders == ((2, 1),) and result.unknowns == 9
    assert result.resultant(0).tolist() == [[3, 0, 0]] and result.resultant(1).tolist() == [[0, 3, 0]]
    assert result.states[0].obj == "v" and result.states[0].strands is None and result.states[0].vtu is None


def test_faults_of_weaves_have_their_exception() -> None:
    assert isinstance(problem_from(422, {"code": "weave.invalid_layout"}), supple.InvalidWeave)


def test_printing_becomes_the_contracts_request() -> None:
    options = supple.PrintOptions(origin=(1, 2), order=[1, 0], overrun=(3, 4), overruns={1: (5, 6)}, loop_overlap=0.5, frame=(2, 16),
                                  grips=[supple.Grip((0, 1), (2, 3), 4), supple.Grip((0, 0), (9, 0))], chord_error=0.01)
    document = WeaveToolpathRequest(supple.Weave.rings(), options, {"bed": [1, 2, 3]}, ("svg",), 7.0).to_wire()
    assert document == {
        "weave": {"pattern": "actuated_rings"}, "printer": {"bed": [1, 2, 3]}, "include": ["svg"], "deadline": 7.0,
        "origin": [1.0, 2.0], "order": [1, 0], "overrun": {"start": 3, "end": 4}, "overruns": [{"strand": 1, "start": 5, "end": 6}],
        "loop_overlap": 0.5, "frame": {"margin": 2, "lead_in": 16}, "chord_error": 0.01,
        "grips": [{"from": [0.0, 1.0], "to": [2.0, 3.0], "width": 4}, {"from": [0.0, 0.0], "to": [9.0, 0.0]}]}
    assert WeaveToolpathRequest(supple.Weave.rings()).to_wire() == {"weave": {"pattern": "actuated_rings"}}
    assert WeaveToolpathRequest(supple.Weave.rings(), include=()).to_wire()["include"] == []


def test_gcode_is_sent_as_text() -> None:
    assert GcodeReportRequest(b"G28 ; \xe9\n").to_wire() == {"gcode": "G28 ; ?\n"}
    assert GcodeReportRequest("G28 ; \u00e9\n", {"cold": 1}, 2.0).to_wire() == {"gcode": "G28 ; ?\n", "limits": {"cold": 1}, "deadline": 2.0}
