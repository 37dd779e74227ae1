"""The families of tilings over HTTP."""

from __future__ import annotations

import json

import numpy as np
import pytest

from contract import ROOT
from harness import Api, pointers, problem_code

EXPECTED = {"IH01": 4, "IH21": 2, "IH22": 3, "IH28": 2, "IH29": 1, "IH50": 2, "IH67": 2, "square": 1}


def test_every_family_is_listed_with_its_bounds(api: Api) -> None:
    families = api.get("/v1/families").json()["families"]
    assert {family["id"]: len(family["parameters"]["lower"]) for family in families} == EXPECTED
    for family in families:
        parameters = family["parameters"]
        for lower, preset, upper in zip(parameters["lower"], parameters["default"], parameters["upper"]):
            assert lower < upper and lower <= preset <= upper
        assert len(parameters["upper"]) == len(parameters["default"]) == len(parameters["lower"])
        assert family["description"] and family["printed_beam_width"] == pytest.approx(0.3)
        assert family["scale"] * family["beam_width"] == pytest.approx(family["printed_beam_width"])


def test_a_family_is_described_by_its_id_as_in_the_list(api: Api) -> None:
    for family in api.get("/v1/families").json()["families"]:
        assert api.get(f"/v1/families/{family['id']}").json() == family


def test_the_cell_of_a_family_is_the_structure_at_its_defaults(api: Api) -> None:
    for family in api.get("/v1/families").json()["families"]:
        structure = api.ok("/v1/structures", {"family": family["id"]})
        assert structure["parameters"] == family["parameters"]["default"]
        assert structure["lattice"] == family["cell"]["lattice"]
        assert structure["cell_area"] == family["cell"]["area"]
        assert structure["relative_density"] == family["cell"]["relative_density"]
        assert len(structure["tiles"]) == family["cell"]["tiles"]


def value(expression: object, parameters: list) -> float:
    """An affine expression of a definition: a number, or a constant with the factors of parameters."""
    if not isinstance(expression, list):
        return float(expression)
    return expression[0] + sum(factor * parameter for factor, parameter in zip(expression[1:], parameters))


def points(rows: list, parameters: list) -> np.ndarray:
    return np.array([[value(x, parameters), value(y, parameters)] for x, y in rows])


def test_a_family_is_drawn_as_its_definition_says(api: Api) -> None:
    for family in api.get("/v1/families").json()["families"]:
        definition = family["definition"]
        if definition is None:
            assert family["id"] == "square"
            continue
        assert definition["id"] == family["id"] and all(one["description"] for one in definition["parameters"])
        bounds = family["parameters"]
        assert [one["lower"] for one in definition["parameters"]] == bounds["lower"]
        assert [one["upper"] for one in definition["parameters"]] == bounds["upper"]
        parameters = [0.6 * preset + 0.4 * upper for preset, upper in zip(bounds["default"], bounds["upper"])]
        structure = api.ok("/v1/structures", {"family": family["id"], "parameters": parameters})
        tile = definition["tile"]
        scale = structure["beam_width"] / value(definition["beam_width"], parameters)
        vertices = points(tile["vertices"], parameters)
        for placement, drawn in zip(tile["placements"], structure["tiles"]):
            linear = np.reshape(placement["linear"], (2, 2))
            outline = vertices @ linear.T + points([placement["offset"]], parameters)
            outline = outline[::-1] if np.linalg.det(linear) < 0 else outline
            np.testing.assert_allclose(drawn["outline"], scale * outline, rtol=0, atol=1e-12 * scale)
        np.testing.assert_allclose(structure["lattice"], scale * points(tile["translations"], parameters), rtol=0, atol=1e-12 * scale)


def test_a_definition_is_what_the_file_of_the_family_holds(api: Api) -> None:
    for path in sorted((ROOT / "models" / "families").glob("*.json")):
        held = json.loads(path.read_text(encoding="utf-8"))
        sent = api.get(f"/v1/families/{held['id']}").json()["definition"]
        for edge in held["tile"]["edges"]:
            edge.setdefault("turned", False)
            edge.setdefault("mirrored", False)
        assert sent == {"mesh_size": 0.5, **held}


def test_an_unknown_family_is_not_found(api: Api) -> None:
    response = api.get("/v1/families/IH99")
    assert (response.status_code, problem_code(response)) == (404, "tiling.family_not_found")
    assert "IH01" in response.json()["detail"], "the known families are named"


@pytest.mark.parametrize("path, more", [("/v1/structures", {}), ("/v1/simulations", {"load": {"green_strain": [[0, 0, 0]]}})])
def test_an_unknown_family_of_a_request_is_pointed_to(api: Api, path: str, more: dict) -> None:
    response = api.post(path, {"family": "IH99", **more})
    assert (response.status_code, problem_code(response)) == (404, "tiling.family_not_found")
    assert pointers(response) == ["/family"]
