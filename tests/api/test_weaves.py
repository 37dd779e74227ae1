"""Weaves over HTTP: layouts, stiffness over directions, sheets under load, jobs, and refusals."""

from __future__ import annotations

import json
import time
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List

import numpy as np
import pytest

from harness import Api, pointers, problem_code
from working_time import WorkingTime, comes_true, ends_within
from test_jobs import events, start_job

LAYOUTS = "/v1/weave-layouts"
HOMOGENIZATIONS = "/v1/weave-homogenizations"
DEFORMATIONS = "/v1/weave-deformations"
SIMULATIONS = "/v1/weave-simulations"
SQUARES = {"pattern": "interlacing_squares", "type": 1}
REGULAR = {"pattern": "regular"}
SHEET = {**REGULAR, "sheet": {"columns": 5, "rows": 4}}
EA = 3500 * np.pi * 0.25**2
"""Stretching stiffness of a strand with the contract's defaults, N."""


def layout(api: Api, weave: Dict[str, Any], **more: Any) -> Dict[str, Any]:
    return api.ok(LAYOUTS, {"weave": weave, **more})  # type: ignore[no-any-return]


def homogenized(api: Api, weave: Dict[str, Any], directions: Any, **more: Any) -> Dict[str, Any]:
    answer = api.ok(HOMOGENIZATIONS, {"weave": weave, "directions": directions, **more})
    assert answer["message"] == "" and set(answer["stopped"]) == {"converged"}
    return answer  # type: ignore[no-any-return]


def simulated(api: Api, weave: Dict[str, Any], supports: List[Any], **more: Any) -> Dict[str, Any]:
    answer = api.ok(SIMULATIONS, {"weave": weave, "supports": supports, **more})
    assert answer["message"] == "" and {state["stopped"] for state in answer["states"]} == {"converged"}
    return answer  # type: ignore[no-any-return]


def held(box: List[List[float]], *displacement: float) -> Dict[str, Any]:
    return {"at": {"box": box}, **({"displacement": list(displacement)} if displacement else {})}


LEFT, RIGHT = [[-1, -1], [0.5, 17]], [[19.5, -1], [21, 17]]
"""Boxes around the ends of the strands along x of the sheet of 20 x 16 mm."""


def long_request(**more: Any) -> Dict[str, Any]:
    """A request that takes many seconds."""
    return {"weave": {**SQUARES, "type": 3}, "directions": 5000, "strain": 0.2, **more}


# --- layouts ---------------------------------------------------------------------------------------------------------

def test_a_pattern_is_laid_out_as_a_cell_or_a_sheet(api: Api) -> None:
    cell = layout(api, {**REGULAR, "connections": "slides_y", "pitch": 3})
    assert len(cell["strands"]) == 4 and len(cell["crossings"]) == 4 and cell["warnings"] == []
    assert {strand["ends"] for strand in cell["strands"]} == {"periodic"}
    np.testing.assert_allclose(cell["lattice"], [[6, 0], [0, 6]])
    assert all([member["slides"] for member in crossing["members"]] == [False, True] for crossing in cell["crossings"])
    sheet = layout(api, {**SHEET, "radius": 0.4})
    assert sheet["lattice"] is None and len(sheet["crossings"]) == 20
    assert sheet["strands"][0] == {"ends": "open", "translation": [0, 0], "length": 20, "radius": 0.4,
                                   "polyline": [[0, 2], [20, 2]]}
    squares, circles = (layout(api, {**pattern, "sheet": {"columns": 2, "rows": 3}})
                        for pattern in (SQUARES, {"pattern": "interlacing_circles", "type": 2}))
    assert len(squares["strands"]) == 4 * (6 + 2) and len(circles["strands"]) == 6
    assert len(layout(api, {"pattern": "actuated_rings"})["crossings"]) == 25


def test_crossings_of_a_layout_are_found_unless_they_are_given(api: Api) -> None:
    strands = [{"points": [[0, 0], [3, 1], [6, -1], [9, 0]]}, {"points": [[2, -3], [2, 3]]}, {"points": [[7, -3], [7, 3]]}]
    found = layout(api, {"strands": strands})
    assert [[m["strand"] for m in c["members"]] for c in found["crossings"]] == [[0, 1], [0, 2]]
    assert found["crossings"][0]["position"][0] == pytest.approx(2) and found["warnings"] == []
    again = layout(api, {"strands": strands, "crossings": [{"members": c["members"]} for c in found["crossings"]]})
    assert again["crossings"] == found["crossings"]
    fewer = layout(api, {"strands": strands, "crossings": [{"members": found["crossings"][0]["members"]}]})
    assert len(fewer["crossings"]) == 1 and len(fewer["warnings"]) == 2, "a missing crossing, and a loose strand"


