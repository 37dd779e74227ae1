"""The tests that a change requires: the table of paths for the files of this checkout, and the graph of targets for a small project."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Dict, List, Optional, Set

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from paths import EVERYTHING, TARGETS, effects_of  # noqa: E402
from plan import ALWAYS, PARTS, ROOT, Plan, changed_since, only_minutes_changed, plan_of, whole_run  # noqa: E402
from targets import Graph, Target, configured_targets  # noqa: E402
from topics import files_about, words_of  # noqa: E402


@pytest.fixture(scope="session")
def graph() -> Graph:
    """The graph of this checkout, without compiling."""
    return Graph(ROOT, configured_targets(ROOT, ROOT / "build/graph"))


def no_graph() -> Graph:
    raise AssertionError("the graph of targets is asked, which takes a configured build")


def parts_of(path: str) -> Dict[str, Optional[Set[str]]]:
    return plan_of({path}, no_graph).parts


@pytest.mark.parametrize("path", ["unknown.txt", "unknown/file.cpp", "CMakeLists.txt", "engine/voronoi/CMakeLists.txt", "cmake/SuppleTargets.cmake",
                                  "CMakePresets.json", "engine/base/src/random.cpp", "api/openapi.yaml", "api/examples/meshes/torus.obj",
                                  "tests/run.sh", "tests/changes/paths.py", ".ci/run", "tests/packages.txt", "deploy/packages.txt", "models/ih67.h5",
                                  "tests/support/private_postgres.sh", "tests/unknown/test_x.py", "clients/unknown/file"])
def test_what_everything_depends_on_runs_everything(path: str) -> None:
    assert parts_of(path) == {part: None for part in PARTS}


@pytest.mark.parametrize("path, parts", [
    ("CHANGELOG.md", {"docs": set()}),
    ("tests/whole-run.txt", {"docs": set()}),
    ("docs/voronoi.md", {"docs": {"docs/voronoi.md"}, "deploy": {"test_service_files.py"}}),
    ("docs/images/first_screen.png", {"docs": None}),
    ("docs/walkthroughs/sole.md", {"docs": {"docs/walkthroughs/sole.md"}, "deploy": {"test_service_files.py"}}),
    ("docs/walkthroughs/files/sole.svg", {"docs": None, "browser": None}),
    ("docs/bench/networks-accuracy.csv", {"docs": None, "web": None, "browser": None}),
    ("CONTRIBUTING.md", {"docs": {"CONTRIBUTING.md"}, "unit": {"unit_numerics"}}),
    ("clients/web/src/main.ts", {"docs": set(), "web": None, "browser": None, "api": {"test_web_files.py"}, "deploy": {"test_service_files.py"}}),
    ("clients/web/test/base.test.ts", {"docs": set(), "web": None}),
    ("clients/python/tests/test_checks.py", {"docs": set(), "python": None}),
    ("clients/python/supple/client.py", {"docs": None, "python": None, "api": None, "deploy": {"test_service_files.py"}}),
    ("tests/api/test_voronoi.py", {"docs": set(), "api": {"test_voronoi.py"}}),
    ("tests/api/test_gone.py", {"docs": set()}),
    ("tests/api/harness.py", {"docs": None, "api": None, "deploy": None, "hostile": None}),
    ("tests/browser/mesh.test.mjs", {"docs": set(), "browser": {"mesh.test.mjs"}}),
    ("tests/browser/harness.mjs", {"docs": set(), "browser": None}),
    ("tests/hostile/test_memory.py", {"docs": set(), "hostile": {"test_memory.py"}}),
    ("tests/hostile/costly.py", {"docs": set(), "hostile": None, "deploy": None}),
    ("deploy/nginx.conf", {"docs": None, "deploy": None, "api": {"test_tls_proxy.py"}}),
    (".clang-tidy", {"docs": set(), "tidy": None}),
    ("tests/tsan.supp", {"docs": set(), "tsan": None}),
    ("tests/fuzz/corpus/fuzz_mesh_reader/plane.off", {"docs": set(), "fuzz": None}),
])
def test_a_path_runs_the_parts_of_its_row(path: str, parts: Dict[str, Optional[Set[str]]]) -> None:
    assert parts_of(path) == parts


def test_several_paths_run_what_each_of_them_runs() -> None:
    plan = plan_of({"tests/api/test_voronoi.py", "tests/api/test_weaves.py", "docs/voronoi.md"}, no_graph)
    assert plan.parts["api"] == {"test_voronoi.py", "test_weaves.py"}
    assert plan.parts["docs"] == {"docs/voronoi.md"}
    plan = plan_of({"tests/api/test_voronoi.py", "tests/api/harness.py"}, no_graph)
    assert plan.parts["api"] is None, "a file of tests leaves nothing out of what another path asks for"
    assert plan_of({"tests/api/test_voronoi.py", "unknown"}, no_graph).parts == {part: None for part in PARTS}


def test_the_plan_names_choices_behind_their_parts_and_what_always_runs_first() -> None:
    plan = Plan()
    plan.add("unit", {"unit_b", "unit_a"})
    plan.add("stability", set())
    plan.add("web")
    assert plan.lines() == [*ALWAYS, "unit unit_a unit_b", "docs -", "web"]


def test_each_file_of_this_checkout_is_known_to_the_table_and_each_part_to_the_script(graph: Graph) -> None:
    """For a folder that the table does not know, each change would run everything, unnoticed."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\0")
    for path in filter(None, files):
        effects = effects_of(path)
        if EVERYTHING in effects:
            assert re.match(r"engine/base/|api/|cmake/|models/|\.ci/|tests/(changes|support|run\.sh|slowest\.py|packages)|deploy/packages|CMake", path) \
                or re.search(r"CMakeLists\.txt$|\.cmake$", path), f"tests/changes/paths.py has no row for {path}"
        if TARGETS in effects:
            assert graph.readers(path) or graph.owners(path), f"no target is known to read {path}"
    script = (ROOT / "tests/run.sh").read_text()
    order = re.search(r"^order=\((.*)\)$", script, re.MULTILINE)
    by_name = re.search(r"^by_name_only=\((.*)\)$", script, re.MULTILINE)
    assert order and by_name
    assert [part for part in order[1].split() if part not in by_name[1].split()] == sorted([*ALWAYS, *PARTS], key=order[1].split().index), \
        "a part is missing in tests/changes/plan.py"
    assert {*ALWAYS, *PARTS} == set(order[1].split()) - set(by_name[1].split())


