"""Whether each source file compiles by itself: the builds of continuous integration compile many of a room's files at a time,
which hides a missing include and a name that hides another.

    tests/single_files.py build/single-files/compile_commands.json [jobs] [words of a path ...]

Nothing is written: the compiler stops after the types. Exit status 1 where a file has an error or a warning. With words,
only the files whose paths have one of them are looked at.
"""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Dict, List, Tuple


def command_of(entry: Dict[str, str]) -> List[str]:
    """The entry's command without a cache, an output and optimization."""
    words = shlex.split(entry["command"])
    while not Path(words[0]).name.startswith(("c++", "g++", "clang++")):
        words.pop(0)
    kept = [words.pop(0), "-fsyntax-only"]
    while words:
        word = words.pop(0)
        if word in ("-o", "-MF", "-MT"):
            words.pop(0)
        elif word not in ("-c", "-MD") and not word.startswith(("-O", "--param=")):  # clang has no such parameters
            kept.append(word)
    return kept


def check(entry: Dict[str, str]) -> Tuple[str, str]:
    done = subprocess.run(command_of(entry), cwd=entry["directory"], capture_output=True, text=True, check=False)
    return entry["file"], done.stderr if done.returncode else ""


def main() -> int:
    entries = json.loads(Path(sys.argv[1]).read_text())
    jobs = int(sys.argv[2]) if len(sys.argv) > 2 else os.cpu_count() or 1
    words = sys.argv[3:]
    wanted = [entry for entry in entries if not words or any(word in entry["file"] for word in words)]
    if not wanted:
        print("no file has one of these words in its path", file=sys.stderr)
        return 2
    faulty = 0
    with ThreadPoolExecutor(jobs) as pool:
        for file, complaint in pool.map(check, wanted):
            if complaint:
                faulty += 1
                print(f"{file}:\n{complaint}", flush=True)
    print(f"{len(wanted)} files, {faulty} with errors or warnings")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
