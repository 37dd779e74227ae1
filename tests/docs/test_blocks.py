"""Every block of code on the pages works: shell and Python are run with a real server, JSON is parsed, TOML must be a configuration
that the server accepts, and C++ must be the content of a compiled file.

The blocks of a page run in their order in one folder, which has the checkout's files. Python blocks can use `supple`, `client` and
`mesh` (an uploaded trefoil knot). Shell blocks can use `id`, the id of that mesh, and the programs `supple`, `supple-server` and those
of engine/examples, which are on the path. A block that cannot run says why in a comment before it: `<!-- not run: REASON -->`.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from typing import List

import pytest

from contract import Contract, strict_json
from harness import BUILD, CLI, ROOT, SERVER, ServerProcess
from pages import RUN, Block, blocks_of

DEFAULT_URL = "http://127.0.0.1:8080"
PAGE_SECONDS = 3600
"""Time limit for all blocks of a page, in wall-clock time. It is long, since blocks take many times as long on a busy machine."""
#: The programs of docs/engine.md, whose C++ blocks are the contents of these files.
EXAMPLES = sorted((ROOT / "engine" / "examples").glob("*.cpp"))
MESH = "api/examples/meshes/trefoil-knot.obj"

PYTHON_BEGIN = f"""
import supple
client = supple.Client()
mesh = client.upload({MESH!r})
"""
#: With --fail-with-body a refused request ends the block.
SHELL_BEGIN = f"""
set -euo pipefail
curl() {{ command curl --fail-with-body "$@"; }}
id=$(supple --json mesh add {MESH} | python3 -c 'import json, sys; print(json.load(sys.stdin)["id"])')
"""


@pytest.fixture(scope="session")
def contract() -> Contract:
    return Contract()


def blocks(page: str, language: str, text: "str | None" = None) -> List[Block]:
    return [block for block in blocks_of(page, text) if block.language == language and not block.not_run]


def pages_with(language: str) -> List[str]:
    return [page for page in RUN if blocks(page, language)]


def folder_for(page: str, tmp_path: Path) -> Path:
    """A folder with the checkout's files, in which a page's blocks may write."""
    folder = tmp_path / "page"
    folder.mkdir()
    for entry in ROOT.iterdir():
        if entry.name != ".git":
            (folder / entry.name).symlink_to(entry)
    return folder


def environment(server: ServerProcess, tmp_path: Path) -> "dict[str, str]":
    programs = tmp_path / "programs"
    programs.mkdir()
    for program in (CLI, SERVER, *(BUILD / "engine" / "examples" / path.stem for path in EXAMPLES)):
        (programs / program.name).symlink_to(program.resolve())
    return {**os.environ, "SUPPLE_SERVER": server.url, "PYTHONPATH": str(ROOT / "clients" / "python"), "PYTHONDONTWRITEBYTECODE": "1",
            "PATH": f"{programs}:/usr/bin:{os.environ['PATH']}"}


def run(command: List[str], server: ServerProcess, tmp_path: Path, page: str) -> None:
    done = subprocess.run(command, cwd=folder_for(page, tmp_path), env=environment(server, tmp_path), capture_output=True, text=True,
                          timeout=PAGE_SECONDS)
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-4000:]}"


def run_shell(page: str, found: List[Block], server: ServerProcess, tmp_path: Path) -> None:
    script = SHELL_BEGIN + "".join(f"echo '--- {block.place}' >&2\n{block.code}" for block in found)
    path = tmp_path / "page.sh"
    path.write_text(script.replace(DEFAULT_URL, server.url), encoding="utf-8")
    run(["bash", str(path)], server, tmp_path, page)


def run_python(page: str, found: List[Block], server: ServerProcess, tmp_path: Path) -> None:
    """Runs Python blocks so that tracebacks name the page and its line."""
    steps = [("setup", 1, PYTHON_BEGIN), *((block.page, block.line, block.code) for block in found)]
    script = ("names = {'__name__': '__main__'}\n" +
              "".join(f"exec(compile({chr(10) * (line - 1) + code!r}, {str(ROOT / page)!r}, 'exec'), names)\n" for page, line, code in steps))
    path = tmp_path / "page.py"
    path.write_text(script.replace(DEFAULT_URL, server.url), encoding="utf-8")
    run(["/usr/bin/python3", str(path)], server, tmp_path, page)


@pytest.mark.parametrize("page", pages_with("sh"))
def test_shell_blocks_run(page: str, server: ServerProcess, tmp_path: Path) -> None:
    run_shell(page, blocks(page, "sh"), server, tmp_path)


@pytest.mark.parametrize("page", pages_with("python"))
def test_python_blocks_run(page: str, server: ServerProcess, tmp_path: Path) -> None:
    run_python(page, blocks(page, "python"), server, tmp_path)


def test_json_blocks_are_json_of_their_schema(contract: Contract) -> None:
    for page in RUN:
        for block in blocks(page, "json"):
            check_json(block, contract)


def check_json(block: Block, contract: Contract) -> None:
    document = strict_json(block.code.encode())
    if block.schema:
        contract.validate({"$ref": f"#/components/schemas/{block.schema}"}, document, block.place)


@pytest.mark.parametrize("page", pages_with("toml"))
def test_toml_blocks_are_configurations_of_the_server(page: str, tmp_path: Path) -> None:
    for block in blocks(page, "toml"):
        path = tmp_path / "supple.toml"
        path.write_text(block.code, encoding="utf-8")
        done = subprocess.run([str(SERVER), "--config", str(path), "--check-config", "--open"], cwd=tmp_path, capture_output=True, text=True,
                              timeout=60, check=False)
        assert done.returncode == 0, f"{block.place}: {done.stderr}"


@pytest.mark.parametrize("page", RUN)
def test_blocks_name_a_language_that_is_checked(page: str) -> None:
    """Without a language a block would never be run."""
    faults = []
    for block in blocks_of(page):
        if block.language not in ("sh", "python", "json", "toml", "cpp", "text"):
            faults.append(f"{block.place}: the language '{block.language}' is not sh, python, json, toml, cpp or text")
        if block.not_run is not None and len(block.not_run.split()) < 3:
            faults.append(f"{block.place}: '{block.not_run}' is no reason")
    assert not faults, "\n".join(faults)


def test_blocks_of_cpp_are_the_files_that_are_compiled() -> None:
    for page in RUN:
        for block in blocks_of(page):
            if block.file:
                assert block.code == (ROOT / block.file).read_text(encoding="utf-8"), f"{block.place} differs from {block.file}"


def test_every_example_of_the_engine_is_shown() -> None:
    shown = {block.file for page in RUN for block in blocks_of(page) if block.file}
    assert shown == {path.relative_to(ROOT).as_posix() for path in EXAMPLES}


def test_most_blocks_run() -> None:
    found = [block for page in RUN for block in blocks_of(page) if block.language in ("sh", "python", "json")]
    left_out = [block for block in found if block.not_run]
    assert len(found) >= 50
    assert len(left_out) <= 0.4 * len(found), f"{len(left_out)} of {len(found)} blocks do not run"


class TestAFaultyBlock:
    """The tests detect blocks that would mislead a reader."""

    def test_refused_request(self, server: ServerProcess, tmp_path: Path) -> None:
        page = "```sh\ncurl -s http://127.0.0.1:8080/v1/nowhere\n```\n"
        with pytest.raises(AssertionError, match="not_found"):
            run_shell("README.md", blocks("README.md", "sh", page), server, tmp_path)

    def test_option_that_does_not_exist(self, server: ServerProcess, tmp_path: Path) -> None:
        page = "```sh\nsupple families --nothing\n```\n"
        with pytest.raises(AssertionError, match="nothing"):
            run_shell("README.md", blocks("README.md", "sh", page), server, tmp_path)

    def test_exception_names_the_line(self, server: ServerProcess, tmp_path: Path) -> None:
        page = "# Title\n\n```python\nx = 1\nmesh.nothing\n```\n"
        with pytest.raises(AssertionError, match=r'README.md", line 5(.|\n)*AttributeError'):
            run_python("README.md", blocks("README.md", "python", page), server, tmp_path)

    def test_json_that_breaks_its_schema(self, contract: Contract) -> None:
        page = "<!-- schema: DesignRequest -->\n```json\n{\"task\": \"stress_strain\"}\n```\n"
        with pytest.raises(AssertionError, match="breaks the contract"):
            check_json(blocks("README.md", "json", page)[0], contract)

    def test_no_json(self, contract: Contract) -> None:
        with pytest.raises(json.JSONDecodeError):
            check_json(blocks("README.md", "json", "```json\n{task: 1}\n```\n")[0], contract)

    def test_only_a_comment_with_a_reason_leaves_a_block_out(self) -> None:
        assert not blocks("README.md", "sh", "<!-- not run: it takes hours -->\n```sh\nfalse\n```\n")
        assert blocks("README.md", "sh", "<!-- not run -->\n```sh\nfalse\n```\n")
        assert blocks("README.md", "sh", "<!-- not run: it takes hours -->\n\n```sh\nfalse\n```\n")
        assert re.match("it takes", str(blocks_of("README.md", "<!-- not run: it takes hours -->\n```sh\nfalse\n```\n")[0].not_run))
