"""Definitions of families of tilings: what a family's file holds, checked and drawn. Lengths are in tiling units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Tuple

from ._arrays import Array, Numbers
from .answers import Cost
from .request import Deadline, Reported, Request, Timeout
from .shown import Shown


@dataclass(frozen=True, repr=False)
class FamilyFinding(Shown):
    """Something that a check of a definition found.

    Attributes:
        flaw: "field", "unused", "too_large", "gap", "overlap", "unmatched", "crossing" or "sliver".
        pointer: JSON pointer to what is meant, such as "/definition/tile/edges/2".
        message: what was found, without its subject.
        parameters: at which it was found, shape (n,); empty if it does not depend on them.
        point: where it is in the plane at these parameters, shape (2,); None if it has no place.
    """

    flaw: str
    message: str
    pointer: str
    parameters: Array
    point: Optional[Array]


@dataclass(frozen=True, repr=False)
class FamilyTiling(Shown):
    """One cell of a tiling: the outlines of its tiles counterclockwise, each of shape (n, 2), and the two translations as rows."""

    parameters: Array
    beam_width: float
    lattice: Array
    tiles: Tuple[Array, ...]


@dataclass(frozen=True, repr=False)
class FamilyCheck(Shown):
    """Whether a definition is one of a family: `good` without faults. Warnings are of places within the bounds that are to be avoided.

    `tiling` is None if fields at fault leave nothing to draw.
    """

    good: bool
    faults: Tuple[FamilyFinding, ...]
    warnings: Tuple[FamilyFinding, ...]
    tiling: Optional[FamilyTiling]
    cost: Cost


@dataclass(frozen=True)
class FamilyCheckRequest(Request[FamilyCheck], path="/v1/family-checks"):
    """Checks the definition of a family of tilings, and draws it.

    Attributes:
        definition: as in `Family.definition` (schema `FamilyDefinition` of the contract). With "isohedral_type" in place of
            "tile" it takes the tile of one of the 81 types.
        parameters: within the definition's bounds; None takes its defaults.
    """

    definition: Mapping[str, Any]
    parameters: Optional[Numbers] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