def test_a_room_runs_its_own_programs_and_those_that_stand_on_it(graph: Graph) -> None:
    plan = plan_of({"engine/voronoi/src/face_cutter.cpp"}, lambda: graph).parts
    unit = plan["unit"]
    assert unit is not None and {"unit_voronoi", "server_json_test", "server_routes_test"} <= unit
    assert not unit & {"unit_surface", "unit_weave", "unit_tiling", "server_http_test", "unit_base"}
    assert plan["stability"] == {"stability_voronoi"} and plan["bench"] == {"voronoi_bench"}
    assert plan["tidy"] == {"engine/voronoi/src/face_cutter.cpp"}, "only what reads the file is looked at anew"
    assert "python" not in plan and "web" not in plan


def test_a_header_runs_those_that_read_it_and_the_arrows(graph: Graph) -> None:
    plan = plan_of({"engine/surface/include/supple/surface/triangle_mesh.h"}, lambda: graph).parts
    unit, tidy = plan["unit"], plan["tidy"]
    assert unit is not None and {"arrows", "unit_surface", "unit_embedded", "unit_voronoi"} <= unit and "unit_dataset" not in unit
    assert tidy is not None and any(source.startswith("server/routes/") for source in tidy) and not any(source.startswith("engine/weave") for source in tidy)
    assert plan["api"] is None and plan["browser"] is None and plan["hostile"] is None


def test_a_file_of_tests_runs_its_program_alone(graph: Graph) -> None:
    assert plan_of({"tests/unit/voronoi/diagram_test.cpp"}, lambda: graph).parts == {
        "docs": set(), "unit": {"unit_voronoi"}, "asan": {"unit_voronoi"}, "tsan": {"unit_voronoi"}}


def test_a_deleted_file_runs_what_its_folder_runs(graph: Graph) -> None:
    unit = plan_of({"engine/weave/src/is_gone.cpp"}, lambda: graph).parts["unit"]
    assert unit is not None and {"unit_weave", "server_routes_test"} <= unit
    assert plan_of({"server/unknown_room/src/gone.cpp"}, lambda: graph).parts["api"] is None


def test_the_cli_and_training_run_no_tests_of_the_server_but_those_that_train(graph: Graph) -> None:
    assert set(plan_of({"clients/cli/src/main.cpp"}, lambda: graph).parts) == {"api", "docs", "tidy"}
    training = plan_of({"engine/training/src/trainer.cpp"}, lambda: graph).parts
    assert training["api"] == {"test_trainings.py"} and "asan" not in training and training["unit"] == {"unit_training", "unit_learning"}


def test_a_room_that_only_its_own_requests_reach_leaves_out_files_about_other_subjects(graph: Graph) -> None:
    words = words_of(graph, "engine/voronoi/src/face_cutter.cpp")
    assert words, "the server reads headers of engine/voronoi in files that are not about it: its row in topics.py is of no use"
    api = plan_of({"engine/voronoi/src/face_cutter.cpp"}, lambda: graph).parts["api"]
    assert api is not None and {"test_voronoi.py", "test_voronoi_clients.py", "test_examples.py", "test_contract.py"} <= api
    assert not api & {"test_weaves.py", "test_designs.py"}
    assert words_of(graph, "engine/surface/src/window.cpp") is None
    assert words_of(graph, "server/routes/src/voronoi.cpp") is None


