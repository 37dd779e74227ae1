"""The image's recipe, compose and the systemd unit: their promised settings, without building or starting them."""

from __future__ import annotations

import itertools
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import List

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
DEPLOY = ROOT / "deploy"
CONTAINERFILE = (DEPLOY / "Containerfile").read_text()


def test_every_list_of_packages_is_in_the_image() -> None:
    lists = [path.name for path in DEPLOY.glob("*packages*.txt")]
    assert lists, "deploy/ has no list of packages"
    for name in lists:
        assert f"COPY deploy/{name}" in CONTAINERFILE


def test_the_build_sees_what_the_recipe_copies_and_nothing_else() -> None:
    ignored = (ROOT / ".containerignore").read_text().splitlines()
    assert ignored[1] == "*", "everything is left out that is not named"
    copied = {source for line in re.findall(r"^COPY (?!--from)(.*) \S+$", CONTAINERFILE, flags=re.M) for source in line.split()}
    named = {line[1:].split("/*")[0] for line in ignored if line.startswith("!")}
    assert copied == named
    for source in copied:
        assert (ROOT / source).exists(), f"the recipe copies {source}, which does not exist"
    assert (ROOT / ".dockerignore").resolve() == ROOT / ".containerignore", "docker reads a file of another name"


def test_all_that_the_editor_takes_from_outside_its_folder_is_copied() -> None:
    stage = CONTAINERFILE.split("AS editor")[1].split("\nFROM")[0]
    copied = re.findall(r"^COPY (\S+) ", stage, flags=re.M)
    imports: List[str] = []
    for path in (ROOT / "clients" / "web" / "src").rglob("*.ts"):
        for name in re.findall(r'"((?:\.\./)+(?:api|docs|models)/[^"?]+)', path.read_text()):
            imports.append(str((path.parent / name).resolve().relative_to(ROOT)))
    assert imports, "the editor imports nothing: this test looks for the wrong text"
    for name in imports:
        assert any(name.startswith(folder + "/") for folder in copied), f"{name} is not in the stage that builds the editor"


def test_the_image_is_not_root_and_says_whether_it_is_well() -> None:
    last = CONTAINERFILE.split("\nFROM")[-1]
    assert re.search(r"^USER 10001:10001$", last, flags=re.M)
    assert re.search(r"^HEALTHCHECK ", last, flags=re.M) and "/healthz" in last
    # Only Docker's image format has a health check.
    assert "--format docker" in (DEPLOY / "build_image.sh").read_text()


def test_compose_has_limits_and_publishes_on_this_machine_alone() -> None:
    service = yaml.safe_load((DEPLOY / "compose.yaml").read_text())["services"]["supple"]
    assert service["mem_limit"] and service["pids_limit"]
    assert service["read_only"] is True and service["cap_drop"] == ["ALL"]
    assert all(port.startswith("127.0.0.1:") for port in service["ports"])
    assert (DEPLOY / service["build"]["context"] / service["build"]["dockerfile"]).exists()


def test_every_example_publishes_on_this_machine_alone() -> None:
    for path in [*DEPLOY.rglob("*"), ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        if not path.is_file() or path.suffix in (".h5", ".pyc"):
            continue
        for published in re.findall(r"(?:-p|--publish)[ =](\S*8080\S*)", path.read_text()):
            assert published.startswith("127.0.0.1:"), f"{path} publishes {published}"


def test_the_unit_has_limits_and_is_understood_by_systemd() -> None:
    unit = DEPLOY / "supple-server.service"
    text = unit.read_text()
    for setting in ("MemoryMax=", "TasksMax=", "NoNewPrivileges=yes", "ProtectSystem=strict", "DynamicUser=yes"):
        assert re.search(f"^{setting}", text, flags=re.M), f"the unit has no {setting}"
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not installed")
    done = subprocess.run(["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, timeout=60, check=False)
    # The program is not installed on this machine, which is no fault of the unit.
    faults = [line for line in done.stderr.splitlines() if "supple-server.service" in line and "not executable" not in line]
    assert faults == []
    done = subprocess.run(["systemd-analyze", "security", "--offline=true", "--threshold=20", "--no-pager", str(unit)],
                          capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, f"more than 2.0 of 10 is exposed:\n{done.stdout[-2000:]}"


@pytest.mark.parametrize("script", sorted(path.relative_to(ROOT).as_posix() for folder in (DEPLOY, DEPLOY / "slurm", ROOT / "tests" / "deploy", ROOT / "tests" / "release") for path in folder.glob("*.sh")))
def test_a_script_explains_itself_and_refuses_what_it_does_not_know(script: str) -> None:
    told = subprocess.run([str(ROOT / script), "--help"], capture_output=True, text=True, timeout=60, check=False)
    lines = (ROOT / script).read_text().splitlines()
    header = [line[2:] for line in itertools.takewhile(lambda line: line.startswith("#"), lines[1:])]
    assert told.returncode == 0 and script in told.stdout and told.stderr == ""
    assert told.stdout.splitlines() == header, "the help is the comment that the script begins with, all of it"
    refused = subprocess.run([str(ROOT / script), "--no-such-option"], capture_output=True, text=True, timeout=60, check=False)
    assert refused.returncode != 0 and "--no-such-option" in refused.stderr
    if shutil.which("shellcheck") is not None:
        checked = subprocess.run(["shellcheck", str(ROOT / script)], capture_output=True, text=True, timeout=60, check=False)
        assert checked.returncode == 0, checked.stdout


@pytest.mark.skipif(shutil.which("shellcheck") is None, reason="shellcheck is not installed")
@pytest.mark.parametrize("script", ["postinst", "prerm", "postrm"])
def test_a_script_of_the_package_has_nothing_that_shellcheck_finds(script: str) -> None:
    checked = subprocess.run(["shellcheck", str(DEPLOY / "debian" / script)], capture_output=True, text=True, timeout=60, check=False)
    assert checked.returncode == 0, checked.stdout


def test_everything_that_names_a_version_names_that_of_the_contract() -> None:
    contract = yaml.safe_load((ROOT / "api" / "openapi.yaml").read_text(encoding="utf-8"))["info"]["version"]
    page = json.loads((ROOT / "clients" / "web" / "package.json").read_text(encoding="utf-8"))["version"]
    python = re.search(r'^version = "(.*)"$', (ROOT / "clients" / "python" / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    module = re.search(r'^__version__ = "(.*)"$', (ROOT / "clients" / "python" / "supple" / "__init__.py").read_text(encoding="utf-8"), re.MULTILINE)
    assert python and module
    assert {"page": page, "python": python.group(1), "module": module.group(1)} == dict.fromkeys(("page", "python", "module"), contract)
