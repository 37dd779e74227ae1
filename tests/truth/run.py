#!/usr/bin/python3
"""Compares the server's answers with independent oracles: small programs that share no code with the engine, closed forms, invariances.

    tests/truth/run.py [WING ...] [--cases N] [--seed S] [--first K] [--server BINARY] [--keep FILE] [--out FOLDER]

Runs the named wings, or all of them, one after another against one server. A wrong case is repeated with `--first K --cases 1`
and the same seed. With `--out docs/bench` the tables of these wings are written into truth.csv and truth.md, whose other rows
and text remain unchanged. With `--keep`, finished cases are kept in a file, and a run that was ended goes on where it was, as long
as neither the suite nor the server has changed. The exit status is 1 if a case exceeds the limit of a check (for checks with a share: if more than
this fraction of the cases does), or if no case examined a check.
"""

from __future__ import annotations

import argparse
import csv
import fcntl
import importlib.util
import math
import os
import re
import signal
import sys
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any, Dict, List, Set

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# Wings import truth.py and their common modules from these folders.
sys.path[:0] = [str(HERE), str(HERE / "wings")]

from kept import KeptCases, state_of  # noqa: E402
from truth import Result, Server, run_wing  # noqa: E402

COLUMNS = ["wing", "check", "about", "unit", "limit", "share", "cases", "median", "largest", "beyond", "seed", "worst_case"]


def wings() -> List[str]:
    """The names of all wings. Modules whose names begin with an underscore are common to several wings."""
    return sorted(path.stem for path in (HERE / "wings").glob("*.py") if not path.stem.startswith("_"))


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"truth_wing_{name}", HERE / "wings" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def sources_of(name: str) -> Set[Path]:
    """The wing's file and the suite's other modules that it uses, from which its cases and their deviations come."""
    found: Set[Path] = set()
    ahead = [HERE / "wings" / f"{name}.py"]
    while ahead:
        found.add(path := ahead.pop())
        named = re.findall(r"^(?:from|import) (\w+)", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        ahead += [other for module in named for folder in (HERE, HERE / "wings") if (other := folder / f"{module}.py").exists() and other not in found]
    return found


def shown(number: float) -> str:
    """The number as text; empty if no case examined the check."""
    return "" if math.isnan(number) else f"{number:.3g}"


def rows_of(result: Result) -> List[Dict[str, str]]:
    return [{"wing": result.wing, "check": name, "about": figures.check.about, "unit": figures.check.unit,
             "limit": f"{figures.check.limit:.3g}", "share": f"{figures.check.share:.3g}", "cases": str(len(figures.deviations)), "median": shown(figures.median),
             "largest": shown(figures.largest), "beyond": str(figures.beyond), "seed": str(result.seed),
             "worst_case": "" if figures.worst_case is None else str(figures.worst_case)}
            for name, figures in result.figures.items()]


def table(rows: List[Dict[str, str]]) -> str:
    lines = ["| Check | What deviates | Cases | Median | Largest | Limit | Unit | Beyond it |", "|---|---|--:|--:|--:|--:|---|--:|"]
    for row in rows:
        limit = row["limit"] + (f", but for {float(row['share']):.0%}" if float(row["share"]) else "")
        lines.append(f"| {row['check']} | {row['about']} | {int(row['cases']):,} | {row['median']} | {row['largest']} | {limit} | {row['unit']} | {row['beyond']} |")
    return "\n".join(lines)


def marks(wing: str) -> "tuple[str, str]":
    return f"<!-- truth: {wing} -->", f"<!-- /truth: {wing} -->"


def write_csv(path: Path, rows: List[Dict[str, str]]) -> None:
    """Replaces the rows of these wings, and leaves those of others unchanged."""
    written = {row["wing"] for row in rows}
    kept: List[Dict[str, Any]] = []
    if path.exists():
        with path.open(newline="", encoding="utf-8") as file:
            kept = [row for row in csv.DictReader(file) if row["wing"] not in written]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(kept + rows, key=lambda row: row["wing"]))


def write_page(path: Path, wing: str, about: str, rows: List[Dict[str, str]]) -> None:
    """Writes the wing's table between its marks. A page without these marks gets a section for the wing at its end."""
    page = path.read_text(encoding="utf-8") if path.exists() else "# Answers beside independent oracles\n"
    begin, end = marks(wing)
    block = f"{begin}\n{about}\n\n{table(rows)}\n{end}"
    if begin in page:
        page = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: block, page, flags=re.DOTALL)
    else:
        page = page.rstrip("\n") + f"\n\n## {wing.capitalize()}\n\n{block}\n"
    path.write_text(page, encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wings", nargs="*", metavar="WING", help=f"of {', '.join(wings())}; all without any")
    parser.add_argument("--cases", type=int, default=1000, metavar="N")
    parser.add_argument("--seed", type=int, default=1, metavar="S")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="index of the first case")
    parser.add_argument("--server", metavar="BINARY", help="supple-server; build/release's without it")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="keeps finished cases, and goes on with those that it has")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="where truth.csv and truth.md are written")
    asked = parser.parse_args()
    if unknown := sorted(set(asked.wings) - set(wings())):
        parser.error(f"there is no wing {', '.join(unknown)}; the wings are {', '.join(wings())}")
    if asked.cases < 1 or asked.first < 0:
        parser.error("--cases is at least 1, and --first at least 0")
    if asked.server:
        os.environ["SUPPLE_TEST_SERVER"] = str(Path(asked.server).resolve())
    sys.path[:0] = [str(ROOT / "tests" / "api")]
    from harness import SERVER, ServerProcess  # importing it reads the environment

    def say(line: str) -> None:
        print(line, flush=True)

    def interrupt(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupt)  # the server is terminated, and results so far are shown but not written

    sound = True
    with tempfile.TemporaryDirectory(prefix="supple-truth-") as folder:
        process = ServerProcess(Path(folder) / "data", "--models", str(ROOT / "models")).start()

        def revive() -> None:
            if not process.running():
                say(f"  the server has died:\n{process.log_text()[-2000:]}")
                process.start()

        try:
            for name in asked.wings or wings():
                wing = load(name)
                say(f"{name}: {wing.ABOUT}")
                kept = KeptCases(asked.keep, name, asked.seed, state_of([SERVER, *sources_of(name)])) if asked.keep else None
                result = run_wing(name, wing, Server(process.url), asked.seed, asked.first, asked.cases, say, revive, kept)
                rows = rows_of(result)
                say(table(rows))
                if result.unexamined:
                    say(f"  no case came to: {', '.join(result.unexamined)}")
                if asked.out and result.cases == asked.cases:
                    asked.out.mkdir(parents=True, exist_ok=True)
                    with (Path(tempfile.gettempdir()) / "supple-truth.lock").open("w", encoding="utf-8") as lock:
                        fcntl.flock(lock, fcntl.LOCK_EX)  # another run may write other wings
                        write_csv(asked.out / "truth.csv", rows)
                        write_page(asked.out / "truth.md", name, wing.ABOUT, rows)
                sound = sound and result.sound and result.cases == asked.cases
                if result.cases < asked.cases:
                    break
        finally:
            process.stop()
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
