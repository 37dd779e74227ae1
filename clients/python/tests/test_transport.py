"""Retries and timeouts, against servers that misbehave on purpose."""

from __future__ import annotations

import re
import socket
import time
from typing import Callable, List

import pytest

from supple.errors import ConnectionFailed, RequestTimeout
from supple.jobs import submit
from supple.transport import RETRIES, Transport
from supple.weaves import Weave, WeaveLayoutRequest

from listener import OK, Listener


def test_a_broken_connection_is_tried_again_where_that_is_safe(listen: Callable[..., Listener]) -> None:
    listener = listen([b"", b"", OK])
    pauses: List[float] = []
    assert Transport(listener.url, 5, sleep=pauses.append).request("GET", "/healthz").json() == {}
    assert len(listener.requests) == 3
    assert pauses == [0.1, 0.2]


def test_a_post_is_sent_once_unless_the_caller_says_that_it_may_be_repeated(listen: Callable[..., Listener]) -> None:
    listener = listen([b"", OK])
    with pytest.raises(ConnectionFailed):
        Transport(listener.url, 5).request("POST", "/v1/geodesics", document={})
    assert len(listener.requests) == 1
    listener = listen([b"", OK])
    Transport(listener.url, 5, sleep=lambda _: None).request("POST", "/v1/geodesics", document={}, repeatable=True)
    assert len(listener.requests) == 2


def test_a_job_is_handed_in_again_under_the_same_key(listen: Callable[..., Listener]) -> None:
    accepted = b"HTTP/1.1 202 Accepted\r\nLocation: /v1/jobs/7\r\nContent-Length: 2\r\n\r\n{}"
    listener = listen([b"", accepted, accepted])
    transport = Transport(listener.url, 5, sleep=lambda _: None)
    request = WeaveLayoutRequest(Weave.rings())
    assert submit(transport, request).id == "7"
    submit(transport, request)
    keys = [re.findall(rb"(?i)idempotency-key: (\S+)", request)[0] for request in listener.requests]
    assert len(keys) == 3
    assert keys[0] == keys[1], "the same request has the same key"
    assert keys[2] != keys[0], "another one has another"


def test_it_gives_up_after_the_last_retry() -> None:
    pauses: List[float] = []
    with socket.create_server(("127.0.0.1", 0)) as unused:
        url = "http://127.0.0.1:%d" % unused.getsockname()[1]
    with pytest.raises(ConnectionFailed):
        Transport(url, 5, sleep=pauses.append).request("GET", "/healthz")
    assert len(pauses) == RETRIES


def test_a_silent_server_is_a_timeout_and_not_tried_again(listen: Callable[..., Listener]) -> None:
    listener = listen([OK], delay=1.0)
    start = time.monotonic()
    with pytest.raises(RequestTimeout):
        Transport(listener.url, 0.2).request("GET", "/healthz")
    assert time.monotonic() - start < 0.9
    assert len(listener.requests) == 1


def test_a_number_that_json_cannot_hold_is_refused_before_it_is_sent() -> None:
    with pytest.raises(ValueError):
        Transport("http://127.0.0.1:1", 5).request("POST", "/v1/geodesics", document={"tolerance": float("nan")})
