"""The checks of the wings about tilings, weaves, parts and designs can fail: they detect small changes of a real server's answers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, Callable, Dict, Iterator

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[0] / "api"), str(HERE / "wings")]

import run  # noqa: E402
from harness import ServerProcess  # noqa: E402
from truth import Server, generator  # noqa: E402

MOST_CASES = 60
"""Largest number of cases until a fault must be found; only some of them examine its check."""


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    process = ServerProcess(tmp_path_factory.mktemp("truth") / "data", "--models", str(HERE.parents[1] / "models")).start()
    yield process.url
    process.stop()


class Faulty(Server):
    """A server whose answers for one path are changed before they are examined."""

    def __init__(self, url: str, path: str, spoil: Callable[[Any], None]) -> None:
        super().__init__(url)
        self.path = path
        self.spoil = spoil

    def post(self, path: str, body: Any, content_type: str = "application/json") -> Any:
        answer = super().post(path, body, content_type)
        if path == self.path:
            self.spoil(answer)
        return answer

    def file(self, path: str, body: Any, accept: str, content_type: str = "application/json") -> bytes:
        data = super().file(path, body, accept, content_type)
        if accept == self.path:
            changed = bytearray(data)
            self.spoil(changed)
            data = bytes(changed)
        return data


def states(change: Callable[[Dict[str, Any]], None]) -> Callable[[Any], None]:
    def spoil(answer: Any) -> None:
        for state in answer["states"]:
            change(state)
    return spoil


def scale(key: str, factor: float) -> Callable[[Dict[str, Any]], None]:
    def change(answer: Dict[str, Any]) -> None:
        answer[key] = (np.array(answer[key]) * factor).tolist()
    return change


def shift(*keys: Any, by: float) -> Callable[[Dict[str, Any]], None]:
    def change(answer: Any) -> None:
        for key in keys[:-1]:
            answer = answer[key]
        if answer[keys[-1]] is not None:
            answer[keys[-1]] += by
    return change


def other_bars_where_searches_have_their_own(answer: Any) -> None:
    """Changes error bars only for the models whose bars differ between found and given designs, which must therefore not be compared."""
    if answer["family"] in ("IH01", "IH22", "IH28", "IH50", "IH67"):
        shift("profile", "error_bar", 1, by=1e-3)(answer)


def thinner(checks: Dict[str, Any]) -> None:
    if checks["checks"]["smallest_neck"] is not None:
        checks["checks"]["smallest_neck"] *= 0.97


def wider(checks: Dict[str, Any]) -> None:
    if checks["checks"]["smallest_neck"] is not None:
        checks["checks"]["smallest_neck"] *= 1.03


def moved_corner(file: Any) -> None:
    """Moves the first corner of a binary STL file, in one triangle."""
    file[84 + 12:84 + 16] = np.float32(np.frombuffer(bytes(file[96:100]), dtype="<f4")[0] + 0.01).tobytes()


def less_filament(answer: Any) -> None:
    answer["gcode"] = answer["gcode"].replace(" E1", " E2", 1)


SIMULATIONS, HOMOGENIZATIONS, PARTS, DESIGNS, PROFILES = "/v1/simulations", "/v1/weave-homogenizations", "/v1/parts", "/v1/designs", "/v1/profiles"
FAULTS = [
    ("simulations", SIMULATIONS, states(scale("energy_density", 1 + 1e-8)), "energy"),
    ("simulations", SIMULATIONS, states(scale("stress", 1 + 1e-8)), "stress"),
    ("simulations", SIMULATIONS, states(scale("smallest_jacobian", 1.01)), "smallest jacobian"),
    ("simulations", SIMULATIONS, states(lambda state: state.update(stable=not state["stable"])), "stability"),
    ("simulations", SIMULATIONS, states(lambda state: state.update(deformation_gradient=[[1, 0], [0, 1]])), "load"),
    ("weaves", HOMOGENIZATIONS, scale("youngs_modulus", 1 + 1e-5), "definitions"),
    ("weaves", HOMOGENIZATIONS, shift("poisson_ratio", 0, by=1e-5), "definitions"),
    ("weaves", "/v1/weave-deformations", scale("energy_density", 1 + 1e-5), "two families"),
    ("weaves", "/v1/weave-deformations", scale("nominal_stress", 1.01), "two families"),
    ("weaves", "/v1/weave-simulations", states(lambda state: state.update(energy=state["energy"] * (1 + 0.03 * state["share"]))), "work"),
    ("weaves", "/v1/weave-toolpaths", less_filament, "printed lengths"),
    ("parts", PARTS, thinner, "parted at the neck"),
    ("parts", PARTS, wider, "whole at the neck"),
    ("parts", PARTS, shift("orientation", by=1e-3), "tested direction"),
    ("parts", PARTS, shift("solid_area", by=0.1), "area"),
    ("parts", "model/stl", moved_corner, "closed"),
    ("designs", DESIGNS, shift("error", "relative_rms", by=1e-6), "deviation"),
    ("designs", DESIGNS, shift("profile", "target", 1, by=1e-2), "target"),
    ("designs", DESIGNS, shift("profile", "achieved", 1, by=1e-2), "profile"),
    ("designs", PROFILES, shift("y", 1, by=1e-2), "equilibrium"),
    ("designs", DESIGNS, other_bars_where_searches_have_their_own, "bars"),
    ("designs", PROFILES, shift("error_bar", 1, by=1e-3), "bars"),
    ("designs", PROFILES, lambda answer: answer.update(in_range=[True] * len(answer["in_range"])), "in range"),
    ("designs", PROFILES, lambda answer: answer.update(error_bar=[bar and 10 * bar for bar in answer["error_bar"]]), "in range"),
    ("designs", DESIGNS, lambda answer: answer.update(reached=not answer["reached"]), "reached"),
]


class OtherwiseLaid(Server):
    """A server that makes files of parts with another direction than the request's."""

    def __init__(self, url: str, other: Callable[[float], float]) -> None:
        super().__init__(url)
        self.other = other

    def file(self, path: str, body: Any, accept: str, content_type: str = "application/json") -> bytes:
        return super().file(path, {**body, "direction": self.other(body["direction"])}, accept, content_type)


