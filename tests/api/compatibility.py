"""Changes of a contract that break programs written for an older version of it.

A program for the older contract sends requests that it permits, and reads what it promises. So a newer contract may accept more
and promise more, but not less. New values in an answer, for example another kind of job, are permitted, since programs must
expect them whatever the contract's version is.
"""

from __future__ import annotations

from typing import Any, Dict, List, Mapping, Set

METHODS = ("get", "head", "post", "put", "patch", "delete")
NARROWER_IF_GREATER = ("minimum", "exclusiveMinimum", "minItems", "minLength", "minProperties")
NARROWER_IF_SMALLER = ("maximum", "exclusiveMaximum", "maxItems", "maxLength", "maxProperties")


def types_of(schema: Mapping[str, Any]) -> Set[str]:
    """The JSON types that a schema permits; empty for all."""
    if "const" in schema and "type" not in schema:
        return types_of({"enum": [schema["const"]]})
    if "enum" in schema and "type" not in schema:
        names = {str: "string", bool: "boolean", int: "integer", float: "number", type(None): "null"}
        return {names.get(type(value), "object") for value in schema["enum"]}
    named = schema.get("type", [])
    types = {named} if isinstance(named, str) else set(named)
    return types | {"integer"} if "number" in types else types


def values_of(schema: Mapping[str, Any]) -> List[Any]:
    """The values that a schema lists; empty if it lists none."""
    return [schema["const"]] if "const" in schema else list(schema.get("enum", []))


