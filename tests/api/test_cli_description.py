"""Descriptions of the command line client: manual page, completion scripts, version."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Iterator, List, Tuple

import pytest

from harness import CLI


def supple(*arguments: str) -> str:
    done = subprocess.run([str(CLI), *arguments], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def subcommands(*command: str) -> List[str]:
    """The subcommands in the help of a command."""
    _, _, listed = supple(*command, "--help").partition("\nSubcommands:\n")
    return re.findall(r"^  ([a-z][a-z-]*)", listed.partition("\n\n")[0], re.MULTILINE)


def commands(*above: str) -> Iterator[Tuple[str, ...]]:
    for name in subcommands(*above):
        yield (*above, name)
        yield from commands(*above, name)


def bash_completions(*words: str) -> List[str]:
    """The completions of the last word in bash, with the script that the program prints."""
    quoted = " ".join(f"'{word}'" for word in words)
    program = f"COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _supple; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    done = subprocess.run(["bash", "-uc", supple("completion", "bash") + program], capture_output=True, text=True, timeout=60,
                          check=True)
    assert done.stderr == ""
    return done.stdout.split()


def fish_completions(tmp_path: Path, line: str) -> List[str]:
    (tmp_path / "supple.fish").write_text(supple("completion", "fish"))
    done = subprocess.run(["fish", "--no-config", "-c", f"source {tmp_path}/supple.fish; complete -C '{line}'"], timeout=60,
                          capture_output=True, text=True, check=True, cwd=tmp_path, env={"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"})
    assert done.stderr == ""
    return [entry.split("\t")[0] for entry in done.stdout.splitlines()]


def zsh_completions(tmp_path: Path, *words: str) -> List[str]:
    """The completions of the last word in zsh, whose functions for completions are replaced by functions that print them."""
    (tmp_path / "_supple").write_text(supple("completion", "zsh"))
    program = f"""
        compdef() {{ }}
        compadd() {{ shift; print -l -- "$@" }}
        _describe() {{ print -l -- "${{(@P)${{@[-1]}}}}" }}
        _files() {{ print files }}
        source {tmp_path}/_supple
        words=({' '.join(f"'{word}'" for word in words)}); CURRENT={len(words)}; PREFIX='{words[-1]}'; _supple"""
    done = subprocess.run(["zsh", "-fc", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stderr == ""
    return [entry.split(":")[0] for entry in done.stdout.splitlines()]


def test_every_command_and_option_of_the_help_stands_in_the_manual_page() -> None:
    page = supple("man").replace("\\-", "-")
    found = list(commands())
    assert len(found) > 25 and ("weave", "print") in found
    for command in found:
        begin = page.index(f".SS supple {' '.join(command)}\n")
        section = page[begin:page.find(".SS ", begin + 1)]
        options = re.findall(r"(?<![\w-])--[a-z][a-z-]*", supple(*command, "--help").partition("Options:")[2].partition("Examples:")[0])
        missing = {option for option in options if option not in section} - {"--help"}
        assert not missing, (command, missing)
    for option in ("--server", "--key-file", "--json", "SUPPLE_SERVER", "NO_COLOR", "EXIT STATUS", "EXAMPLES"):
        assert option in page


def test_the_manual_page_is_roff_without_a_complaint() -> None:
    done = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=supple("man"), capture_output=True, text=True, timeout=60, check=True)
    assert done.stderr == ""
    text = re.sub(r"\x1b\[[0-9;]*m|.\x08", "", done.stdout)
    assert "supple geodesic bunny.obj v0 v1200 --path path.obj" in text and "SUPPLE(1)" in text


def test_bash_offers_commands_options_and_values() -> None:
    assert {"mesh", "weave", "design", "man"} <= set(bash_completions("supple", ""))
    assert bash_completions("supple", "des") == ["design"]
    assert bash_completions("supple", "weave", "la") == ["layout"]
    assert bash_completions("supple", "design", "--pol") == ["--polish", "--polish-tolerance", "--polish-rounds", "--polish-seconds"]
    assert set(bash_completions("supple", "design", "--task", "st")) == {"stress_strain", "stiffness"}
    assert bash_completions("supple", "weave", "layout", "--ser") == ["--server"]
    assert bash_completions("supple", "--server", "x", "mesh", "sh") == ["show"]
    # For files, bash's own completion follows.
    assert bash_completions("supple", "design", "--csv", "") == [] == bash_completions("supple", "geodesic", "")
    assert "-o default" in supple("completion", "bash")


def test_fish_offers_commands_options_and_values(tmp_path: Path) -> None:
    assert fish_completions(tmp_path, "supple des") == ["design"]
    assert {"layout", "homogenize", "deform", "simulate", "print", "check"} == set(fish_completions(tmp_path, "supple weave "))
    assert fish_completions(tmp_path, "supple design --task st") == ["stiffness", "stress_strain"]
    assert "--polish-rounds" in fish_completions(tmp_path, "supple design --polish")
    (tmp_path / "bunny.obj").touch()
    assert fish_completions(tmp_path, "supple geodesic bun") == ["bunny.obj"]


def test_zsh_offers_commands_options_and_values(tmp_path: Path) -> None:
    assert {"mesh", "weave", "design", "man"} <= set(zsh_completions(tmp_path, "supple", ""))
    assert zsh_completions(tmp_path, "supple", "weave", "") == ["layout", "homogenize", "deform", "simulate", "print", "check"]
    assert zsh_completions(tmp_path, "supple", "design", "--task", "") == ["stress_strain", "stiffness", "poisson"]
    assert "--polish-rounds" in zsh_completions(tmp_path, "supple", "design", "--pol")
    assert zsh_completions(tmp_path, "supple", "design", "--csv", "") == ["files"] == zsh_completions(tmp_path, "supple", "geodesic", "")


def test_another_shell_has_no_completion() -> None:
    refused = subprocess.run([str(CLI), "completion", "bsh"], capture_output=True, text=True, timeout=60, check=False)
    assert refused.returncode == 1 and "did you mean bash?" in refused.stderr and refused.stdout == ""


def test_installing_puts_the_program_its_page_and_its_completion_in_their_places(tmp_path: Path) -> None:
    build = CLI.parents[2]
    subprocess.run(["cmake", "--install", str(build), "--component", "client", "--prefix", str(tmp_path)], check=True, timeout=60,
                   capture_output=True)
    assert supple("--version") == subprocess.run([str(tmp_path / "bin" / "supple"), "--version"], capture_output=True, text=True,
                                                 timeout=60, check=True).stdout
    for path, arguments in (("share/man/man1/supple.1", ["man"]), ("share/fish/vendor_completions.d/supple.fish", ["completion", "fish"]),
                            ("share/bash-completion/completions/supple", ["completion", "bash"]),
                            ("share/zsh/site-functions/_supple", ["completion", "zsh"])):
        assert (tmp_path / path).read_text() == supple(*arguments), path
