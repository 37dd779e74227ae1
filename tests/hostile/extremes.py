"""Requests with extreme numbers: each is an example of the contract in which some values were replaced.

    python3 tests/hostile/extremes.py [--requests 20000] [--seed 1] [--only voronoi]

A number is replaced by a limit in the contract, zero, the smallest or the largest double, or another number of the same
body. An entry of a list is repeated or removed. An optional field is added with a value that its schema permits. One to
four values change at a time. The server may answer or refuse, but never with status 500 or in violation of the contract's
schemas: if a result is not finite, the problem names the responsible field. Each request has a deadline of a second, and
may take one more second of the server's CPU time.

Prints each violation of these rules with its body; the exit status is 1 if there are any. Probes are sent during the whole
run. Their durations are printed, as are the server's peak memory and the time that it takes to end while it computes.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import random
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

import requests  # noqa: E402

from contract import ROOT, Contract, ContractViolation  # noqa: E402
from harness import ServerProcess  # noqa: E402
from processes import peak_bytes, reset_peak  # noqa: E402
from test_examples import EXAMPLES, filled, pointed  # noqa: E402
from working_time import PATIENCE_SECONDS, cpu_seconds  # noqa: E402

DEADLINE = 1.0
LATE = 1.0
"""Permitted CPU seconds beyond the deadline, for each of the server's computing threads."""
EXTREMES = [0, 1, -1, 5e-324, 1e-310, 1e-300, 1e-154, 1e-100, 1e-30, 1e-12, 1e-6, 1e6, 1e9, 1e12, 1e30, 1e70, 1e100, 1e154, 1e300,
            1.7976931348623157e308, 2**31 - 1, 2**31, 2**53, 2**63, 2**64]

Place = Tuple[Any, ...]


class Base(NamedTuple):
    path: str
    body: Dict[str, Any]
    accept: str
    schema: Any


def limits_of(node: Any) -> Iterator[float]:
    """Every limit of a number in the contract."""
    if isinstance(node, dict):
        for key, inner in node.items():
            if key in ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum") and isinstance(inner, (int, float)):
                yield inner
            yield from limits_of(inner)
    elif isinstance(node, list):
        for inner in node:
            yield from limits_of(inner)


def places(value: Any, kind: Any, place: Place = ()) -> Iterator[Place]:
    """The places of a body whose value is of this type."""
    if isinstance(value, kind) and not isinstance(value, bool):
        yield place
    if isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            if key not in ("deadline", "mesh"):
                yield from places(inner, kind, place + (key,))


def at(body: Any, place: Place) -> Any:
    for key in place:
        body = body[key]
    return body


class Growth:
    """Generates optional fields of a body from the contract's schemas."""

    def __init__(self, contract: Contract, numbers: List[float], chance: random.Random) -> None:
        self.contract, self.numbers, self.chance = contract, numbers, chance

    def alternatives(self, schema: Any, value: Any) -> Iterator[Any]:
        """The schema, and those of its alternatives that the value satisfies."""
        schema = self.contract.resolve(schema)
        yield schema
        for key in ("allOf", "oneOf", "anyOf"):
            for part in schema.get(key, []):
                try:
                    self.contract.validate(part, value, "")
                except ContractViolation:
                    continue
                yield from self.alternatives(part, value)

    def missing(self, schema: Any, value: Any, place: Place = ()) -> Iterator[Tuple[Place, str, Any]]:
        """Triples of the place of an object, the name of a field that it lacks, and the schema of that field."""
        for part in self.alternatives(schema, value):
            if isinstance(value, dict):
                for name, inner in part.get("properties", {}).items():
                    if name not in value:
                        yield place, name, inner
                    else:
                        yield from self.missing(inner, value[name], place + (name,))
            elif isinstance(value, list) and value and "items" in part:
                chosen = self.chance.randrange(len(value))
                yield from self.missing(part["items"], value[chosen], place + (chosen,))

    def value(self, schema: Any, depth: int = 0) -> Any:
        """A value that the schema permits, or almost permits."""
        schema = self.contract.resolve(schema)
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return self.chance.choice(schema["enum"])
        for key in ("oneOf", "anyOf"):
            if key in schema:
                return self.value(self.chance.choice(schema[key]), depth)
        kind = schema.get("type", "object")
        kind = self.chance.choice(kind) if isinstance(kind, list) else kind
        if kind in ("number", "integer"):
            least = schema.get("minimum", schema.get("exclusiveMinimum", -1e300))
            most = schema.get("maximum", schema.get("exclusiveMaximum", 1e300))
            fits = [number for number in self.numbers if least <= number <= most] or [least]
            number = self.chance.choice([self.chance.choice(fits), least, most, self.chance.uniform(max(least, -3), min(most, 3))])
            return int(number) if kind == "integer" else number
        if kind == "boolean":
            return self.chance.random() < 0.5
        if kind == "array":
            count = min(schema.get("maxItems", 4), schema.get("minItems", 0) + self.chance.choice((0, 1, 3)))
            fixed = [self.value(inner, depth + 1) for inner in schema.get("prefixItems", [])]
            return fixed + [self.value(schema.get("items", {}), depth + 1) for _ in range(count - len(fixed))]
        if kind == "object":
            required = set(schema.get("required", []))
            chosen = {name: self.value(inner, depth + 1) for name, inner in schema.get("properties", {}).items()
                      if name in required or (depth < 3 and self.chance.random() < 0.3)}
            for part in schema.get("allOf", []):
                inner = self.value(part, depth + 1)
                chosen.update(inner if isinstance(inner, dict) else {})
            return chosen
        return None if kind == "null" else self.chance.choice(["x", "on", "off", "auto", "1/2"])


