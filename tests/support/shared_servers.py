"""Servers that share a PostgreSQL database and a folder, for tests."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import List

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "api")]

from harness import ServerProcess  # noqa: E402

POSTGRES = ROOT / "tests" / "support" / "private_postgres.sh"
LEASE = 2
"""Seconds until other servers take over the jobs of a server that was killed."""


class Replicas:
    """A database, a folder and the servers that share them. The constructor does not start the servers."""

    def __init__(self, folder: Path, count: int, *arguments: str) -> None:
        # The database's user must be able to enter its folder. A folder of pytest would not do, since each further run of pytest
        # closes those to other users again.
        self._postgres = Path(tempfile.mkdtemp(prefix="supple-postgres-"))
        self._postgres.chmod(0o711)
        self.database = self._run("start")
        self.servers: List[ServerProcess] = []
        for number in range(count):
            server = ServerProcess(folder / "data", "--database", self.database, "--lease", str(LEASE), *arguments)
            server.log = folder / f"server{number}.log"
            self.servers.append(server)

    def _run(self, action: str) -> str:
        done = subprocess.run([str(POSTGRES), action, str(self._postgres)], capture_output=True, text=True, check=False, timeout=60)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    def start(self) -> None:
        for server in self.servers:
            server.start()

    def kill_database(self) -> None:
        self._run("kill")

    def start_database(self) -> None:
        self._run("again")

    def close(self) -> None:
        for server in self.servers:
            server.stop()
        self._run("stop")
        shutil.rmtree(self._postgres, ignore_errors=True)
