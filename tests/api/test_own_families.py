"""Families of one's own over HTTP: added, used like those of the server, owned by keys, kept and removed."""

from __future__ import annotations

import math
import sqlite3
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any, Callable, Dict, List

import pytest

import supple
from contract import Contract
from harness import CLI, Api, ServerProcess, make_model, pointers, problem_code
from test_access import add_key, id_of
from test_backup import command
from test_replicas import Replicas

FAMILIES = "/v1/families"
ASYNC = {"Prefer": "respond-async"}
NewServer = Callable[..., ServerProcess]
SHIPPED = ["IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67", "square"]
LONG_LOAD = {"green_strain": [[0.002 * step, 0, 0] for step in range(100)]}


def slanted(name: str, lower: float = 0.1, **more: Any) -> Dict[str, Any]:
    """Parallelograms of unit sides, of which one leans by the only parameter."""
    return {"id": name, "description": "Slanted squares", "beam_width": 0.1,
            "parameters": [{"description": "Slant", "lower": lower, "upper": 0.5, "default": 0.3}],
            "tile": {"vertices": [[0, 0], [1, 0], [[1, 1], 1], [[0, 1], 1]], "translations": [[1, 0], [[0, 1], 1]],
                     "placements": [{"linear": [1, 0, 0, 1], "offset": [0, 0]}]}, **more}


def ids(api: Api, query: str = "") -> List[str]:
    """The ids of the families beside those of the server."""
    listed = [family["id"] for family in api.get(FAMILIES + query).json()["families"]]
    assert listed[:len(SHIPPED)] == SHIPPED
    return listed[len(SHIPPED):]


def add(api: Api, definition: Dict[str, Any]) -> Dict[str, Any]:
    response = api.post(FAMILIES, {"definition": definition})
    assert response.status_code == 201, response.text
    assert response.headers["Location"] == f"{FAMILIES}/{definition['id']}"
    return response.json()["family"]


@pytest.fixture
def own(api: Api) -> Any:
    """The id of a family that was added for one test."""
    add(api, slanted("slanted"))
    yield "slanted"
    api.delete(f"{FAMILIES}/slanted")


def test_an_added_family_is_described_like_those_of_the_server(api: Api, own: str) -> None:
    family = api.get(f"{FAMILIES}/{own}").json()
    assert ids(api) == [own]
    assert family in api.get(FAMILIES).json()["families"]
    assert family["parameters"] == {"lower": [0.1], "upper": [0.5], "default": [0.3]}
    assert family["created"] is not None and api.get(f"{FAMILIES}/IH21").json()["created"] is None
    assert family["definition"]["tile"]["vertices"] == slanted(own)["tile"]["vertices"]
    assert family["cell"]["tiles"] == 1


def test_the_same_definition_again_changes_nothing_and_another_of_its_id_is_refused(api: Api, own: str) -> None:
    before = api.get(f"{FAMILIES}/{own}").json()
    again = api.post(FAMILIES, {"definition": slanted(own)})
    assert (again.status_code, again.json()["family"]) == (200, before)
    other = api.post(FAMILIES, {"definition": slanted(own, lower=0.2)})
    assert (other.status_code, problem_code(other), pointers(other)) == (409, "family.exists", ["/definition/id"])
    assert api.get(f"{FAMILIES}/{own}").json() == before


@pytest.mark.parametrize("name", ["IH21", "ih21", "SQUARE", "any"])
def test_the_ids_of_the_server_and_any_are_taken(api: Api, name: str) -> None:
    response = api.post(FAMILIES, {"definition": slanted(name)})
    assert (response.status_code, problem_code(response), pointers(response)) == (409, "family.exists", ["/definition/id"])
    assert ids(api) == []


def test_the_id_of_a_drawing_is_pointed_to(api: Api, own: str) -> None:
    for name in ("IH21", own):
        response = api.post(FAMILIES, {"svg": SQUARE, "type": "IH41", "id": name})
        assert (response.status_code, problem_code(response), pointers(response)) == (409, "family.exists", ["/id"])
    response = api.post(FAMILIES, {"svg": SQUARE, "type": 41, "id": "drawn"}, faulty=True)
    assert (problem_code(response), pointers(response)) == ("request.invalid", ["/type"])


