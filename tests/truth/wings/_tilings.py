"""Code common to the wings about tilings: families, and parameters that have a structure."""

from __future__ import annotations

import functools
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from truth import Refusal, Server

FAMILIES = ("IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67")
DRAWS = 4
"""Number of random parameter vectors of a case. Parameters in the corners of some boxes have no structure; the next vector is then used."""
NO_STRUCTURE = ("tiling.cell_too_small", "tiling.hole_closed")


@functools.lru_cache(maxsize=None)
def _families(server: Server) -> Dict[str, Any]:
    return {family["id"]: family for family in server.get("/v1/families")["families"]}


def draws(rng: np.random.Generator) -> List[List[float]]:
    """Random parameter vectors as fractions of the ranges of the parameters, with more entries than any family has parameters."""
    return [[float(share) for share in rng.uniform(size=8)] for _ in range(DRAWS)]


def parameters_at(server: Server, family: str, shares: Sequence[float]) -> List[float]:
    bounds = _families(server)[family]["parameters"]
    return [low + (high - low) * share for low, high, share in zip(bounds["lower"], bounds["upper"], shares)]


def structure_of(server: Server, family: str, shares: Sequence[Sequence[float]], beam_width: float = 0.3) -> Optional[Dict[str, Any]]:
    """The structure of the first of the parameter vectors that has one; None if none has."""
    for one in shares:
        try:
            answer = server.post("/v1/structures", {"family": family, "parameters": parameters_at(server, family, one), "beam_width": beam_width})
            assert isinstance(answer, dict)
            return answer
        except Refusal as refusal:
            if refusal.code not in NO_STRUCTURE:
                raise
    return None


def turned(angle: float) -> "np.ndarray[Any, np.dtype[np.float64]]":
    """The rotation by the angle, counterclockwise."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
