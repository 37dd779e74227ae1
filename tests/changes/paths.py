"""What a change of a file that is not C++ makes necessary: the table of paths. The first pattern that matches counts.

An effect is the name of a part of tests/run.sh, or PART:CHOICE for what the part can choose from: a file of tests, or for docs a
page ({} stands for what the pattern's first group found). `targets` stands for the targets of CMake that read the file and those that use them, `everything` for every part.
"""

from __future__ import annotations

import re
from typing import List, Set, Tuple

EVERYTHING = "everything"
TARGETS = "targets"

SCRIPTS = "deploy:test_service_files.py"  #: reads what deploy/ publishes, its scripts' help, and the version that all parts name

TABLE: List[Tuple[str, Set[str]]] = [
    # What builds, what runs the tests, and what everything stands on.
    (r"(.*/)?CMakeLists\.txt|.*\.cmake|cmake/.*|CMakePresets\.json", {EVERYTHING}),
    (r"tests/(run\.sh|slowest\.py)|tests/changes/.*|\.ci/.*|(tests|deploy)/packages\.txt", {EVERYTHING}),
    (r"engine/base/.*|api/.*|tests/support/[^/]*\.(py|sh)", {EVERYTHING}),
    (r"models/.*\.(h5|json)", {EVERYTHING}),

    # The rules of the code. Each run checks formats, arrows, links and spelling.
    (r"\.clang-format|\.gitignore|LICENSE|CITATION\.cff|CHANGELOG\.md|tests/whole-run\.txt|tests/arrows/check_(includes|sizes|words)\.py", set()),
    (r"\.clang-tidy|tests/tidy(_cache)?\.py|tests/single_files\.py", {"tidy"}),
    (r"tests/arrows/.*", {"unit:arrows"}),
    (r"tests/lsan\.supp", {"asan"}),
    (r"tests/tsan\.supp", {"tsan"}),
    (r"\.(container|docker)ignore", {SCRIPTS}),

    # Pages. One test of the service's files reads which ports they publish.
    (r"CONTRIBUTING\.md", {"docs:CONTRIBUTING.md", "unit:unit_numerics"}),  # whose energy is compiled from the page
    (r"docs/configuration\.md", {"docs:docs/configuration.md", "api:test_configuration.py", SCRIPTS}),
    (r"((README|SECURITY|docs/[^/]*|docs/(notes|walkthroughs)/[^/]*)\.md)", {"docs:{}", SCRIPTS}),
    (r"docs/walkthroughs/files/.*", {"docs", "browser"}),  # which the tests of the walkthroughs open
    (r"docs/bench/[^/]*\.csv", {"docs", "web", "browser"}),  # the editor shows some of these tables
    (r"docs/.*", {"docs"}),
    (r"deploy/README\.md", {"docs:deploy/README.md", "api:test_sbom.py", SCRIPTS}),
    (r"clients/(cli|python|web)/README\.md", {"docs", "python"}),
    (r"((server|models|deploy/kubernetes)/(.*/)?[^/]*|tests/.*)\.md", {"docs"}),

    # Clients.
    (r"clients/python/notebooks/.*", {"python", "api:test_notebooks.py"}),
    (r"clients/python/tests/.*", {"python"}),
    (r"clients/python/.*", {"python", "api", "docs", SCRIPTS}),
    (r"clients/web/(test/.*|(biome|dprint)\.json)", {"web"}),
    (r"clients/web/.*", {"web", "browser", "api:test_web_files.py", SCRIPTS}),

    # How it is run.
    (r"deploy/nginx\.conf", {"deploy", "docs", "api:test_tls_proxy.py"}),
    (r"deploy/make_sbom\.py", {"deploy", "docs", "api:test_sbom.py"}),
    (r"deploy/.*", {"deploy", "docs"}),

    # Tests that are not compiled.
    (r"tests/api/(test_\w+\.py)", {"api:{}"}),
    (r"tests/api/.*", {"api", "docs", "deploy", "hostile"}),
    (r"tests/browser/([\w-]+\.test\.mjs)", {"browser:{}"}),
    (r"tests/browser/.*", {"browser"}),
    (r"tests/docs/.*", {"docs"}),
    (r"tests/hostile/(test_\w+\.py)", {"hostile:{}"}),
    (r"tests/hostile/.*", {"hostile", "deploy"}),
    (r"tests/deploy/(test_\w+\.py)", {"deploy:{}"}),
    (r"tests/deploy/.*", {"deploy"}),
    (r"tests/release/.*", {SCRIPTS}),
    (r"tests/truth/.*", set()),  # runs by name; that it can fail is tested by each run
    (r"tests/bench/.*\.py", {"bench", "api:test_load.py", "hostile:test_soak.py", "deploy:test_replicas.py"}),
    (r"tests/fuzz/corpus/.*", {"fuzz"}),

    (r"(engine/training/pytorch|tests/unit/training)/.*\.py", {"unit:unit_training"}),
    (r"(engine|server|clients/cli|tests/(unit|stability|examples|bench|fuzz|support))/.*", {TARGETS}),
]


def effects_of(path: str) -> Set[str]:
    """The effects of a change of this file; `everything` where the table does not know it."""
    for pattern, effects in TABLE:
        if found := re.fullmatch(pattern, path):
            return {effect.replace("{}", found[1]) if "{}" in effect else effect for effect in effects}
    return {EVERYTHING}
