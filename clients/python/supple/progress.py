"""Progress of computations as bars."""

from __future__ import annotations

import sys
import warnings
from typing import Any, Callable, Optional, Union

ProgressFunction = Callable[[float, str], None]
Progress = Union[ProgressFunction, bool]
"""The argument `progress`: a function that is called as `progress(fraction, stage)` with the fraction of the work that is
done, in [0, 1], and the current stage; or True for a bar on a terminal or in a notebook, and nothing elsewhere."""


def in_notebook() -> bool:
    """Whether the program runs in the kernel of a notebook."""
    shell = sys.modules.get("IPython")
    current = None if shell is None else shell.get_ipython()
    return current is not None and type(current).__name__ == "ZMQInteractiveShell"


class _PlainLine:
    """A line on standard error that is overwritten."""

    def __init__(self) -> None:
        self._width = 0

    def show(self, fraction: float, stage: str) -> None:
        text = f"{100 * fraction:3.0f} %  {stage}"
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

    def note(self, line: str) -> None:
        sys.stderr.write("\r" + line.ljust(self._width) + "\n")
        self._width = 0

    def close(self) -> None:
        sys.stderr.write("\r" + " " * self._width + "\r")
        sys.stderr.flush()


class _Tqdm:
    """A bar of tqdm, in percent."""

    def __init__(self, tqdm: Any) -> None:
        self._bar = tqdm(total=100, leave=False, bar_format="{percentage:3.0f} %|{bar}| {elapsed}  {desc}")

    def show(self, fraction: float, stage: str) -> None:
        self._bar.set_description_str(stage, refresh=False)
        self._bar.update(round(100 * fraction, 1) - self._bar.n)

    def note(self, line: str) -> None:
        self._bar.write(line, file=sys.stderr)

    def close(self) -> None:
        self._bar.close()


def _new_bar() -> Union[_PlainLine, _Tqdm]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # tqdm warns that it falls back to its text form in a notebook
            from tqdm.auto import tqdm

            return _Tqdm(tqdm)
    except ImportError:
        return _PlainLine()


class Reporter:
    """Passes progress to a function, or shows it as a bar. This is a context manager, which removes the bar at its end.

    `progress` is a `Progress`; None and False show nothing. A bar appears only on a terminal or in a notebook. It is that of
    tqdm if it is installed, or else a plain line.
    """

    def __init__(self, progress: Optional[Progress]) -> None:
        self._function = progress if callable(progress) else None
        self._wants_bar = progress is True and (in_notebook() or sys.stderr.isatty())
        self._bar: Optional[Union[_PlainLine, _Tqdm]] = None

    def __enter__(self) -> "Reporter":
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None

    def __call__(self, fraction: float, stage: str, details: str = "", note: str = "") -> None:
        """Reports a fraction and a stage. A bar shows details of the stage too, and leaves a note in a line above it."""
        if self._function is not None:
            self._function(fraction, stage)
        elif self._wants_bar:
            self._bar = self._bar or _new_bar()
            if note:
                self._bar.note(note)
            self._bar.show(min(max(fraction, 0.0), 1.0), f"{stage}, {details}" if details else stage)
