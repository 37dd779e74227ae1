"""The display of results: in one line, and as tables and pictures in notebooks."""

from __future__ import annotations

import dataclasses
import html
import math
from decimal import Decimal
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

from .drawing import Drawing, to_matplotlib, to_svg

MAX_LINE_LENGTH = 120
"""Largest number of characters of repr()."""
MAX_TEXT_LENGTH = 40
MAX_SHORT_LIST = 4
"""Largest number of entries with which a list or an array is shown in full."""


MAX_PLAIN_INTEGER = 10**15
"""Integers up to this one are shown in full, and larger ones with an exponent."""
ZERO_FRACTION = 1e-9
"""Numbers below this fraction of the largest one beside them are zero but for rounding."""


def _number(value: Any, scale: float = 0.0) -> str:
    number = float(value)
    return "0" if abs(number) <= ZERO_FRACTION * scale else f"{number:.6g}"


def _numbers(values: Sequence[Any]) -> str:
    """Numbers side by side; -2e-17 beside 3 is shown as 0, which it is but for rounding."""
    sizes = [abs(float(value)) for value in values]
    scale = max([size for size in sizes if math.isfinite(size)], default=0.0)
    return ", ".join(_number(value, scale) if isinstance(value, float) else short_text(value) for value in values)


def short_text(value: Any) -> str:
    """A value in a few characters: numbers with six digits, long arrays and lists by their shape."""
    if value is None or isinstance(value, (bool, np.bool_)):
        return str(value)
    if isinstance(value, (int, np.integer)):
        integer = int(value)
        return str(integer) if abs(integer) <= MAX_PLAIN_INTEGER else f"{Decimal(integer).normalize():.6g}"
    if isinstance(value, (float, np.floating)):
        return _number(value)
    if isinstance(value, str):
        return repr(value if len(value) <= MAX_TEXT_LENGTH else value[: MAX_TEXT_LENGTH - 1] + "\u2026")
    if isinstance(value, np.ndarray):
        if value.ndim == 1 and value.size <= MAX_SHORT_LIST:
            return "[" + _numbers(value.tolist()) + "]"
        return f"array{value.shape}"
    if isinstance(value, (tuple, list)):
        if len(value) <= MAX_SHORT_LIST and all(isinstance(entry, (int, float)) for entry in value):
            return "(" + _numbers(value) + ")"
        return "()" if not value else f"{len(value)} \u00d7 {type(value[0]).__name__}"
    if isinstance(value, dict):
        return f"{len(value)} entries"
    if dataclasses.is_dataclass(value):
        return f"{type(value).__name__}(\u2026)"
    return repr(value)


def _entries(value: Any) -> List[Tuple[str, str]]:
    return [(one.name, short_text(getattr(value, one.name))) for one in dataclasses.fields(value)]


class Shown:
    """A result whose repr() is one short line and which notebooks show as a table of its fields."""

    def _shown(self) -> List[Tuple[str, str]]:
        """What is shown, by its name; what matters most comes first."""
        return _entries(self)

    def __repr__(self) -> str:
        text = type(self).__name__ + "("
        for index, (name, shown) in enumerate(self._shown()):
            entry = (", " if index else "") + f"{name}={shown}"
            if len(text) + len(entry) > MAX_LINE_LENGTH:
                return text + ", \u2026)"
            text += entry
        return text + ")"

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><th style="text-align:left">{html.escape(name)}</th>'
            f'<td style="text-align:left">{html.escape(shown)}</td></tr>'
            for name, shown in self._shown()
        )
        return f"<table><caption>{html.escape(type(self).__name__)}</caption>{rows}</table>"


class Drawn(Shown):
    """A result that can be drawn."""

    def _drawing(self) -> Optional[Drawing]:
        """Its picture; None if there is nothing to draw."""
        raise NotImplementedError

    def _repr_svg_(self) -> Optional[str]:
        drawing = self._drawing()
        return None if drawing is None else to_svg(drawing)

    def _repr_html_(self) -> str:
        return (self._repr_svg_() or "") + super()._repr_html_()

    def plot(self, ax: Optional[Any] = None) -> Any:
        """Draws the result with matplotlib into the axes `ax`, or into new ones, and returns them.

        Raises `ImportError` if matplotlib is not installed, and `ValueError` if there is nothing to draw, for example for a
        geodesic whose path was not requested.
        """
        drawing = self._drawing()
        if drawing is None:
            raise ValueError(f"this {type(self).__name__} has nothing to draw: what would be drawn was not asked for")
        return to_matplotlib(drawing, ax)
