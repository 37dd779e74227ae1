"""A real server process, and a client that checks all its traffic against the contract."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence

import pytest
import requests

from contract import Contract, ROOT, strict_json
from shapes import obj_text
from working_time import PATIENCE_SECONDS

BUILD = Path(os.environ.get("SUPPLE_BUILD", ROOT / "build" / "release"))
SERVER = Path(os.environ.get("SUPPLE_TEST_SERVER", BUILD / "server" / "supple-server"))
"""SUPPLE_TEST_SERVER names another program, which must replace itself by the server, for example that of an image."""
CLI = BUILD / "clients" / "cli" / "supple"
MODEL_MAKER = BUILD / "tests" / "support" / "make_test_model"
MESHES = ROOT / "api" / "examples" / "meshes"
SLOWNESS = float(os.environ.get("SUPPLE_TEST_SLOWNESS", "1"))
"""Ratio of the durations of the server of SUPPLE_BUILD to those of an optimized one: 40 under the sanitizers."""
SANITIZED = os.environ.get("SUPPLE_TEST_SANITIZED") == "1"
"""Whether the server of SUPPLE_BUILD runs under the address sanitizer, which changes the use of memory and the end of the process."""
START_SECONDS = 300.0 * SLOWNESS
STOP_SECONDS = 300.0 * SLOWNESS
"""Time limits that are long enough for a busy machine, and still detect a server that hangs."""
FINDINGS = ("ERROR: AddressSanitizer", "ERROR: LeakSanitizer", "runtime error:", "s of work without a look")
"""Texts in the log by which sanitizers and builds with SUPPLE_CHECK_PACE report faults of the server or of a helper process."""


def _has_terminals() -> bool:
    try:
        for end in os.openpty():
            os.close(end)
        return True
    except OSError:
        return False


needs_terminals = pytest.mark.skipif(not _has_terminals(), reason="this machine has no pseudo-terminals (/dev/pts)")
"""Marks tests in which a program has a terminal."""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def make_model(path: Path, model_id: str = "ih21", seed: int = 1, gain: float = 1, family: str = "") -> Path:
    """Creates a model with random weights, whose file appears atomically. It has two parameters, those of IH21.

    `gain` multiplies the last layer's weights: with 1e160 every energy overflows except that at rest. With `family` it is of a family
    of this id, whose definition it has: that of IH21.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([str(MODEL_MAKER), str(path), model_id, str(seed), repr(gain), *([family] if family else [])], check=True, timeout=60)
    return path


class ServerProcess:
    """A supple-server on a free port, with a data folder that remains when it ends. `prefix` is a command that runs the server by exec."""

    def __init__(self, data: Path, *arguments: str, prefix: "Sequence[str]" = ()) -> None:
        self.data = data
        self.arguments = arguments
        self.prefix = prefix
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.log = data.parent / f"{data.name}.log"
        self._process: Optional["subprocess.Popen[bytes]"] = None

    @property
    def pid(self) -> int:
        assert self._process is not None
        return self._process.pid

    def running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def start(self, seconds: float = START_SECONDS) -> "ServerProcess":
        """Starts the server and returns once it is ready. Raises if that takes longer; the process may then still be running."""
        assert not self.running()
        host = [] if "--host" in self.arguments else ["--host", "127.0.0.1"]
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                [*self.prefix, str(SERVER), *host, "--port", str(self.port), "--data", str(self.data), *self.arguments],
                stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            if not self.running():
                raise RuntimeError(f"the server ended with {self._process.returncode}:\n{self.log_text()[-4000:]}")
            try:
                if requests.get(self.url + "/readyz", timeout=1).status_code == 200:
                    return self
            except requests.RequestException:
                pass
            time.sleep(0.02)
        raise RuntimeError(f"the server was not ready within {seconds} s:\n{self.log_text()[-4000:]}")

    def log_text(self) -> str:
        return self.log.read_text(errors="replace") if self.log.exists() else ""

    def terminate(self) -> int:
        """Terminates the server with SIGTERM and returns the exit status."""
        assert self._process is not None
        self._process.send_signal(signal.SIGTERM)
        status = self._process.wait(STOP_SECONDS)
        self.assert_no_findings()
        return status

    def assert_no_findings(self) -> None:
        """Fails if the log has findings of a sanitizer."""
        log = self.log_text()
        found = min((log.find(text) for text in FINDINGS if text in log), default=-1)
        assert found < 0, log[max(0, found - 200):found + 6000]

    def kill(self) -> None:
        """Kills the server with SIGKILL, which ends it like a power failure."""
        assert self._process is not None
        self._process.kill()
        self._process.wait(STOP_SECONDS)

    def stop(self) -> None:
        """Ends the process in any state, for the end of a test."""
        if self.running():
            try:
                self.terminate()
            except subprocess.TimeoutExpired:
                self.kill()

    def resident_bytes(self) -> int:
        status = Path(f"/proc/{self.pid}/status").read_text()
        return 1024 * int(re.search(r"VmRSS:\s+(\d+)", status).group(1))  # type: ignore[union-attr]

    def metrics(self) -> Dict[str, float]:
        """Every sample of /metrics by its full name, labels included."""
        samples: Dict[str, float] = {}
        for line in requests.get(self.url + "/metrics", timeout=PATIENCE_SECONDS).text.splitlines():
            if line and not line.startswith("#"):
                name, value = line.rsplit(" ", 1)
                samples[name] = float(value)
        return samples