def not_turned(direction: float) -> float:
    """The direction that leaves a structure as it lies without any."""
    return np.pi / 2


def turned_the_other_way(direction: float) -> float:
    return np.pi - direction


def a_little_off(direction: float) -> float:
    return direction + 1e-3


def expect_found(name: str, right: Server, faulty: Server, check: str, first: int = 0) -> None:
    """Fails unless a case of the wing is wrong with the faulty server, and right with the other."""
    wing = run.load(name)

    def wrong(server: Server, case: Any) -> bool:
        return any(not abs(deviation) <= wing.CHECKS[check].limit for key, deviation in wing.examine(server, case) if key == check)

    for index in range(first, first + MOST_CASES):
        case = wing.case(generator(1, name, index))
        if wrong(faulty, case):
            assert not wrong(right, case)
            return
    pytest.fail(f"{check} did not find it in {MOST_CASES} cases")


@pytest.mark.parametrize("name, path, spoil, check", FAULTS, ids=[f"{fault[0]}-{fault[3]}-{number}" for number, fault in enumerate(FAULTS)])
def test_an_answer_that_is_changed_by_a_little_is_found(url: str, name: str, path: str, spoil: Callable[[Any], None], check: str) -> None:
    expect_found(name, Server(url), Faulty(url, path, spoil), check)


@pytest.mark.parametrize("other", [not_turned, turned_the_other_way, a_little_off])
def test_a_coupon_that_is_laid_otherwise_is_found_by_its_drawing(url: str, other: Callable[[float], float]) -> None:
    expect_found("coupons", Server(url), OtherwiseLaid(url, other), "drawing")


@pytest.mark.parametrize("other, first", [(not_turned, 8), (turned_the_other_way, 31)])
def test_a_coupon_that_is_laid_otherwise_is_found_by_its_force(url: str, other: Callable[[float], float], first: int) -> None:
    """The first case is one whose design is much stiffer along the direction that the fault lays along y. Beginning there saves time."""
    expect_found("coupons", Server(url), OtherwiseLaid(url, other), "stiffer", first)
