"""Trainings of networks over HTTP, with the real supple-lab: a family becomes a model that designs use, whatever happens meanwhile."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any, Callable, Dict, Tuple

import pytest

import supple
from contract import Contract
from harness import BUILD, CLI, Api, ServerProcess, pointers, problem_code
from test_access import add_key

LAB = BUILD / "engine" / "lab" / "supple-lab"
TRAININGS = "/v1/trainings"
PLANS = "/v1/training-plans"
NewServer = Callable[..., ServerProcess]

pytestmark = pytest.mark.skipif(not LAB.exists(), reason="supple-lab is not built")


def parallelograms(name: str) -> Dict[str, Any]:
    """A family of two parameters, of which a design takes half a second."""
    return {"id": name, "description": "Parallelograms", "isohedral_type": 41, "beam_width": 0.25,
            "shapes": [{"class": "I"}, {"class": "I"}],
            "parameters": [{"description": "Distance between the sides", "lower": 0.9, "upper": 1.3, "default": 1},
                           {"description": "Shift of a row", "lower": 0.3, "upper": 0.6, "default": 0.4}]}


def training(name: str, core_seconds: float = 60, **more: Any) -> Dict[str, Any]:
    return {"family": name, "budget": {"core_seconds": core_seconds}, **more}


@pytest.fixture
def lab_server(new_server: NewServer, contract: Contract) -> Api:
    api = Api(new_server("--lab", str(LAB)), contract)
    assert api.post("/v1/families", {"definition": parallelograms("own")}).status_code == 201
    return api


def state(api: Api, job: str) -> str:
    return str(api.get(f"/v1/jobs/{job}").json()["state"])


def wait_for(api: Api, job: str, seconds: float = 1500) -> Dict[str, Any]:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        status: Dict[str, Any] = api.get(f"/v1/jobs/{job}").json()
        if status["state"] not in ("accepted", "running"):
            return status
        time.sleep(0.5)
    raise AssertionError("the job did not end")


def wait_until_changed(folder: Path) -> None:
    """Until a file below the folder is added, renamed or written."""
    def seen() -> Dict[Path, float]:
        found = {}
        for path in folder.glob("**/*"):
            with contextlib.suppress(FileNotFoundError):
                found[path] = path.stat().st_mtime
        return found

    before = seen()
    end = time.monotonic() + 300
    while seen() == before:
        assert time.monotonic() < end, "nothing was saved"
        time.sleep(0.05)


@pytest.mark.parametrize("path", [PLANS, TRAININGS])
@pytest.mark.parametrize("body, code, where", [
    (b"{", "request.malformed_json", None),
    ({}, "request.invalid", ["/family", "/budget"]),
    (training("IH21", 59.9), "request.invalid", ["/budget/core_seconds"]),
    (training("IH21", 1e9), "request.invalid", ["/budget/core_seconds"]),
    (training("IH21", "much"), "request.invalid", ["/budget/core_seconds"]),
    (training("IH21", accuracy={"error": 0.6}), "request.invalid", ["/accuracy/error"]),
    (training("IH21", accuracy={"errors": 0.1}), "request.invalid", ["/accuracy/errors"]),
    (training("IH21", seed=0), "request.invalid", ["/seed"]),
    (training("IH21", seed=1.5), "request.invalid", ["/seed"]),
    (training("IH21", deadline=-1), "request.invalid", ["/deadline"]),
    (training("IH21", epochs=3), "request.invalid", ["/epochs"]),
])
def test_faulty_requests_name_their_fields(api: Api, path: str, body: Any, code: str, where: Any) -> None:
    sent: Dict[str, Any] = {"body": body, "headers": {"Content-Type": "application/json"}} if isinstance(body, bytes) else {"document": body}
    refused = api.post(path, faulty=True, **sent)
    assert problem_code(refused) == code, refused.text
    assert where is None or pointers(refused) == where


def test_a_small_budget_is_refused_with_what_is_needed(lab_server: Api) -> None:
    refused = lab_server.post(PLANS, training("IH01", 60))
    assert (refused.status_code, problem_code(refused), pointers(refused)) == (422, "training.small_budget", ["/budget/core_seconds"])
    assert "core-seconds at least" in refused.json()["detail"]


def test_a_plan_says_what_the_budget_is_spent_on(lab_server: Api) -> None:
    plan = lab_server.post(PLANS, training("own", 20_000))
    assert plan.status_code == 200, plan.text
    estimate = plan.json()["estimate"]
    assert estimate["designs"] > 2 * estimate["chosen_designs"] - 6 and estimate["chosen_designs"] > 100
    (effect,) = plan.json()["effects"]
    assert (effect["name"], effect["ran"]) == ("committee", False) and "3 rounds" in effect["why"]
    assert 10_000 < estimate["simulation"] + estimate["training"] <= 20_001
    shown = subprocess.run([str(CLI), "--server", lab_server.server.url, "families", "train", "own", "--core-time", "20000s", "--plan"],
                           capture_output=True, text=True, check=True).stdout
    assert f"{estimate['simulation']:.0f} core-seconds of simulations" in shown
    assert f"{estimate['designs']}, of which small networks choose {estimate['chosen_designs']}" in shown
    planned = supple.Client(lab_server.server.url).plan_training("own", 20_000)
    assert (planned.simulation_seconds, planned.designs) == (estimate["simulation"], estimate["designs"])


def test_unknown_families_and_servers_without_the_program_are_refused(lab_server: Api, new_server: NewServer, contract: Contract) -> None:
    for family, code in (("none", "tiling.family_not_found"), ("square", "family.no_definition")):
        assert problem_code(lab_server.post(TRAININGS, training(family))) == code
    without = Api(new_server("--lab", "", data="without"), contract)
    refused = without.post(TRAININGS, training("IH21"))
    assert (refused.status_code, problem_code(refused)) == (503, "training.unavailable")
    late = lab_server.post(TRAININGS, training("own", deadline=1e9))
    assert problem_code(late) == "request.limit_exceeded" and "--max-training" in late.text


def test_a_family_becomes_a_model_of_its_owner_although_the_server_is_killed(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--lab", str(LAB))
    keys = [add_key(server.data, name, "read,compute") for name in ("alice", "bob")]
    server.stop()
    server.start()
    alice, bob = (Api(server, contract, key=key) for key in keys)
    assert alice.post("/v1/families", {"definition": parallelograms("own")}).status_code == 201
    accepted = alice.post(TRAININGS, training("own", accuracy={"error": 0.4}, priority="background"))
    assert accepted.status_code == 202, accepted.text
    job = accepted.json()["id"]
    time.sleep(8)
    server.kill()
    server.start()
    done = wait_for(alice, job)
    assert done["state"] == "successful", done
    result = alice.get(f"/v1/jobs/{job}/result").json()
    assert result["designs"] >= 20 and result["error"] < 0.5
    assert result["errors"][-1] == {"designs": result["designs"], "error": result["error"]}
    model = alice.get(f"/v1/models/{result['model']}").json()
    assert model["family"] == "own"
    target = {"task": "stress_strain", "target": {"control_points": [[0, 0], [0.1, 0.1]]}, "family": "own"}
    assert alice.post("/v1/designs", target).status_code == 200
    assert bob.get(f"/v1/models/{result['model']}").status_code == 404
    assert problem_code(bob.post("/v1/designs", target)) == "design.no_model"


def test_a_dismissed_training_ends_its_program_and_goes_on_with_the_same_request(lab_server: Api) -> None:
    def programs() -> int:
        return subprocess.run(["pgrep", "-f", f"{LAB} (learn|plan).*{lab_server.server.data}"], capture_output=True).stdout.count(b"\n")

    job = lab_server.post(TRAININGS, training("own", 20_000)).json()["id"]
    end = time.monotonic() + 120
    while time.monotonic() < end and lab_server.get(f"/v1/jobs/{job}").json()["stage"] != "designs":
        time.sleep(0.2)
    assert programs() == 1
    time.sleep(3)
    assert lab_server.delete(f"/v1/jobs/{job}").status_code in (200, 202, 204)
    wait_for(lab_server, job, 30)
    end = time.monotonic() + 60
    while time.monotonic() < end and programs() > 0:
        time.sleep(0.1)
    assert programs() == 0
    kept = [path for path in Path(lab_server.server.data, "trainings").rglob("*") if path.is_file()]
    assert any(path.name == "plan.txt" for path in kept)
    before = {path: os.path.getsize(path) for path in kept if path.suffix == ".partial"}
    assert before
    again = lab_server.post(TRAININGS, training("own", 20_000)).json()["id"]
    time.sleep(6)
    lab_server.delete(f"/v1/jobs/{again}")
    wait_for(lab_server, again, 30)
    assert all(os.path.getsize(path) >= size for path, size in before.items())


def test_a_training_that_is_killed_ten_times_ends_with_the_same_bytes(new_server: NewServer, contract: Contract) -> None:
    def begin(data: str) -> Tuple[ServerProcess, Api]:
        server = new_server("--lab", str(LAB), data=data)
        api = Api(server, contract)
        assert api.post("/v1/families", {"definition": parallelograms("own")}).status_code == 201
        return server, api

    request = training("own", accuracy={"error": 0.4})
    server, api = begin("whole")
    assert wait_for(api, api.post(TRAININGS, request).json()["id"])["state"] == "successful"
    (model,) = Path(server.data, "trainings").glob("*/network/model.h5")
    (plan,) = Path(server.data, "trainings").glob("*/plan.txt")
    killed, api = begin("killed")
    # The plan depends on the time of the first designs, and is the same here.
    folder = Path(killed.data, "trainings", plan.parent.name)
    folder.mkdir(parents=True)
    shutil.copy(plan, folder)
    job = api.post(TRAININGS, request).json()["id"]
    for number in range(10):
        # Each start gets on, however slow the machine is: a job whose starts save nothing is given up.
        wait_until_changed(folder)
        time.sleep(0.2 * (1 + number % 3))
        killed.kill()
        killed.start()
    assert state(api, job) in ("accepted", "running"), "it was killed ten times before its end"
    assert wait_for(api, job)["state"] == "successful"
    assert Path(folder, "network", "model.h5").read_bytes() == model.read_bytes()
