#!/usr/bin/python3
"""The server under load: what an immediate answer costs on top of its computation, and many connections for long.

    tests/bench/server_load.py [--requests 20000] [--connections 64] [--output docs/bench]

Starts a server of its own (SUPPLE_BUILD, default build/release), measures, and writes a section of server.md and server.csv. The
clients run on the same machine and share its cores with the server.
"""

from __future__ import annotations

import argparse
import csv
import http.client
import json
import os
import platform
import random
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from harness import ROOT, ServerProcess  # noqa: E402
from sections import write_section  # noqa: E402
from shapes import sphere, two_triangles_apart  # noqa: E402

JSON = "application/json"
WARM_UP = 200


class Kind(NamedTuple):
    """One kind of request of the mix, its weight, and the statuses that are right."""

    name: str
    weight: int
    statuses: Tuple[int, ...]


MIX = [
    Kind("geodesic, near pair", 30, (200,)),
    Kind("geodesic, far pair, path and derivatives", 20, (200,)),
    Kind("geodesic, unreachable pair", 5, (200,)),
    Kind("field, float64", 8, (200,)),
    Kind("field, JSON", 2, (200,)),
    Kind("Karcher mean, five points", 5, (200,)),
    Kind("exponential map", 10, (200,)),
    Kind("mesh report, ETag", 8, (304,)),
    Kind("health", 5, (200,)),
    Kind("truncated body", 3, (400,)),
    Kind("point outside its face", 4, (422,)),
]


class Workload:
    """Builds requests of each kind over the meshes of one server."""

    def __init__(self, server: ServerProcess) -> None:
        self.connection_target = ("127.0.0.1", server.port)
        vertices, faces = sphere(3)
        self.face_count = len(faces)
        self.vertex_count = len(vertices)
        self.sphere, self.etag = self._upload(vertices, faces)
        self.apart, _ = self._upload(*two_triangles_apart())

    def connect(self) -> http.client.HTTPConnection:
        return http.client.HTTPConnection(*self.connection_target, timeout=60)

    def _upload(self, vertices: Any, faces: Any) -> Tuple[str, str]:
        connection = self.connect()
        body = json.dumps({"vertices": vertices.tolist(), "faces": faces.tolist()})
        connection.request("POST", "/v1/meshes", body, {"Content-Type": JSON})
        answer = connection.getresponse()
        document = json.loads(answer.read())
        connection.request("GET", f"/v1/meshes/{document['id']}")
        shown = connection.getresponse()
        shown.read()
        connection.close()
        return document["id"], shown.headers["ETag"]

    def request(self, kind: str, stream: random.Random) -> Tuple[str, str, Optional[bytes], Dict[str, str]]:
        """(method, path, body, headers)."""

        def point() -> Dict[str, Any]:
            a, b = sorted((stream.random(), stream.random()))
            return {"face": stream.randrange(self.face_count), "barycentric": [a, b - a, 1 - b]}

        def post(path: str, document: Any, accept: str = JSON) -> Tuple[str, str, bytes, Dict[str, str]]:
            return "POST", path, json.dumps(document).encode(), {"Content-Type": JSON, "Accept": accept}

        if kind == "geodesic, near pair":
            face = stream.randrange(self.face_count)
            ends = [{"face": face, "barycentric": [0.2, 0.3, 0.5]}, {"face": face, "barycentric": [0.5, 0.3, 0.2]}]
            return post("/v1/geodesics", {"mesh": self.sphere, "pairs": [{"from": ends[0], "to": ends[1]}]})
        if kind.startswith("geodesic, far"):
            return post("/v1/geodesics", {"mesh": self.sphere, "pairs": [{"from": point(), "to": point()}],
                                          "derivatives": 2, "paths": True})
        if kind.startswith("geodesic, unreachable"):
            return post("/v1/geodesics", {"mesh": self.apart, "pairs": [{"from": {"vertex": 0}, "to": {"vertex": 4}}]})
        if kind.startswith("field"):
            accept = "application/octet-stream" if kind.endswith("float64") else JSON
            return post("/v1/geodesic-fields", {"mesh": self.sphere, "sources": [point()]}, accept)
        if kind.startswith("Karcher"):
            return post("/v1/karcher-means", {"mesh": self.sphere, "points": [point() for _ in range(5)]})
        if kind == "exponential map":
            tangent = [stream.uniform(-1, 1) for _ in range(3)]
            return post("/v1/exponential-maps", {"mesh": self.sphere, "start": point(), "tangent": tangent})
        if kind.startswith("mesh report"):
            return "GET", f"/v1/meshes/{self.sphere}", None, {"If-None-Match": self.etag}
        if kind == "health":
            return "GET", "/healthz", None, {}
        if kind == "truncated body":
            return "POST", "/v1/geodesics", b'{"mesh": "', {"Content-Type": JSON}
        outside = {"face": 0, "barycentric": [2.0, -1.0, 0.0]}
        return post("/v1/geodesics", {"mesh": self.sphere, "pairs": [{"from": outside, "to": {"vertex": 0}}]})


def percentile(values: List[float], fraction: float) -> float:
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(fraction * len(ordered)))]


def measure_overhead(workload: Workload, repeats: int) -> Dict[str, float]:
    """Seconds that a near pair takes at the client beyond what its bill says it took to compute, one connection."""
    stream = random.Random(1)
    connection = workload.connect()
    overheads, totals = [], []
    for i in range(repeats + WARM_UP):
        method, path, body, headers = workload.request("geodesic, near pair", stream)
        start = time.perf_counter()
        connection.request(method, path, body, headers)
        content = connection.getresponse().read()
        elapsed = time.perf_counter() - start
        if i >= WARM_UP:
            totals.append(elapsed)
            overheads.append(elapsed - computed_seconds(json.loads(content)))
    connection.close()
    return {"median": percentile(overheads, 0.5), "p99": percentile(overheads, 0.99), "total": percentile(totals, 0.5)}


