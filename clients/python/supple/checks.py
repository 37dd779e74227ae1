"""Checks before a request is sent, for likely mistakes that the server would report too late or could not recognize."""

from __future__ import annotations

import math
import sys
import warnings
from typing import Any, List, Optional, Sequence, Type

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Array

TASKS = ("stress_strain", "stiffness", "poisson")
WHOLE_TURN = 2 * math.pi


class LikelyDegrees(UserWarning):
    """An angle in radians exceeds a whole turn, and was probably meant in degrees."""


def radians(value: Any, name: str) -> float:
    """An angle as a float. Raises `TypeError` if it is no number; warns with `LikelyDegrees` of one beyond a whole turn."""
    angle = number(value, name, "an angle in radians")
    if abs(angle) > WHOLE_TURN:
        warn(
            f"{name}={angle:g} is in radians, more than a whole turn; for {angle:g} degrees write math.radians({angle:g})",
            LikelyDegrees,
        )
    return angle


def warn(message: str, category: Type[Warning] = UserWarning) -> None:
    """Warns of something at the line of the caller's program that called this package."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(message, category, stacklevel=level)


def number(value: Any, name: str, what: str = "a number") -> float:
    """One finite number as a float. Raises `TypeError` or `ValueError`."""
    if isinstance(value, (bool, str)) or np.ndim(value) != 0:
        shown = f"an array of shape {np.shape(value)}" if np.ndim(value) else repr(value)
        raise TypeError(f"{name} is {what}, not {shown}")
    found = float(value)
    if not math.isfinite(found):
        raise ValueError(f"{name} is {found}; expected {what}")
    return found


def pair(values: Any, name: str) -> List[float]:
    """Two numbers, the lesser first. Raises `ValueError`."""
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (2,) or not array[0] <= array[1]:
        raise ValueError(f"{name} is {values!r}; expected a pair (least, most)")
    return [float(array[0]), float(array[1])]


def one_of(value: Optional[str], name: str, allowed: Sequence[str]) -> None:
    if value is not None and value not in allowed:
        raise ValueError(f"{name} is {value!r}; expected one of {', '.join(map(repr, allowed))}")


def control_points(points: ArrayLike, task: str, direction: Any) -> Array:
    """The control points of a target, shape (n, 2). Raises `TypeError` if x and y are separate arguments."""
    array = np.asarray(points, dtype=np.float64)
    if array.ndim == 1 and np.ndim(direction) == 1:
        raise TypeError(
            f"Target({task!r}, x, y) would take y for the direction of the load; control points are one array of (x, y): "
            f"Target({task!r}, numpy.column_stack([x, y]))"
        )
    if array.ndim != 2 or array.shape[1] != 2:
        raise ValueError(f"control_points have the shape {array.shape}; expected (n, 2)")
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise ValueError(f"control point {row} is not finite: {array[row].tolist()}")
    late = np.flatnonzero(np.diff(array[:, 0]) <= 0)
    if len(late):
        row = int(late[0]) + 1
        raise ValueError(f"control point {row} has x = {array[row, 0]:g}, which is not beyond that before it, {array[row - 1, 0]:g}")
    return array


def one_for_each(values: Optional[ArrayLike], name: str, count: int) -> None:
    """Raises `ValueError` unless there are as many numbers as control points, none of them negative."""
    if values is None:
        return
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (count,):
        raise ValueError(f"{name} have the shape {array.shape}; expected ({count},), one for each control point")
    if not (np.isfinite(array) & (array >= 0)).all():
        raise ValueError(f"{name} are finite and not negative")
