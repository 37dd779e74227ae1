"""Options from the command line, the environment and a file; their refusals; the page that lists them.

`tests/api/test_configuration.py --write` updates the table on the page.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Callable, Dict, List

import pytest

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent))

from contract import ROOT
from harness import SERVER, ServerProcess

PAGE = ROOT / "docs" / "configuration.md"
TABLE = re.compile(r"(<!-- options -->\n).*?(<!-- /options -->)", flags=re.S)


def run(*arguments: str, folder: "Path | None" = None, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Runs the server's program with only these variables SUPPLE_..."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SUPPLE_")}
    return subprocess.run([str(SERVER), *arguments], cwd=folder, env={**kept, **environment}, capture_output=True, text=True,
                          timeout=60, check=False)


def check(folder: Path, *arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Runs --check-config with a data folder of the test."""
    return run("--check-config", "--data", str(folder / "data"), *arguments, **environment)


def settings(done: "subprocess.CompletedProcess[str]") -> Dict[str, List[str]]:
    """The output of --check-config as key -> [value, origin]."""
    assert done.returncode == 0, done.stderr
    return {line.split(" = ")[0]: line.split(" = ")[1].split("  # ") for line in done.stdout.splitlines() if " = " in line}


@pytest.fixture
def configuration(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        path = tmp_path / "supple.toml"
        path.write_text(text)
        return path

    return write


def test_the_command_line_counts_more_than_the_environment_and_that_more_than_the_file(
        tmp_path: Path, configuration: Callable[[str], Path]) -> None:
    path = configuration('port = 1\nmax-jobs = 1\ngrace = 1\nallowed-host = ["a.example", "b.example"]\nopen = true\nmax-body = "2MB"\n')
    shown = settings(check(tmp_path, "--config", str(path), "--port", "3", SUPPLE_PORT="2", SUPPLE_MAX_JOBS="2"))
    assert shown["port"] == ["3", "command line"]
    assert shown["max-jobs"] == ["2", "environment, SUPPLE_MAX_JOBS"]
    assert shown["grace"] == ["1", f"{path}, line 3"]
    assert shown["allowed-host"] == ['["a.example", "b.example"]', f"{path}, line 4"]
    assert shown["open"] == ["true", f"{path}, line 5"]
    assert shown["max-body"] == ['"2MB"', f"{path}, line 6"]
    assert shown["workers"][1] == "default"
    assert settings(check(tmp_path, "--open=false", SUPPLE_OPEN="true"))["open"] == ["false", "command line"]


def test_a_server_runs_by_the_file_and_the_environment(new_server: Callable[..., ServerProcess], configuration: Callable[[str], Path],
                                                       monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUPPLE_CONFIG", str(configuration("access-log = true\nworkers = 3\n")))
    monkeypatch.setenv("SUPPLE_WORKERS", "5")
    server = new_server()
    assert " 5 workers" in server.log_text()
    server.terminate()
    assert " access " in server.log_text(), "the file's access-log counts"


def test_what_is_shown_is_a_configuration_file(tmp_path: Path, configuration: Callable[[str], Path]) -> None:
    # Unlike the folders of pytest, the name of a keys file may contain quotes and backslashes.
    first = check(tmp_path, "--allowed-host", "a.example", "--keys", 'a "b" \\ c', "--max-store", "20GB", "--helper", "")
    again = settings(run("--check-config", "--config", str(configuration(first.stdout))))
    shown = settings(first)
    assert {key: value for key, [value, _] in again.items()} == {key: value for key, [value, _] in shown.items()}
    assert shown["max-store"] == [str(20 * 2**30), "command line"]


@pytest.mark.parametrize("text, message", [
    ("max-vertice = 5\n", "line 1: there is no key 'max-vertice'; did you mean 'max-vertices'?"),
    ("\nmax_faces = 5\n", "line 2: there is no key 'max_faces'; did you mean 'max-faces'?"),
    ("colour = 5\n", "line 1: there is no key 'colour'; supple-server --help-config lists all of them"),
    ("config = 'x'\n", "line 1: there is no key 'config'"),
    ("port = 99999\n", "line 1: --port: Value 99999 not in range 0 to 65535"),
    ("port = [1, 2]\n", "line 1: --port has one value, not a list"),
    ("open = 'perhaps'\n", "line 1: "),
    ("max-body = 2GB\n", "line 1: the value '2GB' is neither a number nor true or false; text needs quotes"),
    ("models = '/no/such/folder'\n", "line 1: --models: Directory does not exist: /no/such/folder"),
    ("[limits]\n", "line 1: sections in brackets are not used"),
    ("port = 1\nport = 2\n", "line 2: the key 'port' was given in line 1 already"),
])
def test_a_file_with_a_mistake_is_refused_by_its_line(tmp_path: Path, configuration: Callable[[str], Path], text: str, message: str) -> None:
    path = configuration(text)
    for arguments in ([], ["--check-config"], ["keys", "list"]):
        refused = run("--config", str(path), "--data", str(tmp_path / "data"), *arguments)
        assert (refused.returncode, refused.stdout) == (2, "")
        assert f"{path}, {message}" in refused.stderr, refused.stderr
    assert not (tmp_path / "data").exists(), "nothing was started"


def test_all_mistakes_are_told_at_once(tmp_path: Path, configuration: Callable[[str], Path]) -> None:
    path = configuration("port = 1 2\nmax-vertice = 5\n")
    refused = check(tmp_path, "--config", str(path), SUPPLE_WORKERS="none")
    assert refused.returncode == 2 and len(refused.stderr.splitlines()) == 3
    assert "environment, SUPPLE_WORKERS: " in refused.stderr


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    refused = check(tmp_path, SUPPLE_CONFIG=str(tmp_path / "none.toml"))
    assert refused.returncode == 2
    assert f"--config: {tmp_path}/none.toml cannot be read: No such file or directory" in refused.stderr


def test_help_needs_no_sound_configuration(configuration: Callable[[str], Path]) -> None:
    path = str(configuration("nonsense\n"))
    for option in ("--help", "--version", "--help-config"):
        told = run(option, SUPPLE_CONFIG=path)
        assert (told.returncode, told.stderr) == (0, "") and told.stdout


def test_variables_that_are_no_options_are_told_and_those_of_others_are_not(tmp_path: Path) -> None:
    others = {"SUPPLE_SERVER": "http://127.0.0.1:1", "SUPPLE_KEY_FILE": "x", "SUPPLE_BUILD": "x", "SUPPLE_SERVICE_HOST": "10.0.0.1",
              "SUPPLE_PORT_8080_TCP": "x", "SUPPLE_TEST_SLOWNESS": "1"}
    assert check(tmp_path, **others).stderr == ""
    told = check(tmp_path, SUPPLE_MAX_STOR="1GB")
    assert told.returncode == 0
    assert told.stderr == ("supple-server: warning: the variable SUPPLE_MAX_STOR of the environment is not used: no option has this name; "
                           "did you mean SUPPLE_MAX_STORE?\n")


def test_an_empty_variable_is_none_and_lists_are_separated_by_commas(tmp_path: Path) -> None:
    shown = settings(check(tmp_path, SUPPLE_PORT="", SUPPLE_ALLOWED_HOST="a.example,b.example"))
    assert shown["port"] == ["8080", "default"]
    assert shown["allowed-host"] == ['["a.example", "b.example"]', "environment, SUPPLE_ALLOWED_HOST"]


def test_the_port_that_kubernetes_sets_is_explained(tmp_path: Path) -> None:
    refused = check(tmp_path, SUPPLE_PORT="tcp://10.0.0.1:8080")
    assert refused.returncode == 2 and "enableServiceLinks: false" in refused.stderr
    assert check(tmp_path, "--port", "1", SUPPLE_PORT="tcp://10.0.0.1:8080").returncode == 0, "the command line says otherwise"


def test_the_check_finds_what_would_keep_a_server_from_starting(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "empty").mkdir()
    keys = tmp_path / "keys"
    keys.write_text("nonsense\n")
    keys.chmod(0o600)
    for arguments, message in (
            (["--data", str(tmp_path / "file")], f"--data: {tmp_path}/file is not a folder"),
            (["--data", str(tmp_path / "file" / "data")], f"--data: {tmp_path}/file is not a folder"),
            (["--host", "0.0.0.0"], "--keys: The server would listen beyond loopback without any key"),
            (["--keys", str(keys)], "--keys: "),
            (["--helper", str(tmp_path / "file")], f"--helper: {tmp_path}/file cannot be run: Permission denied"),
            (["--web", str(tmp_path / "empty")], f"--web: {tmp_path}/empty has no index.html"),
            (["--port", "99999"], "--port: Value 99999 not in range 0 to 65535")):
        refused = run("--check-config", *arguments, folder=tmp_path)
        assert refused.returncode == 2 and message in refused.stderr, refused.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "file", "keys"], "it only looks"
    sound = check(tmp_path, "--host", "0.0.0.0", "--open")
    assert sound.returncode == 0 and sound.stdout.endswith("# A server can start with this configuration.\n")


def test_commands_find_the_data_folder_by_the_environment(tmp_path: Path) -> None:
    data = tmp_path / "data"
    data.mkdir(mode=0o700)
    made = run("keys", "add", "--name", "team", "--scopes", "read", SUPPLE_DATA=str(data))
    assert made.returncode == 0 and (data / "keys").exists(), made.stderr
    copied = run("backup", "--to", str(tmp_path / "copy"), SUPPLE_DATA=str(data))
    assert "is required" not in copied.stderr and "data:" not in copied.stderr, copied.stderr


def options_table() -> str:
    told = run("--help-config")
    assert told.returncode == 0, told.stderr
    return told.stdout


def test_the_page_lists_the_options_as_they_are() -> None:
    table = TABLE.search(PAGE.read_text())
    assert table, f"{PAGE} has no place for the table"
    assert table[0] == f"<!-- options -->\n{options_table()}<!-- /options -->", "tests/api/test_configuration.py --write brings the page up to date"


def test_every_option_of_the_help_is_in_the_table() -> None:
    of_process = {"--help", "--version", "--config", "--check-config", "--help-config"}
    told = set(re.findall(r"^ +(?:-h,)?(--[a-z-]+)", run("--help").stdout, flags=re.M))
    assert told - of_process == set(re.findall(r"^\| `(--[a-z-]+)`", options_table(), flags=re.M))


if __name__ == "__main__":
    if sys.argv[1:] != ["--write"]:
        raise SystemExit(f"{sys.argv[0]} --write writes the table of options in {PAGE}")
    PAGE.write_text(TABLE.sub(lambda marks: marks[1] + options_table() + marks[2], PAGE.read_text()))
