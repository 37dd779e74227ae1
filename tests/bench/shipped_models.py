"""What the benchmarks of designs that ask a server have in common: the server, with the shipped models, and their options."""

from __future__ import annotations

import argparse
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import Iterator, Optional

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from contract import Contract  # noqa: E402
from harness import ROOT, Api, ServerProcess  # noqa: E402


@contextmanager
def server_with_shipped_models() -> Iterator[Api]:
    """A server of its own, which ends with the block."""
    with tempfile.TemporaryDirectory() as folder:
        server = ServerProcess(Path(folder) / "data", "--models", str(ROOT / "models")).start()
        try:
            yield Api(server, Contract())
        finally:
            server.stop()


def parser_of(description: Optional[str]) -> argparse.ArgumentParser:
    """The options of a benchmark that writes a section of a page: where the pages are."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "bench")
    return parser


def options_of_curves(description: Optional[str], curves: int) -> argparse.Namespace:
    """The options of a benchmark that asks for curves of some families, `curves` of each without an option."""
    parser = parser_of(description)
    parser.add_argument("--curves", type=int, default=curves, help="of each family")
    parser.add_argument("--families", default="IH01,IH22", help="separated by commas")
    return parser.parse_args()
