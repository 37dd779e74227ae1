"""clang-tidy with the checks of .clang-tidy over every source file of the engine, the server and the CLI.

    tests/tidy.py [jobs [file ...]]     needs the presets release and asan-ubsan configured; with files only these are checked

Most of clang-tidy's time goes into headers and into what they instantiate. So the files of several rooms are read as one:
each room is a namespace of its own, and the preset asan-ubsan has already put the files of a room into few. Findings name
the file they are in. A file that was found clean before, with all that it includes, is left out (tidy_cache.py). Of the training room, what includes LibTorch is left out, whose headers clang 14 does not compile as
C++20.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from bisect import bisect_left
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Dict, List, Tuple

from single_files import command_of
from tidy_cache import cache_of

ROOT = Path(__file__).resolve().parents[1]
OUTPUT = ROOT / "build" / "tidy"
LINES = 16_000
"""Lines of a group, not counting headers: more of them need gigabytes of memory."""
SHALLOW = ["-Xclang", "-analyzer-config", "-Xclang", "mode=shallow,max-nodes=15000"]
"""The analyzer follows calls into small functions alone; to follow all of them takes it about three times as long. Of a function
with very many paths it looks at a fifth of what it would otherwise, which takes it half as long."""
INCLUDES_LIBTORCH = {"checkpoint", "jet_layer", "matrix_product", "optimizer", "row_losses", "stiffness_fit", "torch_network",
                     "trainer", "training_batches", "training_set"}


@dataclass
class Source:
    """What a compiler is called for, with the options that differ between rooms apart from the others."""
    target: str
    file: Path
    seen: List[str] = field(default_factory=list)
    others: List[str] = field(default_factory=list)
    files: List[Path] = field(default_factory=list)
    """The files of a room that are compiled as one, or the one."""

    def __post_init__(self) -> None:
        if not self.files and re.fullmatch(r"unity_\d+_cxx\.cxx", self.file.name):
            self.files = [Path(file) for file in re.findall(r'#include "(.*)"', self.file.read_text())]
        elif not self.files:
            self.files = [self.file]

    def lines(self) -> int:
        return sum(file.read_text().count("\n") for file in self.files)


def lines_of(group: List[Source]) -> int:
    return sum(source.lines() for source in group)


def sources(preset: str) -> List[Source]:
    database = ROOT / "build" / preset / "compile_commands.json"
    if not database.exists():
        sys.exit(f"tests/tidy.py: first cmake --preset {preset}")
    found = []
    for entry in json.loads(database.read_text()):
        target = re.search(r"CMakeFiles/([^/]+)\.dir/", entry["command"])
        assert target, entry["command"]
        source = Source(target[1], Path(entry["file"]))
        words = command_of(entry)[1:]
        while words:
            word = words.pop(0)
            if word in ("-I", "-isystem"):
                source.seen += [word + words.pop(0)]
            elif word.startswith(("-I", "-D")):
                source.seen += [word]
            elif word != entry["file"]:
                source.others += [word]
        found.append(source)
    return found


def groups(is_wanted: Callable[[Source, Path], bool]) -> Dict[str, List[Source]]:
    """Files that are read as one, of those that are wanted. Those of one room are in different groups: equal names may have kept them apart."""
    found: Dict[str, List[Source]] = {}
    for source in sources("asan-ubsan"):
        path = f"/{source.file.relative_to(ROOT)}"
        room = re.search(r"/(engine|server|clients)/", path)
        if not room or "/tests/" in path:
            continue
        source.files = [file for file in source.files if is_wanted(source, file)]
        if not source.files:
            continue
        if not source.target.startswith("supple_"):  # a program, with a function main of its own
            found[f"{source.target}_{source.file.stem}"] = [source]
            continue
        together = re.fullmatch(r"unity_(\d+)_cxx", source.file.stem)
        number = together[1] if together else "alone"
        part = 0
        while (group := found.setdefault(f"{room[1]}_{number}_{part}", [])) and lines_of(group) + source.lines() > LINES:
            part += 1
        group.append(source)
    training = next(source for source in sources("release") if source.target == "supple_training")
    found["training"] = [Source(training.target, file, training.seen, training.others)
                         for file in sorted((ROOT / "engine" / "training" / "src").glob("*.cpp"))
                         if file.stem not in INCLUDES_LIBTORCH and is_wanted(training, file)]
    return {name: members for name, members in found.items() if members}


def text_of(source: Path) -> str:
    """The source as it stands, with the places of the headers beside it."""
    def found(line: re.Match[str]) -> str:
        header = source.parent / line[1]
        return f'#include "{header}"' if header.exists() else line[0]
    return re.sub(r'^#include "(.*)"', found, source.read_text(), flags=re.M)


@dataclass
class Together:
    """Sources in one file, which clang-tidy takes for written there: it analyses only what stands in the file it is given."""
    file: Path
    members: List[Source]
    begins: List[Tuple[int, Path]] = field(default_factory=list)
    """The line before the first of each source."""

    def write(self) -> None:
        lines: List[str] = []
        for member in self.members:
            for source in member.files:
                lines.append("#undef _res")  # a macro of <resolv.h>, and the name of one of Eigen's arguments
                self.begins.append((len(lines), source))
                lines += text_of(source).splitlines()
        self.file.write_text("\n".join(lines) + "\n")

    def command(self) -> Dict[str, object]:
        seen = dict.fromkeys(option for member in self.members for option in member.seen)
        return {"directory": str(ROOT), "file": str(self.file),
                "arguments": ["clang++", *self.members[0].others, *seen, "-c", str(self.file)]}

    def findings(self) -> str:
        options = ["-Wno-unknown-warning-option", *SHALLOW]
        done = subprocess.run(["clang-tidy", "-p", str(OUTPUT), "--quiet", *(f"--extra-arg={option}" for option in options),
                               str(self.file)], capture_output=True, text=True, check=False)
        return "" if done.returncode == 0 else re.sub(re.escape(str(self.file)) + r":(\d+)", self.place, done.stdout or done.stderr)

    def place(self, found: re.Match[str]) -> str:
        line = int(found[1])
        begin, source = self.begins[bisect_left(self.begins, (line, ROOT)) - 1]
        return f"{source.relative_to(ROOT)}:{line - begin}"


def write(found: Dict[str, List[Source]]) -> Dict[str, List[Together]]:
    """For each group all its sources together and then, unless there is but one, each alone; the largest group first."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    written = {}
    for name, members in sorted(found.items(), key=lambda item: -lines_of(item[1])):
        written[name] = [Together(OUTPUT / f"{name}.cpp", members)]
        if len(members) > 1:
            written[name] += [Together(OUTPUT / f"{name}_alone_{k}.cpp", [member]) for k, member in enumerate(members)]
    every = [together for group in written.values() for together in group]
    for together in every:
        together.write()
    (OUTPUT / "compile_commands.json").write_text(json.dumps([together.command() for together in every], indent=1))
    return written