@pytest.mark.parametrize("change, pointer, said", [
    ({"translations": [[1.2, 0], [[0, 1], 1]]}, "/definition/tile", "near the point"),
    ({"translations": [[0.8, 0], [[0, 1], 1]]}, "/definition/tile", "near the point"),
    ({"vertices": [[0, 0], [1, 0], [[0, 1], 1], [[1, 1], 1]]}, "/definition/tile", "at the parameters 0.3"),
])
def test_gaps_overlaps_and_crossings_are_located(api: Api, change: Dict[str, Any], pointer: str, said: str) -> None:
    definition = slanted("faulty")
    definition["tile"] = {**definition["tile"], **change}
    response = api.post(FAMILIES, {"definition": definition})
    assert (response.status_code, problem_code(response)) == (422, "family.faulty")
    assert pointers(response)[0].startswith(pointer) and said in response.json()["detail"]
    assert ids(api) == []


def test_beams_that_close_the_tile_are_a_fault(api: Api) -> None:
    response = api.post(FAMILIES, {"definition": slanted("closed", beam_width=1.5)})
    assert (response.status_code, problem_code(response), pointers(response)) == (422, "family.faulty", ["/definition/beam_width"])


@pytest.mark.parametrize("document", [{}, {"definition": 1}, {"definition": {}}, {"definition": {**slanted("a b")}}, {"definition": slanted("x"), "more": 1}])
def test_bad_uploads_are_refused(api: Api, document: Any) -> None:
    response = api.post(FAMILIES, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert api.call("POST", FAMILIES, body=b"{}", headers={"Content-Type": "text/plain"}, faulty=True).status_code == 415


def test_structures_simulations_and_parts_take_an_added_family(api: Api, own: str) -> None:
    structure = api.ok("/v1/structures", {"family": own, "parameters": [0.2]})
    assert (structure["family"], structure["parameters"]) == (own, [0.2])
    drawn = api.get(f"{FAMILIES}/{own}/structure?parameters=0.2")
    assert ET.fromstring(drawn.content).tag.endswith("svg")
    assert drawn.headers["Cache-Control"] == "private, no-cache", "another family may get its id"
    states = api.ok("/v1/simulations", {"family": own, "load": {"green_strain": [[0.01, 0, 0]]}})["states"]
    assert len(states) == 1 and states[0]["energy_density"] > 0
    part = api.ok("/v1/parts", {"structure": {"family": own}, "outline": {"rectangle": [20, 20]}})
    assert part["relative_density"] > 0
    outside = api.post("/v1/structures", {"family": own, "parameters": [0.9]})
    assert (outside.status_code, problem_code(outside)) == (422, "tiling.parameter_out_of_bounds")


def test_an_unknown_family_is_answered_with_the_known_ones(api: Api, own: str) -> None:
    for response, pointer in ((api.post("/v1/structures", {"family": "none"}), "/family"), (api.get(f"{FAMILIES}/none"), None)):
        assert (response.status_code, problem_code(response)) == (404, "tiling.family_not_found")
        assert own in response.json()["detail"] and "IH21" in response.json()["detail"]
        assert pointer is None or pointers(response) == [pointer]
    assert api.delete(f"{FAMILIES}/none").status_code == 404


def test_designs_say_that_an_added_family_has_no_model_yet(api: Api, own: str) -> None:
    target = {"control_points": [[0, 0], [0.1, 0.1]]}
    design = api.post("/v1/designs", {"family": own, "task": "stress_strain", "target": target})
    profile = api.post("/v1/profiles", {"family": own, "task": "poisson", "parameters": [0.3]})
    for response in (design, profile):
        assert (response.status_code, problem_code(response), pointers(response)) == (422, "design.no_model", ["/family"])
        assert "has no model yet" in response.json()["detail"]


def test_designs_are_found_in_a_family_that_a_model_defines(new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    models = tmp_path / "models"
    make_model(models / "own.h5", "own", family="own")
    make_model(models / "shipped.h5", "shipped")
    api = Api(new_server("--models", str(models)), contract)
    body = {"task": "stress_strain", "target": {"control_points": [[0, 0], [0.1, 0.1]]}}
    design = api.post("/v1/designs", {"family": "own", **body})
    assert design.status_code == 200, design.text
    assert (design.json()["family"], design.json()["model"]) == ("own", "own")
    # The definition is that of IH21, so that the structures are the same.
    own, shipped = (api.post("/v1/designs", {"model": model, "fixed": [0.15, 0.65], **body}).json()["structure"] for model in ("own", "shipped"))
    assert own["relative_density"] == shipped["relative_density"]
    # Everyone may use the family of a model, also without a design.
    assert api.get(own["svg"]).status_code == 200
    assert ids(api) == ["own"] and api.get(f"{FAMILIES}/own").json()["definition"]["shapes"][0] == {"class": "S"}
    # One that a client has added under its name is another family, and has no model.
    add(api, slanted("own"))
    assert ids(api) == ["own"] and api.get(f"{FAMILIES}/own").json()["parameters"]["upper"] == [0.5]
    refused = api.post("/v1/designs", {"family": "own", **body})
    assert (refused.status_code, problem_code(refused)) == (422, "design.no_model")


def test_a_definition_is_had_as_text(api: Api, own: str) -> None:
    text = api.get(f"{FAMILIES}/{own}/definition")
    assert text.headers["Content-Type"].startswith("text/plain")
    lines = text.text.splitlines()
    assert lines[:4] == ["family definition 1", "id slanted", "description Slanted squares", "parameter 0.1 0.5 0.3 Slant"]
    assert supple.Client(api.server.url).family_definition(own) == text.text
    printed = subprocess.run([str(CLI), "--server", api.server.url, "families", "definition", own], capture_output=True, text=True, check=True)
    assert printed.stdout == text.text
    for name, code in (("square", "family.no_definition"), ("none", "tiling.family_not_found")):
        refused = api.get(f"{FAMILIES}/{name}/definition")
        assert (refused.status_code, problem_code(refused)) == (404, code)


def test_families_of_the_server_are_not_removed(api: Api) -> None:
    response = api.delete(f"{FAMILIES}/IH21")
    assert (response.status_code, problem_code(response)) == (409, "family.shipped")


def test_a_family_that_a_job_needs_stays_and_the_job_outlives_a_restart(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    add(api, slanted("needed"))
    add(api, slanted("other"))
    described = api.get(f"{FAMILIES}/needed").json()
    request = {"family": "needed", "load": LONG_LOAD}
    jobs = [api.post("/v1/simulations", request, headers=ASYNC).json()["id"] for _ in range(2)]
    refused = api.delete(f"{FAMILIES}/needed")
    assert (refused.status_code, problem_code(refused)) == (409, "family.in_use")
    assert api.delete(f"{FAMILIES}/other").status_code == 204, "no job needs it"
    server.kill()
    server.start()
    assert api.get(f"{FAMILIES}/needed").json() == described
    assert problem_code(api.delete(f"{FAMILIES}/needed")) == "family.in_use"
    assert [api.wait_for_job(job)["state"] for job in jobs] == ["successful", "successful"]
    assert api.delete(f"{FAMILIES}/needed").status_code == 204
    assert ids(api) == []
    assert api.get(f"/v1/jobs/{jobs[0]}/result").json()["family"] == "needed", "results stay"


def test_families_are_their_keys_own(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    data = tmp_path / "data"
    keys = {name: add_key(data, name, scopes) for name, scopes in
            (("alice", "read,compute"), ("bob", "read,compute"), ("reader", "read"), ("admin", "admin"))}
    server = new_server("--workers", "1")
    nobody = Api(server, contract)
    alice, bob, reader, admin = (Api(server, contract, keys[name]) for name in keys)
    assert nobody.post(FAMILIES, {"definition": slanted("hers")}).status_code == 401
    assert reader.post(FAMILIES, {"definition": slanted("hers")}).status_code == 403
    add(alice, slanted("hers"))
    his = add(bob, slanted("hers", lower=0.2))
    assert alice.get(f"{FAMILIES}/hers").json()["parameters"]["lower"] == [0.1], "each key has its own family of a name"
    assert bob.get(f"{FAMILIES}/hers").json() == his
    assert (ids(reader), ids(admin)) == ([], [])
    assert reader.get(f"{FAMILIES}/hers").status_code == 404
    assert problem_code(admin.post("/v1/structures", {"family": "hers"})) == "tiling.family_not_found"
    assert alice.post("/v1/structures", {"family": "hers", "parameters": [0.15]}).status_code == 200
    assert problem_code(bob.post("/v1/structures", {"family": "hers", "parameters": [0.15]})) == "tiling.parameter_out_of_bounds"
    job = bob.post("/v1/simulations", {"family": "hers", "load": LONG_LOAD}, headers=ASYNC).json()["id"]
    assert problem_code(bob.delete(f"{FAMILIES}/hers")) == "family.in_use"
    server.kill()
    server.start()
    assert bob.wait_for_job(job)["state"] == "successful", "the job finds the family of its owner again"
    query = f"?owner={id_of(keys['bob'])}"
    assert problem_code(alice.get(FAMILIES + query)) == "access.scope"
    assert ids(admin, query) == ["hers"] and admin.get(f"{FAMILIES}/hers{query}").json() == his
    assert admin.delete(f"{FAMILIES}/hers{query}").status_code == 204
    assert (ids(alice), ids(bob)) == (["hers"], [])


def test_the_number_and_the_bytes_of_families_are_bounded(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    data = tmp_path / "data"
    small = add_key(data, "small", "read,compute", "--max-stored", "10000")
    many = add_key(data, "many", "read,compute")
    server = new_server()
    few, api = Api(server, contract, small), Api(server, contract, many)
    for k in range(256):
        add(api, slanted(f"own{k}"))
    refused = api.post(FAMILIES, {"definition": slanted("own256")})
    assert (refused.status_code, problem_code(refused), refused.json()["limit"]) == (409, "family.too_many", 256)
    assert api.post(FAMILIES, {"definition": slanted("own7")}).status_code == 200, "one that is there already is no new one"
    answers = [few.post(FAMILIES, {"definition": slanted(f"own{k}")}) for k in range(12)]
    full = [answer for answer in answers if answer.status_code != 201]
    assert full and {(answer.status_code, problem_code(answer)) for answer in full} == {(507, "store.key_quota")}
    assert full[0].json()["setting"] == "--max-stored" and "families" in full[0].json()["detail"]
    assert few.delete(f"{FAMILIES}/own0").status_code == 204
    assert few.post(FAMILIES, {"definition": slanted("own0")}).status_code == 201, "the bytes are free again"


def test_a_full_store_takes_no_family(new_server: NewServer, contract: Contract) -> None:
    api = Api(new_server("--max-store", "1000000"), contract)
    answer = None
    for k in range(256):
        answer = api.post(FAMILIES, {"definition": slanted(f"own{k}", description="x" * 500)})
        if answer.status_code != 201:
            break
    assert answer is not None and (answer.status_code, problem_code(answer)) == (507, "store.quota")


def damage(database: Path, name: str) -> None:
    with sqlite3.connect(database) as rows:
        rows.execute("UPDATE families SET definition = definition || ' ' WHERE name = ?", (name,))


def test_families_are_in_backups_and_damaged_ones_are_found(new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    server = new_server()
    api = Api(server, contract)
    sound, damaged = add(api, slanted("sound")), add(api, slanted("damaged"))
    backup = tmp_path / "backup"
    assert command("backup", "--data", server.data, "--to", backup).returncode == 0
    assert "looked at 2 families, " in command("check", "--data", backup).stdout
    damage(server.data / "supple.sqlite", "damaged")
    response = api.get(f"{FAMILIES}/damaged")
    assert (response.status_code, problem_code(response)) == (500, "store.corrupted")
    found = command("check", "--data", server.data)
    assert (found.returncode, "The row of the family damaged does not have the content" in found.stdout) == (1, True)
    assert server.terminate() == 0
    assert command("check", "--data", server.data, "--repair").returncode == 1
    assert command("check", "--data", server.data).returncode == 0
    assert [path.name[-7:] for path in (server.data / "quarantine").iterdir()] == [".family"], "nothing is deleted"
    server.start()
    assert ids(api) == ["sound"]
    assert command("restore", "--from", backup, "--data", tmp_path / "restored").returncode == 0
    restored = Api(new_server(data="restored"), contract)
    assert restored.get(FAMILIES).json()["families"][-2:] == [sound, damaged]


def test_servers_share_families(tmp_path: Path, contract: Contract, new_server: NewServer) -> None:
    replicas = Replicas(tmp_path, 2)
    data, backup = replicas.servers[0].data, tmp_path / "backup"
    place = ("--data", data, "--database", replicas.database)
    try:
        replicas.start()
        one, other = (Api(server, contract) for server in replicas.servers)
        family = add(one, slanted("shared"))
        assert other.get(f"{FAMILIES}/shared").json() == family
        assert other.post(FAMILIES, {"definition": slanted("shared")}).status_code == 200
        assert problem_code(other.post(FAMILIES, {"definition": slanted("shared", lower=0.2)})) == "family.exists"
        job = other.post("/v1/simulations", {"family": "shared", "load": LONG_LOAD}, headers=ASYNC).json()["id"]
        assert problem_code(one.delete(f"{FAMILIES}/shared")) == "family.in_use"
        assert command("backup", *place, "--to", backup).returncode == 0
        assert one.wait_for_job(job)["state"] == "successful"
        checked = command("check", *place)
        assert "looked at 1 families, " in checked.stdout and checked.returncode == 0, checked.stdout
        assert one.delete(f"{FAMILIES}/shared").status_code == 204 and ids(other) == []
        for server in replicas.servers:
            assert server.terminate() == 0
        assert command("restore", *place, "--from", backup, "--replace").returncode == 0
        replicas.start()
        assert Api(replicas.servers[1], contract).get(f"{FAMILIES}/shared").json() == family
    finally:
        replicas.close()
    assert command("restore", "--from", backup, "--data", tmp_path / "alone").returncode == 0
    assert ids(Api(new_server(data="alone"), contract)) == ["shared"], "a server with a database of its own understands it too"


def test_the_clients_add_show_and_remove_families(api: Api, tmp_path: Path) -> None:
    def run(*arguments: object) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), "--server", api.server.url, *map(str, arguments)], capture_output=True, text=True, timeout=60)

    client = supple.Client(api.server.url)
    added = client.add_family(slanted("slanted"))
    assert (added.family.id, added.family.created is not None, added.warnings) == ("slanted", True, ())
    with pytest.raises(supple.InvalidStructure, match="overlap|cover"):
        faulty = slanted("faulty")
        client.add_family({**faulty, "tile": {**faulty["tile"], "translations": [[0.8, 0], [[0, 1], 1]]}})
    assert "slanted" in run("families").stdout and "slanted" in run("families", "list").stdout
    atlas = run("families", "atlas", "slanted", "--samples", "4", "--error-samples", "1")
    assert (atlas.returncode, "slanted, 4 samples" in atlas.stdout) == (0, True), atlas.stderr
    explained = run("families", "--help").stdout
    assert all(f"  {command} " in explained for command in ("list", "show", "atlas", "add", "remove")), explained
    shown = run("families", "show", "slanted", "--json")
    assert shown.returncode == 0, shown.stderr
    client.remove_family("slanted")
    with pytest.raises(supple.NotFound):
        client.family("slanted")
    file = tmp_path / "family.json"
    file.write_text(shown.stdout)
    again = run("families", "add", file)
    assert (again.returncode, "Slanted squares" in again.stdout) == (0, True), again.stderr
    assert run("families", "remove", "slanted").returncode == 0
    assert run("families", "show", "slanted").returncode != 0
    tile = tmp_path / "tile.svg"
    tile.write_text(SQUARE)
    assert client.add_drawn_family(tile, "IH41", "drawn", beam_width=0.1).family.beam_width == 0.1
    client.remove_family("drawn")
    drawn = run("families", "add", tile, "--type", "IH41", "--id", "drawn")
    assert (drawn.returncode, "family      drawn" in drawn.stdout) == (0, True), drawn.stderr
    assert run("families", "remove", "drawn").returncode == 0


# --- drawings of a tile -----------------------------------------------------------------------------------------------

def svg_of(outline: List[List[float]], turn: float = 0.4, mirror: int = 1) -> str:
    """A drawing of an outline somewhere on a page, whose y axis points down."""
    corners = ((300 + 90 * (x * math.cos(turn) - mirror * y * math.sin(turn)), 300 - 90 * (x * math.sin(turn) + mirror * y * math.cos(turn)))
               for x, y in outline)
    points = " ".join(f"{x:.6f},{y:.6f}" for x, y in corners)
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 600 600"><polygon points="{points}"/></svg>'


def tile_of(api: Api, number: int, parameters: List[float], shapes: List[Dict[str, Any]]) -> List[List[float]]:
    """The outline of the tile of a type at parameters."""
    checked = api.ok("/v1/family-checks", {"definition": {
        "id": "drawn", "description": "", "beam_width": 0.02, "isohedral_type": number, "shapes": shapes,
        "parameters": [{"description": "", "lower": one - 0.01, "upper": one + 0.01, "default": one} for one in parameters]}})
    return checked["tiling"]["tiles"][0]


@pytest.mark.parametrize("mirror", [1, -1])
def test_the_drawing_of_a_tile_gives_its_family(api: Api, mirror: int) -> None:
    curve = {"class": "J", "sines": [0.05, 0.03], "pieces": 24}
    tile = tile_of(api, 29, [0.43], [{"class": "I"}, curve])
    response = api.post(FAMILIES, {"svg": svg_of(tile, mirror=mirror), "type": "IH29", "id": "drawn", "shape_parameters": True})
    assert response.status_code == 201, response.text
    family = response.json()["family"]
    try:
        assert family["parameters"]["default"] == pytest.approx([0.43, 1], abs=1e-4)
        assert family["definition"]["isohedral_type"] == 29
        assert [shape["class"] for shape in family["definition"]["shapes"]] == ["I", "J"]
        assert api.ok("/v1/structures", {"family": "drawn", "parameters": [0.43, 0.8]})["relative_density"] > 0
    finally:
        assert api.delete(f"{FAMILIES}/drawn").status_code == 204


SQUARE = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'><path d='M0 0 H90 V90 H0 Z'/></svg>"


@pytest.mark.parametrize("svg, type_, code, said", [
    (SQUARE, "IH01", "tiling.drawing", "has 4 corners"),
    (SQUARE.replace("M0 0 H90 V90 H0 Z", "M0 0 H90 L70 80 H0 Z"), "IH41", "tiling.drawing", "the best choice deviates by"),
    (SQUARE.replace("V90 H0", "V90 Q45 60 0 90"), "IH41", "tiling.drawing", "has the shape of the edge from"),
    (SQUARE.replace("Z'/>", "Z'/><path d='M93 0 h6 v6 h-6 z'/>"), "IH41", "tiling.drawing", "2 closed curves"),
    ("<svg", "IH41", "outline.unreadable", ""),
    (SQUARE, "IH19", "request.invalid", "81 isohedral types"),
])
def test_drawings_that_are_no_tile_of_the_type_are_refused(api: Api, svg: str, type_: str, code: str, said: str) -> None:
    response = api.post(FAMILIES, {"svg": svg, "type": type_, "id": "drawn"})
    assert (response.status_code, problem_code(response)) == (400 if code == "request.invalid" else 422, code), response.text
    assert said in response.text
    assert pointers(response) == ["/type" if code == "request.invalid" else "/svg"]
    assert "drawn" not in ids(api)
