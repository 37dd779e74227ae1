"""Messages of the command line client about command lines, without a server: misspellings, missing files, colours."""

from __future__ import annotations

import os
import pty
import subprocess
from pathlib import Path
from typing import Dict, List, Tuple

import pytest

from harness import CLI, needs_terminals


def run(*arguments: str, folder: "Path | None" = None, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Runs `supple` with an address at which there is no server."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SUPPLE_")}
    return subprocess.run([str(CLI), *arguments], cwd=folder, capture_output=True, text=True, timeout=60, check=False,
                          env={**kept, "SUPPLE_SERVER": "http://127.0.0.1:1", **environment})


def on_a_terminal(arguments: List[str], environment: Dict[str, str]) -> Tuple[int, str]:
    """The exit status and all output of a run whose standard output and error are a terminal."""
    leader, follower = pty.openpty()
    kept = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    process = subprocess.Popen([str(CLI), *arguments], stdout=follower, stderr=follower, stdin=follower,
                               env={**kept, "TERM": "xterm-256color", **environment})
    os.close(follower)
    shown = b""
    while True:
        try:
            part = os.read(leader, 4096)
        except OSError:  # the terminal's other end is closed
            break
        if not part:
            break
        shown += part
    os.close(leader)
    return process.wait(60), shown.decode()


@pytest.mark.parametrize("arguments, message", [
    (["desing"], "'supple' has no command 'desing'; did you mean 'design'?"),
    (["geo"], "did you mean 'geodesic'?"),
    (["weave", "layuot", "squares"], "'supple weave' has no command 'layuot'; did you mean 'layout'?"),
    (["design", "--polich", "off"], "'supple design' has no option --polich; did you mean --polish?"),
    (["design", "--polich=off"], "did you mean --polish?"),
    (["design", "--sever", "x"], "did you mean --server?"),
    # The required option that seems to be missing is the misspelt one.
    (["profile", "--tasks", "poisson", "--parameters", "1"], "did you mean --task?"),
    (["profile", "--task", "stiffnes", "--parameters", "1"], "did you mean stiffness?"),
    (["relax", "x.obj", "--starts", "3"], "'supple relax' has no option --starts; 'supple karcher' has"),
    (["structure", "IH21", "more"], "'supple structure' takes no further argument 'more'"),
    (["weave", "layout", "sqares"], "did you mean squares?"),
    (["weave"], "'supple weave' needs a command"),
])
def test_a_slip_is_named_with_what_was_likely_meant(arguments: List[str], message: str) -> None:
    refused = run(*arguments)
    assert refused.returncode == 1 and refused.stdout == ""
    assert message in refused.stderr


def test_what_is_like_nothing_is_named_without_a_suggestion() -> None:
    for arguments in (["xyzzy"], ["design", "--xyzzy"], ["profile", "--task", "xyzzy", "--parameters", "1"]):
        refused = run(*arguments)
        assert refused.returncode == 1 and "xyzzy" in refused.stderr and "did you mean" not in refused.stderr


def test_where_there_is_help_is_said() -> None:
    assert "See 'supple weave layout --help'." in run("weave", "layout", "regular", "--svgg", "x").stderr


@pytest.mark.parametrize("arguments", [
    ["mesh", "add", "nosuch.obj"], ["karcher", "nosuch.obj", "v0"], ["weave", "layout", "nosuch.json"],
    ["design", "--request", "nosuch.json"], ["design", "--task", "poisson", "--target", "nosuch.csv"],
    ["weave", "check", "nosuch.gcode"], ["evaluate", "ih21", "-p", "0.1,0.2", "-s", "nosuch.csv"],
    ["voronoi", "x.obj", "--sites", "nosuch.json"], ["--key-file", "nosuch.key", "mesh", "list"],
])
def test_a_file_that_is_not_there_is_no_such_file(tmp_path: Path, arguments: List[str]) -> None:
    refused = run(*arguments, folder=tmp_path)
    assert refused.returncode == 5, refused.stderr
    assert "nosuch" in refused.stderr and "no such file" in refused.stderr


def test_a_folder_and_a_file_without_permission_are_told_apart(tmp_path: Path) -> None:
    (tmp_path / "folder.obj").mkdir()
    assert "it is a folder" in run("mesh", "add", "folder.obj", folder=tmp_path).stderr
    (tmp_path / "locked.obj").write_text("v 0 0 0\n")
    (tmp_path / "locked.obj").chmod(0)
    if not os.access(tmp_path / "locked.obj", os.R_OK):  # root reads everything
        assert "Permission denied" in run("mesh", "add", "locked.obj", folder=tmp_path).stderr


@needs_terminals
def test_colours_are_for_terminals_that_want_them() -> None:
    status, shown = on_a_terminal(["desing"], {})
    assert status == 1 and "\033[1;31msupple:\033[0m" in shown
    for environment in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        status, shown = on_a_terminal(["desing"], environment)
        assert status == 1 and "supple: 'supple' has no command" in shown and "\033" not in shown
    assert "\033" not in run("desing").stderr
    # An empty NO_COLOR has no effect, according to https://no-color.org.
    assert "\033[" in on_a_terminal(["desing"], {"NO_COLOR": ""})[1]
