"""Searches for the costliest request that the contract permits, for each operation.

Starts from the requests of `costly.py` and changes one value of a body at a time: a number is multiplied, divided or set
to a limit in the contract, a choice is replaced by another one, an optional field is removed. A change is retained if the
request takes more memory or works longer beyond its deadline, and is then changed further. Requests beyond the bounds are
printed with their bodies, so that they can become cases of `costly.py`:

    python3 tests/hostile/search.py --minutes 30 [--operation weave] [--seed 1]

The exit status is 1 if a request exceeded a bound or ended the server.
"""

from __future__ import annotations

import argparse
import copy
import json
import random
import re
import select
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Iterator, List, NamedTuple, Optional, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

import requests  # noqa: E402

from contract import ROOT  # noqa: E402
from costly import CASES, Costly, Meshes, meshes_of  # noqa: E402
from harness import ServerProcess  # noqa: E402
from processes import first_line, peak_bytes, reset_peak, sent_request  # noqa: E402
from working_time import cpu_seconds  # noqa: E402

DEADLINE = 2.0
BOUND_BYTES = 1.25 * 2**30
"""Permitted growth of the process by one request: its limit of 1 GiB, and a margin for free memory that is not returned."""
BOUND_LATE = 1.0
"""Permitted CPU seconds of the server beyond the deadline, for each of its two threads."""

Place = Tuple[Any, ...]


class Cost(NamedTuple):
    status: str
    bytes: int
    late: float
    """CPU seconds between the deadline and the answer."""

    def worth(self) -> float:
        return self.bytes / BOUND_BYTES + self.late / BOUND_LATE


def leaves(value: Any, place: Place = ()) -> Iterator[Place]:
    """The places of a body that are changed. In a long list these are only in its first and last entries."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key != "mesh" and place + (key,) != ("deadline",):
                yield from leaves(inner, place + (key,))
    elif isinstance(value, list):
        for i in sorted({0, len(value) - 1} if len(value) > 8 else set(range(len(value)))):
            yield from leaves(value[i], place + (i,))
        if len(value) > 1:
            yield place
    else:
        yield place


def at(value: Any, place: Place) -> Any:
    for step in place:
        value = value[step]
    return value


def put(value: Any, place: Place, new: Any) -> None:
    at(value, place[:-1])[place[-1]] = new


CHOICES = [["on", "off"], ["newton", "lbfgs", "gradient_descent"], ["exact", "bounded", "edge_based"],
           ["stress_strain", "stiffness", "poisson_ratio"], ["shell", "solid", "rigid"], ["json", "none"],
           ["regular", "interlacing_circles"], ["slides_x", "slides_y", "fixed"], [f"IH{n:02d}" for n in (1, 21, 22, 28, 29, 50, 67)]]


def changed(body: Any, chance: random.Random) -> Any:
    """A copy of the body with one value changed."""
    new = copy.deepcopy(body)
    place = chance.choice(list(leaves(new)))
    value = at(new, place)
    if isinstance(value, bool):
        put(new, place, not value)
    elif isinstance(value, (int, float)):
        factor = chance.choice([0, -1, 0.1, 0.5, 1.1, 2, 3, 10, 1000])
        number = value * factor if value else chance.choice([1, 1e-6, 1e6])
        put(new, place, int(number) if isinstance(value, int) else number)
    elif isinstance(value, list):
        half = len(value) // 2
        put(new, place, value[:max(1, half)] if chance.random() < 0.5 else (value + value)[:2 * len(value)])
    elif isinstance(value, str):
        for choices in CHOICES:
            if value in choices:
                put(new, place, chance.choice(choices))
    if chance.random() < 0.1 and len(place) > 1 and isinstance(place[-1], str):
        at(new, place[:-1]).pop(place[-1])
    return new


class Search:
    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.server = ServerProcess(Path(tempfile.mkdtemp(prefix="supple_search_")) / "data", "--models", str(ROOT / "models"),
                                    "--max-request-memory", "1G")
        self.meshes: Meshes = {}
        self.tries = 0
        self.faults: List[str] = []

    def start(self) -> None:
        self.server.start()
        self.meshes = meshes_of(self._upload)

    def _upload(self, content: bytes) -> str:
        response = requests.post(self.server.url + "/v1/meshes", data=content, headers={"Content-Type": "model/ply"}, timeout=120)
        response.raise_for_status()
        return str(response.json()["id"])

    def cost(self, request: Costly) -> Cost:
        """Sends a request. If it exceeds a bound, it is sent again to a newly started server."""
        self.tries += 1
        reset_peak(self.server.pid)
        before = self.server.resident_bytes()
        connection = sent_request(self.server, request)
        answered = bool(select.select([connection], [], [], DEADLINE)[0])
        at_deadline = sum(cpu_seconds(self.server.pid).values())
        status = first_line(connection)
        late = max(0.0, sum(cpu_seconds(self.server.pid).values()) - at_deadline) / 2
        connection.close()
        if not self.server.running():
            return Cost("died", 0, late)
        return Cost(status[9:12], peak_bytes(self.server.pid) - before, 0.0 if answered else late)

    def judge(self, name: str, request: Costly, cost: Cost) -> None:
        if cost.status == "died" or cost.bytes > BOUND_BYTES or cost.late > BOUND_LATE or cost.status in ("500", ""):
            file = Path(tempfile.gettempdir()) / f"costly_{len(self.faults)}.json"
            file.write_bytes(request.body)
            self.faults.append(f"{name}: {cost.status}, {cost.bytes / 2**20:.0f} MiB, {cost.late:.2f} CPU seconds late: {file}")
            print(self.faults[-1], flush=True)
        if cost.status == "died":
            print(self.server.log_text()[-1000:])
            self.start()

    def climb(self, name: str, end: float) -> None:
        request = CASES[name](self.meshes, {"deadline": DEADLINE})
        if request.content_type != "application/json" or not request.body.startswith(b"{") or len(request.body) > 4_000_000:
            return
        best = self.cost(request)
        self.judge(name, request, best)
        first = best
        while time.monotonic() < end:
            body = changed(json.loads(request.body), self.chance)
            attempt = request._replace(body=json.dumps(body).encode())
            cost = self.cost(attempt)
            self.judge(name, attempt, cost)
            if cost.status != "died" and cost.worth() > best.worth() * 1.02:
                request, best = attempt, cost
        print(f"{name:42s} {first.bytes / 2**20:6.0f} -> {best.bytes / 2**20:6.0f} MiB, late {first.late:.2f} -> {best.late:.2f} s, "
              f"status {best.status}", flush=True)

    def run(self, names: List[str], minutes: float) -> None:
        self.start()
        share = 60 * minutes / len(names)
        for name in names:
            self.climb(name, time.monotonic() + share)
        self.server.stop()


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--operation", default="", help="only requests with this in their name or path")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    names = [name for name in sorted(CASES) if re.search(options.operation, name)
             and not name.startswith(("upload_", "repair_", "body_", "picture_of_many"))]
    search = Search(options.seed)
    search.run(names, options.minutes)
    print(f"{search.tries} requests, {len(search.faults)} beyond a bound")
    return 1 if search.faults else 0


if __name__ == "__main__":
    sys.exit(main())