def test_a_layout_is_drawn_as_a_file_or_within_the_answer(api: Api) -> None:
    response = api.post(LAYOUTS, {"weave": SQUARES}, headers={"Accept": "image/svg+xml"})
    assert response.status_code == 200 and response.headers["Content-Type"] == "image/svg+xml"
    picture = ElementTree.fromstring(response.text)
    assert picture.tag.endswith("svg") and len(list(picture)) > 8
    assert layout(api, SQUARES, svg=True)["svg"] == response.text and "svg" not in layout(api, SQUARES)
    refused = api.post(LAYOUTS, {"weave": SQUARES}, headers={"Accept": "model/stl"})
    assert (refused.status_code, problem_code(refused)) == (406, "http.not_acceptable")


def sliding_members(answer: Dict[str, Any]) -> List[Dict[str, Any]]:
    return [{"crossing": c, "slides": [m for m, member in enumerate(crossing["members"]) if member["slides"]]}
            for c, crossing in enumerate(answer["crossings"])
            if any(member["slides"] for member in crossing["members"])]


def test_overrides_make_one_type_of_a_pattern_another(api: Api) -> None:
    fused, sliding = (layout(api, {**SQUARES, "type": kind}) for kind in (1, 2))
    overrides = sliding_members(sliding)
    assert len(overrides) == 8 and sliding_members(fused) == []
    changed = {**SQUARES, "overrides": overrides}
    assert layout(api, changed)["crossings"] == sliding["crossings"], "with the pattern's limits"
    back = {**SQUARES, "type": 2, "overrides": [{"crossing": o["crossing"], "slides": []} for o in overrides]}
    assert layout(api, back)["crossings"] == fused["crossings"]
    one, two = (homogenized(api, weave, [0.3], strain=0.05) for weave in (changed, {**SQUARES, "type": 2}))
    assert one["youngs_modulus"] == two["youngs_modulus"]


def test_sliding_ranges_come_from_the_override_the_share_or_the_pattern(api: Api) -> None:
    def ranges(**more: Any) -> Any:
        member = layout(api, {**REGULAR, **more})["crossings"][1]["members"][0]
        return member["slides"], member.get("backward"), member.get("forward")

    assert ranges() == (False, None, None)
    assert ranges(overrides=[{"crossing": 1, "slides": [0]}]) == (True, None, None), "as far as its neighbours let it"
    assert ranges(connections="slides_x", sliding_share=0.5) == (True, pytest.approx(2), pytest.approx(2))
    assert ranges(sliding_share=0.5, overrides=[{"crossing": 1, "slides": [0], "forward": 0.75, "backward": None}]) == (
        True, None, 0.75)
    assert ranges(overrides=[{"crossing": 1, "slides": [0]}, {"crossing": 1, "slides": []}]) == (False, None, None)


# --- homogenization --------------------------------------------------------------------------------------------------

def test_a_fused_grid_is_as_stiff_along_its_strands_as_they_are(api: Api) -> None:
    answer = homogenized(api, {**REGULAR, "pitch": 4}, [0, np.pi / 2], thickness=0.5)
    np.testing.assert_allclose(answer["youngs_modulus"], 1000 * EA / 4, rtol=1e-6)
    np.testing.assert_allclose(answer["youngs_modulus_mpa"], EA / 4 / 0.5, rtol=1e-6)
    np.testing.assert_allclose(answer["poisson_ratio"], 0, atol=1e-6)
    twice = homogenized(api, {**REGULAR, "material": {"youngs_modulus": 7000}}, [0])
    assert twice["youngs_modulus"][0] == pytest.approx(2 * answer["youngs_modulus"][0], rel=1e-6)
    thick = homogenized(api, {**REGULAR, "radius": 0.5}, [0])
    assert thick["youngs_modulus"][0] == pytest.approx(4 * answer["youngs_modulus"][0], rel=1e-6)


def test_the_strain_is_imposed_exactly_and_the_stress_is_uniaxial(api: Api) -> None:
    answer = homogenized(api, {**REGULAR, "connections": [["fused", "slides_x"], ["slides_y", "fused"]]}, 7, strain=0.05)
    assert answer["directions"] == pytest.approx([np.pi * k / 7 for k in range(7)])
    for angle, f, sigma, modulus in zip(answer["directions"], answer["deformation_gradient"], answer["cauchy_stress"],
                                        answer["youngs_modulus"]):
        d, n = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        np.testing.assert_allclose(np.array(f).T @ d, 1.05 * d, atol=1e-12)
        assert d @ np.array(sigma) @ d == pytest.approx(0.05 * modulus, rel=1e-9)
        assert abs(n @ np.array(sigma) @ n) < 1e-4 * abs(modulus) and abs(n @ np.array(sigma) @ d) < 1e-4 * abs(modulus)