class Extremes:
    def __init__(self, server: ServerProcess, seed: int, only: str = "") -> None:
        self.server = server
        self.contract = Contract()
        self.chance = random.Random(seed)
        self.session = requests.Session()
        limits = sorted(set(limits_of(self.contract.spec)) - {0})
        self.numbers = [sign * number for number in [*EXTREMES, *limits] for sign in (1, -1)]
        self.growth = Growth(self.contract, self.numbers, self.chance)
        self.bases = [base for base in self.examples() if only in base.path]
        self.broken: List[str] = []
        self.statuses: "Counter[int]" = Counter()

    def examples(self) -> Iterator[Base]:
        """The computations of the examples, after the uploads that they need."""
        for example in EXAMPLES:
            saved: Dict[str, str] = {}
            for step in json.loads(example.read_text(encoding="utf-8"))["steps"]:
                folder, headers = example.parent, dict(filled(step.get("headers", {}), saved))
                body: Optional[bytes] = None
                document = filled(step.get("body"), saved)
                if "file" in step:
                    body = (folder / step["file"]).read_bytes()
                    if document is not None:
                        document = {**json.loads(body), **document}
                if document is not None:
                    body = json.dumps(document).encode()
                    headers.setdefault("Content-Type", "application/json")
                elif "text" in step:
                    body = filled(step["text"], saved).encode()
                path = filled(step["path"], saved)
                if step["method"] == "POST" and isinstance(document, dict) and step["status"] in (200, 202, 422):
                    limited = {**document, "deadline": DEADLINE}
                    found = self.contract.match("POST", path)
                    content = self.contract.resolve(found[1].get("requestBody", {})).get("content", {}) if found else {}
                    yield Base(path, limited if self.allowed(path, limited) else document, headers.get("Accept", "application/json"),
                               content.get("application/json", {}).get("schema"))
                if step["method"] != "DELETE" and (path == "/v1/meshes" or "save" in step):
                    answer = self.session.request(step["method"], self.server.url + path, data=body, headers=headers, timeout=PATIENCE_SECONDS)
                    for name, pointer in step.get("save", {}).items():
                        saved[name] = str(pointed(answer.json(), pointer))

    def allowed(self, path: str, body: Dict[str, Any]) -> bool:
        try:
            self.contract.check_request("POST", path, {"Content-Type": "application/json"}, json.dumps(body).encode())
        except ContractViolation:
            return False
        return True

    def changed(self, base: Base) -> Dict[str, Any]:
        """The body with one to four changes."""
        body = copy.deepcopy(base.body)
        for _ in range(self.chance.choice((1, 1, 2, 3, 4))):
            if base.schema is not None and self.chance.random() < 0.4:
                if fields := list(self.growth.missing(base.schema, body)):
                    place, name, schema = self.chance.choice(fields)
                    at(body, place)[name] = self.growth.value(schema)
                continue
            numbers = list(places(body, (int, float)))
            lists = [place for place in places(body, list) if at(body, place)]
            if lists and self.chance.random() < 0.15:
                entries = at(body, self.chance.choice(lists))
                chosen = self.chance.randrange(len(entries))
                if self.chance.random() < 0.5:
                    entries[chosen:chosen] = [copy.deepcopy(entries[chosen]) for _ in range(self.chance.choice((1, 1, 10)))]
                else:
                    del entries[chosen]
            elif numbers:
                place = self.chance.choice(numbers)
                other = at(body, self.chance.choice(numbers))
                old = at(body, place)
                new = self.chance.choice([self.chance.choice(self.numbers), other, -old, old * 10.0 ** self.chance.randint(-12, 12)])
                if isinstance(old, int) and self.chance.random() < 0.8:
                    new = int(min(max(new, -2.0**64), 2.0**64))
                elif isinstance(new, float) and not math.isfinite(new):
                    continue
                at(body, place[:-1])[place[-1]] = new
        return body

    def with_field(self, base: Base, place: Place, name: str, schema: Any) -> Dict[str, Any]:
        """The body with a generated value of this field."""
        body = copy.deepcopy(base.body)
        at(body, place)[name] = self.growth.value(schema)
        return body

    def ask(self, path: str, body: Dict[str, Any], accept: str) -> str:
        """Sends a request and returns what is wrong with its answer, or an empty text."""
        before = sum(cpu_seconds(self.server.pid).values())
        try:
            answer = self.session.post(self.server.url + path, data=json.dumps(body),
                                       headers={"Content-Type": "application/json", "Accept": accept}, timeout=PATIENCE_SECONDS)
        except requests.RequestException as error:
            return f"no answer: {error!r}; the server {'runs' if self.server.running() else 'has ended'}"
        self.statuses[answer.status_code] += 1
        late = sum(cpu_seconds(self.server.pid).values()) - before - 2 * (DEADLINE + LATE)
        if late > 0:
            return f"{answer.status_code}, {late:.1f} CPU seconds too late"
        if answer.status_code == 500:
            return f"500 {answer.text[:300]}"
        try:
            self.contract.check_response("POST", path, answer.status_code, answer.headers, answer.content)
        except ContractViolation as violation:
            return str(violation)
        return ""

    def run(self, count: int) -> None:
        for _ in range(count):
            base = self.chance.choice(self.bases)
            body = self.changed(base)
            if fault := self.ask(base.path, body, base.accept):
                self.broken.append(f"{base.path} (Accept: {base.accept})\n  {fault}\n  {json.dumps(body)[:20000]}")
                print(self.broken[-1], flush=True)
                if not self.server.running():
                    self.server.start()


