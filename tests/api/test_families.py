"""The families of tilings over HTTP."""

from __future__ import annotations

import pytest

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


def test_an_unknown_family_is_not_found(api: Api) -> None:
    response = api.get("/v1/families/IH99")
    assert (response.status_code, problem_code(response)) == (404, "tiling.family_not_found")
    assert "IH01" in response.json()["detail"], "the known families are named"


@pytest.mark.parametrize("path, more", [("/v1/structures", {}), ("/v1/simulations", {"load": {"green_strain": [[0, 0, 0]]}})])
def test_an_unknown_family_of_a_request_is_pointed_to(api: Api, path: str, more: dict) -> None:
    response = api.post(path, {"family": "IH99", **more})
    assert (response.status_code, problem_code(response)) == (404, "tiling.family_not_found")
    assert pointers(response) == ["/family"]
