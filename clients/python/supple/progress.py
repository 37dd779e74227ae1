"""Progress of computations as bars."""

from __future__ import annotations

import sys
import warnings
from typing import Any, Callable, Optional, Union

ProgressFunction = Callable[[float, str], None]
Progress = Union[ProgressFunction, bool]
"""What the calls accept as `progress`: a function that is called as `progress(fraction, stage)` with the share of the work
that is done, in [0, 1], and what runs now; or True for a bar on a terminal or in a notebook, and nothing elsewhere."""


def in_notebook() -> bool:
    """Whether this runs in the kernel of a notebook."""
    shell = sys.modules.get("IPython")
    current = None if shell is None else shell.get_ipython()
    return current is not None and type(current).__name__ == "ZMQInteractiveShell"


class _PlainLine:
    """One line on standard error that is written anew."""

    def __init__(self) -> None:
        self._width = 0

    def show(self, fraction: float, stage: str) -> None:
        text = f"{100 * fraction:3.0f} %  {stage}"
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

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

    def close(self) -> None:
        self._bar.close()


def _new_bar() -> Union[_PlainLine, _Tqdm]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what its notebook form lacks; it takes the other one then
            from tqdm.auto import tqdm

            return _Tqdm(tqdm)
    except ImportError:
        return _PlainLine()


class Reporter:
    """Hands progress to a function, or shows it as a bar. A context manager that takes the bar away in the end.

    `progress` is what the calls accept; None and False show nothing. A bar needs a terminal or a notebook: without one
    nothing is shown. It is tqdm's where that is installed, else a plain line.
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

    def __call__(self, fraction: float, stage: str) -> None:
        if self._function is not None:
            self._function(fraction, stage)
        elif self._wants_bar:
            self._bar = self._bar or _new_bar()
            self._bar.show(min(max(fraction, 0.0), 1.0), stage)
