#!/usr/bin/python3
"""What a job and a mesh cost with a database of the server's own (SQLite), and with one that servers share (PostgreSQL).

    tests/bench/store_cost.py [--repeats 300] [--jobs 600] [--output docs/bench]

Starts one server with a database of its own, and one and three on a PostgreSQL of their own which waits for its disk as it
does by default (Debian's package postgresql-15). All are asked in turn, so that a slow moment meets all of them. Writes a
section of server.md. Clients, servers and database share the cores of the machine.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any, Callable, Dict, List, Tuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / part) for part in ("api", "support")]

from harness import ServerProcess  # noqa: E402
from sections import write_section  # noqa: E402
from server_load import percentile  # noqa: E402
from shapes import sphere  # noqa: E402
from shared_servers import Replicas  # noqa: E402

OPTIONS = ("--workers", "2", "--max-jobs", "100000", "--client-share", "1")
CLIENTS = 8
LATER = {"Prefer": "respond-async"}
LARGE = 4000
"""Pairs of points whose request is larger than those that a shared database holds itself."""


class Service:
    """One or more servers that know the same jobs, and the times that their answers took."""

    def __init__(self, name: str, servers: List[ServerProcess]) -> None:
        self.name = name
        self.connections = [http.client.HTTPConnection("127.0.0.1", server.port, timeout=60) for server in servers]
        self.ports = [server.port for server in servers]
        self.seconds: Dict[str, List[float]] = {}
        self.mesh = self.upload(0)

    def ask(self, method: str, path: str, document: Any = None, headers: "Dict[str, str] | None" = None) -> Any:
        return answer_on(self.connections[0], method, path, document, headers)

    def upload(self, number: int) -> str:
        vertices, faces = sphere(3)
        vertices = vertices * (1 + 0.001 * number)
        return str(self.ask("POST", "/v1/meshes", {"vertices": vertices.tolist(), "faces": faces.tolist()})["id"])

    def time(self, what: str, call: Callable[[], None]) -> None:
        start = time.perf_counter()
        call()
        self.seconds.setdefault(what, []).append(time.perf_counter() - start)

    def job(self, pairs: int = 1) -> Dict[str, Any]:
        pair = {"from": {"face": 0, "barycentric": [0.2, 0.3, 0.5]}, "to": {"face": 0, "barycentric": [0.5, 0.3, 0.2]}}
        return {"mesh": self.mesh, "pairs": [pair] * pairs}

    def hand_in_and_follow(self, what: str, pairs: int) -> None:
        """Hands a job in, waits for its end, and fetches its result."""
        request = self.job(pairs)
        start = time.perf_counter()
        job = self.ask("POST", "/v1/geodesics", request, LATER)["id"]
        self.seconds.setdefault(f"{what}, accepted", []).append(time.perf_counter() - start)
        while self.ask("GET", f"/v1/jobs/{job}")["state"] in ("accepted", "running"):
            pass
        self.ask("GET", f"/v1/jobs/{job}/result")
        self.seconds.setdefault(f"{what}, result fetched", []).append(time.perf_counter() - start)

    def one_round(self, number: int) -> None:
        self.time("immediate answer on a mesh", lambda: self.ask("POST", "/v1/geodesics", self.job()))
        self.hand_in_and_follow("small job", 1)
        if number % 10 == 0:
            self.hand_in_and_follow("job of a large request", LARGE)
            self.time("new mesh of 642 vertices", lambda: self.upload(1 + number) and None)

    def jobs_per_second(self, jobs: int) -> float:
        """From the first job that is handed in until the last has ended, by clients that hand in one after the other."""
        ids: List[str] = []
        lock = threading.Lock()
        request = self.job()

        def client(number: int) -> None:
            connection = http.client.HTTPConnection("127.0.0.1", self.ports[number % len(self.ports)], timeout=60)
            for _ in range(jobs // CLIENTS):
                job = answer_on(connection, "POST", "/v1/geodesics", request, LATER)["id"]
                with lock:
                    ids.append(job)
            connection.close()

        threads = [threading.Thread(target=client, args=(number,)) for number in range(CLIENTS)]
        start = time.perf_counter()
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        while any(self.ask("GET", f"/v1/jobs?state={state}&limit=1")["jobs"] for state in ("accepted", "running")):
            time.sleep(0.01)
        return len(ids) / (time.perf_counter() - start)


def answer_on(connection: http.client.HTTPConnection, method: str, path: str, document: Any = None,
              headers: "Dict[str, str] | None" = None) -> Any:
    body = None if document is None else json.dumps(document).encode()
    connection.request(method, path, body, {"Content-Type": "application/json", **(headers or {})})
    answer = connection.getresponse()
    content = answer.read()
    if answer.status not in (200, 201, 202):
        raise RuntimeError(f"{method} {path}: {answer.status} {content[:300]!r}")
    return json.loads(content)


REPORT = """## What a shared database costs

Written by `tests/bench/store_cost.py` on 2 cores, which clients, servers and PostgreSQL share; PostgreSQL waits for its disk (`fsync`) as it does by
default. Milliseconds at a client with one connection, the median and in 99 of 100 cases; all were asked in turn.

{times}

{clients} clients that hand in small jobs as fast as they can, until all have ended, with two workers for each server:

{rates}

An immediate answer needs the database only to learn, once a second, whether its mesh is still there. A job that is accepted has been written to the
database before its 202 is sent, with either store, and its result before it is called successful.
"""


def table(header: List[str], rows: List[List[str]]) -> str:
    lines = [header, ["---"] + ["--:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def report(services: List[Service], rates: List[Tuple[str, float]]) -> str:
    def cell(values: List[float]) -> str:
        return f"{1e3 * percentile(values, 0.5):.2f} ({1e3 * percentile(values, 0.99):.1f})"

    rows = [[what, *(cell(service.seconds[what]) for service in services)] for what in services[0].seconds]
    return REPORT.format(times=table(["", *(service.name for service in services)], rows), clients=CLIENTS,
                         rates=table(["Store", "Jobs a second"], [[name, f"{rate:.0f}"] for name, rate in rates]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=600)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "bench")
    given = parser.parse_args()
    os.environ["PRIVATE_POSTGRES_OPTIONS"] = "-c fsync=on"
    with tempfile.TemporaryDirectory(prefix="supple-stores-") as name:
        folder = Path(name)
        alone = ServerProcess(folder / "own", *OPTIONS).start()
        folders = [folder / "one", folder / "three"]
        for place in folders:
            place.mkdir()
        groups = [Replicas(place, count, *OPTIONS) for place, count in zip(folders, (1, 3))]
        try:
            for group in groups:
                group.start()
            services = [Service("SQLite", [alone]), Service("PostgreSQL, one server", groups[0].servers),
                        Service("PostgreSQL, three servers", groups[1].servers)]
            for number in range(given.repeats):
                for service in services:
                    service.one_round(number)
            rates = [(service.name, service.jobs_per_second(given.jobs)) for service in services]
        finally:
            alone.stop()
            for group in groups:
                group.close()
    text = report(services, rates)
    print(text)
    write_section(given.output, "server", "stores", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
