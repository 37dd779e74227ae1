"""Mixed requests and jobs for a long time, while everything around the server fails.

    python3 tests/hostile/soak.py [--requests 200000] [--jobs 2000] [--fault-every 2] [--seed 1] [--output docs/bench]

The first phase has faults. Every few seconds the server is killed (SIGKILL) or terminated (SIGTERM) and started again, its
disk is full for a second, a stored file is damaged, or it starts with a clock that has jumped by eight days. Meanwhile
slow clients send halves of requests, and others disconnect before their answers. Every answer is compared with the answer
to the same request before the faults began. In the end every accepted job must exist, once, with the right result.

The second phase is calm: as many requests again, during which memory must not grow; and paced requests, which must be
answered in time while long jobs occupy the workers.

The exit status is 1 if something was lost, duplicated or wrong. Mounting a small disk requires root, and jumps of the clock
`faketime` (Debian's package); without them these faults are omitted, and the report says so.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Set, Tuple

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "api"), str(Path(__file__).resolve().parents[1] / "bench")]

from harness import ROOT, SANITIZED, ServerProcess  # noqa: E402
from sections import write_section  # noqa: E402
from server_load import MIX, Workload, percentile  # noqa: E402
from shapes import flat_grid  # noqa: E402

DISK = "192m"
GOES_ON = {429, 503, 507}
"""Status codes that the server may temporarily answer with: it is busy, starts, terminates, or its disk is full."""
FLAT = 1.05
P99 = 0.05
"""Seconds within which 99 of 100 paced requests must be answered while long jobs run."""
PACED_PER_SECOND = 40


class Sent(NamedTuple):
    method: str
    path: str
    body: Optional[bytes]
    headers: Dict[str, str]


class Known(NamedTuple):
    """A request and its right answer."""

    request: Sent
    status: int
    answer: bytes


def without_bill(content: bytes) -> bytes:
    """The answer without values that differ between runs: seconds and identifiers."""
    try:
        document = json.loads(content)
    except ValueError:
        return content

    def strip(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: strip(inner) for key, inner in value.items()
                    if key not in ("cost", "seconds", "request_id", "instance", "uptime_seconds",
                                   "silence_seconds")}
        return [strip(inner) for inner in value] if isinstance(value, list) else value

    return json.dumps(strip(document), sort_keys=True).encode()


class Client:
    """A persistent connection, which is opened again whenever it was closed."""

    def __init__(self, port: int) -> None:
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)

    def once(self, sent: Sent) -> Tuple[int, bytes, Any]:
        """Status, content and headers of the answer. Raises OSError or HTTPException if the connection was closed."""
        try:
            self._connection.request(sent.method, sent.path, sent.body, sent.headers)
            answer = self._connection.getresponse()
            return answer.status, answer.read(), answer.headers
        except (OSError, http.client.HTTPException):
            self._connection.close()
            raise

    def until_answered(self, sent: Sent, seconds: float = 120) -> Tuple[int, bytes, Any]:
        """Repeats the request while the server is down or answers with one of GOES_ON."""
        end = time.monotonic() + seconds
        while True:
            try:
                status, content, headers = self.once(sent)
                if status not in GOES_ON or time.monotonic() > end:
                    return status, content, headers
            except (OSError, http.client.HTTPException):
                if time.monotonic() > end:
                    raise
            time.sleep(0.02)


class Counts:
    """Counts of events, and descriptions of faults."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.events: "Counter[str]" = Counter()
        self.wrong: List[str] = []

    def add(self, event: str, number: int = 1) -> None:
        with self.lock:
            self.events[event] += number

    def fault(self, text: str) -> None:
        with self.lock:
            self.wrong.append(text)


