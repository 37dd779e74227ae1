"""The profiles of given parameters over HTTP: uniaxial loads, stiffness at rest, error bars, what lies outside of the training."""

from __future__ import annotations

import numpy as np
import pytest

from design_requests import DESIGNS, KNOWN, PROFILES, answers, known_problem, profile
from harness import Api
from test_jobs import start_job


@pytest.mark.parametrize("direction", [0.0, 0.7, 2.0])
def test_stress_over_strain_is_that_of_the_models_uniaxial_load(designs: Api, direction: float) -> None:
    strains = [0.02, 0.05, 0.1]
    answer = profile(designs, "stress_strain", strains, direction=direction)
    states = designs.ok("/v1/models/ih67/uniaxial", {"parameters": KNOWN["IH67"], "direction": direction,
                                                     "green_strains": strains})["states"]
    np.testing.assert_allclose(answer["y"], [state["directional_stress"] for state in states], rtol=1e-7)
    assert answer["direction"] == direction and answer["model"] == "ih67" and "strain" not in answer


def test_the_profiles_at_rest_are_those_of_the_stiffness(designs: Api) -> None:
    x = [0.0, 0.4, 1.3, 2.2]
    tangent = np.array(designs.ok("/v1/models/ih67/evaluations", {
        "parameters": [KNOWN["IH67"]], "green_strain": [[0, 0, 0]], "derivatives": 2})["tangent"][0])
    compliance = np.linalg.inv(tangent)
    stiffness, poisson = (profile(designs, task, x, strain=0)["y"] for task in ("stiffness", "poisson"))
    for angle, modulus, ratio in zip(x, stiffness, poisson):
        c, s = np.cos(angle), np.sin(angle)
        along, across = np.array([c * c, s * s, c * s]), np.array([s * s, c * c, -c * s])
        strain = compliance @ along
        assert modulus == pytest.approx(1 / (along @ strain), rel=1e-6)
        assert ratio == pytest.approx(-(across @ strain) / (along @ strain), rel=1e-5, abs=1e-8)


def test_the_stiffness_of_a_profile_is_the_slope_of_stress_over_strain(designs: Api) -> None:
    step, direction = 1e-4, 0.6
    below, above = profile(designs, "stress_strain", [0.05 - step, 0.05 + step], direction=direction)["y"]
    (stiffness,) = profile(designs, "stiffness", [direction], strain=0.05)["y"]
    assert stiffness == pytest.approx((above - below) / (2 * step), rel=1e-5)


def test_engineering_strain_and_stress_are_stretch_and_force(designs: Api) -> None:
    green = [-0.05, 0.04, 0.1]
    stretches = [np.sqrt(1 + 2 * strain) for strain in green]
    second = profile(designs, "stress_strain", green)["y"]
    first = profile(designs, "stress_strain", [s - 1 for s in stretches], strain_measure="engineering")
    np.testing.assert_allclose(first["y"], np.multiply(second, stretches), rtol=1e-7)
    assert first["strain_measure"] == "engineering"
    moduli = [profile(designs, "stiffness", [0.3], **where)["y"][0] for where in (
        {"strain": 0.04}, {"strain": stretches[1] - 1, "strain_measure": "engineering"})]
    assert moduli[0] == pytest.approx(moduli[1], rel=1e-7), "stiffness stays that of Green strain"


def test_samples_may_come_in_any_order(designs: Api) -> None:
    x = [0.08, -0.04, 0.02, 0, -0.08]
    shuffled, ordered = (profile(designs, "stress_strain", places)["y"] for places in (x, sorted(x)))
    np.testing.assert_allclose(shuffled, [ordered[sorted(x).index(place)] for place in x], rtol=1e-8, atol=1e-14)