def test_a_deformation_gradient_of_a_homogenization_has_the_same_state(api: Api) -> None:
    weave = {"pattern": "interlacing_circles", "type": 2}
    along = homogenized(api, weave, [0, 0.7], strain=0.05)
    states = api.ok(DEFORMATIONS, {"weave": weave, "deformation_gradients": along["deformation_gradient"], "deformed": [1]})
    assert states["stopped"] == ["converged"] * 2 and states["message"] == ""
    for name in ("deformation_gradient", "nominal_stress", "cauchy_stress", "energy_density"):
        np.testing.assert_allclose(states[name], along[name], rtol=1e-4, atol=1e-4 * np.abs(along[name]).max())
    assert [cell["state"] for cell in states["cells"]] == [1] and len(states["cells"][0]["sliding"]) == len(states["sliders"])
    assert {effect["name"] for effect in states["effects"]} == {effect["name"] for effect in along["effects"]}


def test_stress_is_the_derivative_of_the_energy_by_the_deformation_gradient(api: Api) -> None:
    f, h = np.array([[1.06, 0.03], [-0.02, 0.97]]), 1e-4
    directions = [np.eye(4)[k].reshape(2, 2) for k in range(4)]
    gradients = [f, *(f + sign * h * d for d in directions for sign in (1, -1))]
    answer = api.ok(DEFORMATIONS, {"weave": {"pattern": "interlacing_circles", "type": 1}, "accuracy": {"tolerance": 1e-10},
                                   "deformation_gradients": [g.tolist() for g in gradients], "effects": {"out_of_plane": "off"}})
    energy = np.array(answer["energy_density"])
    slopes = (energy[1::2] - energy[2::2]) / (2 * h)
    np.testing.assert_allclose(np.ravel(answer["nominal_stress"][0]), slopes, atol=1e-5 * np.abs(slopes).max())


@pytest.mark.parametrize("fields, status, pointer", [
    ({"deformation_gradients": [[[1, 0], [0, 0]]]}, 400, "/deformation_gradients/0"),
    ({"deformation_gradients": [[[1, 0], [0, 1]]], "deformed": [1]}, 400, "/deformed/0"),
    ({"deformation_gradients": [[[1, 0], [0, 1]]], "weave": {**REGULAR, "sheet": {"columns": 2, "rows": 2}}}, 422, "/weave"),
    ({"deformation_gradients": [[[1, 0], [0, 1]]], "accuracy": {"segments": 0}}, 400, "/accuracy/segments")])
def test_deformation_gradients_that_are_none_are_refused(api: Api, fields: Dict[str, Any], status: int, pointer: str) -> None:
    answer = api.post(DEFORMATIONS, {"weave": REGULAR, **fields}, faulty=True)
    assert (answer.status_code, pointers(answer)) == (status, [pointer])


def test_suppressed_shear_is_stiffer_off_the_axes(api: Api) -> None:
    free, suppressed = (homogenized(api, REGULAR, [0.4], shear=shear)["youngs_modulus"][0] for shear in ("free", "suppressed"))
    assert suppressed > 1.5 * free > 0


def test_sliding_squares_are_soft_until_they_lock(api: Api) -> None:
    small, large = (homogenized(api, {**SQUARES, "type": 2}, [0], strain=strain)["youngs_modulus"][0] for strain in (0.1, 0.3))
    assert abs(small) < 1e-3 * large and large > 100


def test_deformed_cells_come_with_the_directions_that_are_asked_for(api: Api) -> None:
    weave = {**SQUARES, "type": 2}
    answer = homogenized(api, weave, 4, deformed=[3, 0])
    rest = layout(api, weave)
    assert [cell["direction"] for cell in answer["cells"]] == [3, 0] and len(answer["sliders"]) == 8
    for cell in answer["cells"]:
        f = np.array(answer["deformation_gradient"][cell["direction"]])
        np.testing.assert_allclose(cell["lattice"], np.array(rest["lattice"]) @ f.T, atol=1e-9)
        assert len(cell["strands"]) == len(rest["strands"]) and len(cell["sliding"]) == 8
        assert np.ptp(np.array(cell["strands"][0]), axis=0)[0] > 5, "a side of 12 mm"
    assert homogenized(api, weave, 2)["cells"] == []


def test_a_layout_is_homogenized_like_the_pattern_that_it_is(api: Api) -> None:
    strands = [{"points": [start], "ends": "periodic", "translation": period}
               for start, period in (([0, 2], [8, 0]), ([0, 6], [8, 0]), ([2, 0], [0, 8]), ([6, 0], [0, 8]))]
    directions = [0.2, 0.785]
    own = homogenized(api, {"strands": strands, "lattice": [[8, 0], [0, 8]]}, directions)
    np.testing.assert_allclose(own["youngs_modulus"], homogenized(api, REGULAR, directions)["youngs_modulus"], rtol=1e-6)


