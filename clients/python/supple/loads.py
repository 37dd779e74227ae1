"""Macroscopic loads of a structure. The states of a load form one path from rest, which is followed in their order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from .checks import one_of, radians


@dataclass(frozen=True)
class GreenStrain:
    """Prescribed Green strains (E_xx, E_yy, E_xy; tensor components). `strains` has the shape (n, 3)."""

    strains: ArrayLike

    def to_wire(self) -> Dict[str, Any]:
        strains = np.asarray(self.strains, dtype=np.float64)
        if strains.ndim != 2 or strains.shape[1] != 3:
            raise ValueError(f"strains have the shape {strains.shape}; expected (n, 3)")
        return {"green_strain": strains.tolist()}


@dataclass(frozen=True)
class Uniaxial:
    """Stretches along a direction (angle from the x axis in radians); lateral strain and shear are free.

    `frame` is the frame of the direction: "space" (the server's default), or "material", as for models and designs.
    """

    direction: float
    stretches: Sequence[float]
    frame: Optional[str] = None

    def __post_init__(self) -> None:
        radians(self.direction, "direction")
        one_of(self.frame, "frame", ("space", "material"))

    def to_wire(self) -> Dict[str, Any]:
        load: Dict[str, Any] = {"direction": float(self.direction), "stretches": [float(s) for s in self.stretches]}
        if self.frame is not None:
            load["frame"] = self.frame
        return {"uniaxial": load}


@dataclass(frozen=True)
class Biaxial:
    """Stretches along a direction (angle from the x axis in radians) and orthogonal to it, in pairs."""

    direction: float
    stretches: Sequence[Tuple[float, float]]

    def __post_init__(self) -> None:
        radians(self.direction, "direction")

    def to_wire(self) -> Dict[str, Any]:
        pairs = [[float(along), float(across)] for along, across in self.stretches]
        return {"biaxial": {"direction": float(self.direction), "stretches": pairs}}


Load = Union[GreenStrain, Uniaxial, Biaxial]
