"""The files of the web editor, which --web serves: types, caching, and no file outside of the folder."""

from __future__ import annotations

import http.client
import subprocess
from pathlib import Path
from typing import Callable

import pytest
import requests

from harness import SERVER, ServerProcess
from working_time import PATIENCE_SECONDS

INDEX = "<!doctype html><title>Supple</title>"
SCRIPT = "export const answer = 42;\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A small site, next to files that must not be served."""
    web = tmp_path / "web"
    (web / "assets" / "deep").mkdir(parents=True)
    (web / "index.html").write_text(INDEX)
    (web / "favicon.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    (web / "assets" / "index-4f2a.js").write_text(SCRIPT)
    (web / "assets" / "deep" / "style-00ff.css").write_text("body { margin: 0 }")
    (web / "assets" / "data.bin").write_bytes(bytes(range(256)))
    (web / ".hidden").write_text("secret")
    (web / ".git").mkdir()
    (web / ".git" / "config").write_text("secret")
    (web / "{mesh}").write_text("a pattern")
    (tmp_path / "secret.txt").write_text("secret")
    return web


@pytest.fixture
def server(new_server: Callable[..., ServerProcess], folder: Path) -> ServerProcess:
    return new_server("--web", str(folder))


@pytest.mark.parametrize("path, media_type, content", [
    ("/", "text/html; charset=utf-8", INDEX.encode()),
    ("/index.html", "text/html; charset=utf-8", INDEX.encode()),
    ("/favicon.svg", "image/svg+xml", None),
    ("/assets/index-4f2a.js", "text/javascript; charset=utf-8", SCRIPT.encode()),
    ("/assets/deep/style-00ff.css", "text/css; charset=utf-8", None),
    ("/assets/data.bin", "application/octet-stream", bytes(range(256))),
])
def test_a_file_is_sent_with_its_type(server: ServerProcess, path: str, media_type: str, content: "bytes | None") -> None:
    response = requests.get(server.url + path, timeout=PATIENCE_SECONDS)
    assert (response.status_code, response.headers["Content-Type"]) == (200, media_type)
    assert content is None or response.content == content
    assert response.headers["X-Content-Type-Options"] == "nosniff"
    policy = response.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy and "script-src 'self';" in policy and "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy


def test_files_whose_names_change_with_them_are_kept_and_others_asked_for_again(server: ServerProcess) -> None:
    assert "immutable" in requests.get(server.url + "/assets/index-4f2a.js", timeout=PATIENCE_SECONDS).headers["Cache-Control"]
    for path in ("/", "/index.html", "/favicon.svg"):
        assert requests.get(server.url + path, timeout=PATIENCE_SECONDS).headers["Cache-Control"] == "no-cache"


def test_a_copy_that_is_current_is_not_sent_again(server: ServerProcess) -> None:
    for path in ("/", "/assets/index-4f2a.js"):
        first = requests.get(server.url + path, timeout=PATIENCE_SECONDS)
        again = requests.get(server.url + path, headers={"If-None-Match": first.headers["ETag"]}, timeout=PATIENCE_SECONDS)
        assert (again.status_code, again.content) == (304, b"")
        assert again.headers["ETag"] == first.headers["ETag"]
        assert again.headers["Cache-Control"] == first.headers["Cache-Control"]
        other = requests.get(server.url + path, headers={"If-None-Match": '"other"'}, timeout=PATIENCE_SECONDS)
        assert (other.status_code, other.content) == (200, first.content)


def test_head_has_the_headers_and_no_body(server: ServerProcess) -> None:
    response = requests.head(server.url + "/", timeout=PATIENCE_SECONDS)
    assert (response.status_code, response.content) == (200, b"")
    assert response.headers["ETag"]


@pytest.mark.parametrize("target", [
    "/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/%2e%2e%2fsecret.txt",
    "/assets/..%5c..%5csecret.txt", "//secret.txt", "/./index.html", "/assets/../index.html", "/index.html%00",
    "/.hidden", "/.git/config", "/%7Bmesh%7D", "/anything", "/assets", "/assets/", "/INDEX.HTML", "/v1/nothing",
])
def test_no_path_leads_out_of_the_folder_and_unknown_ones_are_problems(server: ServerProcess, target: str) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE_SECONDS)
    connection.request("GET", target)  # unlike requests, http.client does not normalize the path
    response = connection.getresponse()
    body = response.read()
    assert response.status in (400, 404) and b"secret" not in body.replace(target.encode(), b"").replace(b"secret.txt", b"")
    assert response.headers["Content-Type"] == "application/problem+json"
    connection.close()


def test_the_endpoints_stay_where_they_are(server: ServerProcess) -> None:
    assert requests.get(server.url + "/healthz", timeout=PATIENCE_SECONDS).json()["status"] == "ok"
    assert requests.get(server.url + "/v1/families", timeout=PATIENCE_SECONDS).status_code == 200
    assert requests.post(server.url + "/", timeout=PATIENCE_SECONDS).status_code == 405


def test_without_a_folder_there_is_nothing_at_the_root(new_server: Callable[..., ServerProcess]) -> None:
    response = requests.get(new_server().url + "/", timeout=PATIENCE_SECONDS)
    assert (response.status_code, response.json()["code"]) == (404, "http.not_found")


def test_a_folder_without_an_index_ends_the_start_with_a_reason(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    ended = subprocess.run([str(SERVER), "--port", "0", "--data", str(tmp_path / "data"), "--web", str(tmp_path / "empty")],
                           capture_output=True, text=True, timeout=60)
    assert ended.returncode != 0
    assert "index.html" in ended.stderr
