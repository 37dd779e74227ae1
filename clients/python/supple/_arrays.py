"""The array types of the package, and those of fields whose shape the contract fixes."""

from typing import Annotated, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .wire import At, Shape, integers

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Vector3 = Tuple[float, float, float]

Positions = Annotated[Array, Shape(-1, 3)]
"""Rows of three numbers."""
Positions2 = Annotated[Array, Shape(-1, 2)]
Numbers = Annotated[ArrayLike, Shape(-1)]
"""A list of numbers as an argument."""
Vector3Like = Annotated[ArrayLike, Shape(3)]
Vector2Like = Annotated[ArrayLike, Shape(2)]
IndexList = Annotated[Sequence[int], At(write=integers)]
"""A list of indices as an argument."""