def test_ranges_and_samples_are_as_the_contract_says(designs: Api) -> None:
    request = {"family": "IH29", "parameters": KNOWN["IH29"]}
    strains = designs.ok(PROFILES, {**request, "task": "stress_strain"})
    np.testing.assert_allclose(strains["x"], np.linspace(-0.1, 0.2, 31), atol=1e-15)
    directions = designs.ok(PROFILES, {**request, "task": "poisson"})
    np.testing.assert_allclose(directions["x"], np.pi * np.arange(50) / 50)
    assert directions["strain"] == 0.05 and "direction" not in directions
    chosen = designs.ok(PROFILES, {**request, "task": "stress_strain", "range": [0, 0.1], "samples": 3})
    assert chosen["x"] == pytest.approx([0, 0.05, 0.1])
    assert len(designs.ok(PROFILES, {**request, "task": "stiffness", "samples": 7})["y"]) == 7


def test_a_profile_says_what_lies_outside_of_the_training(designs: Api) -> None:
    answer = profile(designs, "stress_strain", [0.02, 2.0])
    assert answer["in_range"] == [True, False]
    assert profile(designs, "stress_strain", [0.02], parameters=[0.5, 0.9])["in_range"] == [False]


@pytest.mark.parametrize("task, limit", [("stress_strain", 0.05), ("stiffness", 0.1), ("poisson", 0.1)])
def test_each_value_has_an_error_bar_and_long_ones_are_not_in_range(designs: Api, task: str, limit: float) -> None:
    x = [-0.2, -0.05, 0, 0.1, 0.4] if task == "stress_strain" else [0, 0.5, 1, 2, 3]
    said = set()
    for share in np.linspace(0, 1, 9):
        bounds = designs.get("/v1/models/ih67").json()["parameters"]
        parameters = [low + share * (high - low) for low, high in zip(bounds["lower"], bounds["upper"])]
        answer = designs.ok(PROFILES, {"task": task, "family": "IH67", "parameters": parameters, "x": x,
                                       **({} if task == "stress_strain" else {"strain": -0.1})})
        for y, bar, inside in zip(answer["y"], answer["error_bar"], answer["in_range"]):
            if bar is None:
                assert not inside
                continue
            longest = limit * (1 if task == "poisson" else abs(y))
            assert bar >= 0 and (bar == longest or inside == (bar <= longest))
            said.add(inside)
    assert said == {True, False}, "bars tell places apart"


@pytest.mark.parametrize("family", list(KNOWN))
def test_a_design_has_the_error_bars_of_designs_that_searches_find(designs: Api, family: str) -> None:
    """Searched designs have other error bars than given ones, as a profile has, since these come from other simulations."""
    assert "searched" in designs.get(f"/v1/models/{family.lower()}").json()["error_bars"]["stress_at_strain"]
    answer = designs.ok(DESIGNS, known_problem(designs, family=family))
    again = profile(designs, "stress_strain", answer["profile"]["x"], family=family, parameters=answer["parameters"],
                    direction=answer["profile"]["direction"])
    np.testing.assert_allclose(again["y"], answer["profile"]["achieved"], rtol=1e-6, atol=1e-12)
    ratios = np.array(answer["profile"]["error_bar"]) / np.array(again["error_bar"])
    assert ((ratios > 0.3) & (ratios < 5)).all() and (abs(ratios - 1) > 1e-3).any(), ratios


def test_error_bars_are_unknown_outside_of_the_training(designs: Api) -> None:
    answer = profile(designs, "stress_strain", [0, 0.02, 2.0])
    assert answer["error_bar"][0] < 1e-15 and answer["error_bar"][1] > 0 and answer["error_bar"][2] is None


def test_the_model_says_what_its_error_bars_are_worth(designs: Api) -> None:
    bars = designs.get("/v1/models/ih67").json()["error_bars"]
    assert bars["level"] == 0.9 and bars["judged_by"] in ("fresh", "held_out")
    for quantity in ("stress", "stiffness", "poisson", "stress_at_strain"):
        assert bars[quantity]["designs"] > 20 and 0.88 <= bars[quantity]["share"] <= 0.97


def test_profiles_are_jobs_where_the_client_prefers_it(designs: Api) -> None:
    request = {"task": "poisson", "family": "IH29", "parameters": KNOWN["IH29"]}
    job = start_job(designs, PROFILES, request)
    assert designs.wait_for_job(job)["kind"] == "profiles"
    assert answers(designs.get(f"/v1/jobs/{job}/result").json()) == answers(designs.ok(PROFILES, request))
