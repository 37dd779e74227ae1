"""The packages for Debian 12, taken apart: they hold what they should, and what is in them works from there.

Environment: SUPPLE_PACKAGES, the folder of the packages (build/packages), which deploy/build_packages.sh has filled.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Dict, Iterator, Set

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = Path(os.environ.get("SUPPLE_PACKAGES", ROOT / "build" / "packages"))
NAMES = ("supple-server", "supple", "libsupple-dev", "python3-supple")


def run(*command: str, **options: str) -> str:
    """What a command prints; options become variables of its environment."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **options})
    assert done.returncode == 0, f"{' '.join(command)}: {done.stdout[-2000:]}{done.stderr[-2000:]}"
    return done.stdout


def package(name: str) -> Path:
    found = sorted(PACKAGES.glob(f"{name}_*.deb"))
    assert len(found) == 1, f"{len(found)} packages {name} in {PACKAGES}: run deploy/build_packages.sh"
    return found[0]


def field(name: str, which: str) -> str:
    return run("dpkg-deb", "--field", str(package(name)), which).strip()


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All packages as a machine would have them, below one folder."""
    folder = tmp_path_factory.mktemp("root")
    for name in NAMES:
        run("dpkg-deb", "--extract", str(package(name)), str(folder))
    return folder


@pytest.fixture(scope="module")
def server(unpacked: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The packaged server, which finds its networks and its page by itself; gives its address."""
    data = tmp_path_factory.mktemp("data")
    process = subprocess.Popen([str(unpacked / "usr/bin/supple-server"), "--port", "0", "--data", str(data), "--open"], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = re.search(r"http://\S+", line)
        assert address, line
        yield address.group()
    finally:
        process.terminate()
        process.wait(30)


@pytest.mark.parametrize("name", NAMES)
def test_a_package_says_what_it_is_and_whose(name: str, unpacked: Path) -> None:
    assert field(name, "Package") == name
    assert re.fullmatch(r"\d+\.\d+\.\d+(~dev)?(\+[0-9a-z.]+)?", field(name, "Version"))
    assert field(name, "Architecture") == ("all" if name == "python3-supple" else run("dpkg", "--print-architecture").strip())
    assert len(field(name, "Description").splitlines()) > 1
    assert "GPL-3" in (unpacked / "usr/share/doc" / name / "copyright").read_text(encoding="utf-8")
    assert "@" in field(name, "Maintainer")


def test_a_package_depends_on_the_libraries_of_its_programs() -> None:
    for name, libraries in {"supple-server": ["libgmsh", "libhdf5", "libcholmod", "libsqlite3", "libc6 (>="], "supple": ["libc6 (>=", "libcpp-httplib"]}.items():
        for library in libraries:
            assert library in field(name, "Depends"), name
    assert "libeigen3-dev" in field("libsupple-dev", "Depends")
    for library in ("libhdf5-dev", "libpolyclipping-dev", "libpugixml-dev", "libzip-dev", "libfmt-dev"):
        assert library not in field("libsupple-dev", "Depends"), "geodesics do without it"
        assert library in field("libsupple-dev", "Recommends"), "other components use it"
    assert "torch" not in "".join(field(name, "Depends") for name in NAMES), "training stays where networks are trained"


def test_no_two_packages_have_the_same_file() -> None:
    owners: Dict[str, Set[str]] = {}
    for name in NAMES:
        for line in run("dpkg-deb", "--contents", str(package(name))).splitlines():
            mode, _, _, _, _, path = line.split(maxsplit=5)
            assert " root/root " in line and "w" not in mode[5:], line
            if not path.endswith("/"):
                owners.setdefault(path, set()).add(name)
    assert {path: who for path, who in owners.items() if len(who) > 1} == {}
    assert all(path.startswith("./usr/") for path in owners)


def test_nothing_in_a_package_names_the_folder_that_it_was_built_in(unpacked: Path) -> None:
    built_in = str(ROOT).encode()
    named = [str(path) for path in unpacked.rglob("*") if path.is_file() and built_in in path.read_bytes()]
    assert named == []


def test_the_server_finds_its_networks_and_its_page(server: str, unpacked: Path) -> None:
    version = run(str(unpacked / "usr/bin/supple-server"), "--version").split()[-1]
    assert version.replace("-dev", "~dev") == field("supple-server", "Version")
    client = str(unpacked / "usr/bin/supple")
    models = run(client, "--server", server, "models")
    assert sum(name in models for name in ("ih01", "ih21", "ih22", "ih28", "ih29", "ih50", "ih67")) == 7
    page = run("curl", "-fsS", server + "/")
    assert "<title>" in page
    assert "MIT" in run("curl", "-fsS", server + "/licences.txt")
    assert "systemctl" in (unpacked / "usr/share/doc/supple-server/README.md").read_text(encoding="utf-8"), "what postinst refers to"


def test_the_packaged_helper_meshes_and_the_client_writes_the_file(server: str, unpacked: Path, tmp_path: Path) -> None:
    client = str(unpacked / "usr/bin/supple")
    run(client, "--server", server, "structure", "IH21", "--stl", str(tmp_path / "patch.stl"))
    assert (tmp_path / "patch.stl").stat().st_size > 1000
    assert (unpacked / "usr/share/man/man1/supple.1").exists() or (unpacked / "usr/share/man/man1/supple.1.gz").exists()


def test_the_python_package_is_imported_from_where_debian_has_it(server: str, unpacked: Path) -> None:
    folder = unpacked / "usr/lib/python3/dist-packages"
    printed = run("/usr/bin/python3", "-c", f"import supple; print(supple.__file__, supple.Client({server!r}).ready())", PYTHONPATH=str(folder), PYTHONDONTWRITEBYTECODE="1")
    assert printed.split() == [str(folder / "supple" / "__init__.py"), "True"]
    assert (folder / "supple" / "py.typed").exists()


def test_a_program_of_ones_own_is_built_with_the_packaged_library(unpacked: Path, tmp_path: Path) -> None:
    examples = tmp_path / "examples"
    shutil.copytree(unpacked / "usr/share/doc/supple/examples", examples)
    run("cmake", "-S", str(examples), "-B", str(tmp_path / "build"), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={unpacked / 'usr'}")
    run("cmake", "--build", str(tmp_path / "build"))
    distance = run(str(tmp_path / "build" / "geodesic_distance"), str(ROOT / "api" / "examples" / "meshes" / "torus.obj"))
    assert "distance" in distance
    models = unpacked / "usr/share/supple/models"
    assert run(str(tmp_path / "build" / "find_design"), str(models / "ih21.h5"))
    assert run(str(tmp_path / "build" / "homogenize_tiling"), "IH21")


def test_the_rooms_that_train_are_not_in_the_library(unpacked: Path) -> None:
    headers = {path.name for path in (unpacked / "usr/include/supple").iterdir()}
    assert {"surface", "design", "weave"} <= headers and not headers & {"training", "lab"}


@pytest.mark.parametrize("arguments", [("postinst", "configure"), ("prerm", "remove"), ("prerm", "upgrade"), ("postrm", "purge")])
def test_the_scripts_of_the_package_run_where_no_systemd_does(arguments: "tuple[str, str]", tmp_path: Path) -> None:
    if Path("/run/systemd/system").exists():
        pytest.skip("systemd runs here, and would be told of the unit")
    run("dpkg-deb", "--control", str(package("supple-server")), str(tmp_path))
    run(str(tmp_path / arguments[0]), arguments[1])