def check(group: List[Together]) -> str:
    """The findings of a group. Where it has any, its sources are asked one by one: they may only not go together."""
    findings = group[0].findings()
    if not findings or len(group) == 1:
        return findings
    alone = "\n".join(filter(None, (member.findings() for member in group[1:])))
    if not alone:
        print(f"This took longer, for its sources do not go together:\n{findings}", flush=True)
    return alone


def main() -> int:
    jobs = int(sys.argv[1]) if len(sys.argv) > 1 else os.cpu_count() or 1
    wanted = {ROOT / file for file in sys.argv[2:]}
    cache, where = cache_of(ROOT, SHALLOW)
    keys: Dict[Path, str] = {}

    def is_wanted(source: Source, file: Path) -> bool:
        if wanted and file not in wanted:
            return False
        keys[file] = cache.key(file, [*source.others, *source.seen])
        return not cache.is_clean(keys[file])

    groups_to_check = list(write(groups(is_wanted)).values())
    left = [file for group in groups_to_check for member in group[0].members for file in member.files]
    print(f"{len(left)} of {len(keys)} files are looked at; {where}", flush=True)
    clean = True
    with ThreadPoolExecutor(jobs) as pool:
        for group, findings in zip(groups_to_check, pool.map(check, groups_to_check)):
            if findings:
                clean = False
                print(findings, flush=True)
            else:
                cache.keep([keys[file] for member in group[0].members for file in member.files])
    return 0 if clean else 1


if __name__ == "__main__":
    sys.exit(main())
