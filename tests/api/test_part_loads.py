"""Loads of parts: the direction of the design along a coupon or a block, and the agreement of the part's response with the design."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
import pytest

import supple
from harness import CLI, Api, pointers, problem_code

PARTS = "/v1/parts"
COUPON = {"outline": {"coupon": {"width": 24, "length": 30, "grip_length": 4}}, "structure": {"family": "IH67"}, "beam_width": 0.3}
BLOCK = {"outline": {"block": {"width": 24, "height": 30, "plate": 2}}, "structure": {"family": "IH67"}}


def turn(angle: float) -> Any:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def holes(svg: str) -> List[Any]:
    """The holes in the drawing of a part, with y upwards."""
    (path,) = re.findall(r' d="([^"]*)"', svg)
    rings = [np.array([[float(x) for x in corner.split()] for corner in ring.strip()[1:].split("L")]) for ring in path.split("Z") if ring.strip()]
    return [ring * [1, -1] for ring in sorted(rings, key=lambda ring: -np.prod(np.ptp(ring, axis=0)))[1:]]


@pytest.mark.parametrize("request_of", [COUPON, BLOCK])
def test_a_direction_of_the_design_is_laid_along_the_load(api: Api, request_of: Dict[str, Any]) -> None:
    for orientation, direction in ((0.0, 0.0), (0.3, 0.0), (-0.8, 2.35), (0.5, np.pi / 2)):
        laid = api.ok(PARTS, {**request_of, "orientation": orientation, "direction": direction, "svg": True})
        assert laid["orientation"] == pytest.approx(orientation + np.pi / 2 - direction, abs=1e-12)
        assert laid["tested_direction"] == direction
        turned = api.ok(PARTS, {**request_of, "orientation": laid["orientation"], "svg": True})
        assert turned["svg"] == laid["svg"] and turned["tested_direction"] == pytest.approx(np.pi / 2)


def test_without_a_direction_the_part_lies_as_before_and_says_what_it_tests(api: Api) -> None:
    plain = api.ok(PARTS, {**COUPON, "orientation": 0.4})
    assert plain["orientation"] == 0.4 and plain["tested_direction"] == pytest.approx(np.pi / 2)
    sheet = api.ok(PARTS, {"outline": {"rectangle": [20, 20]}, "structure": {"family": "IH67"}, "orientation": 0.4})
    assert sheet["orientation"] == 0.4 and sheet["tested_direction"] is None


@pytest.mark.parametrize("outline", [{"rectangle": [20, 20]}, {"polygons": [[[0, 0], [9, 0], [0, 9]]]}])
def test_a_part_without_an_axis_of_load_takes_no_direction(api: Api, outline: Dict[str, Any]) -> None:
    answer = api.post(PARTS, {"outline": outline, "structure": {"family": "IH67"}, "direction": 0}, faulty=True)
    assert problem_code(answer) == "request.invalid" and pointers(answer) == ["/direction"], answer.text
    assert "coupon" in answer.text


@pytest.mark.parametrize("outline", [{"rectangle": [20, 24]}, {"polygons": [[[0, 0], [20, 0], [20, 24], [0, 20]]]}])
def test_a_direction_of_the_design_is_laid_along_the_axis_of_a_drawing(api: Api, outline: Dict[str, Any]) -> None:
    region = {"outline": [[0, 0], [9, 0], [9, 12], [0, 12]], "structure": {"family": "IH29"}, "orientation": 0.2}
    request = {"outline": outline, "structure": {"family": "IH67"}, "orientation": 0.3, "svg": True}
    laid = api.ok(PARTS, {**request, "axis": 0.9, "direction": 0.4, "regions": [region, {**region, "direction": 0.7}]})
    assert laid["orientation"] == pytest.approx(0.3 + 0.9 - 0.4) and laid["tested_direction"] == 0.4
    turned = [{**region, "orientation": 0.2 + 0.9 - 0.4}, {**region, "orientation": 0.2 + 0.9 - 0.7}]
    assert api.ok(PARTS, {**request, "orientation": 0.3 + 0.9 - 0.4, "regions": turned})["svg"] == laid["svg"]
    untold = api.ok(PARTS, {**request, "axis": 0.9})
    assert untold["orientation"] == pytest.approx(0.3) and untold["tested_direction"] == 0.9
    refused = api.post(PARTS, {**request, "regions": [{**region, "direction": 0.7}]}, faulty=True)
    assert problem_code(refused) == "request.invalid" and pointers(refused) == ["/regions/0/direction"], refused.text


def test_regions_of_a_coupon_are_turned_with_it(api: Api) -> None:
    region = {"outline": [[0, 0], [12, 0], [12, 38], [0, 38]], "structure": {"family": "IH29"}, "orientation": 0.2}
    laid = api.ok(PARTS, {**COUPON, "regions": [region], "direction": 1.0, "svg": True})
    turned = {**COUPON, "orientation": np.pi / 2 - 1, "regions": [{**region, "orientation": 0.2 + np.pi / 2 - 1}], "svg": True}
    assert api.ok(PARTS, turned)["svg"] == laid["svg"]


PARAMETERS = [0.25, 0.75]
DESIGNED = {"family": "IH67", "parameters": PARAMETERS}
STRETCHES = [1.01, 1.03, 1.05]


def lattice_in(api: Api, part: Dict[str, Any]) -> Any:
    """The lattice of the holes in a part, as columns. It is determined from the part, starting from the design's lattice rotated by the
    angle in the answer."""
    structure = api.ok("/v1/structures", DESIGNED)
    lattice = turn(part["orientation"]) @ np.asarray(structure["lattice"]).T * 0.3 / structure["beam_width"]
    middles = np.array([ring.mean(axis=0) for ring in holes(part["svg"])])

    def is_whole(middle: Any) -> bool:
        """Whether a hole is away from the outline, which would cut it."""
        return abs(middle[0]) < 8 and abs(middle[1]) < 11

    for step in lattice.T:
        copies = [middle + step for middle in middles if is_whole(middle) and is_whole(middle + step)]
        assert copies
        away = [np.linalg.norm(middles - copy, axis=1).min() for copy in copies]
        assert max(away) < 1e-3, "holes repeat by the lattice as the answer turns it"
    return lattice


def simulated_stress(api: Api, direction: float) -> Any:
    """Second Piola-Kirchhoff stress along a direction of the tiling, with free lateral strain and shear."""
    load = {"uniaxial": {"direction": direction, "stretches": STRETCHES, "frame": "material"}}
    states = api.ok("/v1/simulations", {**DESIGNED, "load": load, "tangents": False})["states"]
    c, s = np.cos(direction), np.sin(direction)
    return np.array([np.dot([c * c, s * s, 2 * c * s], state["stress"]) for state in states])


@pytest.mark.parametrize("direction, orientation", [(0.0, 0.0), (0.7, 0.3)])
def test_the_part_follows_the_curve_of_its_design(designs: Api, direction: float, orientation: float) -> None:
    """Compares a simulation of the tiling in the part, along the part's axis, with the curve of the design."""
    laid = designs.ok(PARTS, {**COUPON, "structure": DESIGNED, "orientation": orientation, "direction": direction, "svg": True})
    carried = designs.ok(PARTS, {**COUPON, "structure": DESIGNED, "orientation": orientation, "svg": True})
    design = designs.ok("/v1/profiles", {**DESIGNED, "task": "stress_strain", "x": [(stretch**2 - 1) / 2 for stretch in STRETCHES],
                                         "direction": direction, "orientation": orientation})
    along_axis = []
    for part in (laid, carried):
        # The part's axis in the frame of the tiling, by the lattice in the part.
        own = np.linalg.solve(lattice_in(designs, part), [0, 1])
        structure = designs.ok("/v1/structures", DESIGNED)
        x, y = np.asarray(structure["lattice"]).T @ own
        along_axis.append(simulated_stress(designs, float(np.arctan2(y, x))))
    size = np.linalg.norm(design["y"])
    assert np.linalg.norm(along_axis[0] - design["y"]) < 0.1 * size, "but for the model's error"
    assert np.linalg.norm(along_axis[1] - design["y"]) > 0.5 * size, "carried over as it is, it would be tested along another direction"


