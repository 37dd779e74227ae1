"""The sources of a key, and the requests with it."""

from __future__ import annotations

import os
import socket
import threading
import warnings
from pathlib import Path
from typing import List

import pytest

from supple import Client, KeyReadableByOthers
from supple.keys import find_key

KEY = "supple_0123456789ab_" + "1" * 64
OTHER = "supple_0123456789ab_" + "2" * 64


@pytest.fixture(autouse=True)
def no_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SUPPLE_KEY", raising=False)
    monkeypatch.delenv("SUPPLE_KEY_FILE", raising=False)


def key_file(folder: Path, text: str = KEY + "\n", mode: int = 0o600) -> Path:
    path = folder / "key"
    path.write_text(text)
    os.chmod(path, mode)
    return path


def test_a_key_is_given_or_in_a_file_or_in_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = key_file(tmp_path)
    assert find_key(None, None) == ""
    assert find_key(None, path) == KEY
    monkeypatch.setenv("SUPPLE_KEY_FILE", str(path))
    assert find_key(None, None) == KEY
    monkeypatch.setenv("SUPPLE_KEY", OTHER)
    assert find_key(None, None) == OTHER
    assert find_key(KEY, None) == KEY
    assert find_key(None, path) == KEY


def test_a_file_that_others_may_read_is_warned_of(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        find_key(None, key_file(tmp_path))
    with pytest.warns(KeyReadableByOthers, match="chmod 600"):
        assert find_key(None, key_file(tmp_path, mode=0o640)) == KEY


def test_what_is_no_key_is_not_sent_and_not_repeated(tmp_path: Path) -> None:
    for text in (KEY + "\r\nX-Other: 1", "two words", "schlüssel", ""):
        with pytest.raises(ValueError) as raised:
            find_key(text, None)
        assert not text or text not in str(raised.value)
    with pytest.raises(ValueError, match=str(tmp_path)):
        find_key(None, key_file(tmp_path, "nothing here"))


def test_the_key_travels_as_a_header_and_not_in_the_address(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    netrc = tmp_path / "netrc"
    netrc.write_text("machine 127.0.0.1 login someone password else\n")
    netrc.chmod(0o600)
    monkeypatch.setenv("NETRC", str(netrc))
    received: List[bytes] = []
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def answer() -> None:
            for _ in range(2):
                connection, _ = listener.accept()
                with connection:
                    received.append(connection.recv(65536))
                    connection.sendall(b"HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: 2\r\n\r\n{}")

        thread = threading.Thread(target=answer)
        thread.start()
        url = "http://127.0.0.1:%d" % listener.getsockname()[1]
        with Client(url, key=KEY) as client:
            assert client.ready()
        with Client(url) as client:
            assert client.ready()
        thread.join()
    assert f"Authorization: Bearer {KEY}\r\n".encode() in received[0]
    assert KEY.encode() not in received[0].split(b"\r\n")[0]
    assert b"Bearer" not in received[1]