class Probes(threading.Thread):
    """Requests the server's health twenty times a second."""

    def __init__(self, server: ServerProcess) -> None:
        super().__init__(daemon=True)
        self.server = server
        self.seconds: List[float] = []
        self.ended = threading.Event()

    def run(self) -> None:
        with requests.Session() as session:
            while not self.ended.wait(0.05):
                begin = time.monotonic()
                try:
                    session.get(self.server.url + "/healthz", timeout=PATIENCE_SECONDS)
                except requests.RequestException:
                    continue  # a server that has ended is reported by the request that ended it
                self.seconds.append(time.monotonic() - begin)

    def text(self) -> str:
        """The durations of the probes, as a sentence."""
        ordered = sorted(self.seconds) or [math.nan]
        shares = ", ".join(f"{100 * share:g} % within {1000 * ordered[min(len(ordered) - 1, int(share * len(ordered)))]:.0f} ms" for share in (0.5, 0.99, 0.999))
        return f"{len(self.seconds)} probes: {shares}, the longest {1000 * ordered[-1]:.0f} ms"


def ending(server: ServerProcess, extremes: "Extremes") -> float:
    """Seconds that the server takes to terminate while it computes."""
    def send(base: Base) -> None:
        try:
            requests.post(server.url + base.path, json=base.body, timeout=PATIENCE_SECONDS)
        except requests.RequestException:
            pass  # the server has ended

    for base in extremes.bases[:4]:
        threading.Thread(target=send, args=(base,), daemon=True).start()
    time.sleep(0.2)
    begin = time.monotonic()
    server.terminate()
    return time.monotonic() - begin


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--requests", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="a part of the path")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="supple_extremes_") as folder:
        server = ServerProcess(Path(folder) / "data", "--models", str(ROOT / "models")).start()
        try:
            extremes = Extremes(server, options.seed, options.only)
            probes = Probes(server)
            before, budget = server.resident_bytes(), server.metrics()["supple_memory_budget_bytes"]
            reset_peak(server.pid)
            probes.start()
            start = time.monotonic()
            extremes.run(options.requests)
            taken = time.monotonic() - start
            probes.ended.set()
            probes.join()
            peak = peak_bytes(server.pid) - before
            end = ending(server, extremes)
        finally:
            server.stop()
    print(f"{probes.text()}; {peak / 2**20:.0f} MiB of memory at most, of a budget of {budget / 2**20:.0f} MiB; ended in {end:.1f} s")
    print(f"{options.requests} requests of {len(extremes.bases)} examples in {taken:.0f} s: {len(extremes.broken)} broke a rule; "
          + ", ".join(f"{status}: {count}" for status, count in sorted(extremes.statuses.items())))
    return 1 if extremes.broken else 0


if __name__ == "__main__":
    sys.exit(main())