def test_more_segments_are_more_accurate(api: Api) -> None:
    def shear(segments: int) -> float:
        return homogenized(api, REGULAR, [np.pi / 4], strain=1e-4, accuracy={"segments": segments})["youngs_modulus"][0]  # type: ignore[no-any-return]

    four, eight, fine = shear(4), shear(8), shear(32)
    assert 0.07 < 1 - four / fine < 0.14 and 0.015 < 1 - eight / fine < 0.045


def test_every_stiffness_has_an_error_that_holds(api: Api) -> None:
    directions = [0.2, 0.8, 1.4]
    answer = homogenized(api, SQUARES, directions)
    fine = homogenized(api, SQUARES, directions, accuracy={"segments": 32}, effects={"error_estimate": "off"})
    for name in ("youngs_modulus", "poisson_ratio"):
        errors = np.abs(np.array(answer[name]) - np.array(fine[name]))
        assert np.all(errors <= answer[f"{name}_error"]) and np.median(answer[f"{name}_error"]) < 10 * np.median(errors)
    assert 0.02 < answer["accuracy"]["discretization_error"]["youngs_modulus"] < 0.4
    assert {effect["name"]: effect["ran"] for effect in answer["effects"]}["error_estimate"]
    assert fine["accuracy"]["discretization_error"] is None and fine["youngs_modulus_error"] == [None] * 3


def test_deformations_and_sheets_have_errors_where_they_are_asked_for(api: Api) -> None:
    states = api.ok(DEFORMATIONS, {"weave": REGULAR, "deformation_gradients": [[[1, 0.05], [0.05, 1]]]})
    assert 0 < states["cauchy_stress_error"][0] < 0.5 * np.linalg.norm(states["cauchy_stress"][0])
    assert set(states["accuracy"]["discretization_error"]) == {"stress", "energy"}
    sheet = {"weave": {"pattern": "regular", "sheet": {"columns": 3, "rows": 3}},
             "supports": [{"at": {"strand": 0, "share": 0}}, {"at": {"strand": 0, "share": 1}},
                          {"at": {"strand": 2, "share": 0.5}, "displacement": [1, 0, 0]}], "deformed": "none"}
    usual = api.ok(SIMULATIONS, sheet)
    assert usual["accuracy"]["discretization_error"] is None and usual["states"][0]["energy_error"] is None
    asked = api.ok(SIMULATIONS, {**sheet, "effects": {"error_estimate": "on"}})
    assert 0 < asked["states"][0]["energy_error"] < asked["states"][0]["energy"] and asked["states"][0]["reaction_error"] > 0


def test_the_answer_says_what_ran_and_what_was_reached(api: Api) -> None:
    answer = homogenized(api, {**SQUARES, "type": 2}, 3, effects={"out_of_plane": "off"})
    effects = {effect["name"]: effect for effect in answer["effects"]}
    assert not effects["out_of_plane"]["ran"] and effects["out_of_plane"]["why"] == "switched off by the request"
    assert all(effect["why"] for effect in effects.values())
    assert answer["accuracy"]["segments"] == 4 and answer["accuracy"]["tolerance"] == 1e-6
    assert 0 <= answer["accuracy"]["residual"] <= 1
    assert answer["cost"]["stages"] and not any(answer["out_of_plane"]) and all(answer["stable"])


def test_a_cell_ends_on_the_lower_side_and_its_sliders_at_their_limits(api: Api) -> None:
    cell = {"weave": {"pattern": "interlacing_squares", "type": 2, "side": 24, "overlap": 6}, "strain": 0.3, "directions": [0]}
    answer = api.ok(HOMOGENIZATIONS, {**cell, "deformed": [0]})
    straight = api.ok(HOMOGENIZATIONS, {**cell, "effects": {"buckling": "off"}})
    assert answer["stable"] == [True] and answer["message"] == ""
    assert answer["energy_density"][0] <= straight["energy_density"][0] * (1 + 1e-6)
    assert answer["limit_error"][0] <= answer["accuracy"]["limit_error"] <= answer["accuracy"]["limit_tolerance"] == 1e-6
    assert [abs(slid) for slid in answer["cells"][0]["sliding"]] == pytest.approx([4.2] * 8, abs=1e-5)


def test_a_cell_is_proportional_to_youngs_modulus_and_to_its_size(api: Api) -> None:
    cell = {"pattern": "interlacing_squares", "type": 2, "side": 12, "overlap": 3, "radius": 0.25}
    directions = {"strain": 0.3, "directions": [0, 0.4]}

    def moduli(times: float, modulus: float) -> list[float]:
        scaled = {name: value if isinstance(value, str) or name == "type" else value * times for name, value in cell.items()}
        weave = {**scaled, "material": {"youngs_modulus": 3500 * modulus}}
        return [value / modulus / times for value in api.ok(HOMOGENIZATIONS, {"weave": weave, **directions})["youngs_modulus"]]

    usual = moduli(1, 1)
    assert usual[0] == pytest.approx(294.29, abs=0.03)
    assert moduli(1, 0.01) == pytest.approx(usual, rel=1e-12)
    assert moduli(1, 1000) == pytest.approx(usual, rel=1e-12)
    assert moduli(20, 1) == pytest.approx(usual, rel=1e-6)


