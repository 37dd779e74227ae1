"""Determines the parts of tests/run.sh, and the tests of each part, that depend on changed files.

    tests/changes/plan.py [REV]     since REV, or else since the commit that tests/whole-run.txt names

Uncommitted changes are included. Prints a line for each part: its name and, unless all of it must run, the tests to run. The
reasons are printed on standard error. If the dependents of a change are unknown, all tests depend on it.
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Dict, List, Optional, Set

from paths import EVERYTHING, TARGETS, effects_of
from targets import Graph, configured_targets
from topics import pages_about, files_about, words_of

ROOT = Path(__file__).resolve().parents[2]
WHOLE_RUN = "tests/whole-run.txt"

PARTS = ["build", "unit", "stability", "python", "api", "docs", "deploy", "hostile", "web", "browser", "bench", "tidy", "asan", "tsan", "fuzz"]
"""Parts that depend on the changes. The others take seconds and always run, as do the checks of links and spelling of the pages."""
ALWAYS = ["changes", "arrows", "format"]
SERVED = {"supple-server", "supple-helper", "make_test_model"}
"""Programs that tests with a running server start."""


@dataclass
class Plan:
    """For each part the names of the tests to run, or None if all of it runs."""
    parts: Dict[str, Optional[Set[str]]] = field(default_factory=lambda: {"docs": set()})
    reasons: List[str] = field(default_factory=list)

    def everything(self, reason: str) -> None:
        self.reasons.append(f"everything: {reason}")
        self.parts = {part: None for part in PARTS}

    def add(self, part: str, chosen: Optional[Set[str]] = None) -> None:
        """Adds tests of a part, or the whole part if `chosen` is None. An empty set adds nothing."""
        if chosen is None or self.parts.get(part, set()) is None:
            self.parts[part] = None
        elif chosen:
            self.parts[part] = (self.parts.get(part) or set()) | chosen

    def lines(self) -> List[str]:
        shown = list(ALWAYS)
        for part in PARTS:
            if part in self.parts:
                chosen = self.parts[part]
                shown.append(part if chosen is None else " ".join([part, *(sorted(chosen) or ["-"])]))
        return shown


def git(*arguments: str, root: Path = ROOT) -> Optional[str]:
    done = subprocess.run(["git", *arguments], cwd=root, capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else None


def changed_since(revision: str, root: Path = ROOT) -> Set[str]:
    """Files that differ between a commit and the working tree, with their old and new names, and files that git does not track."""
    differing = git("diff", "--name-only", "--no-renames", "-z", revision, "--", root=root)
    unknown = git("ls-files", "--others", "--exclude-standard", "-z", root=root)
    assert differing is not None and unknown is not None, "git does not compare the working tree"
    return {path for path in (differing + unknown).split("\0") if path}


def whole_run(root: Path = ROOT) -> str:
    """The commit of the last complete run. Raises LookupError if this history does not contain it."""
    path = root / WHOLE_RUN
    words = path.read_text().split() if path.exists() else []
    if not words:
        raise LookupError(f"{WHOLE_RUN} names no commit")
    if git("cat-file", "-e", f"{words[0]}^{{commit}}", root=root) is None:
        raise LookupError(f"{WHOLE_RUN} names {words[0][:12]}, which this clone does not have")
    if git("merge-base", "--is-ancestor", words[0], "HEAD", root=root) is None:
        raise LookupError(f"{WHOLE_RUN} names {words[0][:12]}, which is no ancestor of this commit")
    return words[0]


def without_minutes(page: str) -> str:
    return re.sub(r"<!-- minutes -->.*?<!-- /minutes -->", "", page, flags=re.DOTALL)


def only_minutes_changed(revision: str, root: Path = ROOT) -> bool:
    """Whether CONTRIBUTING.md differs only in its table of minutes."""
    before, page = git("show", f"{revision}:CONTRIBUTING.md", root=root), root / "CONTRIBUTING.md"
    return before is not None and page.exists() and without_minutes(before) == without_minutes(page.read_text(encoding="utf-8"))


def add_targets(plan: Plan, graph: Graph, path: str, root: Path) -> None:
    """Adds the parts and tests that a change of a C++ file, or of another file in a target's folder, requires."""
    readers = graph.readers(path)
    direct = {target for target, _ in readers} or graph.owners(path)
    if not direct:
        plan.everything(f"no target is known to read {path}")
        return
    sources = {source for _, source in readers} or {source for name in direct for source in graph.targets[name].sources}
    affected = graph.users_of(direct)
    unit = {name for name in graph.used_by("unit_tests") if name in affected}
    stability, bench, fuzz = (graph.programs(f"tests/{folder}") & affected for folder in ("stability", "bench", "fuzz"))
    plan.add("unit", unit | ({"arrows"} if path.endswith(".h") and path.startswith(("engine/", "server/")) else set()))
    plan.add("stability", stability)
    plan.add("bench", bench)
    plan.add("fuzz", fuzz)
    # The sanitizers' builds have no LibTorch.
    plan.add("asan", {name for name in unit if "supple_training" not in graph.used_by(name) and not name.startswith("example_")})
    plan.add("tsan", unit & graph.used_by("threaded_tests"))
    plan.add("tidy", {source for source in sources if re.match(r"(engine|server|clients)/", source)})
    if any(name.startswith("example_") for name in affected):
        plan.add("docs", {"docs/engine.md"})
    if affected & SERVED:
        words = words_of(graph, path)
        if words is None:
            for part in ("api", "docs", "deploy", "hostile", "browser"):
                plan.add(part)
        else:
            plan.add("hostile")
            plan.add("api", files_about(root, "tests/api", "test_*.py", words))
            plan.add("deploy", files_about(root, "tests/deploy", "test_*.py", words))
            plan.add("browser", files_about(root, "tests/browser", "*.test.mjs", words))
            plan.add("docs", pages_about(root, words))
    if "supple-lab" in affected:
        plan.add("api", {"test_trainings.py"})
    if "supple" in affected:
        plan.add("api")
        plan.add("docs")


