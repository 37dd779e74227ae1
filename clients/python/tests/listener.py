"""A server that answers what a test tells it to."""

from __future__ import annotations

import re
import socket
import threading
import time
from typing import List

OK = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 2\r\n\r\n{}"


def _request_of(connection: socket.socket) -> bytes:
    """A whole request: its head and its body may come in several pieces."""
    request = connection.recv(65536)
    while piece := connection.recv(65536) if _lacks(request) else b"":
        request += piece
    return request


def _lacks(request: bytes) -> bool:
    head, _, body = request.partition(b"\r\n\r\n")
    length = re.search(rb"content-length: *(\d+)", head, re.IGNORECASE)
    return b"\r\n\r\n" not in request or (length is not None and len(body) < int(length.group(1)))


class Listener:
    """Accepts connections, reads one request from each and answers with the next of `answers` (b"" closes the connection)."""

    def __init__(self, answers: List[bytes], delay: float = 0.0) -> None:
        self.requests: List[bytes] = []
        self._answers = list(answers)
        self._delay = delay
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.url = "http://127.0.0.1:%d" % self._socket.getsockname()[1]
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        while self._answers:
            connection, _ = self._socket.accept()
            with connection:
                self.requests.append(_request_of(connection))
                time.sleep(self._delay)
                connection.sendall(self._answers.pop(0))

    def close(self) -> None:
        self._socket.close()