def test_clients_lay_a_design_along_the_load(designs: Api, tmp_path: Path) -> None:
    request = {"task": "stress_strain", "family": "IH67", "direction": 0.6, "orientation": 0.2, "accuracy": {"starts": 1, "candidates": 24},
               "target": {"control_points": [[0, 0], [0.05, 0.1], [0.1, 0.2]]}}
    file = tmp_path / "design.json"

    def cli(*arguments: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), "--server", designs.server.url, *arguments], capture_output=True, text=True, timeout=60)

    file.write_text(json.dumps(designs.ok("/v1/designs", request)))
    shown = cli("part", "--design", str(file), "--coupon", "24x30", "--json")
    assert shown.returncode == 0, shown.stderr
    part = json.loads(shown.stdout)
    assert part["tested_direction"] == 0.6 and part["orientation"] == pytest.approx(0.2 + np.pi / 2 - 0.6)
    told = cli("part", "--design", str(file), "--coupon", "24x30")
    assert "0.6 rad" in told.stdout and "necks" in told.stdout
    assert f"turned by {np.degrees(np.pi / 2 - 0.6):.4g} degrees so that the design's load runs along the part" in told.stdout
    assert "24 x 60 x 1 mm; 24 x 30 mm between the grips" in told.stdout, "the outer size beside that of the structure"
    along = json.loads(cli("part", "--design", str(file), "--rectangle", "24x30", "--axis", "20deg", "--json").stdout)
    assert along["tested_direction"] == 0.6 and along["orientation"] == pytest.approx(0.2 + np.pi / 9 - 0.6)
    sheet = json.loads(cli("part", "--design", str(file), "--rectangle", "24x30", "--json").stdout)
    assert sheet["tested_direction"] is None and sheet["orientation"] == pytest.approx(0.2)
    assert json.loads(cli("part", "IH67", "--coupon", "24x30", "--direction", "30deg", "--json").stdout)["tested_direction"] == pytest.approx(np.pi / 6)
    with supple.Client(designs.server.url) as client:
        found = client.design(supple.Target("stress_strain", [[0, 0], [0.05, 0.1], [0.1, 0.2]], direction=0.6), family="IH67", orientation=0.2,
                              options=supple.DesignOptions(candidates=24, starts=1))
        options = supple.PartOptions.of_design(found, thickness=2)
        assert (options.direction, options.thickness, options.orientation) == (0.6, 2, pytest.approx(0.2))
        same = client.part(supple.parts.coupon(24, 30), found.family, found.parameters, options=options)
        assert same.orientation == pytest.approx(part["orientation"]) and same.tested_direction == 0.6
        assert same.smallest_neck is not None and same.smallest_neck >= 0.98 * same.smallest_wall and same.cut_necks == 0
    # A design with loads in two directions has no single direction.
    request["also"] = [{"task": "stress_strain", "direction": 1.6, "target": {"control_points": [[0, 0], [0.1, 0.2]]}}]
    file.write_text(json.dumps(designs.ok("/v1/designs", request)))
    both = json.loads(cli("part", "--design", str(file), "--coupon", "24x30", "--json").stdout)
    assert both["orientation"] == pytest.approx(0.2) and both["tested_direction"] == pytest.approx(np.pi / 2)
    file.write_text("{}")
    assert "supple design --json" in cli("part", "--design", str(file), "--coupon", "24x30").stderr