def test_sliders_that_barriers_alone_stop_are_said_to_stand_short_of_their_limits(api: Api) -> None:
    cell = {"weave": {**SQUARES, "type": 2}, "strain": 0.3, "directions": [0, 0.4]}
    soft = api.ok(HOMOGENIZATIONS, {**cell, "accuracy": {"limit_tolerance": 1}})
    assert soft["accuracy"]["limit_error"] == max(soft["limit_error"]) > 0.01
    state = api.ok(HOMOGENIZATIONS, cell)
    assert all(soft["youngs_modulus"][k] > state["youngs_modulus"][k] * 1.005 for k in range(2))
    unfinished = api.ok(HOMOGENIZATIONS, {**cell, "directions": [0], "accuracy": {"max_iterations": 1}})
    assert unfinished["stopped"] != ["converged"] or "sliders stand short of their limits" in unfinished["message"]


def test_a_direction_that_is_not_reached_is_null_and_no_error(api: Api) -> None:
    answer = api.ok(HOMOGENIZATIONS, {"weave": {**SQUARES, "type": 2}, "directions": [0.5, 1], "strain": 0.3,
                                      "accuracy": {"max_iterations": 1}})
    assert "converged" not in answer["stopped"] and "2 of 2" in answer["message"]
    assert answer["youngs_modulus"] == answer["poisson_ratio"] == [None, None]


def test_equal_requests_have_equal_answers(api: Api) -> None:
    first, second = (homogenized(api, {**SQUARES, "type": 3}, 9, deformed=[4]) for _ in range(2))
    for name in ("youngs_modulus", "poisson_ratio", "cells", "residual", "iterations"):
        assert first[name] == second[name], name


# --- sheets ----------------------------------------------------------------------------------------------------------

def test_a_sheet_is_drawn_out_by_boxes_of_strand_ends(api: Api) -> None:
    answer = simulated(api, SHEET, [held(LEFT), held(RIGHT, 0.4, 0, 0)], states=2)
    assert [place["support"] for place in answer["supports"]] == [0] * 4 + [1] * 4
    assert all(place["position"][0] in (0, 20) for place in answer["supports"])
    for state, share in zip(answer["states"], (0.5, 1)):
        assert state["share"] == share
        reactions = np.array(state["reactions"])
        np.testing.assert_allclose(reactions.sum(axis=0), 0, atol=1e-6)
        pulled = reactions[4:, 0].sum()
        assert pulled == pytest.approx(4 * EA * 0.4 * share / 20, rel=1e-3), "four strands of 20 mm"
        assert state["energy"] == pytest.approx(0.5 * pulled * 0.4 * share, rel=1e-3)
        assert len(state["strands"]) == 9 and len(state["crossings"]) == 20
    assert answer["accuracy"]["unknowns"] > 100 and answer["accuracy"]["residual"] <= 1


def test_a_place_may_be_named_in_every_way(api: Api) -> None:
    ends = [{"at": {"strand": 0, "coordinate": 0}}, {"at": {"strand": 0, "share": 1}}]
    others = [{"at": {"crossing": 0}}, {"at": {"crossing": 19}, "held": [True, True, False]}]
    answer = simulated(api, SHEET, [*ends, *others], forces=[{"at": {"box": [[9, 13], [11, 15]]}, "force": [0.1, 0, 0]}])
    assert [place["coordinate"] for place in answer["supports"]] == [0, 20, 2, 18]
    assert answer["supports"][3]["position"] == [18, 14]
    np.testing.assert_allclose(np.array(answer["states"][0]["reactions"]).sum(axis=0), [-0.1, 0, 0], atol=1e-6)


def test_forces_of_a_box_are_shared_by_its_places(api: Api) -> None:
    supports = [held(LEFT)]
    whole = simulated(api, SHEET, supports, forces=[{"at": {"box": RIGHT}, "force": [2, 0, 0]}])
    single = simulated(api, SHEET, supports,
                       forces=[{"at": {"strand": row, "share": 1}, "force": [0.5, 0, 0]} for row in range(4)])
    np.testing.assert_allclose(whole["states"][0]["crossings"], single["states"][0]["crossings"], atol=1e-9)


