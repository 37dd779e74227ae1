#!/usr/bin/python3
"""Fails where a file includes what its room may not see (the arrows in CONTRIBUTING.md), where one writes again what numerics
has, and where a room's threads are not watched by the thread sanitizer."""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# Folder -> rooms under <supple/...> that its files may include, or single headers of a room.
ROOMS = {
    "engine/base": {"base"},
    "engine/numerics": {"base", "numerics"},
    "engine/surface": {"base", "numerics", "surface"},
    "engine/meshing": {"base", "meshing"},
    "engine/outlines": {"base", "outlines"},
    "engine/embedded": {"base", "numerics", "surface", "meshing", "embedded"},
    "engine/voronoi": {"base", "numerics", "surface", "voronoi"},
    "engine/tiling": {"base", "meshing", "tiling"},
    "engine/microscale": {"base", "numerics", "tiling", "microscale"},
    "engine/weave": {"base", "numerics", "weave"},
    "engine/files": {"base", "files"},
    "engine/dataset": {"base", "files", "dataset"},
    # Training sees families of tilings and their definitions, and not their meshes: networks are trained where there is no mesh generator.
    "engine/training": {"base", "files", "tiling/definition_text.h", "tiling/family.h", "tiling/family_definition.h", "tiling/symmetry.h", "dataset", "neural", "training"},
    "engine/neural": {"base", "files", "neural"},
    "engine/design": {"base", "numerics", "tiling", "microscale", "neural", "design"},
    "engine/helper": {"base", "numerics", "meshing", "neural", "tiling"},
    "engine/lab": {"base", "files", "numerics", "tiling", "microscale", "dataset", "neural", "training", "lab"},
    "engine/examples": {"base", "surface", "embedded", "voronoi", "outlines", "tiling", "microscale", "neural", "design", "weave"},
    "server/problem": {"base", "problem"},
    "server/log": {"log"},
    "server/budget": {"base", "problem", "budget"},
    "server/access": {"base", "problem", "access"},
    "server/configuration": {"problem", "configuration"},
    "server/http": {"base", "problem", "budget", "log", "http"},
    "server/json": {"base", "numerics", "surface", "embedded", "voronoi", "outlines", "tiling", "microscale", "weave", "neural", "design", "problem", "budget", "json"},
    "server/store": {"base", "numerics", "surface", "tiling", "neural", "design", "problem", "store"},
    "server/metrics": {"base", "problem", "metrics"},
    "server/trainings": {"base", "trainings"},
    "server/jobs": {"base", "problem", "budget", "log", "store", "jobs"},
    "server/routes": {"base", "surface", "embedded", "voronoi", "outlines", "tiling", "microscale", "weave", "neural", "design", "problem", "budget", "access", "http",
                      "json", "store", "metrics", "jobs", "trainings", "routes"},
    "clients": set(),
}

# Heavy or foreign libraries -> the folders whose files may include them.
LIBRARIES = {
    "httplib.h": ("server/http", "clients/cli", "tests"),
    "nlohmann/": ("server/json", "clients/cli", "tests"),
    "sqlite3.h": ("server/store",),
    "pqxx/pqxx": ("server/store",),
    "prometheus/": ("server/metrics",),
    "spdlog/": ("server",),
    "CLI/": ("server", "clients/cli", "engine/lab"),
    "hdf5.h": ("engine/files",),
    "zip.h": ("engine/tiling",),
    "torch/": ("engine/training", "tests"),
    "CGAL/": ("tests",),
    "gmsh.h": ("engine/meshing", "tests/unit/tiling"),
    "pugixml.hpp": ("engine/outlines",),
    "polyclipping/": ("engine/outlines", "engine/tiling"),
    "clipper.hpp": ("engine/tiling",),
    "cholmod.h": ("engine/numerics",),
    "tbb/": ("engine/base", "tests/unit/base"),
    "oneapi/": ("engine/base",),
    "gtest/": ("tests",),
    "benchmark/": ("tests",),
}

# What numerics has once for all rooms of the engine and the server.
WRITTEN_ONCE = (
    (re.compile(r"\bpublic\s+(?:supple::)?(?:numerics::)?Objective\b"),
     "implements Objective by hand: a sum of energies is a numerics::System of a state and its terms"),
    (re.compile(r"\b(?:class|struct)\s+\w*EquilibriumPath\b"),
     "is a second load stepper: numerics::EquilibriumPath follows every load path"),
)

# Rooms with threads of their own, and where their tests are said to be worth the thread sanitizer's time.
THREADS = re.compile(r"\b(parallel_for|parallel_tasks|parallel_bills|std::j?thread)\b")
# Training is not built with sanitizers.
WITHOUT_THREADED_TESTS = {"engine/training"}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


def untested_threads() -> "list[str]":
    found = []
    for room in sorted(set(ROOMS) - WITHOUT_THREADED_TESTS - {"clients"}):
        top, name = room.split("/")
        sources = [path for path in (ROOT / room).rglob("*") if path.suffix in (".h", ".cpp")]
        if not any(THREADS.search(path.read_text(encoding="utf-8")) for path in sources):
            continue
        tests = ROOT / "tests/unit" / (name if top == "engine" else "server") / "CMakeLists.txt"
        program = rf"supple_unit_test\((?:unit_\w+|server_{name}_test) THREADS\b"
        if not re.search(program, tests.read_text(encoding="utf-8")):
            found.append(f"{tests.relative_to(ROOT)}: {room} has threads, but none of its test programs is marked THREADS")
    return found


def violations() -> "list[str]":
    found = []
    sources = [path for top in ("engine", "server", "clients", "tests") for path in sorted((ROOT / top).rglob("*"))
               if path.suffix in (".h", ".cpp", ".hpp", ".cc") and "node_modules" not in path.parts]
    if len(sources) < 10:
        return [f"only {len(sources)} source files were found: the check looks in the wrong place"]
    for top in ("engine", "server"):
        for folder in sorted(path for path in (ROOT / top).iterdir() if path.is_dir()):
            if f"{top}/{folder.name}" not in ROOMS:
                found.append(f"{top}/{folder.name}: no arrow of this room is known; add it to ROOMS and CONTRIBUTING.md")
    for path in sources:
        name = path.relative_to(ROOT).as_posix()
        shared = name.startswith(("engine/", "server/")) and not name.startswith("engine/numerics/")
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if shared:
                found += [f"{name}:{number}: {what}" for pattern, what in WRITTEN_ONCE if pattern.search(line)]
            match = INCLUDE.match(line)
            if not match:
                continue
            header = match.group(1)
            for folder, rooms in ROOMS.items():
                if name.startswith(folder + "/") and header.startswith("supple/") and not (
                        header.split("/")[1] in rooms or header.removeprefix("supple/") in rooms):
                    found.append(f"{name}:{number}: {folder} may not see {header}")
            for library, folders in LIBRARIES.items():
                if header.startswith(library) and not any(name.startswith(f + "/") for f in folders):
                    found.append(f"{name}:{number}: {header} belongs to {', '.join(folders)}")
            if ".." in header.split("/"):
                found.append(f"{name}:{number}: {header} climbs out of its folder")
    return found


if __name__ == "__main__":
    wrong = violations() + untested_threads()
    print("\n".join(wrong) if wrong else "every include runs along the arrows, and there is one objective and one load stepper")
    sys.exit(1 if wrong else 0)
