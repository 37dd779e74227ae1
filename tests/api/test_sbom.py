"""The software bill of materials names the libraries that the programs load, with versions."""

from __future__ import annotations

import json
import re
import subprocess

from harness import BUILD, ROOT

SCRIPT = ROOT / "deploy" / "make_sbom.py"


def test_the_bill_of_materials_has_every_kind_of_component_with_its_version() -> None:
    made = subprocess.run([str(SCRIPT), "--build", str(BUILD)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False, timeout=60)
    assert made.returncode == 0, made.stderr
    document = json.loads(made.stdout)
    assert (document["bomFormat"], document["specVersion"]) == ("CycloneDX", "1.5")
    assert re.fullmatch(r"\d+\.\d+\.\d+(-dev)?(\+[0-9a-z.]+)?", document["metadata"]["component"]["version"])
    components = {component["name"]: component for component in document["components"]}
    for name in ("libc6", "libsqlite3-0", "libgmsh4.8", "libeigen3-dev", "three"):
        assert components[name]["version"], name
        assert components[name]["purl"].endswith(components[name]["version"]) or "?arch=" in components[name]["purl"]
        assert components[name]["licenses"], name
    assert "vite" not in components, "what only builds the page is no part of it"
    table = (ROOT / "deploy" / "README.md").read_text(encoding="utf-8").split("## What it consists of")[1]
    named = {name for row in table.splitlines() if row.startswith("| ") for name in re.findall(r"`([^`]+)`", row.split("|")[2])}
    assert len(named) > 15 and named <= components.keys(), f"not loaded: {sorted(named - components.keys())}"


def test_the_bill_of_materials_says_what_is_not_built(tmp_path) -> None:  # type: ignore[no-untyped-def]
    made = subprocess.run([str(SCRIPT), "--build", str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False, timeout=60)
    assert made.returncode == 1 and made.stdout == ""
    assert "supple-server is missing" in made.stderr