def test_a_sheet_that_slides_shears_more_easily_than_a_fused_one(api: Api) -> None:
    supports = [held([[-1, -1], [21, 2.5]]), held([[-1, 13.5], [21, 17]], 2, 0, 0)]
    fused, sliding = (simulated(api, {**SHEET, "connections": connection}, supports, accuracy={"segments": 2},
                                effects={"out_of_plane": "off"})["states"][0] for connection in ("fused", "slides_y"))
    assert 0 < sliding["energy"] < 0.7 * fused["energy"]
    assert fused["sliding"] == [] and max(map(abs, sliding["sliding"])) > 0.01


def test_a_strand_that_is_pushed_makes_the_rings_rise(api: Api) -> None:
    outer = layout(api, {"pattern": "actuated_rings"})["strands"][2]["length"]
    supports = [{"at": {"strand": 2, "coordinate": 0.75 * outer}, "clamped": True},
                {"at": {"strand": 6, "share": 1}, "displacement": [0, 6, 0]}]
    answer = simulated(api, {"pattern": "actuated_rings"}, supports, states=2, accuracy={"segments": 2})
    heights = [np.abs(np.array(state["crossings"])[:, 2]).max() for state in answer["states"]]
    assert heights[1] > heights[0] > 1 and all(state["out_of_plane"] for state in answer["states"])


def test_strands_come_as_polylines_or_as_obj_and_vtu_files(api: Api) -> None:
    supports = [held(LEFT), held(RIGHT, 0.4, 0, 0)]
    as_json, as_obj, as_vtu, without = (simulated(api, SHEET, supports, deformed=deformed)["states"][0]
                                        for deformed in ("json", "obj", "vtu", "none"))
    points = np.concatenate([np.array(strand) for strand in as_json["strands"]])
    lines = as_obj["obj"].splitlines()
    vertices = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
    np.testing.assert_array_equal(vertices, points)
    elements = [list(map(int, line.split()[1:])) for line in lines if line.startswith("l ")]
    assert [len(element) for element in elements] == [len(strand) for strand in as_json["strands"]]
    assert sum(elements, []) == list(range(1, len(points) + 1))
    (piece,) = ElementTree.fromstring(as_vtu["vtu"]).iter("Piece")
    arrays = {array.attrib["Name"]: np.array((array.text or "").split(), dtype=float) for array in piece.iter("DataArray")}
    np.testing.assert_array_equal(arrays["Points"].reshape(-1, 3), points)
    np.testing.assert_array_equal(arrays["offsets"], np.cumsum([len(strand) for strand in as_json["strands"]]))
    assert set(arrays["types"]) == {4} and set(arrays["radius"]) == {0.25}
    assert not {"strands", "obj", "vtu"} & without.keys()


def test_a_path_that_ends_early_is_answered_with_its_reason(api: Api) -> None:
    answer = api.ok(SIMULATIONS, {"weave": SHEET, "supports": [held(LEFT), held(RIGHT, -12, 3, 0)], "states": 3,
                                  "accuracy": {"max_iterations": 1}})
    assert answer["message"] and answer["states"][-1]["stopped"] != "converged"
    assert len(answer["states"]) < 3 or answer["states"][-1]["share"] < 1


# --- jobs ------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("path, document", [
    (LAYOUTS, {"weave": SQUARES}), (HOMOGENIZATIONS, {"weave": SQUARES, "directions": 20}),
    (DEFORMATIONS, {"weave": SQUARES, "deformation_gradients": [[[1.05, 0], [0.01, 1]], [[1, 0.1], [0.1, 1]]], "deformed": [0]}),
    (SIMULATIONS, {"weave": SHEET, "supports": [held(LEFT), held(RIGHT, 0.4, 0, 0)], "states": 3}),
], ids=["layouts", "homogenizations", "deformations", "simulations"])
def test_a_job_has_the_result_of_the_immediate_answer(api: Api, path: str, document: Dict[str, Any]) -> None:
    job = start_job(api, path, document)
    seen = list(events(api, job))
    assert seen[-1][1]["state"] == "successful" and seen[-1][1]["kind"] == path[4:] and seen[-1][1]["progress"] == 1
    shares = [status["progress"] for _, status in seen]
    assert shares == sorted(shares)
    result, immediate = api.get(f"/v1/jobs/{job}/result").json(), api.ok(path, document)
    for answer in (result, immediate):
        del answer["cost"], answer["effects"]
    assert result == immediate


def test_delete_dismisses_a_running_homogenization_within_a_moment(api: Api) -> None:
    job = start_job(api, HOMOGENIZATIONS, long_request())
    comes_true(lambda: api.get(f"/v1/jobs/{job}").json()["progress"] > 0, "the first direction", 180)
    assert api.get(f"/v1/jobs/{job}").json()["stage"] == "directions"
    assert api.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    ends_within(api.server.pid, api.busy, 3, "the computation goes on")


