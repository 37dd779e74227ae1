"""Checks traffic against api/openapi.yaml: every request that should be valid, and every response."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Tuple
from urllib.parse import parse_qsl, urlsplit

import yaml
from jsonschema import Draft202012Validator, RefResolver

ROOT = Path(__file__).resolve().parents[2]
PROBLEM = "application/problem+json"


class ContractViolation(AssertionError):
    """A request or response that the contract does not permit."""


def _no_constants(name: str) -> None:
    raise ContractViolation(f"the body contains {name}, which is not JSON")


def strict_json(body: bytes) -> Any:
    """The body as JSON without Python's extensions: UTF-8, no NaN, no Infinity."""
    return json.loads(body.decode("utf-8"), parse_constant=_no_constants)


def media_type(header: Optional[str]) -> str:
    return (header or "").split(";")[0].strip().lower()


class Contract:
    """The parsed contract, whose operations can be found by method and path."""

    def __init__(self, path: Path = ROOT / "api" / "openapi.yaml") -> None:
        self.spec: Dict[str, Any] = yaml.load(path.read_text(encoding="utf-8"), yaml.CSafeLoader)
        self._resolver = RefResolver("", self.spec)
        self._operations: List[Tuple["re.Pattern[str]", str, str, Dict[str, Any]]] = []
        for template, item in self.spec["paths"].items():
            pattern = re.compile("".join(f"(?P<{part[1:-1]}>[^/]+)" if part.startswith("{") else re.escape(part)
                                         for part in re.split(r"(\{[^}]+\})", template)))
            for method in item.keys() & {"get", "head", "post", "put", "patch", "delete", "options"}:
                operation = dict(item[method])
                operation["parameters"] = item.get("parameters", []) + operation.get("parameters", [])
                self._operations.append((pattern, method.upper(), template, operation))

    def operations(self) -> List[Tuple[str, str]]:
        """(method, path template) of every operation."""
        return sorted((method, template) for _, method, template, _ in self._operations)

    def resolve(self, node: Any) -> Any:
        """The node at the end of a chain of $ref."""
        while isinstance(node, Mapping) and "$ref" in node:
            node = self._resolver.resolve(node["$ref"])[1]
        return node

    def match(self, method: str, url: str) -> Optional[Tuple[str, Dict[str, Any], Dict[str, str]]]:
        """(path template, operation, path parameters), or None if the contract has no such operation."""
        path = urlsplit(url).path
        for pattern, its_method, template, operation in self._operations:
            found = pattern.fullmatch(path)
            if its_method == method and found:
                return template, operation, found.groupdict()
        return None

    def validate(self, schema: Mapping[str, Any], value: Any, what: str) -> None:
        validator = Draft202012Validator(schema, resolver=self._resolver,
                                         format_checker=Draft202012Validator.FORMAT_CHECKER)
        errors = sorted(validator.iter_errors(value), key=lambda error: list(map(str, error.path)))
        if errors:
            shown = "\n".join(f"  /{'/'.join(map(str, e.path))}: {e.message[:400]}" for e in errors[:5])
            raise ContractViolation(f"{what} breaks the contract in {len(errors)} places:\n{shown}")

    def _check_content(self, content: Mapping[str, Any], header: Optional[str], body: bytes, what: str) -> None:
        kind = media_type(header)
        entry = content.get(kind) or content.get("*/*")
        if entry is None:
            raise ContractViolation(f"{what} has the media type '{kind}'; the contract allows {sorted(content)}")
        if kind.endswith("json"):
            self.validate(entry.get("schema", {}), strict_json(body), what)

    def _check_parameters(self, operation: Mapping[str, Any], path_values: Mapping[str, str],
                          query: Mapping[str, str], what: str) -> None:
        declared = [self.resolve(p) for p in operation["parameters"]]
        for name in query:
            if not any(p["in"] == "query" and p["name"] == name for p in declared):
                raise ContractViolation(f"{what} has the undeclared query parameter '{name}'")
        for parameter in declared:
            values = {"query": query, "path": path_values}.get(parameter["in"], {})
            if parameter["name"] in values:
                self.validate(parameter["schema"], self._typed(parameter["schema"], values[parameter["name"]]),
                              f"{what}, parameter {parameter['name']}")

    def _typed(self, schema: Any, text: str) -> Any:
        kind = self.resolve(schema).get("type")
        try:
            return int(text) if kind == "integer" else float(text) if kind == "number" else text
        except ValueError:
            return text

    def check_request(self, method: str, url: str, headers: Mapping[str, str], body: bytes) -> None:
        """Raises ContractViolation unless the request satisfies the contract."""
        what = f"{method} {url} (request)"
        found = self.match(method, url)
        if found is None:
            raise ContractViolation(f"{what} is no operation of the contract")
        _, operation, path_values = found
        self._check_parameters(operation, path_values, dict(parse_qsl(urlsplit(url).query)), what)
        declared = self.resolve(operation.get("requestBody"))
        if declared is None:
            if body:
                raise ContractViolation(f"{what} has a body; the contract declares none")
            return
        if body or declared.get("required"):
            self._check_content(declared["content"], headers.get("Content-Type"), body, what)

    def check_response(self, method: str, url: str, status: int, headers: Mapping[str, str], body: bytes) -> None:
        """Raises ContractViolation unless the response satisfies the contract.

        A request that matches no operation must be answered with a problem (404 or 405).
        """
        what = f"{method} {url} -> {status}"
        found = self.match(method, url)
        if found is None:
            if status not in (400, 403, 404, 405, 408, 414, 421, 431) or media_type(headers.get("Content-Type")) != PROBLEM:
                raise ContractViolation(f"{what} is outside the contract and must be a 404 or 405 problem")
            self.validate({"$ref": "#/components/schemas/Problem"}, strict_json(body), what)
            return
        responses = found[1]["responses"]
        response = self.resolve(responses.get(str(status)) or responses.get(f"{status // 100}XX")
                                or responses.get("default"))
        if response is None:
            raise ContractViolation(f"{what}: the contract declares only {sorted(responses)}")
        for name, header in response.get("headers", {}).items():
            header = self.resolve(header)
            if name in headers:
                self.validate(header["schema"], self._typed(header["schema"], headers[name]), f"{what}, header {name}")
            elif header.get("required"):
                raise ContractViolation(f"{what} lacks the header {name}")
        content = response.get("content", {})
        if content:
            self._check_content(content, headers.get("Content-Type"), body, what)
        elif body:
            raise ContractViolation(f"{what} has a body; the contract declares none")
        if status >= 400:
            if media_type(headers.get("Content-Type")) != PROBLEM:
                raise ContractViolation(f"{what} is an error that is not {PROBLEM}")
            problem = strict_json(body)
            if problem.get("status") != status:
                raise ContractViolation(f"{what}: the problem says status {problem.get('status')}")
            if problem.get("code") not in ERROR_CODES:
                raise ContractViolation(f"{what}: the code {problem.get('code')!r} is not in api/errors.yaml")
            if ERROR_CODES[problem["code"]] != status:
                raise ContractViolation(f"{what}: api/errors.yaml gives {problem['code']} another status")


ERROR_CODES: Dict[str, int] = {
    row["code"]: row["status"]
    for row in yaml.safe_load((ROOT / "api" / "errors.yaml").read_text(encoding="utf-8"))["errors"]
}