def plan_of(changed: Set[str], graph: Callable[[], Graph], root: Path = ROOT, ignored: Callable[[str], bool] = lambda path: False) -> Plan:
    """The plan for these files. `graph` is called only if targets must be known. `ignored` says whether a change has no effect."""
    plan = Plan()
    effects = {path: effects_of(path) for path in sorted(changed) if not ignored(path)}
    for path, found in effects.items():
        if EVERYTHING in found:
            plan.everything(f"{path} changed")
            return plan
    known: Optional[Graph] = None
    for path, found in effects.items():
        for effect in sorted(found):
            part, _, chosen = effect.partition(":")
            if effect == TARGETS:
                known = known or graph()
                add_targets(plan, known, path, root)
            elif not chosen:
                plan.add(part)
            else:
                plan.add(part, {chosen} & still_there(part, chosen, root))
        plan.reasons.append(f"{path}: {' '.join(sorted(found)) or 'nothing besides'}")
    return plan


def still_there(part: str, chosen: str, root: Path) -> Set[str]:
    """The choice, or an empty set if it is a deleted file."""
    folder = {"api": "tests/api", "hostile": "tests/hostile", "browser": "tests/browser", "deploy": "tests/deploy", "docs": "."}.get(part)
    return {chosen} if folder is None or (root / folder / chosen).exists() else set()


def main() -> int:
    plan = Plan()
    try:
        if len(sys.argv) > 1:
            revision = sys.argv[1]
            if git("cat-file", "-e", f"{revision}^{{commit}}") is None:
                print(f"tests/run.sh: --changed: there is no commit '{revision}'", file=sys.stderr)
                return 2
        else:
            revision = whole_run()
        changed = changed_since(revision)
        plan = plan_of(changed, lambda: Graph(ROOT, configured_targets(ROOT, ROOT / "build/graph")),
                       ignored=lambda path: path == "CONTRIBUTING.md" and only_minutes_changed(revision))
        print(f"{len(changed)} files differ from {revision[:12]}", file=sys.stderr)
    except (LookupError, RuntimeError) as unknown:
        plan.everything(str(unknown))
    print("\n".join(f"  {reason}" for reason in plan.reasons), file=sys.stderr)
    print("\n".join(plan.lines()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
