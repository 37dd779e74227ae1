"""The JSON of requests for designs and profiles and of their answers."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple import DesignOptions, DesignRequest, DesignResult, Limits, Material, ProfileRequest, Region, RegionsRequest, Target
from supple.wire import decode

BILL = {"accuracy": {"tolerance": 1e-6, "equilibrium_tolerance": 1e-10, "residual": 1e-12}, "effects": [],
        "cost": {"seconds": 0.1, "stages": [], "quantities": {}}}
MATERIAL = {"youngs_modulus": 26, "law": "neo_hookean", "poisson_ratio": 0.48, "density": 1.2}
ERROR = {"relative_rms": 0.02, "max": 0.3}


def profile_document(**more: Any) -> Dict[str, Any]:
    return {"task": "stress_strain", "direction": 0.5, "strain_measure": "green", "x": [0, 0.1], "target": [0, 1],
            "initial": [None, 2], "achieved": [0, 1.02], "error_bar": None, "verified": None, "in_range": [True, False],
            "reached": [True, False], "envelope": None, "bound": None, "beam_width_sensitivity": None,
            "ranges": [{"from": 0, "to": 0.05, "reached": True, "deviation": 0.0},
                       {"from": 0.05, "to": 0.1, "reached": False, "deviation": None}], **more}


def design_document(**more: Any) -> Dict[str, Any]:
    return {"family": "IH21", "model": "ih21", "sha256": "0", "parameters": [0.15, 0.65], "profile": profile_document(),
            "verdict": {"grade": "reached", "source": "model", "deviation": 0.02, "sentence": "By the model: reached, 2 % off.",
                        "bound": ""},
            "also": [], "error": ERROR, "reached": False, "iterations": 7, "starts": 2, "stopped": "converged", "message": "m",
            "polish": None, "ways_out": [], "ranking": [{"family": "IH21", "model": "ih21", "parameters": [0.15, 0.65], "error": ERROR,
                         "model_error": None, "simulated_error": None, "stopped": "converged",
                         "orientation": 0.25, "material": MATERIAL}],
            "structure": {"svg": "/s", "dxf": "/d", "stl": "/t", "beam_width": 0.3, "cell_size": 4.8,
                          "relative_density": 0.25, "density": 0.3}, "material": MATERIAL, "orientation": 0.25, **more}


def test_what_is_not_given_is_left_to_the_server() -> None:
    request = DesignRequest(Target("poisson", np.array([[0, 0.1], [1, 0.3]])))
    assert request.url() == "/v1/designs"
    assert request.to_wire() == {"task": "poisson", "target": {"control_points": [[0.0, 0.1], [1.0, 0.3]]}}


def test_materials_sizes_and_limits_are_sent() -> None:
    def sent(**more: Any) -> Dict[str, Any]:
        document = DesignRequest(Target("poisson", [(0, 0.1), (1, 0.3)]), **more).to_wire()
        return {name: value for name, value in document.items() if name not in ("task", "target")}

    assert sent(orientation=0.5) == {"orientation": 0.5}
    assert sent(orientation=(0, 3), initial=[0.1], initial_orientation=1) == {
        "orientation": [0, 3], "initial": [0.1], "initial_orientation": 1}
    assert sent(material=Material(2000)) == {"material": {"youngs_modulus": 2000}}
    full = Material((20, 60), 1.21, "TPU", 0.48, "neo_hookean")
    assert sent(material=[full, Material(5)], beam_width=0.4, limits=Limits((0, 0.3), cell_size=np.array([2, 4]))) == {
        "material": [{"name": "TPU", "youngs_modulus": [20, 60], "law": "neo_hookean", "poisson_ratio": 0.48, "density": 1.21},
                     {"youngs_modulus": 5}],
        "beam_width": 0.4, "limits": {"relative_density": [0, 0.3], "cell_size": [2, 4]}}
    assert sent(cell_size=5, limits=Limits(beam_width=(0.4, 0.8))) == {
        "cell_size": 5, "limits": {"beam_width": [0.4, 0.8]}}
    with pytest.raises(ValueError, match="pair"):
        sent(limits=Limits(relative_density=(0.3, 0.1)))
    with pytest.raises(ValueError, match="shape"):
        sent(material=Material((1, 2, 3)))  # type: ignore[arg-type]


def test_a_part_of_a_design_needs_nothing_twice() -> None:
    found = decode(DesignResult, {**design_document(), **BILL})
    request = supple.PartRequest(supple.parts.coupon("12 mm", "3 cm"), found, options=supple.PartOptions(thickness=2, density="1 g/cm3"))
    assert request.to_wire() == {
        "outline": {"coupon": {"width": 12, "length": 30}}, "structure": {"family": "IH21", "parameters": [0.15, 0.65]},
        "beam_width": 0.3, "orientation": 0.25, "direction": 0.5, "thickness": 2, "material": {"density": 1}}
    sheet = supple.PartFileRequest(supple.parts.rectangle(20, 30), found, kind="dxf").to_wire()
    assert "direction" not in sheet and sheet["orientation"] == 0.25
    loaded = supple.PartRequest(supple.parts.rectangle(20, 30), found, options=supple.PartOptions(axis="60 deg")).to_wire()
    assert loaded["axis"] == pytest.approx(np.pi / 3) and loaded["direction"] == 0.5
    with pytest.raises(ValueError, match="parameters of its own"):
        supple.PartRequest(supple.parts.block(12, 30), found, [0.1, 0.2])


def test_a_part_of_a_design_without_a_single_direction_is_warned_of() -> None:
    also = [profile_document(direction=1.5)]
    found = decode(DesignResult, {**design_document(also=also), **BILL})
    with pytest.warns(UserWarning, match="no single direction"):
        assert "direction" not in supple.PartRequest(supple.parts.coupon(12, 30), found).to_wire()
    with pytest.warns(UserWarning, match=r"no single direction .* along its direction 0\.3 rad"):
        assert "direction" not in supple.PartRequest(supple.parts.rectangle(12, 30), found, options=supple.PartOptions(axis=0.3)).to_wire()
    chosen = supple.PartRequest(supple.parts.coupon(12, 30), found, options=supple.PartOptions(direction="30 deg")).to_wire()
    assert chosen["direction"] == pytest.approx(np.pi / 6)


def test_a_design_tells_its_material_and_its_size() -> None:
    found = decode(DesignResult, {**design_document(), **BILL})
    assert found.material.youngs_modulus == 26 and found.material.name == ""
    assert found.orientation == found.ranking[0].orientation == 0.25
    assert found.ranking[0].material == found.material
    assert found.size.cell_size == 4.8 and found.size.density == 0.3
    assert found.structure == {"svg": "/s", "dxf": "/d", "stl": "/t"}
    nothing = {"svg": "/s", "dxf": "/d", "stl": "/t", "beam_width": 0.3, "cell_size": None, "relative_density": None,
               "density": None}
    lost = decode(DesignResult, {**design_document(structure=nothing, material={**MATERIAL, "name": "PLA"}), **BILL})
    assert lost.size.density is None and lost.material.name == "PLA"


def test_a_missed_design_tells_what_would_help() -> None:
    way = {"change": "turn", "sentence": "Turn the tiling by 82 degrees: 3.5 % instead of 55 % by the model.", "family": "IH21",
           "model": "ih21", "parameters": [0.1, 0.7], "orientation": 1.43, "youngs_modulus": 26, "range": None, "deviation": 0.035}
    shorter = {**way, "change": "shorten", "range": [0, 0.12]}
    found = decode(DesignResult, {**design_document(ways_out=[way, shorter]), **BILL})
    assert [one.change for one in found.ways_out] == ["turn", "shorten"]
    turned, shortened = found.ways_out
    assert turned.sentence == way["sentence"] and turned.deviation == 0.035 and turned.range is None
    assert turned.parameters.tolist() == [0.1, 0.7] and shortened.range is not None and shortened.range.tolist() == [0, 0.12]
    assert decode(DesignResult, {**design_document(), **BILL}).ways_out == ()
    older = {name: value for name, value in design_document().items() if name != "ways_out"}
    assert decode(DesignResult, {**older, **BILL}).ways_out == (), "of a server that does not know ways out"


def test_a_design_tells_how_near_any_material_comes() -> None:
    possible = {"deviation": 0.07, "y": [0.5, 0.75]}
    sentence = "No material at rest comes nearer than 7 % to it."
    verdict = {"grade": "missed", "source": "model", "deviation": 0.3, "sentence": "By the model: 30 % off.", "bound": sentence}

    def found_with(bound: Any) -> DesignResult:
        profile = {**profile_document(bound=bound, task="stiffness", strain=0.05), "direction": None}
        return decode(DesignResult, {**design_document(profile=profile, verdict=verdict), **BILL})

    alone = found_with({**possible, "together": None})
    assert alone.profile.bound is not None and alone.profile.bound.deviation == 0.07 and alone.profile.bound.together is None
    assert alone.profile.bound.y.tolist() == [0.5, 0.75]
    assert alone.verdict.bound == sentence and ("bound", sentence) in alone._shown()
    both = found_with({**possible, "together": {"deviation": 0.2, "y": [0.25, 1]}})
    assert both.profile.bound is not None and both.profile.bound.together is not None
    assert both.profile.bound.together.deviation == 0.2
    for found, y in ((alone, [0.5, 0.75]), (both, [0.25, 1])):
        (line,) = [line for line in found._drawing().lines if line.label == "nearest that any material can have at rest"]
        assert line.points[:, 1].tolist() == y
    close = found_with({"deviation": 0.001, "y": [0.0, 1.0], "together": None})
    assert len(close._drawing().lines) == 2, "a curve on that of the target is not drawn"
    older = {name: value for name, value in profile_document().items() if name != "bound"}
    old_verdict = {name: value for name, value in verdict.items() if name != "bound"}
    old = decode(DesignResult, {**design_document(profile=older, verdict=old_verdict), **BILL})
    assert old.profile.bound is None and old.verdict.bound == "", "of a server that does not know bounds"


def test_a_design_tells_how_sensitive_it_is_to_the_beam_width() -> None:
    profile = profile_document(beam_width_sensitivity={"wider": 0.12, "narrower": None})
    found = decode(DesignResult, {**design_document(profile=profile), **BILL}).profile.beam_width_sensitivity
    assert found is not None and found.wider == 0.12 and found.narrower is None
    older = {name: value for name, value in profile_document().items() if name != "beam_width_sensitivity"}
    assert decode(DesignResult, {**design_document(profile=older), **BILL}).profile.beam_width_sensitivity is None


def test_everything_that_is_given_is_sent() -> None:
    target = Target("stress_strain", [(0, 0), (0.1, 1)], direction=0.5, strain_measure="engineering", interpolation="linear",
                    weights=[1, 2], bands=(0, 0.1), samples=5, weight=2)
    also = Target("stiffness", [(0, 1), (1, 2)], strain=0.02)
    problem: Dict[str, Any] = {"target": target, "name": "heel", "family": "IH21", "also": [also], "initial": np.array([0.15, 0.65]),
                               "fixed": [None, 0.65]}
    options = DesignOptions(1e-7, 1e-11, 9, 3, 32, 4, "on", "off", "on", 0.01, 7, 50, "off", "on", "off")
    document = DesignRequest(**problem, options=options, verify=True, session="s", deadline=7.0).to_wire()
    assert document == {
        "task": "stress_strain", "direction": 0.5, "strain_measure": "engineering", "samples": 5, "weight": 2,
        "target": {"control_points": [[0, 0], [0.1, 1]], "interpolation": "linear", "weights": [1, 2], "bands": [0, 0.1]},
        "also": [{"task": "stiffness", "strain": 0.02, "target": {"control_points": [[0, 1], [1, 2]]}}],
        "name": "heel", "family": "IH21", "initial": [0.15, 0.65], "fixed": [None, 0.65], "verify": True, "session": "s",
        "deadline": 7.0, "accuracy": {"tolerance": 1e-7, "equilibrium_tolerance": 1e-11, "max_iterations": 9, "starts": 3,
                                      "candidates": 32, "verified_samples": 4, "polish_tolerance": 0.01, "polish_rounds": 7,
                                      "polish_seconds": 50},
        "effects": {"trust": "off", "multi_start": "on", "envelope": "off", "polish": "on", "ways_out": "on", "beam_width_sensitivity": "off"}}
    assert RegionsRequest([Region(**problem)] * 2).to_wire()["regions"][1]["name"] == "heel"


@pytest.mark.parametrize("points", [[0.1, 0.2], [[0, 0, 0]], [[[0, 0]]]])
def test_control_points_of_another_shape_are_refused(points: Any) -> None:
    with pytest.raises(ValueError, match="shape"):
        Target("poisson", points).to_wire()


def test_profiles_are_asked_for_at_places_or_in_a_range() -> None:
    plain = ProfileRequest("poisson", [0.1], "IH29")
    assert plain.url() == "/v1/profiles" and plain.to_wire() == {"task": "poisson", "parameters": [0.1], "family": "IH29"}
    full = ProfileRequest("stress_strain", [0.1], None, "ih29", 0.5, None, "green", np.array([0.1]), (0, 1), 3, 1e-9, 0.2,
                          Material(5.0), 2.0)
    assert full.to_wire() == {"task": "stress_strain", "parameters": [0.1], "model": "ih29", "direction": 0.5,
                             "strain_measure": "green", "x": [0.1], "range": [0, 1], "samples": 3,
                             "accuracy": {"equilibrium_tolerance": 1e-9}, "orientation": 0.2, "material": {"youngs_modulus": 5},
                             "deadline": 2.0}


def test_a_design_has_its_verdict_and_the_ranges_that_are_reached() -> None:
    found = decode(DesignResult, {**design_document(), **BILL})
    assert (found.verdict.grade, found.verdict.source, found.verdict.deviation) == ("reached", "model", 0.02)
    assert found.verdict.sentence == "By the model: reached, 2 % off."
    assert [(part.from_, part.to, part.reached, part.deviation) for part in found.profile.ranges] == [
        (0, 0.05, True, 0), (0.05, 0.1, False, None)]
    lost = {"grade": "unknown", "source": "simulation", "deviation": None, "sentence": "Simulated: no result."}
    assert decode(DesignResult, {**design_document(verdict=lost), **BILL}).verdict.deviation is None


def test_missing_values_are_nan_and_missing_curves_none() -> None:
    result = decode(DesignResult, {**design_document(), **BILL})
    assert isinstance(result, supple.Design) and result.name == "" and result.residual == 1e-12
    assert np.isnan(result.profile.initial[0]) and result.profile.initial[1] == 2
    assert result.profile.lower is None and result.profile.verified is None and result.profile.strain is None
    assert result.profile.in_range.tolist() == [True, False] and result.ranking[0].error.max == 0.3
    assert result.ranking[0].model_error is None
    assert result.profile.error_bar is None
    verified = {"x": [0.1], "target": [1], "y": [None], "model": [1.02], "target_error": None, "discretization_error": 0.004}
    document = profile_document(envelope={"lower": [0, 0.5], "upper": [0, 3]}, verified=verified, error_bar=[0.02, None])
    full = decode(DesignResult, {**design_document(profile=document, also=[profile_document()]), **BILL})
    assert full.profile.error_bar is not None and full.profile.error_bar[0] == 0.02 and np.isnan(full.profile.error_bar[1])
    assert full.profile.upper is not None and full.profile.upper.tolist() == [0, 3] and len(full.also) == 1
    assert full.profile.verified is not None and full.profile.verified.relative_rms is None
    assert np.isnan(full.profile.verified.y[0]) and full.profile.verified.target_error is None
    assert full.profile.verified.discretization_error == 0.004
    assert full.profile.verified.target.tolist() == [1]


def test_a_polished_design_tells_its_rounds() -> None:
    rounds = [{"proposal": "search", "parameters": [0.15, 0.65], "target_error": 0.02, "accepted": True, "reason": "", "seconds": 2.0,
               "orientation": 0},
              {"proposal": "step", "parameters": [0.16, 0.65], "target_error": None, "accepted": False, "reason": "r", "seconds": 1.0,
               "orientation": 0}]
    polish = {"target_error": 0.02, "stopped": "time_limit", "rounds": rounds}
    result = decode(DesignResult, {**design_document(polish=polish), **BILL})
    assert decode(DesignResult, {**design_document(), **BILL}).polish is None
    assert result.polish is not None and (result.polish.target_error, result.polish.stopped) == (0.02, "time_limit")
    first, second = result.polish.rounds
    assert (first.proposal, first.target_error, first.accepted, first.seconds) == ("search", 0.02, True, 2.0)
    assert second.target_error is None and second.reason == "r" and second.parameters.tolist() == [0.16, 0.65]
    running = decode(supple.PartialRound, {"family": "IH21", "model": "ih21", "name": "heel", "round": rounds[1]})
    assert isinstance(running, supple.PartialRound) and running.name == "heel" and running.round.reason == "r"


def test_regions_keep_their_order_and_names() -> None:
    found = decode(supple.RegionDesigns, {"regions": [design_document(name="heel"), design_document()], **BILL})
    assert [region.name for region in found.regions] == ["heel", ""] and found.tolerance == 1e-6


def test_a_running_job_may_show_a_design() -> None:
    document = {"id": "0", "kind": "designs", "state": "running", "progress": 0.5, "stage": "optimization", "created": "t"}
    partial = {"name": "heel", "family": "IH21", "model": "ih21", "parameters": [0.1], "x": [0, 1], "achieved": [2, 3],
               "error": ERROR, "iteration": 4, "orientation": 0.5}
    assert decode(supple.JobStatus, document).partial is None
    assert decode(supple.JobStatus, {**document, "partial": partial}).partial is not None
    best = decode(supple.PartialDesign, partial)
    assert (best.name, best.iteration, best.achieved.tolist()) == ("heel", 4, [2, 3])


def test_a_profile_has_nan_where_there_is_no_equilibrium() -> None:
    curve = decode(supple.ProfileCurve, {"family": "IH21", "model": "ih21", "sha256": "0", "parameters": [0.1], "task": "poisson",
                               "strain": 0.05, "strain_measure": "green", "x": [0, 1], "y": [None, 0.3],
                               "error_bar": [None, 0.02], "in_range": [False, True], "orientation": 0, "material": MATERIAL, **BILL})
    assert curve.error_bar is not None and np.isnan(curve.error_bar[0]) and curve.error_bar[1] == 0.02
    assert np.isnan(curve.y[0]) and curve.direction is None and curve.strain == 0.05 and curve.residual == 1e-12
