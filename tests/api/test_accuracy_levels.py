"""The table of accuracy levels against the contract: each level is a valid part of a request, and normal is the defaults."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Dict, List

import pytest

from contract import Contract

ROOT = Path(__file__).resolve().parents[2]
TABLE: Dict[str, Any] = json.loads((ROOT / "api" / "accuracy_levels.json").read_text(encoding="utf-8"))
LEVELS: List[Dict[str, Any]] = TABLE["levels"]
CONTRACT = Contract()


def named(level: Dict[str, Any]) -> str:
    return f"{level['capability']}-{level['level']}"


def request_schema(path: str) -> Dict[str, Any]:
    body = CONTRACT.spec["paths"][path]["post"]["requestBody"]["content"]["application/json"]["schema"]
    schema: Dict[str, Any] = CONTRACT.resolve(body)
    return schema


def test_the_table_is_as_the_contract_says() -> None:
    CONTRACT.validate({"$ref": "#/components/schemas/AccuracyLevels"}, TABLE, "api/accuracy_levels.json")


def test_every_capability_has_its_three_levels_in_order() -> None:
    capabilities = [level["capability"] for level in LEVELS[::3]]
    assert len(set(capabilities)) == len(capabilities)
    assert [(level["capability"], level["level"]) for level in LEVELS] == [
        (capability, name) for capability in capabilities for name in ("draft", "normal", "sure")]
    for draft, normal, sure in zip(LEVELS[::3], LEVELS[1::3], LEVELS[2::3]):
        for shared in ("path", "task", "error_of"):
            assert draft[shared] == normal[shared] == sure[shared]


@pytest.mark.parametrize("level", LEVELS, ids=named)
def test_a_level_is_a_valid_part_of_a_request(level: Dict[str, Any]) -> None:
    properties = request_schema(level["path"])["properties"]
    for name, fragment in level["request"].items():
        CONTRACT.validate(CONTRACT.resolve(properties[name]), fragment, f"{named(level)}: {name}")


@pytest.mark.parametrize("level", LEVELS, ids=named)
def test_normal_is_the_defaults(level: Dict[str, Any]) -> None:
    if level["level"] == "normal":
        assert level["request"] == {}


@pytest.mark.parametrize("level", LEVELS, ids=named)
def test_the_numbers_of_a_level_have_a_source_that_exists(level: Dict[str, Any]) -> None:
    if level["source"] is None:
        assert level["seconds"] is None and level["error"] in (None, 0, level["request"].get("accuracy", {}).get("discretization_error"))
        return
    page, _, section = level["source"].partition("#")
    headings = [line.lstrip("#").strip() for line in (ROOT / page).read_text(encoding="utf-8").splitlines() if line.startswith("#")]
    anchors = {"".join(c for c in heading.lower().replace(" ", "-") if c.isalnum() or c in "-_") for heading in headings}
    assert section in anchors, level["source"]


def test_a_surer_level_is_measured_to_err_less() -> None:
    for draft, normal, sure in zip(LEVELS[::3], LEVELS[1::3], LEVELS[2::3]):
        errors = [level["error"] for level in (draft, normal, sure) if level["error"] is not None]
        assert errors == sorted(errors, reverse=True), draft["capability"]
