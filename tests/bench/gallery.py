"""What the scripts that make the galleries share: where things are, the command line, drawing."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import List

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients" / "python"))

DEFAULT_SERVER = "http://127.0.0.1:8080"


@dataclass
class Order:
    """What a gallery is asked for: `pictures` is a folder under the documentation, there from now on."""

    server: str
    docs: Path
    pictures: Path
    names: List[str]

    def wants(self, name: str) -> bool:
        return not self.names or name in self.names


def read_order(description: str, folder: str) -> Order:
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--server", default=DEFAULT_SERVER)
    parser.add_argument("--out", type=Path, default=ROOT / "docs")
    parser.add_argument("names", nargs="*")
    arguments = parser.parse_args()
    pictures = arguments.out / "images" / folder
    pictures.mkdir(parents=True, exist_ok=True)
    return Order(arguments.server, arguments.out, pictures, arguments.names)
