"""The contract is valid and complete, and the server serves it as it is in the repository."""

from __future__ import annotations

import re
from typing import Any, Iterator, Tuple

import pytest
from jsonschema import Draft202012Validator

from contract import Contract, ContractViolation, ERROR_CODES, ROOT
from harness import Api


def nodes(value: Any, path: str = "") -> Iterator[Tuple[str, Any]]:
    yield path, value
    if isinstance(value, dict):
        for key, child in value.items():
            yield from nodes(child, f"{path}/{key}")
    elif isinstance(value, list):
        for number, child in enumerate(value):
            yield from nodes(child, f"{path}/{number}")


def test_every_schema_is_valid_json_schema(contract: Contract) -> None:
    for schema in contract.spec["components"]["schemas"].values():
        Draft202012Validator.check_schema(schema)


def test_every_reference_leads_somewhere(contract: Contract) -> None:
    references = [node["$ref"] for _, node in nodes(contract.spec) if isinstance(node, dict) and "$ref" in node]
    assert len(references) > 50
    for reference in references:
        contract.resolve({"$ref": reference})


def test_every_property_says_what_it_is(contract: Contract) -> None:
    for path, node in nodes(contract.spec["components"]["schemas"]):
        if re.fullmatch(r".*/properties/[^/]+", path):
            resolved = contract.resolve(node)
            assert "description" in node or "description" in resolved or "required" in resolved, path


def test_every_object_is_closed(contract: Contract) -> None:
    for path, node in nodes(contract.spec["components"]["schemas"]):
        if isinstance(node, dict) and node.get("type") == "object":
            assert "additionalProperties" in node, path


def test_every_computation_that_may_become_a_job_is_a_kind_of_job(contract: Contract) -> None:
    kinds = set(contract.resolve({"$ref": "#/components/schemas/Job"})["properties"]["kind"]["enum"])
    accepting = {path for path, item in contract.spec["paths"].items() if "202" in item.get("post", {}).get("responses", {})}
    names = {"/v1/models/{model}/evaluations": "model-evaluations", "/v1/models/{model}/uniaxial": "model-uniaxial"}
    assert {names.get(path, path.removeprefix("/v1/")) for path in accepting} == kinds


def test_the_result_of_a_job_may_be_whatever_its_computation_answers(contract: Contract) -> None:
    def contents(operation: Any) -> Any:
        return operation["responses"]["200"]["content"]

    results = contents(contract.spec["paths"]["/v1/jobs/{job}/result"]["get"])
    schemas = [entry["$ref"] for entry in results["application/json"]["schema"]["anyOf"]]
    for path, item in contract.spec["paths"].items():
        if "202" not in item.get("post", {}).get("responses", {}):
            continue
        for media_type, content in contents(item["post"]).items():
            assert media_type in results, path
            if media_type == "application/json":
                assert content["schema"]["$ref"] in schemas, path


def test_the_server_serves_this_contract(api: Api) -> None:
    assert api.get("/openapi.yaml").content == (ROOT / "api" / "openapi.yaml").read_bytes()


def test_the_server_serves_this_table_of_accuracies(api: Api) -> None:
    assert api.get("/v1/accuracy-levels").content == (ROOT / "api" / "accuracy_levels.json").read_bytes()


def test_the_error_table_has_no_code_twice_and_only_error_statuses() -> None:
    text = (ROOT / "api" / "errors.yaml").read_text(encoding="utf-8")
    assert len(re.findall(r"^\s*- code:", text, re.MULTILINE)) == len(ERROR_CODES)
    assert all(400 <= status < 600 for status in ERROR_CODES.values())


@pytest.mark.parametrize("method, path, status, headers, body", [
    ("GET", "/healthz", 200, {"Content-Type": "application/json"}, b'{"status": "ok", "version": "1"}'),
    ("GET", "/healthz", 200, {"Content-Type": "application/json"}, b'{"status": "ok", "version": "1", "uptime_seconds": NaN,'
     b' "silence_seconds": 0}'),
    ("GET", "/healthz", 200, {"Content-Type": "text/html"}, b"ok"),
    ("GET", "/v1/nothing", 200, {"Content-Type": "application/json"}, b"{}"),
    ("GET", "/v1/jobs", 404, {"Content-Type": "application/problem+json"},
     b'{"type": "t", "title": "t", "status": 404, "detail": "d", "code": "not.in_the_table"}'),
], ids=["missing-field", "nan", "media-type", "unknown-path", "unknown-code"])
def test_the_check_itself_refuses_what_the_contract_does_not_allow(
        contract: Contract, method: str, path: str, status: int, headers: Any, body: bytes) -> None:
    with pytest.raises(ContractViolation):
        contract.check_response(method, path, status, headers, body)
