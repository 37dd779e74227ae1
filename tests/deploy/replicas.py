"""Three servers on one database behind a load balancer, while servers are killed, and during a rolling upgrade.

    python3 tests/deploy/replicas.py [--jobs 2000] [--kill-every 3] [--requests 3000] [--seed 1] [--output docs/bench]

In the first trial, clients submit jobs through HAProxy (deploy/haproxy.cfg), each with an Idempotency-Key, and submit a job
again whenever they got no answer. Every few seconds one of the servers is killed (SIGKILL), and started again a second later.
In the end each job must exist once, whichever servers its requests reached, and have the right result.

The second trial is a rolling upgrade: clients request immediate answers and submit jobs, and never repeat a request, while one
server after the other is terminated (SIGTERM, --drain) and started again. Every request must be answered.

The exit status is 1 if something was lost, duplicated or wrong. Requires Debian's packages postgresql-15 and haproxy.
"""

from __future__ import annotations

import argparse
import csv
import http.client
import json
import random
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from collections import Counter
from pathlib import Path
from typing import Any, Dict, List, Tuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / part) for part in ("api", "support", "hostile", "bench")]

from harness import free_port  # noqa: E402
from sections import write_section  # noqa: E402
from shared_servers import LEASE, Replicas  # noqa: E402
from shapes import sphere  # noqa: E402
from soak import without_bill  # noqa: E402

SERVERS = 3
DRAIN = 4
"""Seconds that a terminating server still answers: longer than the load balancer needs to notice it, also on a busy machine."""
CLIENTS = 6
KINDS = 24
"""Number of different jobs, whose right results are known."""


class Balancer:
    """HAProxy with the configuration of deploy/, in which addresses are replaced."""

    def __init__(self, folder: Path, servers: List[int]) -> None:
        self.port = free_port()
        text = (ROOT / "deploy" / "haproxy.cfg").read_text().replace("127.0.0.1:8080", f"127.0.0.1:{self.port}")
        for number, port in enumerate(servers):
            example = f"127.0.0.1:{8081 + number}"
            assert example in text
            text = text.replace(example, f"127.0.0.1:{port}")
        self.servers = len(servers)
        self.statistics = free_port()
        text += f"\nlisten statistics\n    mode http\n    bind 127.0.0.1:{self.statistics}\n    stats enable\n    stats uri /\n"
        file = folder / "haproxy.cfg"
        file.write_text(text)
        self.log = (folder / "haproxy.log").open("wb")
        self._process = subprocess.Popen(["haproxy", "-f", str(file)], stdout=self.log, stderr=subprocess.STDOUT)

    def wait_until_it_answers(self) -> None:
        end = time.monotonic() + 20
        while time.monotonic() < end:
            try:
                if ask(self.port, "GET", "/readyz")[0] == 200:
                    return
            except (OSError, http.client.HTTPException):
                pass
            time.sleep(0.05)
        raise RuntimeError("the load balancer does not answer")

    def wait_until_it_sends_to_all(self) -> None:
        """Waits until every server has passed the balancer's checks, which takes longer on a busy machine."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            rows = csv.DictReader(ask(self.statistics, "GET", "/;csv")[1].decode().removeprefix("# ").splitlines())
            up = sum(row["svname"] not in ("FRONTEND", "BACKEND") and row["status"].startswith("UP") for row in rows)
            if up == self.servers:
                return
            time.sleep(0.05)
        raise RuntimeError("the load balancer does not take all servers back")

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(20)
        self.log.close()


def ask(port: int, method: str, path: str, document: Any = None, headers: "Dict[str, str] | None" = None) -> Tuple[int, bytes]:
    """Sends one request over a new connection. Raises OSError or HTTPException if there is no answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    try:
        body = None if document is None else json.dumps(document).encode()
        sent = {"Content-Type": "application/json"} if body else {}
        connection.request(method, path, body, {**sent, **(headers or {})})
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


def until_answered(port: int, method: str, path: str, document: Any = None, headers: "Dict[str, str] | None" = None) -> Tuple[int, bytes]:
    """Repeats a request while there is no answer or a temporary refusal."""
    end = time.monotonic() + 120
    while True:
        try:
            status, content = ask(port, method, path, document, headers)
            if status not in (502, 503, 504) or time.monotonic() > end:
                return status, content
        except (OSError, http.client.HTTPException):
            if time.monotonic() > end:
                raise
        time.sleep(0.05)


