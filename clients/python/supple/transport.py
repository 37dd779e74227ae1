"""Requests and answers: timeouts, retries, problems. This is the only module that uses the library `requests`."""

from __future__ import annotations

import json
import time
from typing import Any, Callable, Dict, Mapping, Optional
from urllib.parse import urlencode

import numpy as np
import requests

from .errors import ConnectionFailed, RequestTimeout, problem_from
from .keys import KeyHeader
from .progress import Progress

IDEMPOTENT = frozenset({"GET", "HEAD", "PUT", "DELETE"})
RETRIES = 3
FIRST_RETRY_DELAY = 0.1
"""Seconds before the first retry; the delay doubles for each further one."""


class Answer:
    """A successful answer: status, headers (case-insensitive) and body."""

    def __init__(self, status: int, headers: Mapping[str, str], content: bytes) -> None:
        self.status = status
        self.headers = headers
        self.content = content

    @property
    def content_type(self) -> str:
        return self.headers.get("Content-Type", "").split(";")[0].strip().lower()

    def json(self) -> Any:
        return json.loads(self.content)


class Transport:
    """One server, over a pool of persistent connections.

    A request whose connection broke is repeated (up to three times, after 0.1, 0.2 and 0.4 s) if it is idempotent. GET and
    DELETE always are. The caller says so for a POST: of a mesh, whose id is the hash of its content, of a computation that is
    answered immediately, and of a job, which has an idempotency key.
    """

    def __init__(
        self,
        url: str,
        timeout: float,
        *,
        key: str = "",
        progress: Optional[Progress] = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.progress = progress
        self.url = url.rstrip("/")
        self._timeout = timeout
        self._sleep = sleep
        self._session = requests.Session()
        self._session.auth = KeyHeader(key) if key else None

    def close(self) -> None:
        self._session.close()

    def request(
        self,
        method: str,
        path: str,
        *,
        query: Optional[Mapping[str, str]] = None,
        body: Optional[bytes] = None,
        document: Any = None,
        headers: Optional[Dict[str, str]] = None,
        timeout: Optional[float] = None,
        repeatable: Optional[bool] = None,
    ) -> Answer:
        """Sends a request and returns its answer (status below 400). The values of `query` are escaped.

        Raises `ProblemError` for any other status, and `ConnectionFailed` or `RequestTimeout` if there is no answer.
        """
        url = self.url + path + ("?" + urlencode(query, safe=",") if query else "")
        sent = dict(headers or {})
        if document is not None:
            body = json.dumps(document, allow_nan=False, default=_plain).encode()
            sent["Content-Type"] = "application/json"
        sent.setdefault("Accept", "application/json")
        attempts = 1 + (RETRIES if (method in IDEMPOTENT if repeatable is None else repeatable) else 0)
        for attempt in range(attempts):
            try:
                response = self._session.request(
                    method,
                    url,
                    data=body,
                    headers=sent,
                    timeout=self._timeout if timeout is None else timeout,
                    allow_redirects=False,
                )
                break
            except requests.Timeout as error:
                raise RequestTimeout(f"no answer from {self.url} in time: {error}") from error
            except requests.RequestException as error:
                if attempt + 1 == attempts:
                    raise ConnectionFailed(f"no answer from {self.url}: {error}") from error
                self._sleep(FIRST_RETRY_DELAY * 2**attempt)
        if response.status_code >= 400:
            raise problem_from(response.status_code, _decoded(response))
        return Answer(response.status_code, response.headers, response.content)


def _plain(value: Any) -> Any:
    """Numbers and arrays of numpy as Python numbers and lists, for JSON."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{value!r} cannot be sent to the server")


def _decoded(response: requests.Response) -> Any:
    try:
        return response.json()
    except ValueError:
        return None
