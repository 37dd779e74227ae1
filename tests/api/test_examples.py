"""The documented examples, run with a real server."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any, Dict

import pytest

from contract import ROOT
from harness import Api

EXAMPLES = sorted((ROOT / "api" / "examples").glob("*.json"))
TYPES = {"$number": (int, float), "$integer": int, "$string": str, "$array": list, "$time": str}
REPEAT_SECONDS = 120


def filled(value: Any, saved: Dict[str, str]) -> Any:
    """The value with every {{name}} replaced by the value that an earlier step saved."""
    if isinstance(value, str):
        for name, replacement in saved.items():
            value = value.replace("{{" + name + "}}", replacement)
        return value
    if isinstance(value, list):
        return [filled(entry, saved) for entry in value]
    if isinstance(value, dict):
        return {key: filled(entry, saved) for key, entry in value.items()}
    return value


def pointed(document: Any, pointer: str) -> Any:
    for part in pointer.split("/")[1:]:
        document = document[int(part)] if isinstance(document, list) else document[part]
    return document


def match(expected: Any, actual: Any, tolerance: float, where: str = "") -> None:
    if expected == "$any":
        return
    if isinstance(expected, str) and expected in TYPES:
        assert isinstance(actual, TYPES[expected]) and not isinstance(actual, bool), f"{where} is {actual!r}"
        if expected == "$time":
            assert actual.endswith("Z") and "T" in actual, f"{where} is {actual!r}"
    elif isinstance(expected, dict):
        assert isinstance(actual, dict), f"{where} is {actual!r}"
        for key, value in expected.items():
            assert key in actual, f"{where}/{key} is missing"
            match(value, actual[key], tolerance, f"{where}/{key}")
    elif isinstance(expected, list):
        assert isinstance(actual, list) and len(actual) == len(expected), f"{where} is {actual!r}"
        for number, (e, a) in enumerate(zip(expected, actual)):
            match(e, a, tolerance, f"{where}/{number}")
    elif isinstance(expected, (int, float)) and not isinstance(expected, bool):
        assert isinstance(actual, (int, float)) and not isinstance(actual, bool), f"{where} is {actual!r}"
        assert abs(actual - expected) <= tolerance * max(1.0, abs(expected)), f"{where} is {actual!r}, not {expected!r}"
    else:
        assert actual == expected, f"{where} is {actual!r}, not {expected!r}"


def send(api: Api, step: Dict[str, Any], saved: Dict[str, str], folder: Path) -> Any:
    headers = filled(step.get("headers", {}), saved)
    statuses = step["status"] if isinstance(step["status"], list) else [step["status"]]
    body = None
    if "file" in step:
        body = (folder / step["file"]).read_bytes()
        if "body" in step:
            body = json.dumps({**json.loads(body), **filled(step["body"], saved)}).encode()
            headers.setdefault("Content-Type", "application/json")
    elif "text" in step:
        body = filled(step["text"], saved).encode()
    elif "body" in step:
        body = json.dumps(filled(step["body"], saved)).encode()
        headers.setdefault("Content-Type", "application/json")
    # A step that shows the answer to a mistake must make it.
    mistake = all(status >= 400 for status in statuses)
    return api.call(step["method"], filled(step["path"], saved), body=body, headers=headers, faulty=mistake), statuses


def run_example(api: Api, path: Path) -> None:
    """Sends the requests in a file of examples and compares the answers. Requests may contain other files of its folder."""
    saved: Dict[str, str] = {}
    for step in json.loads(path.read_text(encoding="utf-8"))["steps"]:
        end = time.monotonic() + REPEAT_SECONDS
        while True:
            response, statuses = send(api, step, saved, path.parent)
            assert response.status_code in statuses, f"{step['name']}: {response.status_code} {response.text[:1000]}"
            repeat = step.get("repeat_until")
            if repeat is None or pointed(response.json(), repeat["pointer"]) == repeat["value"]:
                break
            assert time.monotonic() < end, f"{step['name']}: {response.text[:1000]}"
            time.sleep(0.05)
        try:
            if "response" in step:
                match(filled(step["response"], saved), response.json(), step.get("tolerance", 1e-9))
            for name, value in filled(step.get("response_headers", {}), saved).items():
                match(value, response.headers.get(name), 0, f"header {name}")
        except AssertionError as error:
            raise AssertionError(f"{step['name']}: {error}\n{response.text[:2000]}") from error
        assert filled(step.get("response_text", ""), saved) in response.text, step["name"]
        for name, pointer in step.get("save", {}).items():
            saved[name] = str(pointed(response.json(), pointer))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_example_runs_as_documented(api: Api, path: Path) -> None:
    run_example(api, path)


def test_there_are_examples_of_every_operation(api: Api) -> None:
    shown = {api.contract.match(step["method"], step["path"].replace("{{", "").replace("}}", ""))
             and (step["method"], api.contract.match(step["method"], step["path"])[0])  # type: ignore[index]
             for path in EXAMPLES for step in json.loads(path.read_text(encoding="utf-8"))["steps"]}
    assert set(api.contract.operations()) <= shown