class Trial:
    """The servers, the balancer, and counts of events."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.chance = random.Random(seed)
        self.replicas = Replicas(folder, SERVERS, "--workers", "1", "--drain", str(DRAIN), "--grace", "20", "--max-jobs", "100000",
                                 "--client-share", "1")
        self.replicas.start()
        self.balancer = Balancer(folder, [server.port for server in self.replicas.servers])
        self.balancer.wait_until_it_answers()
        self.port = self.balancer.port
        self.lock = threading.Lock()
        self.wrong: List[str] = []
        self.counts: "Counter[str]" = Counter()
        self.accepted: Dict[str, int] = {}
        vertices, faces = sphere(5)
        status, content = until_answered(self.port, "POST", "/v1/meshes", {"vertices": vertices.tolist(), "faces": faces.tolist()})
        assert status in (200, 201), content
        self.mesh = json.loads(content)["id"]
        self.vertices = len(vertices)
        self.known: List[Tuple[str, Any, bytes]] = []
        for number in range(KINDS):
            path, document = self.job(number)
            status, content = until_answered(self.port, "POST", path, document)
            assert status == 200, content
            self.known.append((path, document, without_bill(content)))

    def job(self, number: int) -> Tuple[str, Any]:
        stream = random.Random(number)
        points = [{"vertex": stream.randrange(self.vertices)} for _ in range(6)]
        if number % 3 == 0:
            return "/v1/geodesic-fields", {"mesh": self.mesh, "sources": points}
        if number % 3 == 1:
            return "/v1/karcher-means", {"mesh": self.mesh, "points": points, "tolerance": 1e-12}
        springs = [{"between": [k, k + 1]} for k in range(5)]
        return "/v1/embedded-systems", {"mesh": self.mesh, "points": points, "springs": springs, "fixed_points": [0, 5]}

    def close(self) -> None:
        self.balancer.close()
        self.replicas.close()

    def fault(self, text: str) -> None:
        with self.lock:
            self.wrong.append(text)

    def count(self, event: str) -> None:
        with self.lock:
            self.counts[event] += 1

    # --- kills -------------------------------------------------------------------------------------------------------

    def hand_in(self, number: int, jobs: int, seconds: float) -> None:
        """Submits `jobs` jobs, distributed over `seconds`."""
        stream = random.Random(100 + number)
        for _ in range(jobs):
            kind = stream.randrange(KINDS)
            path, document, _ = self.known[kind]
            headers = {"Prefer": "respond-async", "Idempotency-Key": uuid.uuid4().hex}
            end = time.monotonic() + 120
            while True:
                try:
                    status, content = ask(self.port, "POST", path, document, headers)
                except (OSError, http.client.HTTPException):
                    status, content = 0, b""
                if status == 202 or time.monotonic() > end:
                    break
                self.count("asked again" if status in (0, 502, 503, 504) else "other")
                time.sleep(0.05)
            if status != 202:
                self.fault(f"a job was refused: {status} {content[:200]!r}")
            else:
                with self.lock:
                    self.accepted[json.loads(content)["id"]] = kind
            time.sleep(seconds / jobs * 2 * stream.random())

    def kill(self, every: float, ended: threading.Event) -> None:
        while not ended.wait(every * (0.5 + self.chance.random())):
            server = self.chance.choice(self.replicas.servers)
            server.kill()
            self.count("killed")
            time.sleep(1)
            server.start()

    def kills(self, jobs: int, every: float) -> None:
        ended = threading.Event()
        killer = threading.Thread(target=self.kill, args=(every, ended))
        clients = [threading.Thread(target=self.hand_in, args=(n, jobs // CLIENTS + (n < jobs % CLIENTS), jobs / 20))
                   for n in range(CLIENTS)]
        killer.start()
        for client in clients:
            client.start()
        for client in clients:
            client.join()
        ended.set()
        killer.join()
        self.check_jobs()

    def check_jobs(self) -> None:
        """Checks that each accepted job exists once, was successful and has its result, and that there are no other jobs."""
        for job, kind in self.accepted.items():
            end = time.monotonic() + 300
            while True:
                status, content = until_answered(self.port, "GET", f"/v1/jobs/{job}")
                document = json.loads(content)
                if status != 200 or document["state"] not in ("accepted", "running") or time.monotonic() > end:
                    break
                time.sleep(0.05)
            if status != 200 or document["state"] != "successful":
                self.fault(f"job {job}: {status} {content[:300]!r}")
                continue
            status, content = until_answered(self.port, "GET", f"/v1/jobs/{job}/result")
            if status != 200 or without_bill(content) != self.known[kind][2]:
                self.fault(f"the result of job {job}: {status} {content[:200]!r}")
            self.count("jobs that ended with the right result")
        listed: List[str] = []
        after = ""
        while True:
            status, content = until_answered(self.port, "GET", f"/v1/jobs?limit=1000{after}")
            page = json.loads(content)
            listed += [job["id"] for job in page["jobs"]]
            if "next" not in page:
                break
            after = f"&after={page['next']}"
        doubled = len(listed) - len(set(listed))
        strangers = set(listed) - set(self.accepted)
        if doubled or strangers:
            self.fault(f"{doubled} jobs are listed twice, {len(strangers)} that nobody was told of")
        self.counts["run again"] = self.run_again()
        self.check_files(len(listed))

    def check_files(self, jobs: int) -> None:
        """Checks that each job has the result of its last lease, and that there are no other files except those that a killed server
        had half-written."""
        rights = set(self.query("SELECT id || '.' || hold || '.result' FROM jobs").split())
        end = time.monotonic() + 10
        while True:
            files = {file.name for file in (self.replicas.servers[0].data / "results").iterdir()}
            half_written = {name for name in files if name.endswith(".part")}
            missing, strangers = rights - files, files - rights - half_written
            if not strangers or time.monotonic() > end:
                break
            time.sleep(0.1)  # a server that learns that it has lost the lease of a job removes its late result
        if len(rights) != jobs or missing or strangers or len(half_written) > self.counts["killed"]:
            self.fault(f"{len(rights)} results of {jobs} jobs; missing {sorted(missing)[:5]}, of none {sorted(strangers)[:5]}, "
                       f"half-written {sorted(half_written)[:5]} after {self.counts['killed']} kills")
        self.counts["half-written"] = len(half_written)

    def run_again(self) -> int:
        """Number of jobs that were begun more than once because their server was killed."""
        return int(self.query("SELECT count(*) FROM jobs WHERE attempts > 1"))

    def query(self, statement: str) -> str:
        done = subprocess.run(["psql", "--no-align", "--tuples-only", f"--dbname={self.replicas.database}", f"--command={statement}"],
                              capture_output=True, text=True, check=True, timeout=60)
        return done.stdout

    # --- a rolling upgrade -------------------------------------------------------------------------------------------

    def ask_once(self, number: int, requests: int, ended: threading.Event) -> None:
        stream = random.Random(200 + number)
        asked = 0
        while asked < requests or not ended.is_set():
            asked += 1
            kind = stream.randrange(KINDS)
            path, document, right = self.known[kind]
            later = stream.random() < 0.2
            headers = {"Prefer": "respond-async", "Idempotency-Key": uuid.uuid4().hex} if later else {}
            try:
                status, content = ask(self.port, "POST", path, document, headers)
            except (OSError, http.client.HTTPException) as error:
                self.fault(f"no answer during the upgrade: {error!r}")
                continue
            if status != (202 if later else 200) or (not later and without_bill(content) != right):
                self.fault(f"during the upgrade: {status} {content[:200]!r}")
            elif later:
                with self.lock:
                    self.accepted[json.loads(content)["id"]] = kind
            self.count("requests during the upgrade")
            time.sleep(0.01 * stream.random())

    def upgrade(self, requests: int) -> None:
        self.counts["jobs that ended with the right result"] = 0
        ended = threading.Event()
        clients = [threading.Thread(target=self.ask_once, args=(n, requests // CLIENTS, ended)) for n in range(CLIENTS)]
        self.balancer.wait_until_it_sends_to_all()
        for client in clients:
            client.start()
        for server in self.replicas.servers:
            if server.terminate() != 0:
                self.fault("SIGTERM: another exit status than 0")
            server.start()
            self.balancer.wait_until_it_sends_to_all()
        ended.set()
        for client in clients:
            client.join()
        self.check_jobs()


REPORT = """## Several servers on one database

