"""The connection to a server, over which requests are run and submitted."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Optional, Type, TypeVar, Union

from . import jobs
from .jobs import Job
from .keys import find_key
from .progress import Progress
from .request import Request
from .transport import Transport
from .units import Number

DEFAULT_URL = "http://127.0.0.1:8080"
Self = TypeVar("Self", bound="Connection")
Result = TypeVar("Result")


class Connection:
    """The base class of `Client`, where the arguments are described."""

    def __init__(
        self,
        url: Optional[str] = None,
        *,
        key: Optional[str] = None,
        key_file: Optional[Union[str, Path]] = None,
        timeout: float = 60.0,
        progress: Optional[Progress] = None,
    ) -> None:
        if url is None:
            url = os.environ.get("SUPPLE_SERVER", DEFAULT_URL)
        self._transport = Transport(url, timeout, key=find_key(key, key_file), progress=progress)

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections. Jobs on the server continue."""
        self._transport.close()

    @property
    def url(self) -> str:
        return self._transport.url

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.url!r})"

    def run(self, request: Request[Result], *, timeout: Optional[Number] = None, progress: Optional[Progress] = None) -> Result:
        """Computes and returns the result of a request, such as `SimulationRequest`.

        Args:
            request: a request of any kind.
            timeout: seconds after which `RequestTimeout` is raised, or for example "2 min"; None takes that of the request.
            progress: see `Progress`; None takes that of the request.

        Anything that interrupts the wait cancels the computation on the server.
        """
        return jobs.run(self._transport, request, timeout, progress)

    def submit(self, request: Request[Result]) -> Job[Result]:
        """Submits a request as a job, and returns immediately. The job goes on if the client is closed."""
        return jobs.submit(self._transport, request)
