"""CMake's target graph, and the files that each source file reads. They determine the tests that a change in C++ requires."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, FrozenSet, List, Set, Tuple

from includes import Includes


@dataclass
class Target:
    name: str
    kind: str  #: type in CMake's file API: EXECUTABLE, STATIC_LIBRARY, UTILITY
    folder: str  #: folder of its CMakeLists.txt, relative to the project
    sources: List[str] = field(default_factory=list)
    folders: List[str] = field(default_factory=list)  #: folders of the project that are searched for headers
    uses: FrozenSet[str] = frozenset()  #: targets that are built before it


def configured_targets(root: Path, build: Path) -> List[Target]:
    """Configures `build` with tests, benchmarks and fuzzers, without compiling."""
    query = build / ".cmake/api/v1/query"
    query.mkdir(parents=True, exist_ok=True)
    (query / "codemodel-v2").touch()
    done = subprocess.run(["cmake", "--preset", "release", "-B", str(build), "-DSUPPLE_BUILD_BENCH=ON", "-DSUPPLE_BUILD_FUZZ=ON",
                           "-DSUPPLE_GROUPED=OFF"], cwd=root, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"cmake ended with status {done.returncode}:\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}")
    reply = build / ".cmake/api/v1/reply"
    index = json.loads(max(reply.glob("index-*.json")).read_text())
    model = json.loads((reply / index["reply"]["codemodel-v2"]["jsonFile"]).read_text())
    return [read_target(root, json.loads((reply / entry["jsonFile"]).read_text()))
            for entry in model["configurations"][0]["targets"]]


def read_target(root: Path, told: dict) -> Target:  # type: ignore[type-arg]
    folders: Dict[str, None] = {}
    for group in told.get("compileGroups", []):
        for include in group.get("includes", []):
            path = Path(include["path"]).resolve()
            if path.is_relative_to(root):
                folders[str(path.relative_to(root))] = None
    return Target(told["name"], told["type"], told["paths"]["source"], [source["path"] for source in told.get("sources", [])],
                  list(folders), frozenset(entry["id"].split("::@")[0] for entry in told.get("dependencies", [])))


class Graph:
    """Targets with all targets that they use, directly or not, and the files that each of their sources reads."""

    def __init__(self, root: Path, targets: List[Target]) -> None:
        self.targets = {target.name: target for target in targets}
        self.users: Dict[str, Set[str]] = {name: set() for name in self.targets}
        for target in targets:
            for used in target.uses:
                self.users.setdefault(used, set()).add(target.name)
        includes = Includes(root)
        self.read: Dict[Tuple[str, str], FrozenSet[str]] = {
            (target.name, source): includes.closure(source, tuple(target.folders)) for target in targets for source in target.sources}

    def readers(self, file: str) -> Set[Tuple[str, str]]:
        """Pairs of a target and one of its sources that reads this file."""
        return {key for key, files in self.read.items() if file in files}

    def owners(self, file: str) -> Set[str]:
        """Targets of the innermost folder around this file that has targets, for a file that was deleted or that no source includes."""
        folder = Path(file).parent
        while folder != Path("."):
            owners = {target.name for target in self.targets.values() if target.folder == str(folder)}
            if owners:
                return owners
            folder = folder.parent
        return set()

    def users_of(self, names: Set[str]) -> Set[str]:
        """These targets and all targets that use them, directly or not."""
        reached, open_names = set(names), list(names)
        while open_names:
            for user in self.users.get(open_names.pop(), set()) - reached:
                reached.add(user)
                open_names.append(user)
        return reached

    def programs(self, folder: str) -> Set[str]:
        """Programs that are declared within a folder of the project."""
        return {target.name for target in self.targets.values()
                if target.kind == "EXECUTABLE" and (target.folder == folder or target.folder.startswith(f"{folder}/"))}

    def used_by(self, name: str) -> FrozenSet[str]:
        return self.targets[name].uses if name in self.targets else frozenset()