Written by `tests/deploy/replicas.py` in {minutes:.1f} minutes on 2 cores, which {servers} servers, their clients, HAProxy and PostgreSQL share.

**Kills.** {jobs:,} jobs were handed in through the load balancer while one of the servers was killed (SIGKILL) every {every:g} seconds or so, {killed} times
in all, and started again a second later. {cut_off} jobs ran when their server
was killed. The load balancer sent requests that met a lost server to another one; clients asked {again} times again themselves. {wrong_kills} jobs were lost, doubled or wrong: each
was there once, ended well and had the right result. {half_written} files were left that a killed server had half-written.

**A rolling upgrade.** Each server was ended (SIGTERM) and started again, one after the other, while clients sent {upgraded:,} requests, each only once.
{wrong_upgrade} requests were without the right answer.

A job whose server was killed runs again at another one after {lease} seconds, which is the `--lease` of this trial.
"""


def run(jobs: int, every: float, requests: int, seed: int) -> Tuple[Trial, Dict[str, int]]:
    """Both trials, and the number of faults in each by its name."""
    with tempfile.TemporaryDirectory(prefix="supple-replicas-") as name:
        trial = Trial(Path(name), seed)
        try:
            trial.kills(jobs, every)
            trial.counts["cut off"] = trial.counts["run again"]
            trial.counts["half-written after the kills"] = trial.counts["half-written"]
            wrong = {"kills": len(trial.wrong)}
            trial.upgrade(requests)
            wrong["upgrade"] = len(trial.wrong) - wrong["kills"]
        finally:
            trial.close()
    return trial, wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=2000)
    parser.add_argument("--kill-every", type=float, default=3)
    parser.add_argument("--requests", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    begin = time.monotonic()
    trial, wrong = run(given.jobs, given.kill_every, given.requests, given.seed)
    text = REPORT.format(minutes=(time.monotonic() - begin) / 60, servers=SERVERS, jobs=given.jobs, every=given.kill_every,
                         killed=trial.counts["killed"], again=trial.counts["asked again"], wrong_kills=wrong["kills"], cut_off=trial.counts["cut off"],
                         half_written=trial.counts["half-written after the kills"],
                         upgraded=trial.counts["requests during the upgrade"], wrong_upgrade=wrong["upgrade"], lease=LEASE)
    print(text)
    for fault in trial.wrong[:20]:
        print(fault)
    if given.output and not trial.wrong:
        write_section(given.output, "server", "replicas", text)
    return 1 if trial.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
