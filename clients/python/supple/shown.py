"""How results show themselves: in one line, and as tables and pictures in notebooks."""

from __future__ import annotations

import dataclasses
import html
from typing import Any, List, Optional, Tuple

import numpy as np

from .drawing import Drawing, to_matplotlib, to_svg

LONGEST_LINE = 120
"""Characters of the one line that repr() gives."""
LONGEST_TEXT = 40
SHORT_LIST = 4
"""Lists and arrays of at most so many numbers are shown with them."""


def _number(value: Any) -> str:
    return f"{float(value):.6g}"


def short_text(value: Any) -> str:
    """A value in a few characters: numbers with six digits, long arrays and lists by their shape."""
    if value is None or isinstance(value, (bool, np.bool_)):
        return str(value)
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return _number(value)
    if isinstance(value, str):
        return repr(value if len(value) <= LONGEST_TEXT else value[: LONGEST_TEXT - 1] + "\u2026")
    if isinstance(value, np.ndarray):
        if value.ndim == 1 and value.size <= SHORT_LIST:
            return "[" + ", ".join(short_text(entry) for entry in value.tolist()) + "]"
        return f"array{value.shape}"
    if isinstance(value, (tuple, list)):
        if len(value) <= SHORT_LIST and all(isinstance(entry, (int, float)) for entry in value):
            return "(" + ", ".join(short_text(entry) for entry in value) + ")"
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

    def __repr__(self) -> str:
        text = type(self).__name__ + "("
        for index, (name, shown) in enumerate(_entries(self)):
            entry = (", " if index else "") + f"{name}={shown}"
            if len(text) + len(entry) > LONGEST_LINE:
                return text + ", \u2026)"
            text += entry
        return text + ")"

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><th style="text-align:left">{html.escape(name)}</th>'
            f'<td style="text-align:left">{html.escape(shown)}</td></tr>'
            for name, shown in _entries(self)
        )
        return f"<table><caption>{html.escape(type(self).__name__)}</caption>{rows}</table>"


class Drawn(Shown):
    """A result that can be drawn."""

    def _drawing(self) -> Optional[Drawing]:
        """What it looks like; None where it has nothing to show."""
        raise NotImplementedError

    def _repr_svg_(self) -> Optional[str]:
        drawing = self._drawing()
        return None if drawing is None else to_svg(drawing)

    def _repr_html_(self) -> str:
        return (self._repr_svg_() or "") + super()._repr_html_()

    def plot(self, ax: Optional[Any] = None) -> Any:
        """Draws it with matplotlib into the axes `ax`, or into new ones, and returns them.

        Raises `ImportError` where matplotlib is not installed, `ValueError` where there is nothing to draw, such as a
        geodesic whose path was not asked for.
        """
        drawing = self._drawing()
        if drawing is None:
            raise ValueError(f"this {type(self).__name__} has nothing to draw: what would be drawn was not asked for")
        return to_matplotlib(drawing, ax)