def spoil_database(data: Path, damage: str) -> None:
    """Removes ("lost") or overwrites ("overwritten") the database in a data folder whose server has ended."""
    database = data / "supple.sqlite"
    if damage == "lost":
        database.unlink()
    else:
        database.write_bytes(b"not a database" * 1000)


def servers_of_a_test(folder: Path) -> "Iterator[Callable[..., ServerProcess]]":
    """Yields, for a fixture, a function that starts servers for a single test, which may kill and restart them; ends them afterwards."""
    started: List[ServerProcess] = []

    def start(*arguments: str, data: str = "data", prefix: Sequence[str] = ()) -> ServerProcess:
        process = ServerProcess(folder / data, *arguments, prefix=prefix)
        started.append(process)
        return process.start()

    yield start
    for process in started:
        process.stop()


def keys_command(data: Path, *arguments: str) -> str:
    """The output of `supple-server keys ...` for a data folder; for add and rotate this is the key."""
    done = subprocess.run([str(SERVER), "--data", str(data), "keys", *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


class Api:
    """A client of a server, with a key if one is given. It checks each request and each response against the contract."""

    def __init__(self, server: ServerProcess, contract: Contract, key: str = "") -> None:
        self.server = server
        self.contract = contract
        self.session = requests.Session()
        if key:
            self.session.headers["Authorization"] = f"Bearer {key}"

    def call(self, method: str, path: str, *, document: Any = None, body: Optional[bytes] = None,
             headers: Optional[Dict[str, str]] = None, faulty: bool = False,
             timeout: float = PATIENCE_SECONDS) -> requests.Response:
        """Sends a request. `faulty` says that the request violates the contract on purpose; the response must never do so."""
        sent = dict(headers or {})
        if document is not None:
            body = json.dumps(document).encode()
            sent.setdefault("Content-Type", "application/json")
        if not faulty:
            self.contract.check_request(method, path, sent, body or b"")
        response = self.session.request(method, self.server.url + path, data=body, headers=sent, timeout=timeout,
                                        allow_redirects=False)
        self.contract.check_response(method, path, response.status_code, response.headers, response.content)
        return response

    def get(self, path: str, **more: Any) -> requests.Response:
        return self.call("GET", path, **more)

    def post(self, path: str, document: Any = None, **more: Any) -> requests.Response:
        return self.call("POST", path, document=document, **more)

    def delete(self, path: str, **more: Any) -> requests.Response:
        return self.call("DELETE", path, **more)

    def ok(self, path: str, document: Any, **more: Any) -> Any:
        """The JSON answer of a POST that must be answered with 200."""
        response = self.post(path, document, **more)
        assert response.status_code == 200, response.text
        return strict_json(response.content)

    def upload(self, vertices: Any, faces: Any) -> str:
        """Uploads a mesh given by arrays and returns its id. Large ones are sent as OBJ, since checking each number of their JSON
        against the contract would take longer than the tests themselves."""
        if len(faces) > 10_000:
            response = self.call("POST", "/v1/meshes", body=obj_text((vertices, faces)).encode(), headers={"Content-Type": "model/obj"})
        else:
            response = self.post("/v1/meshes", {"vertices": [list(map(float, v)) for v in vertices],
                                                "faces": [list(map(int, f)) for f in faces]})
        assert response.status_code in (200, 201), response.text
        return str(response.json()["id"])

    def busy(self) -> bool:
        """Whether a computation runs or waits."""
        ready = self.get("/readyz").json()
        return bool(ready["jobs_running"] or ready["jobs_waiting"]
                    or self.server.metrics()["supple_immediate_computations"])

    def wait_for_job(self, job: str, states: "tuple[str, ...]" = ("successful", "failed", "dismissed"),
                     seconds: float = 300) -> Any:
        """Polls until the job is in one of the states and returns its document."""
        deadline = time.monotonic() + seconds
        while True:
            document = self.get(f"/v1/jobs/{job}").json()
            if document["state"] in states:
                return document
            assert time.monotonic() < deadline, f"job {job} is still {document['state']} after {seconds} s"
            time.sleep(0.02)


def slow_relaxation(mesh: str, iterations: int, **more: Any) -> Dict[str, Any]:
    """A small request of /v1/embedded-systems that takes a millisecond or more for each iteration on a mesh of 1280 faces."""
    return {"mesh": mesh, "points": {"kind": "per_face", "barycentric": [0.3, 0.3, 0.4]},
            "springs": {"kind": "adjacent_faces", "rest_length": 0.01}, "fixed_points": [0, 400, 900],
            "method": "gradient_descent", "max_iterations": iterations, "accuracy": {"tolerance": 1e-14}, **more}


def problem_code(response: requests.Response) -> str:
    return str(response.json()["code"])


def pointers(response: requests.Response) -> List[str]:
    """The JSON pointers in a problem."""
    return [entry["pointer"] for entry in response.json().get("errors", [])]
