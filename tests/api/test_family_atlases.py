"""Atlases over HTTP: what a family can do at rest, kept once it is computed, stopped as other long work is."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any, Callable, Dict

import numpy as np
import pytest

import supple
from harness import CLI, ROOT, Api, ServerProcess, keys_command, pointers, problem_code

ATLASES = "/v1/family-atlases"


def added_key(data: Path, scopes: str) -> str:
    return keys_command(data, "add", "--name", scopes.replace(",", "-"), "--scopes", scopes)


def rectangles(lower: float, upper: float, name: str = "rectangles") -> Dict[str, Any]:
    """Rectangles of width 1 and height 0.6 whose beams are as wide as the parameter says."""
    return {"id": name, "description": "Rectangles", "beam_width": [0, 1],
            "parameters": [{"description": "Width of the beams", "lower": lower, "upper": upper, "default": lower}],
            "tile": {"vertices": [[0, 0], [1, 0], [1, 0.6], [0, 0.6]], "translations": [[1, 0], [0, 0.6]],
                     "placements": [{"linear": [1, 0, 0, 1], "offset": [0, 0]}]}}


def test_an_atlas_has_samples_profiles_and_its_mesh_error(api: Api) -> None:
    atlas = api.ok(ATLASES, {"definition": rectangles(0.1, 0.2), "samples": 6, "error_samples": 2})
    assert len(atlas["samples"]) == sum(atlas["places"].values()) == 6
    assert atlas["samples"][0]["parameters"] == [0.1] and not atlas["kept"] and atlas["stopped"] == "none"
    assert 0 < atlas["mesh_error"]["median"] <= atlas["mesh_error"]["largest"] < 0.1 and atlas["mesh_error"]["samples"] == 2
    for sample in atlas["samples"]:
        compliance = np.array(sample["compliance"])
        np.testing.assert_allclose(compliance, compliance.T, rtol=1e-6, atol=1e-9)
        assert np.all(np.linalg.eigvalsh(compliance) > 0)
        # Along the beams the stiffness is that of beams that stretch; the lower one is across the diagonals.
        assert sample["stiffness"][0] <= 1 / compliance[0, 0] * (1 + 1e-9) <= sample["stiffness"][1] * (1 + 2e-9)
    for profile in atlas["profiles"]:
        assert profile["deviation"] >= 0 and profile["sample"] < 6
    effects = {effect["name"]: effect for effect in atlas["effects"]}
    assert effects["second_mesh"]["ran"] and effects["second_mesh"]["count"] == 2
    assert not effects["crossings"]["ran"] and "left out" in effects["crossings"]["why"]


def test_a_hole_that_closes_within_the_bounds_is_located(api: Api) -> None:
    atlas = api.ok(ATLASES, {"definition": rectangles(0.3, 0.9), "samples": 12, "error_samples": 0})
    for sample in atlas["samples"]:
        assert (sample["place"] == "closed") == (sample["parameters"][0] >= 0.6)
        assert (sample["compliance"] is None) == (sample["place"] == "closed")
    assert atlas["mesh_error"] is None and 0 < atlas["places"]["closed"] < 12


def test_a_type_without_parameters_has_its_beam_width_as_parameter(api: Api) -> None:
    atlas = api.ok(ATLASES, {"isohedral_type": 76, "samples": 4, "error_samples": 0})
    assert atlas["family"] == "type-76" and atlas["parameters"]["lower"] == [0.05]
    assert atlas["definition"]["isohedral_type"] == 76
    assert atlas["samples"][1]["relative_density"] != atlas["samples"][0]["relative_density"]


def test_a_crossing_within_the_bounds_is_located_and_left_out(api: Api) -> None:
    atlas = api.ok(ATLASES, {"isohedral_type": 21, "samples": 24, "error_samples": 0})
    assert atlas["places"]["crossing"] > 0 and atlas["good_fraction"] < 1
    assert all(sample["compliance"] is None for sample in atlas["samples"] if sample["place"] == "crossing")
    crossing = next(one for one in atlas["warnings"] if one["flaw"] == "crossing")
    assert len(crossing["parameters"]) == len(atlas["parameters"]["lower"])


def test_what_was_computed_is_kept_and_compared_with(new_server: Callable[..., ServerProcess], contract: Any) -> None:
    # Without shipped models and atlases, so that the server has those that this test computes.
    with_nothing = new_server()
    api = Api(with_nothing, contract)
    whole = {"samples": 256, "error_samples": 8}
    first = api.ok(ATLASES, {"family": "square", **whole})
    assert not first["kept"] and first["definition"] is None and first["comparison"] is None
    again = api.get("/v1/families/square/atlas").json()
    assert again["kept"] and again["samples"] == first["samples"]
    assert api.ok(ATLASES, {"family": "square"})["kept"]
    other = api.ok(ATLASES, {"definition": rectangles(0.1, 0.2), "samples": 4, "error_samples": 0})
    assert other["comparison"]["families"] == ["square"] and other["comparison"]["same_as"] is None
    assert all(profile["others"]["family"] == "square" for profile in other["profiles"])
    with_nothing.terminate()
    with_nothing.start()
    assert api.get("/v1/families/square/atlas").json()["samples"] == first["samples"]


def test_the_shipped_atlases_hold_for_the_families_as_they_are(new_server: Callable[..., ServerProcess], contract: Any, tmp_path: Path) -> None:
    # Without networks, which take long to read.
    folder = tmp_path / "models" / "families"
    shutil.copytree(ROOT / "models" / "families" / "atlas", folder / "atlas")
    api = Api(new_server("--models", str(folder.parent)), contract)
    names = {file.stem for file in (folder / "atlas").iterdir()}
    assert names and names <= {family["id"] for family in api.get("/v1/families").json()["families"]}
    for name in names:
        atlas = api.get(f"/v1/families/{name}/atlas").json()
        assert atlas["kept"] and atlas["family"] == name and len(atlas["samples"]) == 256
        assert len(atlas["profiles"]) == 18 and set(atlas["comparison"]["families"]) == names - {name}


def test_a_key_that_may_only_read_starts_no_computation(tmp_path: Path, contract: Any) -> None:
    reader = added_key(tmp_path / "data", "read")
    worker = added_key(tmp_path / "data", "read,compute")
    process = ServerProcess(tmp_path / "data").start()
    try:
        refused = Api(process, contract, reader).get("/v1/families/square/atlas")
        assert (refused.status_code, problem_code(refused)) == (403, "access.scope")
        assert Api(process, contract, worker).ok(ATLASES, {"family": "square", "samples": 256})["places"]["good"] == 256
        assert Api(process, contract, reader).get("/v1/families/square/atlas").json()["kept"]
    finally:
        process.stop()


def test_the_atlas_of_an_added_family_is_that_of_its_own_definition(tmp_path: Path, contract: Any) -> None:
    keys = [added_key(tmp_path / "data", scopes) for scopes in ("read,compute", "compute,read", "read")]
    process = ServerProcess(tmp_path / "data").start()
    alice, bob, reader = (Api(process, contract, key) for key in keys)
    atlas = "/v1/families/mine/atlas"

    def is_computed_anew(api: Api) -> bool:
        """Whether no atlas is kept. The job that would compute it is dismissed."""
        response = api.get(atlas, headers={"Prefer": "respond-async"})
        if response.status_code == 200:
            return False
        job = response.headers["Location"]
        assert problem_code(api.delete("/v1/families/mine")) == "family.in_use"
        api.delete(job)
        return api.wait_for_job(job.rsplit("/", 1)[1])["state"] == "dismissed"

    try:
        for api, lower in ((alice, 0.1), (bob, 0.15)):
            assert api.post("/v1/families", {"definition": rectangles(lower, 0.2, "mine")}).status_code == 201
        first = alice.ok(ATLASES, {"family": "mine"})
        assert (first["family"], first["kept"], first["crossings"], first["parameters"]["lower"]) == ("mine", False, False, [0.1])
        again = alice.get(atlas).json()
        assert again["kept"] and again["samples"] == first["samples"] and again["definition"]["id"] == "mine"
        with supple.Client(process.url, key=keys[0]) as client:
            assert client.family_atlas(family="mine").kept
        assert is_computed_anew(bob), "another key's family of the same name has another atlas"
        his = bob.ok(ATLASES, {"family": "mine", "samples": 4, "error_samples": 0})
        assert not his["kept"] and his["parameters"]["lower"] == [0.15]
        assert is_computed_anew(bob), "an atlas with fewer samples is not kept"
        unknown = reader.get(atlas)
        assert (unknown.status_code, problem_code(unknown)) == (404, "tiling.family_not_found")
        unknown = reader.get("/v1/families/none/atlas")
        assert (unknown.status_code, "mine" in unknown.json()["detail"]) == (404, False)
        process.terminate()
        process.start()
        assert alice.get(atlas).json()["samples"] == first["samples"]
        assert alice.delete("/v1/families/mine").status_code == 204
        assert alice.get(atlas).status_code == 404
        assert alice.post("/v1/families", {"definition": rectangles(0.12, 0.2, "mine")}).status_code == 201
        assert is_computed_anew(alice), "a family that is added under the name of a removed one has another atlas"
    finally:
        process.stop()


def test_a_deadline_answers_with_what_was_done(api: Api) -> None:
    atlas = api.ok(ATLASES, {"family": "IH50", "samples": 4096, "deadline": 3, "recompute": True})
    assert atlas["stopped"] == "deadline" and 0 < len(atlas["samples"]) < 4096 and atlas["profiles"]


def test_an_atlas_is_a_job_with_progress_that_can_be_cancelled(api: Api) -> None:
    response = api.post(ATLASES, {"family": "IH50", "samples": 4096}, headers={"Prefer": "respond-async"})
    assert response.status_code == 202
    job = response.headers["Location"]
    assert api.get(job).json()["kind"] == "family-atlases"
    api.delete(job)
    assert api.wait_for_job(job.rsplit("/", 1)[1])["state"] == "dismissed"


@pytest.mark.parametrize("document, where", [
    ({}, ""),
    ({"family": "IH21", "isohedral_type": 21}, ""),
    ({"isohedral_type": 19}, "/isohedral_type"),
    ({"family": "IH21", "samples": 0}, "/samples"),
    ({"family": "IH21", "samples": 4, "error_samples": 5}, "/error_samples"),
    ({"family": "IH21", "mesh_size": 3}, "/mesh_size"),
])
def test_faults_of_the_request_are_pointed_to(api: Api, document: Dict[str, Any], where: str) -> None:
    response = api.post(ATLASES, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert where in pointers(response)


def test_a_definition_with_faults_and_unknown_families_are_refused(api: Api) -> None:
    gap = rectangles(0.1, 0.2)
    gap["tile"]["translations"] = [[1.2, 0], [0, 0.6]]
    response = api.post(ATLASES, {"definition": gap})
    assert (response.status_code, problem_code(response)) == (422, "atlas.faulty_definition")
    assert pointers(response)[0].startswith("/definition/tile")
    assert api.post(ATLASES, {"family": "IH02"}).status_code == 404
    assert api.get("/v1/families/IH02/atlas").status_code == 404
    assert api.get("/v1/isohedral-types/19/atlas").status_code == 404
    assert api.get("/v1/isohedral-types/x/atlas", faulty=True).status_code == 404


def test_the_python_client_and_the_command_line_print_and_write_it(api: Api, tmp_path: Path) -> None:
    with supple.Client(api.server.url) as client:
        atlas = client.family_atlas(definition=rectangles(0.1, 0.2), samples=4, error_samples=1)
        assert atlas.samples[0].compliance is not None and atlas.samples[0].compliance.shape == (3, 3)
        assert atlas.places["closed"] == 0 and atlas.mesh_error is not None and atlas.profiles[0].name == "poisson_-0.9"
    (tmp_path / "own.json").write_text(json.dumps(rectangles(0.1, 0.2)))
    done = subprocess.run([str(CLI), "--server", api.server.url, "families", "atlas", str(tmp_path / "own.json"), "--samples", "4",
                           "--error-samples", "1", "--output", str(tmp_path / "atlas.json")], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "rectangles, 4 samples" in done.stdout and "poisson_0.3" in done.stdout
    assert len(json.loads((tmp_path / "atlas.json").read_text())["samples"]) == 4
