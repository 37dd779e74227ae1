"""Programs that were written for the last release still work: its contract is satisfied, and its examples run.

The last release is the latest tag vMAJOR.MINOR.PATCH in the history of this commit, or the commit in the variable
SUPPLE_COMPATIBLE_WITH. A release with a greater MAJOR may be incompatible with it, and so may one of version 0 with a greater MINOR.
"""

from __future__ import annotations

import copy
import io
import os
import re
import subprocess
import tarfile
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional

import pytest
import yaml

from compatibility import breaking_changes
from contract import ROOT
from harness import Api
from test_examples import run_example

CONTRACT: Dict[str, Any] = yaml.safe_load((ROOT / "api" / "openapi.yaml").read_text(encoding="utf-8"))


def git(*arguments: str) -> Optional[bytes]:
    done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, check=False)
    return done.stdout if done.returncode == 0 else None


def last_release() -> Optional[str]:
    if named := os.environ.get("SUPPLE_COMPATIBLE_WITH"):
        return named
    # Git refuses a checkout of another user, which must not be mistaken for a history without releases.
    assert not (ROOT / ".git").exists() or git("rev-parse", "HEAD") is not None, "git does not show the history of this checkout"
    tag = git("describe", "--tags", "--abbrev=0", "--match", "v[0-9]*.[0-9]*.[0-9]*")
    return tag.decode().strip() if tag else None


@pytest.fixture(scope="module")
def release(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder `api` of the last release."""
    name = last_release()
    if name is None:
        pytest.skip("no release leads to this commit (git has no tag v*)")
    archive = git("archive", name, "api")
    assert archive is not None, f"git knows no {name}"
    folder = tmp_path_factory.mktemp("release")
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        files.extractall(folder)
    return folder / "api"


def may_break(older: str, newer: str) -> bool:
    before, now = ([int(number) for number in version.split(".")] for version in (older, newer))
    return now[0] > before[0] or (now[0] == 0 and now[1] > before[1])


def test_the_contract_keeps_what_that_of_the_last_release_promises(release: Path) -> None:
    older = yaml.safe_load((release / "openapi.yaml").read_text(encoding="utf-8"))
    if not may_break(older["info"]["version"], CONTRACT["info"]["version"]):
        assert breaking_changes(older, CONTRACT) == []


def test_the_examples_of_the_last_release_run(api: Api, release: Path) -> None:
    older = yaml.safe_load((release / "openapi.yaml").read_text(encoding="utf-8"))
    if may_break(older["info"]["version"], CONTRACT["info"]["version"]):
        pytest.skip("this version may break with it")
    for path in sorted((release / "examples").glob("*.json")):
        run_example(api, path)


def schema(contract: Dict[str, Any], name: str) -> Dict[str, Any]:
    found = contract["components"]["schemas"][name]
    assert isinstance(found, dict)
    return found


def request_of(contract: Dict[str, Any], path: str) -> Dict[str, Any]:
    reference = contract["paths"][path]["post"]["requestBody"]["content"]["application/json"]["schema"]["$ref"]
    return schema(contract, reference.rsplit("/", 1)[1])


def without_an_operation(contract: Dict[str, Any]) -> None:
    del contract["paths"]["/v1/geodesics"]["post"]


def with_a_necessary_field(contract: Dict[str, Any]) -> None:
    request = request_of(contract, "/v1/geodesics")
    request["properties"]["reason"] = {"type": "string"}
    request["required"].append("reason")


def without_a_field_of_requests(contract: Dict[str, Any]) -> None:
    del request_of(contract, "/v1/geodesics")["properties"]["pairs"]


def without_a_field_of_answers(contract: Dict[str, Any]) -> None:
    del schema(contract, "Mesh")["properties"]["vertices"]


def with_a_field_that_may_be_missing(contract: Dict[str, Any]) -> None:
    schema(contract, "Mesh")["required"].remove("vertices")


def with_another_type_of_answer(contract: Dict[str, Any]) -> None:
    schema(contract, "Mesh")["properties"]["vertices"] = {"type": ["integer", "null"]}


def with_a_narrower_limit(contract: Dict[str, Any]) -> None:
    request_of(contract, "/v1/geodesics")["properties"]["pairs"]["maxItems"] = 1


def without_a_status(contract: Dict[str, Any]) -> None:
    del contract["paths"]["/v1/geodesics"]["post"]["responses"]["200"]


def without_an_alternative(contract: Dict[str, Any]) -> None:
    hosts = next(found for found in contract["components"]["schemas"].values() if len(found.get("oneOf", [])) > 2)
    hosts["oneOf"].pop()


BREAKS: List[Any] = [
    (without_an_operation, r"POST /v1/geodesics is gone"),
    (with_a_necessary_field, r"POST /v1/geodesics: the body/reason has become necessary"),
    (without_a_field_of_requests, r"POST /v1/geodesics: the body/pairs is refused"),
    (without_a_field_of_answers, r"/vertices is gone"),
    (with_a_field_that_may_be_missing, r"/vertices may be missing"),
    (with_another_type_of_answer, r"/vertices may be null"),
    (with_a_narrower_limit, r"/pairs: maxItems is 1 and was"),
    (without_a_status, r"POST /v1/geodesics: the status 200 is gone"),
    (without_an_alternative, r"alternative \d+ is gone or has changed"),
]


@pytest.mark.parametrize("change, sentence", BREAKS, ids=lambda value: getattr(value, "__name__", ""))
def test_a_change_that_breaks_older_programs_is_found(change: Callable[[Dict[str, Any]], None], sentence: str) -> None:
    newer = copy.deepcopy(CONTRACT)
    change(newer)
    found = breaking_changes(CONTRACT, newer)
    assert any(re.search(sentence, one) for one in found), found


def test_a_contract_that_allows_and_promises_more_breaks_nothing() -> None:
    newer = copy.deepcopy(CONTRACT)
    request = request_of(newer, "/v1/geodesics")
    request["properties"]["note"] = {"type": "string"}
    request["properties"]["pairs"].pop("maxItems", None)
    info = schema(newer, "Mesh")
    info["properties"]["note"] = {"type": "string"}
    info["required"].append("note")
    newer["paths"]["/v1/notes"] = {"get": {"responses": {"200": {"description": "Notes."}}}}
    assert breaking_changes(CONTRACT, newer) == []


def test_versions_say_what_may_break() -> None:
    assert not may_break("1.2.3", "1.3.0") and may_break("1.2.3", "2.0.0")
    assert may_break("0.1.0", "0.2.0") and not may_break("0.1.0", "0.1.1")