def computed_seconds(answer: Dict[str, Any]) -> float:
    return float(answer["cost"]["seconds"])


class Load:
    """Sends the mix over many connections and records every latency."""

    def __init__(self, workload: Workload, requests: int) -> None:
        self._workload = workload
        self._lock = threading.Lock()
        self._left = requests
        self.latencies: Dict[str, List[float]] = {kind.name: [] for kind in MIX}
        self.failures: List[str] = []
        self.done = 0

    def _take(self) -> bool:
        with self._lock:
            self._left -= 1
            return self._left >= 0

    def _connection(self, number: int) -> None:
        stream = random.Random(number)
        names = [kind.name for kind in MIX]
        weights = [kind.weight for kind in MIX]
        allowed = {kind.name: kind.statuses for kind in MIX}
        connection = self._workload.connect()
        while self._take():
            kind = stream.choices(names, weights)[0]
            method, path, body, headers = self._workload.request(kind, stream)
            start = time.perf_counter()
            failure = None
            try:
                connection.request(method, path, body, headers)
                answer = connection.getresponse()
                content = answer.read()
                if answer.status not in allowed[kind]:
                    failure = f"{kind}: {answer.status} {content[:200]!r}"
            except (OSError, http.client.HTTPException) as error:
                failure = f"{kind}: {error!r}"
                connection.close()
            elapsed = time.perf_counter() - start
            with self._lock:
                self.done += 1
                self.latencies[kind].append(elapsed)
                if failure:
                    self.failures.append(failure)
        connection.close()

    def run(self, connections: int, server: ServerProcess) -> Tuple[float, List[Tuple[int, int]]]:
        """(seconds, [(requests done, resident bytes of the server)])."""
        threads = [threading.Thread(target=self._connection, args=(n,)) for n in range(connections)]
        start = time.perf_counter()
        for thread in threads:
            thread.start()
        memory = []
        while any(thread.is_alive() for thread in threads):
            memory.append((self.done, server.resident_bytes()))
            time.sleep(0.25)
        memory.append((self.done, server.resident_bytes()))
        return time.perf_counter() - start, memory


def memory_at(memory: List[Tuple[int, int]], fraction: float) -> int:
    """The server's memory once this fraction of the requests was done."""
    total = memory[-1][0]
    return next(resident for done, resident in memory if done >= fraction * total)


def report(load: Load, seconds: float, memory: List[Tuple[int, int]], overhead: Dict[str, float],
           arguments: argparse.Namespace) -> str:
    mebi = 1024 * 1024
    growth = memory_at(memory, 1.0) - memory_at(memory, 0.25)
    lines = [
        "## Under load", "",
        f"Written by `tests/bench/server_load.py` on {os.cpu_count()} cores ({platform.machine()}), which the server and "
        "the clients share.", "",
        "### An immediate answer", "",
        "A geodesic within one face over one kept connection; the overhead is the time at the client less the time that "
        "the answer's bill reports for the computation.", "",
        "| overhead, median | overhead, 99 % | whole answer, median |", "|---|---|---|",
        f"| {1e3 * overhead['median']:.3f} ms | {1e3 * overhead['p99']:.3f} ms | {1e3 * overhead['total']:.3f} ms |", "",
        f"### {arguments.requests:,} mixed requests over {arguments.connections} connections", "",
        f"{load.done:,} answers in {seconds:.1f} s ({load.done / seconds:.0f} per second); {len(load.failures)} wrong. The "
        f"server's resident memory was {memory_at(memory, 0.25) / mebi:.1f} MiB after a quarter of the requests and "
        f"{memory_at(memory, 1.0) / mebi:.1f} MiB at the end ({growth / mebi:+.1f} MiB).", "",
        "| request | number | median, ms | 99 %, ms | slowest, ms |", "|---|---|---|---|---|",
    ]
    for name, values in load.latencies.items():
        if values:
            lines.append(f"| {name} | {len(values):,} | {1e3 * percentile(values, 0.5):.1f} | "
                         f"{1e3 * percentile(values, 0.99):.1f} | {1e3 * max(values):.1f} |")
    lines += ["", "The times include waiting: with every connection busy at once, a request waits for those before it.", ""]
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--requests", type=int, default=20_000)
    parser.add_argument("--connections", type=int, default=64)
    parser.add_argument("--overhead-repeats", type=int, default=2_000)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "bench")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        server = ServerProcess(Path(folder) / "data").start()
        try:
            workload = Workload(server)
            overhead = measure_overhead(workload, arguments.overhead_repeats)
            load = Load(workload, arguments.requests)
            seconds, memory = load.run(arguments.connections, server)
        finally:
            server.stop()
    text = report(load, seconds, memory, overhead, arguments)
    print(text)
    write_section(arguments.output, "server", "load", text)
    with (arguments.output / "server.csv").open("w", newline="", encoding="utf-8") as table:
        writer = csv.writer(table)
        writer.writerow(["requests_done", "resident_bytes"])
        writer.writerows(memory)
    for failure in load.failures[:10]:
        print(failure, file=sys.stderr)
    return 1 if load.failures else 0


if __name__ == "__main__":
    sys.exit(main())
