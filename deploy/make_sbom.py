#!/usr/bin/python3
"""Writes what a built Supple consists of, as a software bill of materials (CycloneDX 1.5, JSON).

    deploy/make_sbom.py [--build build/release] [--output sbom.json]

Components are the Debian packages of the shared libraries that the programs load, directly or through others, with the
versions that are installed; the packages of headers that are compiled into them; and what the web editor's bundle is made
of, from its lock file. Licences of Debian packages are those that their copyright files name in Debian's machine-readable
form; where a package has another form, the file is named instead.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, Dict, Iterable, List, Optional, Set

ROOT = Path(__file__).resolve().parent.parent
PROGRAMS = ("server/supple-server", "server/supple-helper", "clients/cli/supple")
COMPILED_IN = ("libeigen3-dev", "nlohmann-json3-dev", "libcli11-dev", "libtbb-dev", "libspdlog-dev")
"""Packages whose headers become part of the programs."""


def output_of(*command: str) -> str:
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout


def loaded_libraries(program: Path) -> Set[Path]:
    """The shared libraries that the loader finds for a program."""
    return {Path(path).resolve() for path in re.findall(r"=> (/\S+)", output_of("ldd", str(program)))}


def packages_of(files: Iterable[Path]) -> Set[str]:
    """The Debian packages that the files belong to. Files of no package raise LookupError: a bill must not be silent on them."""
    # A file of a merged /usr may be listed without it.
    names = {name: file for file in files for name in (str(file), str(file).removeprefix("/usr"))}
    found = subprocess.run(["dpkg-query", "--search", *sorted(names)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False)
    packages: Set[str] = set()
    owned: Set[Path] = set()
    for line in found.stdout.splitlines():
        package, _, name = line.rpartition(": ")
        if name in names:
            packages.add(package.split(":")[0])
            owned.add(names[name])
    unknown = sorted(set(names.values()) - owned)
    if unknown:
        raise LookupError(f"{unknown[0]} belongs to no Debian package")
    return packages


def licences_of(copyright_text: str) -> List[str]:
    """The short names in a copyright file of Debian's machine-readable form; empty for others."""
    if not copyright_text.startswith("Format:"):
        return []
    return sorted(set(line.strip() for line in re.findall(r"^License:[ \t]*(\S.*)$", copyright_text, re.MULTILINE)))


def debian_component(name: str) -> Dict[str, Any]:
    version, architecture, homepage = output_of("dpkg-query", "--show", "--showformat", "${Version}\t${Architecture}\t${Homepage}", name).split("\t")
    component: Dict[str, Any] = {"type": "library", "name": name, "version": version,
                                 "purl": f"pkg:deb/debian/{name}@{version}?arch={architecture}&distro=debian-12"}
    if homepage:
        component["externalReferences"] = [{"type": "website", "url": homepage}]
    file = Path(f"/usr/share/doc/{name}/copyright")
    licences = licences_of(file.read_text(errors="replace")) if file.exists() else []
    component["licenses"] = [{"license": {"name": licence}} for licence in licences or [f"see {file}"]]
    return component


def npm_components(lock: Dict[str, Any]) -> List[Dict[str, Any]]:
    """Packages that the page's bundle may contain: all of a lock file (version 2 or 3) but those for development."""
    components = []
    for path, package in sorted(lock["packages"].items()):
        if not path or package.get("dev"):
            continue
        name = path.split("node_modules/")[-1]
        component = {"type": "library", "name": name, "version": package["version"], "purl": f"pkg:npm/{name.replace('@', '%40')}@{package['version']}",
                     "licenses": [{"license": {"name": package.get("license", "not said")}}]}
        components.append(component)
    return components


def version_of(program: Path) -> str:
    """What a built program says its version is, without its own name."""
    return output_of(str(program), "--version").split()[-1]


def bill(build: Path) -> Dict[str, Any]:
    missing = [program for program in PROGRAMS if not (build / program).exists()]
    if missing:
        raise FileNotFoundError(f"{build / missing[0]} is missing: build the target {Path(missing[0]).name} first")
    libraries: Set[Path] = set().union(*(loaded_libraries(build / program) for program in PROGRAMS))
    names = packages_of(libraries) | set(COMPILED_IN)
    lock = json.loads((ROOT / "clients" / "web" / "package-lock.json").read_text(encoding="utf-8"))
    return {
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": {"timestamp": datetime.now(timezone.utc).isoformat(timespec="seconds"),
                     "component": {"type": "application", "name": "supple", "version": version_of(build / PROGRAMS[0])}},
        "components": [debian_component(name) for name in sorted(names)] + npm_components(lock),
    }


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "release", help="folder of the built programs")
    parser.add_argument("--output", type=Path, help="file to write; without it the bill is printed")
    options = parser.parse_args(arguments)
    try:
        text = json.dumps(bill(options.build), indent=2) + "\n"
    except (LookupError, OSError, subprocess.CalledProcessError) as error:
        print(f"make_sbom.py: {error}", file=sys.stderr)
        return 1
    if options.output:
        options.output.write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