def test_a_deadline_ends_a_sheet_between_two_states(api: Api) -> None:
    sheet = {**REGULAR, "connections": "slides_y", "sheet": {"columns": 40, "rows": 40}}
    supports = [held([[-1, -1], [161, 3]]), held([[-1, 157], [161, 161]], 50, 0, 0)]
    work = WorkingTime(api.server.pid)
    response = api.post(SIMULATIONS, {"weave": sheet, "supports": supports, "states": 200, "deformed": "none", "deadline": 1.5})
    work.check(15, "the computation goes on")
    if response.status_code == 200:  # a state was finished in time
        answer = response.json()
        assert 1 <= len(answer["states"]) < 200 and answer["states"][-1]["stopped"] == "deadline"
        assert answer["message"].startswith("The deadline passed after the equilibrium under ")
        assert all(state["stopped"] == "converged" for state in answer["states"][:-1])
    else:
        assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


def test_a_deadline_leaves_the_directions_that_are_finished(api: Api) -> None:
    job = start_job(api, HOMOGENIZATIONS, long_request())
    started = time.monotonic()
    comes_true(lambda: api.get(f"/v1/jobs/{job}").json()["progress"] > 0, "the first direction", 180)
    first = time.monotonic() - started
    api.delete(f"/v1/jobs/{job}")
    for factor in (2, 4, 8, 16):  # the machine may be busy
        response = api.post(HOMOGENIZATIONS, {**long_request(), "deadline": factor * first})
        if response.status_code == 200:
            break
        assert problem_code(response) == "job.deadline_exceeded"
    answer = response.json()
    assert response.status_code == 200 and "deadline" in answer["stopped"] and "converged" in answer["stopped"]
    for modulus, ratio, stopped in zip(answer["youngs_modulus"], answer["poisson_ratio"], answer["stopped"]):
        assert (stopped == "deadline") == (modulus is None) == (ratio is None)
    assert "have no value; `stopped` says why." in answer["message"] and answer["accuracy"]["residual"] is not None


# --- refusals --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("weave, code, expected", [
    ({**SQUARES, "overlap": 6}, "weave.invalid_pattern", ["/weave/overlap"]),
    ({"pattern": "interlacing_circles", "type": 1, "distance": 11}, "weave.invalid_pattern", ["/weave/distance"]),
    ({**REGULAR, "sheet": {"columns": 20000, "rows": 2}}, "weave.invalid_pattern", ["/weave/sheet/columns"]),
    ({"strands": [{"points": [[0, 0], [1, 0]]}, {"points": [[0, 0], [0, 0]]}]}, "weave.invalid_strand",
     ["/weave/strands/1/points/1"]),
    ({"strands": [{"points": [[0, 0]]}]}, "weave.invalid_strand", ["/weave/strands/0/points"]),
    ({"strands": [{"points": [[0, 0]], "ends": "periodic", "translation": [3, 0]}], "lattice": [[2, 0], [0, 2]]},
     "weave.invalid_layout", ["/weave/strands/0/translation"]),
    ({"strands": [{"points": [[0, 0], [1, 0]]}], "lattice": [[0, 1], [1, 0]]}, "weave.invalid_layout", ["/weave/lattice"]),
    ({"strands": [{"points": [[0, 0], [1, 0]]}, {"points": [[0, -1], [0, 1]]}],
      "crossings": [{"members": [{"strand": 0, "coordinate": 0.5}, {"strand": 1, "coordinate": 1}]}]},
     "weave.invalid_layout", ["/weave/crossings/0/members/1"]),
    ({**REGULAR, "overrides": [{"crossing": 4, "slides": []}]}, "weave.invalid_layout", ["/weave/overrides/0/crossing"]),
    ({**REGULAR, "overrides": [{"crossing": 3, "slides": [0, 2]}]}, "weave.invalid_layout", ["/weave/overrides/0/slides/1"]),
], ids=lambda value: json.dumps(value)[:60])
def test_a_weave_that_does_not_fit_together_is_pointed_to(api: Api, weave: Any, code: str, expected: List[str]) -> None:
    for path, more in ((LAYOUTS, {}), (HOMOGENIZATIONS, {}), (SIMULATIONS, {"supports": [{"at": {"crossing": 0}}]})):
        response = api.post(path, {"weave": weave, **more}, headers={"Prefer": "respond-async"})
        assert (response.status_code, problem_code(response)) == (422, code), "before it is a job"
        assert pointers(response) == expected


def test_a_sheet_is_not_homogenized_and_a_cell_is_no_sheet(api: Api) -> None:
    response = api.post(HOMOGENIZATIONS, {"weave": SHEET})
    assert (response.status_code, problem_code(response)) == (422, "weave.not_periodic")
    assert pointers(response) == ["/weave"]
    response = api.post(SIMULATIONS, {"weave": REGULAR, "supports": [{"at": {"crossing": 0}}]})
    assert (response.status_code, problem_code(response)) == (422, "weave.invalid_load")
    assert pointers(response) == ["/weave"]


