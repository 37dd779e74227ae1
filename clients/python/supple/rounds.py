"""What a running job tells about the rounds in which it polishes designs."""

from __future__ import annotations

import math
from typing import Any, Dict, Optional

from .design_answers import PartialDesign, PartialRound, percent


class Rounds:
    """The rounds of a job, as its statuses report them. A status has the latest round only, and regions are polished one after the
    other."""

    def __init__(self) -> None:
        self._best: Dict[str, float] = {}
        self._latest: Optional[PartialRound] = None
        self._searches = False
        self._unnamed = 0

    def add(self, partial: Any) -> str:
        """The round in words if it is a new one, otherwise an empty text."""
        if isinstance(partial, PartialDesign):
            self._searches = True
        if not isinstance(partial, PartialRound) or (self._latest is not None and _same(partial, self._latest)):
            return ""
        # Regions without a name are told apart by the searches between them.
        self._unnamed += partial.name == "" and (self._searches or self._unnamed == 0)
        self._latest, self._searches = partial, False
        name, one = partial.name or f"region {self._unnamed}", partial.round
        error = math.inf if one.target_error is None else one.target_error
        self._best[name] = min(error, self._best.get(name, math.inf))
        best = f", best {percent(self._best[name])}" if math.isfinite(self._best[name]) else ""
        named = f"{partial.name}: " if partial.name else ""
        off = " off by the simulation" if one.target_error is not None else ""
        return f"{named}{percent(one.target_error)}{off} after {one.seconds:.3g} s{best}"

    def best(self) -> str:
        """The best deviation so far of the region that is furthest from its target; empty before the first round with a result."""
        if not self._best:
            return ""
        worst = max(self._best, key=lambda name: self._best[name])
        if not math.isfinite(self._best[worst]):
            return ""
        return f"{'' if len(self._best) == 1 else f'worst: {worst}, '}best {percent(self._best[worst])}"


def _same(a: PartialRound, b: PartialRound) -> bool:
    return (a.name, a.family, a.round.seconds, a.round.target_error, a.round.parameters.tolist()) == (
        b.name, b.family, b.round.seconds, b.round.target_error, b.round.parameters.tolist())