class Comparison:
    """Compares two parsed contracts. `breaks` then has a sentence for each change that breaks an older program."""

    def __init__(self, older: Mapping[str, Any], newer: Mapping[str, Any]) -> None:
        self.older, self.newer = older, newer
        self.breaks: List[str] = []
        self._compared: Set[Any] = set()
        self._paths()

    def _paths(self) -> None:
        for path, item in self.older["paths"].items():
            for method in METHODS:
                if method in item:
                    newer = self.newer["paths"].get(path, {}).get(method)
                    where = f"{method.upper()} {path}"
                    if newer is None:
                        self.breaks.append(f"{where} is gone")
                    else:
                        self._operation(where, item, item[method], self.newer["paths"][path], newer)

    def _operation(self, where: str, older_item: Any, older: Any, newer_item: Any, newer: Any) -> None:
        before, now = self._parameters(self.older, older_item, older), self._parameters(self.newer, newer_item, newer)
        for key, parameter in before.items():
            if key not in now:
                self.breaks.append(f"{where}: the {key[0]} parameter {key[1]} is gone")
            else:
                self._accepts(f"{where}: the parameter {key[1]}", parameter.get("schema", {}), now[key].get("schema", {}))
        for key, parameter in now.items():
            if parameter.get("required") and not before.get(key, {}).get("required"):
                self.breaks.append(f"{where}: the {key[0]} parameter {key[1]} has become necessary")
        before_body, now_body = self._old(older.get("requestBody", {})), self._new(newer.get("requestBody", {}))
        for kind, content in before_body.get("content", {}).items():
            if kind not in now_body.get("content", {}):
                self.breaks.append(f"{where}: bodies of type {kind} are refused")
            else:
                self._accepts(f"{where}: the body", content.get("schema", {}), now_body["content"][kind].get("schema", {}))
        for status, response in older["responses"].items():
            if status not in newer["responses"]:
                self.breaks.append(f"{where}: the status {status} is gone")
                continue
            answers = self._new(newer["responses"][status]).get("content", {})
            for kind, content in self._old(response).get("content", {}).items():
                if kind not in answers:
                    self.breaks.append(f"{where}: answers {status} of type {kind} are gone")
                else:
                    self._promises(f"{where}: the answer {status}", content.get("schema", {}), answers[kind].get("schema", {}))

    @staticmethod
    def _resolved(contract: Mapping[str, Any], node: Any) -> Any:
        while isinstance(node, Mapping) and "$ref" in node:
            target: Any = contract
            for part in node["$ref"].split("/")[1:]:
                target = target[part]
            node = target
        return node

    def _old(self, node: Any) -> Any:
        return self._resolved(self.older, node)

    def _new(self, node: Any) -> Any:
        return self._resolved(self.newer, node)

    def _parameters(self, contract: Mapping[str, Any], item: Any, operation: Any) -> Dict[Any, Any]:
        all_of_them = [self._resolved(contract, one) for one in item.get("parameters", []) + operation.get("parameters", [])]
        return {(one["in"], one["name"]): one for one in all_of_them}

    def _is_new_pair(self, direction: str, older: Any, newer: Any) -> bool:
        """Whether the pair of schemas was not compared yet. Each pair is compared once, since schemas are recursive and used repeatedly."""
        pair = (direction, id(older), id(newer))
        if pair in self._compared:
            return False
        self._compared.add(pair)
        return True

    def _fits(self, compare: str, older: Any, newer: Any) -> bool:
        """Whether a newer alternative of a schema replaces an older one without breaking programs."""
        kept, self.breaks = self.breaks, []
        compared, self._compared = self._compared, set(self._compared)
        getattr(self, compare)("", older, newer)
        fits = not self.breaks
        self.breaks, self._compared = kept, compared
        return fits

    def _alternatives(self, compare: str, where: str, older: Any, newer: Any) -> bool:
        """Compares two schemas if at least one has alternatives; returns false if neither has."""
        lists = [schema.get("oneOf") or schema.get("anyOf") for schema in (older, newer)]
        if lists[0] is None and lists[1] is None:
            return False
        before, now = lists[0] or [older], lists[1] or [newer]
        for number, one in enumerate(before):
            if not any(self._fits(compare, one, other) for other in now):
                self.breaks.append(f"{where}: alternative {number + 1} is gone or has changed")
        return True

    def _accepts(self, where: str, older: Any, newer: Any) -> None:
        """Checks that the newer schema permits everything that the older one permits."""
        older, newer = self._old(older), self._new(newer)
        if not self._is_new_pair("accepts", older, newer) or self._alternatives("_accepts", where, older, newer):
            return
        before, now = types_of(older), types_of(newer)
        if now and not before <= now:
            self.breaks.append(f"{where}: {', '.join(sorted(before - now)) or 'any type'} is refused")
        listed = values_of(newer)
        if listed and not (values_of(older) and all(value in listed for value in values_of(older))):
            self.breaks.append(f"{where}: a value that was allowed is refused")
        for word in NARROWER_IF_GREATER + NARROWER_IF_SMALLER:
            if word in newer and (word not in older or (newer[word] > older[word] if word in NARROWER_IF_GREATER else newer[word] < older[word])):
                self.breaks.append(f"{where}: {word} is {newer[word]} and was {older.get(word, 'not there')}")
        for name in newer.get("required", []):
            if name not in older.get("required", []):
                self.breaks.append(f"{where}/{name} has become necessary")
        for name, schema in older.get("properties", {}).items():
            if name in newer.get("properties", {}):
                self._accepts(f"{where}/{name}", schema, newer["properties"][name])
            elif newer.get("additionalProperties") is False:
                self.breaks.append(f"{where}/{name} is refused")
        if "items" in older and "items" in newer:
            self._accepts(f"{where}/0", older["items"], newer["items"])

    def _promises(self, where: str, older: Any, newer: Any) -> None:
        """Checks that the newer schema promises everything in an answer that the older one promises."""
        older, newer = self._old(older), self._new(newer)
        if not self._is_new_pair("promises", older, newer) or self._alternatives("_promises", where, older, newer):
            return
        before, now = types_of(older), types_of(newer)
        if before and not (now and now <= before):
            self.breaks.append(f"{where} may be {', '.join(sorted(now - before)) or 'of any type'}")
        for name in older.get("required", []):
            if name not in newer.get("required", []):
                self.breaks.append(f"{where}/{name} may be missing")
        for name, schema in older.get("properties", {}).items():
            if name in newer.get("properties", {}):
                self._promises(f"{where}/{name}", schema, newer["properties"][name])
            else:
                self.breaks.append(f"{where}/{name} is gone")
        if "items" in older:
            self._promises(f"{where}/0", older["items"], newer.get("items", {}))


def breaking_changes(older: Mapping[str, Any], newer: Mapping[str, Any]) -> List[str]:
    """One sentence for each change of the newer contract that breaks a program written for the older one."""
    return Comparison(older, newer).breaks