@pytest.mark.parametrize("supports, forces, expected", [
    ([{"at": {"crossing": 20}}], [], ["/supports/0/at/crossing"]), ([{"at": {"strand": 9, "share": 0}}], [], ["/supports/0/at/strand"]),
    ([{"at": {"box": [[100, 100], [200, 200]]}}], [], ["/supports/0/at/box"]),
    ([{"at": {"crossing": 1}}, {"at": {"strand": 0, "coordinate": 21}}], [], ["/supports/1/coordinate"]),
    ([held(LEFT), {"at": {"strand": 2, "coordinate": 0}}], [], ["/supports/1"] * 3),
    ([{"at": {"crossing": 1}}], [{"at": {"crossing": 99}, "force": [1, 0, 0]}], ["/forces/0/at/crossing"]),
    ([held(LEFT)], [{"at": {"box": RIGHT}, "force": [1, 0, 0]}, {"at": {"strand": 0, "coordinate": 99}, "force": [1, 0, 0]}],
     ["/forces/1/coordinate"]),
], ids=lambda value: json.dumps(value)[:50])
def test_a_load_that_cannot_be_imposed_is_pointed_to(api: Api, supports: Any, forces: Any, expected: List[str]) -> None:
    response = api.post(SIMULATIONS, {"weave": SHEET, "supports": supports, "forces": forces})
    assert (response.status_code, problem_code(response)) == (422, "weave.invalid_load")
    assert pointers(response) == expected


def test_a_clamp_needs_a_strand_that_does_not_slide(api: Api) -> None:
    both = {**SHEET, "overrides": [{"crossing": 0, "slides": [0, 1]}]}
    response = api.post(SIMULATIONS, {"weave": both, "supports": [held(RIGHT), {"at": {"crossing": 0}, "clamped": True}]})
    assert (response.status_code, problem_code(response)) == (422, "weave.invalid_load")
    assert pointers(response) == ["/supports/1/clamped"]


@pytest.mark.parametrize("path, fields, pointer", [
    (HOMOGENIZATIONS, {"strain": 0}, "/strain"), (HOMOGENIZATIONS, {"strain": "much"}, "/strain"),
    (HOMOGENIZATIONS, {"directions": []}, "/directions"), (HOMOGENIZATIONS, {"directions": 10001}, "/directions"),
    (HOMOGENIZATIONS, {"shear": "none"}, "/shear"), (HOMOGENIZATIONS, {"thickness": 0}, "/thickness"),
    (HOMOGENIZATIONS, {"deformed": [200]}, "/deformed/0"), (HOMOGENIZATIONS, {"accuracy": {"segments": 65}}, "/accuracy/segments"),
    (HOMOGENIZATIONS, {"effects": {"twist": "on"}}, "/effects/twist"), (HOMOGENIZATIONS, {"states": 3}, "/states"),
    (SIMULATIONS, {"states": 0}, "/states"), (SIMULATIONS, {"deformed": "stl"}, "/deformed"),
    (SIMULATIONS, {"sliding": {"regularization": -1}}, "/sliding/regularization"), (LAYOUTS, {"svg": 1}, "/svg"),
], ids=lambda value: str(value))
def test_a_field_outside_its_range_is_pointed_to(api: Api, path: str, fields: Dict[str, Any], pointer: str) -> None:
    more = {"supports": [{"at": {"crossing": 0}}]} if path == SIMULATIONS else {}
    response = api.post(path, {"weave": SHEET if path == SIMULATIONS else REGULAR, **more, **fields}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [pointer]


def test_no_more_deformed_points_than_the_limit(api: Api) -> None:
    document = {"weave": {**REGULAR, "sheet": {"columns": 50, "rows": 50}}, "supports": [{"at": {"crossing": 0}}], "states": 1000}
    response = api.post(SIMULATIONS, document)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/deformed"] and response.json()["limit"] == 1_000_000


def test_the_contract_names_the_defaults_that_the_server_has(api: Api) -> None:
    schemas = api.contract.spec["components"]["schemas"]
    answer = homogenized(api, REGULAR, [0.3])
    accuracy = schemas["WeaveAccuracy"]["properties"]
    assert answer["accuracy"]["segments"] == accuracy["segments"]["default"]
    assert answer["accuracy"]["tolerance"] == accuracy["tolerance"]["default"]
    assert answer["strain"] == schemas["WeaveHomogenizationRequest"]["properties"]["strain"]["default"]
    laid = layout(api, REGULAR)
    assert laid["material"] == {name: entry["default"] for name, entry in schemas["StrandMaterial"]["properties"].items()}
    assert laid["strands"][0]["radius"] == schemas["StrandRadius"]["default"]
    assert laid["strands"][0]["length"] == 2 * schemas["RegularWeave"]["properties"]["pitch"]["default"]
