"""TLS by a proxy: deploy/nginx.conf in front of a real server, with a certificate for the test."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any, Callable, Iterator

import pytest
import requests

from contract import ROOT
from harness import CLI, ServerProcess, free_port
from shapes import flat_grid
from working_time import PATIENCE_SECONDS
from test_access import add_key

NGINX = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
OPENSSL = shutil.which("openssl")

pytestmark = pytest.mark.skipif(not NGINX or not OPENSSL, reason="nginx and openssl are not installed")

MAIN = """
daemon off;
{user}
pid {folder}/nginx.pid;
error_log {folder}/error.log;
events {{}}
http {{
    access_log {folder}/access.log;
    client_body_temp_path {folder}/body;
    proxy_temp_path {folder}/proxy;
    fastcgi_temp_path {folder}/fastcgi;
    uwsgi_temp_path {folder}/uwsgi;
    scgi_temp_path {folder}/scgi;
{site}
}}
"""


class Proxy:
    """nginx with the configuration of deploy/, in which ports, name and certificate are replaced by those of the test."""

    def __init__(self, folder: Path, server: ServerProcess) -> None:
        folder.mkdir()
        self.certificate = folder / "certificate.pem"
        self.port, self.plain_port = free_port(), free_port()
        self.url = f"https://localhost:{self.port}"
        subprocess.run([str(OPENSSL), "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost",
                        "-addext", "subjectAltName=DNS:localhost", "-keyout", str(folder / "key.pem"),
                        "-out", str(self.certificate)], check=True, capture_output=True, timeout=60)
        site = (ROOT / "deploy" / "nginx.conf").read_text()
        for text, ours in (("127.0.0.1:8080;", f"127.0.0.1:{server.port};"), ("listen 80;", f"listen {self.plain_port};"),
                           ("listen [::]:80;", ""), ("listen 443 ssl;", f"listen {self.port} ssl;"), ("listen [::]:443 ssl;", ""),
                           ("/etc/ssl/certs/supple.example.pem", str(self.certificate)),
                           ("/etc/ssl/private/supple.example.key", str(folder / "key.pem")), ("supple.example;", "localhost;")):
            assert text in site, text
            site = site.replace(text, ours)
        configuration = folder / "nginx.conf"
        configuration.write_text(MAIN.format(user="user root;" if os.geteuid() == 0 else "", folder=folder, site=site))
        self._process = subprocess.Popen([str(NGINX), "-p", str(folder), "-c", str(configuration)], stderr=subprocess.PIPE)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            assert self._process.poll() is None, self._process.stderr.read().decode()  # type: ignore[union-attr]
            try:
                if requests.get(self.url + "/healthz", timeout=2, verify=str(self.certificate)).status_code == 200:
                    return
            except requests.RequestException:
                time.sleep(0.05)
        raise AssertionError((folder / "error.log").read_text())

    def call(self, method: str, path: str, key: str = "", **more: Any) -> requests.Response:
        headers = dict(more.pop("headers", {}))
        if key:
            headers["Authorization"] = f"Bearer {key}"
        return requests.request(method, self.url + path, headers=headers, verify=str(self.certificate), timeout=PATIENCE_SECONDS, **more)

    def stop(self) -> None:
        self._process.terminate()
        self._process.wait(20)


@pytest.fixture
def proxied(new_server: Callable[..., ServerProcess], tmp_path: Path) -> Iterator[Any]:
    """(proxy, key of the server behind it)."""
    key = add_key(tmp_path / "data", "team", "read,compute")
    proxy = Proxy(tmp_path / "nginx", new_server("--allowed-host", "localhost"))
    yield proxy, key
    proxy.stop()


def test_a_key_is_answered_over_tls(proxied: Any) -> None:
    proxy, key = proxied
    assert proxy.call("GET", "/v1/meshes").status_code == 401
    assert proxy.call("GET", "/v1/meshes", key).json() == {"meshes": []}
    vertices, faces = flat_grid(4)
    mesh = {"vertices": [list(map(float, v)) for v in vertices], "faces": [list(map(int, f)) for f in faces]}
    made = proxy.call("POST", "/v1/meshes", key, json=mesh)
    assert made.status_code == 201
    request = {"mesh": made.json()["id"], "pairs": [{"from": {"vertex": 0}, "to": {"vertex": 24}}]}
    assert proxy.call("POST", "/v1/geodesics", key, json=request).status_code == 200
    job = proxy.call("POST", "/v1/geodesics", key, json=request, headers={"Prefer": "respond-async"}).json()["id"]
    assert "event: finished" in proxy.call("GET", f"/v1/jobs/{job}/events", key).text


def test_counters_and_pages_of_others_are_refused_through_it(proxied: Any) -> None:
    proxy, key = proxied
    assert proxy.call("GET", "/metrics").status_code == 401
    assert proxy.call("GET", "/metrics", key).status_code == 200
    forged = proxy.call("GET", "/v1/meshes", key, headers={"Origin": "https://evil.example"})
    assert (forged.status_code, forged.json()["code"]) == (403, "http.cross_origin")


def test_a_browser_signs_in_through_it_and_its_cookie_stays_with_tls(proxied: Any) -> None:
    proxy, key = proxied
    own = {"Origin": proxy.url}
    browser = requests.Session()
    browser.verify = str(proxy.certificate)
    browser.trust_env = False  # the environment may name other certificates
    signed_in = browser.post(proxy.url + "/v1/session", json={"key": key}, headers=own, timeout=60)
    assert signed_in.status_code == 200 and signed_in.headers["Set-Cookie"].endswith("; Secure")
    assert signed_in.headers["Strict-Transport-Security"]
    assert browser.get(proxy.url + "/v1/meshes", timeout=60).status_code == 200
    assert browser.delete(proxy.url + "/v1/session", headers=own, timeout=60).status_code == 204
    assert browser.get(proxy.url + "/v1/meshes", timeout=60).status_code == 401


def test_without_tls_it_only_says_where_to_go(proxied: Any) -> None:
    proxy, _ = proxied
    answer = requests.get(f"http://localhost:{proxy.plain_port}/v1/meshes", timeout=PATIENCE_SECONDS, allow_redirects=False)
    assert answer.status_code == 301 and answer.headers["Location"].startswith("https://localhost/v1/meshes")


@pytest.mark.skipif(not CLI.exists(), reason="the command line client is not built")
def test_the_command_line_client_speaks_to_it(proxied: Any, tmp_path: Path) -> None:
    proxy, key = proxied
    path = tmp_path / "key"
    path.write_text(key + "\n")
    path.chmod(0o600)
    environment = {"SSL_CERT_FILE": str(proxy.certificate), "SUPPLE_KEY_FILE": str(path), "SUPPLE_SERVER": proxy.url}
    done = subprocess.run([str(CLI), "mesh", "list"], env=environment, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    del environment["SUPPLE_KEY_FILE"]
    refused = subprocess.run([str(CLI), "mesh", "list"], env=environment, capture_output=True, text=True, timeout=60)
    assert refused.returncode == 2 and "access.key_required" in refused.stderr