class Soak:
    def __init__(self, folder: Path, seed: int) -> None:
        self.folder = folder
        self.chance = random.Random(seed)
        self.counts = Counts()
        self.data = folder / "data"
        self.data.mkdir()
        self.mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK}", "tmpfs", str(self.data)],
                                      capture_output=True, check=False).returncode == 0
        self.clock = next(iter(sorted(Path("/usr/lib").glob("*/faketime/libfaketime.so.1"))), None)
        self.server = ServerProcess(self.data, "--workers", "2", "--max-jobs", "100000").start()
        self.workload = Workload(self.server)
        self.known: List[Known] = []
        self.known_jobs: List[Known] = []
        self.accepted: Dict[str, Known] = {}
        self.perhaps = 0
        self.ending = threading.Event()
        self.enough_faults = threading.Event()

    def close(self) -> None:
        self.server.stop()
        if self.mounted:
            subprocess.run(["umount", "--lazy", str(self.data)], check=False)

    # --- what is right -----------------------------------------------------------------------------------------------

    def learn(self, requests: int, jobs: int) -> None:
        """Records the answers of a healthy server, with which later answers are compared."""
        client = Client(self.server.port)
        stream = random.Random(self.chance.random())
        names, weights = [kind.name for kind in MIX if kind.name != "health"], [kind.weight for kind in MIX if kind.name != "health"]
        for _ in range(requests):
            sent = Sent(*self.workload.request(stream.choices(names, weights)[0], stream))
            status, content, _ = client.until_answered(sent)
            self.known.append(Known(sent, status, without_bill(content)))
        for i in range(jobs):
            points = [{"vertex": stream.randrange(self.workload.vertex_count)} for _ in range(6)]
            document: Dict[str, Any] = {"mesh": self.workload.sphere, "sources": points}
            path = "/v1/geodesic-fields"
            if i % 3 == 1:
                document, path = {"mesh": self.workload.sphere, "points": points, "tolerance": 1e-12}, "/v1/karcher-means"
            if i % 3 == 2:
                document = {"mesh": self.workload.sphere, "points": points, "springs": [{"between": [k, k + 1]} for k in range(5)],
                            "fixed_points": [0, 5]}
                path = "/v1/embedded-systems"
            sent = Sent("POST", path, json.dumps(document).encode(), {"Content-Type": "application/json", "Accept": "application/json"})
            status, content, _ = client.until_answered(sent)
            self.known_jobs.append(Known(sent, status, without_bill(content)))

    # --- clients -----------------------------------------------------------------------------------------------------

    def ask(self, number: int, count: int) -> None:
        """Sends `count` requests, and more while the faults continue."""
        client, stream = Client(self.server.port), random.Random(number)
        asked = 0
        while asked < count or not self.enough_faults.is_set():
            asked += 1
            known = stream.choice(self.known)
            try:
                status, content, _ = client.until_answered(known.request)
            except (OSError, http.client.HTTPException) as error:
                self.counts.fault(f"no answer for two minutes: {error!r}")
                continue
            self.counts.add("answers")
            if status != known.status or without_bill(content) != known.answer:
                self.counts.fault(f"{known.request.method} {known.request.path}: {status} {content[:200]!r}")

    def submit(self, number: int, count: int) -> None:
        """Submits jobs, twenty at a time, so that some wait whenever the server is killed. Their results are checked in the end."""
        client, stream = Client(self.server.port), random.Random(1000 + number)
        left = count
        while left > 0:
            if left % 20 == 0:
                time.sleep(2 * stream.random())
            known = stream.choice(self.known_jobs)
            sent = known.request._replace(headers={**known.request.headers, "Prefer": "respond-async"})
            try:
                status, content, _ = client.once(sent)
            except (OSError, http.client.HTTPException):
                with self.counts.lock:
                    self.perhaps += 1  # the server may have accepted the job although no answer came
                time.sleep(0.05)
                continue
            if status == 202:
                with self.counts.lock:
                    self.accepted[json.loads(content)["id"]] = known
                left -= 1
            elif status not in GOES_ON:
                self.counts.fault(f"a job was refused: {status} {content[:200]!r}")
                left -= 1
            else:
                time.sleep(0.05)

    def vanish(self, number: int) -> None:
        """Sends half a request, or a whole one without waiting for its answer."""
        stream = random.Random(2000 + number)
        while not self.ending.wait(0.02):
            known = stream.choice(self.known)
            body = known.request.body or b""
            text = (f"{known.request.method} {known.request.path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                    f"Content-Length: {len(body)}\r\n\r\n").encode() + body
            try:
                with socket.create_connection(("127.0.0.1", self.server.port), timeout=5) as connection:
                    connection.sendall(text if stream.random() < 0.5 else text[:stream.randrange(1, len(text))])
                    if stream.random() < 0.3:
                        time.sleep(stream.random())
                self.counts.add("clients that left")
            except OSError:
                pass

    # --- faults ------------------------------------------------------------------------------------------------------

    def restart(self, prefix: "Tuple[str, ...]" = ()) -> None:
        self.server.prefix = prefix
        self.server.start()

    def kinds(self) -> List[str]:
        """The kinds of faults in a random order, of which kills are the most frequent."""
        kinds = ["kill", "kill", "kill", "end", "damage"] + ["full disk"] * self.mounted + ["clock"] * bool(self.clock)
        self.chance.shuffle(kinds)
        return kinds

    def break_something(self, kind: str) -> None:
        self.counts.add(kind)
        if kind == "full disk":
            self.fill_disk()
        elif kind == "damage":
            self.damage()
        elif kind == "end":
            if self.server.terminate() != 0:
                self.counts.fault("SIGTERM: another exit status than 0")
            self.restart()
        else:
            self.server.kill()
            self.restart(("env", f"LD_PRELOAD={self.clock}", "FAKETIME=+8d", "DONT_FAKE_MONOTONIC=1") if kind == "clock" else ())

    def fill_disk(self) -> None:
        ballast = self.data / "ballast"
        with ballast.open("wb") as file:
            space = os.statvfs(self.data)
            try:
                os.posix_fallocate(file.fileno(), 0, max(1, space.f_bavail * space.f_frsize))
            except OSError:
                pass  # the server took the last free space
        time.sleep(1)
        ballast.unlink()

    def damage(self) -> None:
        """Stores a new mesh, flips a byte of its file, and expects that the server reports it."""
        client = Client(self.server.port)
        vertices, faces = flat_grid(3)
        vertices = vertices + self.chance.random()
        sent = Sent("POST", "/v1/meshes", json.dumps({"vertices": vertices.tolist(), "faces": faces.tolist()}).encode(),
                    {"Content-Type": "application/json"})
        status, content, _ = client.until_answered(sent)
        if status not in (200, 201):
            self.counts.fault(f"a mesh was refused: {status} {content[:200]!r}")
            return
        mesh = json.loads(content)["id"]
        file = next(self.data.rglob(f"{mesh}*.ply"))
        file.chmod(0o600)
        bytes_of_file = bytearray(file.read_bytes())
        bytes_of_file[-3] ^= 0x10
        file.write_bytes(bytes_of_file)
        status, content, _ = client.until_answered(Sent("GET", f"/v1/meshes/{mesh}/content", None, {}))
        if status != 500 or b"store.corrupted" not in content:
            self.counts.fault(f"a damaged mesh was answered with {status} {content[:200]!r}")

    # --- phases ------------------------------------------------------------------------------------------------------

    def faults(self, requests: int, jobs: int, every: float, clients: int = 8) -> None:
        threads = [threading.Thread(target=self.ask, args=(n, requests // clients)) for n in range(clients)]
        threads += [threading.Thread(target=self.submit, args=(n, jobs // 2)) for n in range(2)]
        leavers = [threading.Thread(target=self.vanish, args=(n,)) for n in range(2)]
        for thread in threads + leavers:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            for kind in self.kinds():
                time.sleep(every * (0.5 + self.chance.random()))
                self.break_something(kind)
            self.enough_faults.set()
        self.ending.set()
        for thread in leavers:
            thread.join()
        self.check_jobs()

    def check_jobs(self) -> None:
        client = Client(self.server.port)
        for job, known in self.accepted.items():
            end = time.monotonic() + 300
            while True:
                status, content, _ = client.until_answered(Sent("GET", f"/v1/jobs/{job}", None, {}))
                document = json.loads(content) if status == 200 else {}
                if status != 200 or document["state"] not in ("accepted", "running") or time.monotonic() > end:
                    break
                time.sleep(0.05)
            if status != 200 or document["state"] != "successful":
                error = document.get("error", {}).get("code")
                # A job that failed because of the full disk says so, and is neither lost nor wrong.
                if error == "store.full":
                    self.counts.add("jobs that met the full disk")
                else:
                    self.counts.fault(f"job {job}: {status} {document.get('state')} {error}")
                continue
            status, content, _ = client.until_answered(Sent("GET", f"/v1/jobs/{job}/result", None, {}))
            self.counts.add("jobs")
            if status != 200 or without_bill(content) != known.answer:
                self.counts.fault(f"the result of job {job}: {status} {content[:200]!r}")
        listed = self.all_jobs(client)
        lost = set(self.accepted) - listed
        if lost:
            self.counts.fault(f"{len(lost)} jobs are in no list")
        if len(listed) > len(self.accepted) + self.perhaps:
            self.counts.fault(f"{len(listed)} jobs are listed, {len(self.accepted)} were accepted and {self.perhaps} perhaps")

    @staticmethod
    def all_jobs(client: Client) -> Set[str]:
        found: Set[str] = set()
        after = ""
        while True:
            _, content, _ = client.until_answered(Sent("GET", f"/v1/jobs?limit=1000{after}", None, {}))
            page = [job["id"] for job in json.loads(content)["jobs"]]
            found.update(page)
            if len(page) < 1000:
                return found
            after = f"&after={page[-1]}"

    def calm(self, requests: int, clients: int = 4) -> Dict[str, float]:
        """Measures memory during many requests, and then times paced requests while two long jobs occupy the workers."""
        self.restart_calmly()
        client = Client(self.server.port)
        half = requests // 2
        memory: List[int] = []
        for part in range(2):
            threads = [threading.Thread(target=self.ask, args=(3000 + 10 * part + n, half // clients)) for n in range(clients)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            memory.append(self.server.resident_bytes())
        long_job = {"weave": {"pattern": "interlacing_circles", "type": 2}, "directions": 10_000, "strain": 0.2, "deadline": 3600,
                    "accuracy": {"segments": 64, "tolerance": 1e-12, "load_steps": 10_000}}
        jobs, latencies = [], []
        for _ in range(2):
            status, content, _ = client.until_answered(Sent("POST", "/v1/weave-homogenizations", json.dumps(long_job).encode(),
                                                            {"Content-Type": "application/json", "Prefer": "respond-async"}))
            jobs.append(json.loads(content)["id"])
        paced = [known for known in self.known if known.status == 200 and "geodesics" in known.request.path]
        for i in range(min(2000, max(100, requests // 10))):
            start = time.perf_counter()
            client.until_answered(paced[i % len(paced)].request)
            latencies.append(time.perf_counter() - start)
            time.sleep(max(0.0, 1 / PACED_PER_SECOND - latencies[-1]))
        running = [json.loads(client.until_answered(Sent("GET", f"/v1/jobs/{job}", None, {}))[1])["state"] for job in jobs]
        for job in jobs:
            client.until_answered(Sent("DELETE", f"/v1/jobs/{job}", None, {}))
        if running != ["running", "running"]:
            self.counts.fault(f"the long jobs did not run all the while: {running}")
        measured = {"memory_first": memory[0], "memory_last": memory[1], "median": percentile(latencies, 0.5), "p99": percentile(latencies, 0.99)}
        if not SANITIZED and memory[1] > FLAT * memory[0]:
            self.counts.fault(f"memory grew from {memory[0]} to {memory[1]} bytes")
        return measured

    def restart_calmly(self) -> None:
        self.server.terminate()
        self.restart()


def run(requests: int, jobs: int, every: float, seed: int) -> "Tuple[Soak, Dict[str, float]]":
    with tempfile.TemporaryDirectory(prefix="supple_soak_") as folder:
        soak = Soak(Path(folder), seed)
        try:
            soak.learn(300, 30)
            soak.faults(requests // 2, jobs, every)
            measured = soak.calm(requests // 2)
        finally:
            soak.close()
    return soak, measured


def report(soak: Soak, measured: Dict[str, float], seconds: float) -> str:
    events = soak.counts.events
    mebi = 2**20
    lines = [
        "## While everything around it fails", "",
        f"Written by `tests/hostile/soak.py` in {seconds / 60:.1f} minutes on {os.cpu_count()} cores, which the server and its clients share.", "",
        f"{events['answers']:,} answers and {events['jobs']:,} jobs were compared with those of a sound server; {len(soak.counts.wrong)} were lost, "
        "doubled or wrong.", "", "| what happened | times |", "|---|---:|"]
    names = {"kill": "SIGKILL and a new start", "end": "SIGTERM and a new start", "clock": "SIGKILL and a start eight days later by the clock",
             "full disk": "The disk was full for a second", "damage": "A stored mesh was damaged, and said to be",
             "clients that left": "A client left before its answer, or in the middle of its request",
             "jobs that met the full disk": "A job ended while the disk was full, and said so"}
    lines += [f"| {text} | {events[name]:,} |" for name, text in names.items()]
    lines += ["", f"Without faults: resident memory was {measured['memory_first'] / mebi:.1f} MiB after half of the "
              f"requests and {measured['memory_last'] / mebi:.1f} MiB at the end. While two long jobs kept both workers busy a geodesic, {PACED_PER_SECOND} a second, was answered within "
              f"{1e3 * measured['median']:.1f} ms in the median and {1e3 * measured['p99']:.1f} ms in 99 of 100 cases.", ""]
    if not soak.mounted:
        lines.append("No disk could be mounted, so that none was full.")
    if not soak.clock:
        lines.append("faketime is not installed, so that no clock jumped.")
    return "\n".join(lines)


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--requests", type=int, default=200_000)
    parser.add_argument("--jobs", type=int, default=2_000)
    parser.add_argument("--fault-every", type=float, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "bench")
    options = parser.parse_args(arguments)
    start = time.monotonic()
    soak, measured = run(options.requests, options.jobs, options.fault_every, options.seed)
    text = report(soak, measured, time.monotonic() - start)
    print(text)
    write_section(options.output, "server", "soak", text)
    for wrong in soak.counts.wrong[:20]:
        print(wrong, file=sys.stderr)
    if measured["p99"] > P99:
        print(f"99 of 100 paced requests took up to {measured['p99']:.3f} s, more than {P99} s", file=sys.stderr)
    return 1 if soak.counts.wrong or measured["p99"] > P99 else 0


if __name__ == "__main__":
    sys.exit(main())
