#!/usr/bin/python3
"""Makes screenshots small: each is written again with a palette of 128 colours, which is enough for the pages of the editor.

    docs/images/palette.py docs/images/walkthroughs/*.png
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

COLOURS = 128
#: Largest size of a picture in bytes.
MAX_BYTES = 150_000


def shrink(path: Path) -> int:
    """The size of the file in bytes after it was written again."""
    image = Image.open(path).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    image.save(path, optimize=True)
    return path.stat().st_size


def main() -> int:
    large = []
    for name in sys.argv[1:]:
        size = shrink(Path(name))
        print(f"{name}: {size} bytes")
        if size > MAX_BYTES:
            large.append(name)
    if large:
        print(f"larger than {MAX_BYTES} bytes: {', '.join(large)}", file=sys.stderr)
    return 1 if large or not sys.argv[1:] else 0


if __name__ == "__main__":
    sys.exit(main())