def test_what_a_test_imports_counts_as_its_own_words(tmp_path: Path) -> None:
    (tmp_path / "tests/api").mkdir(parents=True)
    (tmp_path / "tests/api/test_a.py").write_text("from helper import request\n")
    (tmp_path / "tests/api/helper.py").write_text("# about Voronoi diagrams\n")
    (tmp_path / "tests/api/test_b.py").write_text("nothing = 1\n")
    assert files_about(tmp_path, "tests/api", "test_*.py", "voronoi") == {"test_a.py"}


def small_graph(root: Path) -> Graph:
    files = {"a/include/a.h": "#pragma once\n", "a/src/a.cpp": '#include "a.h"\n', "b/src/b.h": '#  include <a.h>\n',
             "b/src/b.cpp": '#include "b.h"\n#include <vector>\n', "c/c.cpp": "int main() {}\n"}
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return Graph(root, [Target("a", "STATIC_LIBRARY", "a", ["a/src/a.cpp"], ["a/include"]),
                        Target("b", "STATIC_LIBRARY", "b", ["b/src/b.cpp"], ["a/include"], frozenset({"a"})),
                        Target("c", "EXECUTABLE", "c", ["c/c.cpp"], [], frozenset({"b"}))])


def test_the_graph_follows_includes_within_folders_and_uses_across_targets(tmp_path: Path) -> None:
    graph = small_graph(tmp_path)
    assert graph.readers("a/include/a.h") == {("a", "a/src/a.cpp"), ("b", "b/src/b.cpp")}
    assert graph.users_of({"a"}) == {"a", "b", "c"} and graph.users_of({"b"}) == {"b", "c"}
    assert graph.owners("b/data/table.txt") == {"b"} and graph.owners("d/x.h") == set()


def git(root: Path, *arguments: str) -> str:
    return subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=root, capture_output=True, text=True,
                          check=True).stdout.strip()


@pytest.fixture
def history(tmp_path: Path) -> List[str]:
    """Two commits in tmp_path, and a third one on a branch that begins at the first."""
    git(tmp_path, "init", "-q", "-b", "main")
    (tmp_path / "tests").mkdir()
    commits = []
    for name in ("one", "two"):
        (tmp_path / name).write_text(name)
        git(tmp_path, "add", "-A")
        git(tmp_path, "commit", "-q", "-m", name)
        commits.append(git(tmp_path, "rev-parse", "HEAD"))
    git(tmp_path, "checkout", "-q", "-b", "beside", commits[0])
    git(tmp_path, "commit", "-q", "--allow-empty", "-m", "three")
    commits.append(git(tmp_path, "rev-parse", "HEAD"))
    git(tmp_path, "checkout", "-q", "main")
    return commits


def test_the_last_whole_run_counts_only_where_this_history_contains_it(tmp_path: Path, history: List[str]) -> None:
    named = tmp_path / "tests/whole-run.txt"
    with pytest.raises(LookupError, match="names no commit"):
        whole_run(tmp_path)
    named.write_text("\n")
    with pytest.raises(LookupError, match="names no commit"):
        whole_run(tmp_path)
    named.write_text("0123456789012345678901234567890123456789\n")
    with pytest.raises(LookupError, match="does not have"):
        whole_run(tmp_path)
    named.write_text(history[2] + "\n")
    with pytest.raises(LookupError, match="no ancestor"):
        whole_run(tmp_path)
    named.write_text(history[0] + "\n")
    assert whole_run(tmp_path) == history[0]


def test_what_is_not_committed_counts_as_changed_and_so_does_a_name_that_is_left(tmp_path: Path, history: List[str]) -> None:
    assert changed_since(history[0], tmp_path) == {"two"}
    (tmp_path / "one").write_text("changed")
    (tmp_path / "new").write_text("not added")
    assert changed_since(history[1], tmp_path) == {"one", "new"}
    git(tmp_path, "add", "new")
    assert changed_since(history[1], tmp_path) == {"one", "new"}
    git(tmp_path, "mv", "two", "three")
    assert {"two", "three"} <= changed_since(history[1], tmp_path)


def test_a_new_table_of_minutes_is_no_change_of_the_page(tmp_path: Path, history: List[str]) -> None:
    page = "text\n<!-- minutes -->\n{}\n<!-- /minutes -->\n{}\n"
    (tmp_path / "CONTRIBUTING.md").write_text(page.format("1", "end"))
    git(tmp_path, "add", "-A")
    git(tmp_path, "commit", "-q", "-m", "page")
    (tmp_path / "CONTRIBUTING.md").write_text(page.format("2", "end"))
    assert only_minutes_changed("HEAD", tmp_path)
    (tmp_path / "CONTRIBUTING.md").write_text(page.format("2", "other end"))
    assert not only_minutes_changed("HEAD", tmp_path)
    assert not only_minutes_changed(history[0], tmp_path), "there was no such page"
