"""Macroscopic loads of a structure. The states of a load form one path from rest, which is followed in their order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Optional, Union

from numpy.typing import ArrayLike

from .checks import one_of, radians
from .units import ANGLE, RATIO, Number
from .wire import At, Sent, Shape


@dataclass(frozen=True)
class GreenStrain(Sent):
    """Prescribed Green strains (E_xx, E_yy, E_xy; tensor components). `strains` has the shape (n, 3)."""

    strains: Annotated[ArrayLike, Shape(-1, 3), At("/green_strain"), RATIO]


@dataclass(frozen=True)
class Uniaxial(Sent):
    """Stretches along a direction (angle from the x axis in radians); lateral strain and shear are free.

    `frame` is the frame of the direction: "space" (the server's default), or "material", as for models and designs.
    """

    direction: Annotated[Number, At("/uniaxial/direction"), ANGLE]
    stretches: Annotated[ArrayLike, Shape(-1), At("/uniaxial/stretches"), RATIO]
    frame: Annotated[Optional[str], At("/uniaxial/frame")] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        radians(self.direction, "direction")
        one_of(self.frame, "frame", ("space", "material"))


@dataclass(frozen=True)
class Biaxial(Sent):
    """Stretches along a direction (angle from the x axis in radians) and orthogonal to it, in pairs."""

    direction: Annotated[Number, At("/biaxial/direction"), ANGLE]
    stretches: Annotated[ArrayLike, Shape(-1, 2), At("/biaxial/stretches"), RATIO]

    def __post_init__(self) -> None:
        super().__post_init__()
        radians(self.direction, "direction")


Load = Union[GreenStrain, Uniaxial, Biaxial]
