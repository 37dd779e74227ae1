"""The suite can fail: it detects planted deviations, refusals and checks that no case examines. The same seed gives the same case."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, Iterator, Tuple

import numpy as np
import pytest
from shapely.affinity import rotate
from shapely.geometry import box

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from _coupons import Coupon, Linear  # noqa: E402
from _elements import Law  # noqa: E402
from _hosts import shell_energies  # noqa: E402
from _networks import Network  # noqa: E402
from _shapes import Renumbering, any_mesh, folded, random_point  # noqa: E402
from _surface import Surface  # noqa: E402
from _unfolding import distances  # noqa: E402
from kept import KeptCases  # noqa: E402
from truth import ALL_EXAMINED_FROM, ANSWERED, Check, Refusal, Result, Server, generator, run_wing  # noqa: E402


def wing_of(examine: Any) -> ModuleType:
    wing = ModuleType("planted")
    wing.ABOUT = "A planted wing."  # type: ignore[attr-defined]
    wing.CHECKS = {"exact": Check("Something", 1e-9, "of something"), "rough": Check("Something else", 0.1, "of it")}  # type: ignore[attr-defined]
    wing.case = lambda rng: {"number": float(rng.uniform())}  # type: ignore[attr-defined]
    wing.examine = examine  # type: ignore[attr-defined]
    return wing


def result_of(examine: Any, cases: int = 20, first: int = 0, seed: int = 1) -> Result:
    return run_wing("planted", wing_of(examine), Server("http://127.0.0.1:1"), seed, first, cases)


def right(_: Server, case: Any) -> Iterator[Tuple[str, float]]:
    yield "exact", -1e-10
    yield "rough", 0.05 * case["number"]


def test_a_wing_whose_deviations_keep_their_limits_is_sound() -> None:
    result = result_of(right)
    assert result.sound and not result.found
    assert len(result.figures["exact"].deviations) == 20 and result.figures["exact"].largest == 1e-10


@pytest.mark.parametrize("wrong", [1e-8, -1e-8, math.nan, math.inf])
def test_a_deviation_beyond_its_limit_is_found_with_the_case_that_repeats_it(wrong: float) -> None:
    seen = []

    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        seen.append(case)
        yield "exact", wrong if len(seen) == 8 else 0.0
        yield "rough", 0

    result = result_of(examine)
    assert not result.sound and [(found.check, found.index) for found in result.found] == [("exact", 7)]
    assert result.figures["exact"].beyond == 1 and result.figures["exact"].worst_case == 7
    assert wing_of(right).case(generator(1, "planted", 7)) == seen[7]


def test_the_largest_of_several_deviations_of_a_case_counts() -> None:
    result = result_of(lambda server, case: iter([("rough", 0.01), ("rough", 0.2), ("rough", 0.02)]), cases=1)
    assert result.figures["rough"].deviations == {0: 0.2} and not result.sound


@pytest.mark.parametrize("error", [Refusal(422, {"code": "request.invalid", "detail": "No."}), ValueError("No."), KeyError("exact")])
def test_a_case_that_ends_in_a_refusal_or_an_exception_is_found_and_the_others_are_examined(error: Exception) -> None:
    calls = []
    revived = []

    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        calls.append(case)
        if len(calls) == 3:
            raise error
        yield "exact", 0

    result = run_wing("planted", wing_of(examine), Server("http://127.0.0.1:1"), 1, 0, 5, revive=lambda: revived.append(True))
    assert [(found.check, found.index) for found in result.found] == [(ANSWERED, 2)] and type(error).__name__ in result.found[0].message
    assert len(calls) == 5 and revived == [True]


def test_a_check_that_no_case_comes_to_is_a_fault_of_a_long_run() -> None:
    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        yield "exact", 0

    assert result_of(examine, cases=5).sound
    long = result_of(examine, cases=ALL_EXAMINED_FROM)
    assert long.unexamined == ["rough"] and not long.sound


def test_a_share_of_the_cases_may_be_beyond_the_limit_and_no_more() -> None:
    for share, sound in ((0.05, True), (0.04, False)):
        calls = []

        def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
            calls.append(case)
            yield "exact", 1.0 if len(calls) == 7 else 0.0

        wing = wing_of(examine)
        wing.CHECKS["exact"] = Check("Something", 0, "of something", share)  # type: ignore[attr-defined]
        result = run_wing("planted", wing, Server("http://127.0.0.1:1"), 1, 0, 20)
        assert result.sound is sound and len(result.found) == 1


def test_an_interrupted_run_has_the_cases_before() -> None:
    calls = []

    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        calls.append(case)
        if len(calls) == 4:
            raise KeyboardInterrupt
        yield "exact", 0

    result = result_of(examine)
    assert result.cases == 3 and len(result.figures["exact"].deviations) == 3 and len(result.figures[ANSWERED].deviations) == 3


def test_a_run_goes_on_with_the_cases_that_an_earlier_one_has_kept(tmp_path: Path) -> None:
    examined = []

    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        examined.append(case)
        yield "exact", math.nan if len(examined) == 3 else 1e-10
        if len(examined) == 5:
            raise Refusal(422, {"code": "planted", "detail": "planted"})

    def kept(state: str = "this") -> KeptCases:
        return KeptCases(tmp_path / "kept.jsonl", "planted", 1, state)

    def goes_on(cases: int, kept: KeptCases) -> Result:
        return run_wing("planted", wing_of(examine), Server("http://127.0.0.1:1"), 1, 0, cases, kept=kept)

    first = goes_on(6, kept())
    with (tmp_path / "kept.jsonl").open("a", encoding="utf-8") as file:
        file.write('{"wing": "planted", "se')  # the run was killed here
    whole = goes_on(10, kept())
    assert len(examined) == 10
    assert [found.index for found in first.found] == [found.index for found in whole.found] == [2, 4]
    assert whole.found[1].message.startswith("Refusal: 422 planted")
    assert len(goes_on(10, kept()).found) == 2 and len(examined) == 10
    goes_on(10, kept("another"))
    assert len(examined) == 20, "what another state has found says nothing about this one"


def test_what_a_wing_is_made_of_is_known_with_the_modules_that_it_uses() -> None:
    assert {path.name for path in run.sources_of("coupons")} >= {"coupons.py", "_coupons.py", "_elements.py", "truth.py", "kept.py"}
    assert "_coupons.py" not in {path.name for path in run.sources_of("geodesics")}


def test_a_check_that_the_wing_does_not_name_is_found() -> None:
    assert not result_of(lambda server, case: iter([("unnamed", 0.0)]), cases=1).sound


def test_random_numbers_depend_on_seed_wing_and_index_alone() -> None:
    draw = lambda *key: generator(*key).uniform()  # noqa: E731
    assert draw(1, "a", 0) == draw(1, "a", 0)
    assert len({draw(1, "a", 0), draw(2, "a", 0), draw(1, "b", 0), draw(1, "a", 1)}) == 4


def test_tables_of_other_wings_and_the_text_between_them_stay(tmp_path: Path) -> None:
    page, numbers = tmp_path / "truth.md", tmp_path / "truth.csv"
    for wing in ("one", "two"):
        rows = [{**row, "wing": wing} for row in run.rows_of(result_of(right))]
        run.write_csv(numbers, rows)
        run.write_page(page, wing, f"About {wing}.", rows)
    page.write_text(page.read_text() + "\nWhat was found.\n")
    rows = [{**row, "wing": "one"} for row in run.rows_of(result_of(right, cases=3))]
    run.write_csv(numbers, rows)
    run.write_page(page, "one", "Another sentence.", rows)
    text = page.read_text()
    assert "Another sentence." in text and "About one." not in text and "About two." in text and text.endswith("What was found.\n")
    with numbers.open(newline="") as file:
        assert [(row["wing"], row["cases"]) for row in csv.DictReader(file) if row["check"] == "exact"] == [("one", "3"), ("two", "20")]


def test_every_wing_has_what_a_run_asks_for() -> None:
    assert run.wings()
    for name in run.wings():
        wing = run.load(name)
        assert wing.ABOUT.endswith(".") and wing.CHECKS and ANSWERED not in wing.CHECKS
        assert all(isinstance(check, Check) and np.isfinite(check.limit) and check.limit >= 0 for check in wing.CHECKS.values())
        assert wing.case(generator(1, name, 0)) is not None


def test_unfolded_lengths_are_those_of_the_plane_on_a_folded_rectangle() -> None:
    rng = np.random.default_rng(1)
    for _ in range(5):
        vertices, faces, flat, _ = folded(rng, tube=False)
        points = [random_point(rng, faces) for _ in range(5)]
        surface = Surface(vertices, faces)
        places = np.array([coordinates @ flat[face] for face, coordinates in (surface.entries(point)[0] for point in points)])
        found, _ = distances(surface, points, points)
        assert np.abs(found - np.linalg.norm(places[:, None] - places[None], axis=2)).max() < 1e-13


def test_unfolded_lengths_know_no_order_and_no_path_is_shorter() -> None:
    rng = np.random.default_rng(2)
    for _ in range(8):
        _, (vertices, faces) = any_mesh(rng)
        surface, points = Surface(vertices, faces), [random_point(rng, faces) for _ in range(5)]
        renumbered = Renumbering(rng, surface)
        found, to_vertices = distances(surface, points, points, to_vertices=True)
        other, _ = distances(Surface(renumbered.vertices, renumbered.faces), *2 * [[renumbered.point(point) for point in points]])
        assert np.abs(found - other).max() < 1e-12 and np.abs(found - found.T).max() < 1e-12
        assert (found[:, :, None] <= found[:, None, :] + found[None] + 1e-12).all(), "a way round is shorter"
        edges = surface.length
        assert (np.abs(to_vertices[:, surface.start] - to_vertices[:, surface.end]) <= edges + 1e-12).all()


def near_vertex(rng: np.random.Generator, faces: Any) -> Any:
    """A point of a random face, 1e-12 to 1e-1 from one of its corners, and as near or nearer to one of the edges at this corner."""
    corner, turn, near = int(rng.integers(3)), int(rng.integers(1, 3)), 10 ** rng.uniform(-12, -1)
    coordinates = np.zeros(3)
    coordinates[(corner + turn) % 3], coordinates[(corner - turn) % 3] = near, near * rng.choice([0, 1, 10 ** rng.uniform(-10, 0)])
    coordinates[corner] = 1 - coordinates.sum()
    return {"face": int(rng.integers(len(faces))), "barycentric": coordinates.tolist()}


def test_unfolded_lengths_are_the_same_in_both_senses_but_beside_vertices() -> None:
    rng = np.random.default_rng(4)
    beside = 0
    for _ in range(25):
        _, (vertices, faces) = any_mesh(rng)
        surface, others = Surface(vertices, faces), [random_point(rng, faces, inside=True) for _ in range(5)]
        points = [near_vertex(rng, faces) for _ in range(12)]
        compared = [point for point in points if not surface.beside_vertex(point)]
        beside += len(points) - len(compared)
        there, back = distances(surface, compared, others)[0], distances(surface, others, compared)[0]
        assert np.abs(there - back.T).max(initial=0) < 1e-12 * surface.diagonal
        for point in points:  # the vertex that replaces such a point is close to it
            place = surface.nearest_vertex(point)
            assert not surface.beside_vertex(place) and np.linalg.norm(surface.position(place) - surface.position(point)) < 3e-6 * surface.length.max()
    assert 25 < beside < 275


def test_lengths_of_networks_are_compared_but_for_ends_beside_vertices() -> None:
    networks = run.load("networks")
    rng = np.random.default_rng(5)
    _, (vertices, faces) = any_mesh(rng)
    surface = Surface(vertices, faces)
    points = [random_point(rng, faces, inside=True) for _ in range(3)] + [{"face": 0, "barycentric": [1 - 2e-9, 1e-9, 1e-9]}]
    springs = [{"between": [0, 1], "rest_length": 1}, {"between": [1, 2], "rest_length": 1}, {"between": [2, 3], "rest_length": 1}]
    network, own = Network(springs, [], None, np.zeros((1, 1))), distances(surface, points, points)[0]
    lengths = [own[0, 1], own[1, 2], own[3, 2] + 0.1]

    def deviation() -> float:
        ((name, found),) = networks._lengths("length", surface, network, {"points": points, "springs": [{"length": length} for length in lengths]}, own)
        return found

    assert deviation() == 0
    lengths[1] += 1e-9
    assert deviation() > networks.CHECKS["length"].limit


def test_walks_end_as_far_as_they_were_to_go() -> None:
    rng = np.random.default_rng(3)
    for _ in range(8):
        vertices, faces, _, _ = folded(rng, tube=True)
        surface, point = Surface(vertices, faces), random_point(rng, faces, inside=True)
        length = 0.2 * float(surface.length.min())
        end = surface.walk(point, float(rng.uniform(0, 6)), length)
        found, _ = distances(surface, [point], [end])
        on_boundary = any(surface.twin[3 * face + (int(np.argmin(coordinates)) + 1) % 3] < 0 and coordinates.min() < 1e-9 for face, coordinates in surface.entries(end))
        assert abs(found[0, 0] - length) < 1e-12 or on_boundary


def test_a_cylinder_bends_with_the_energy_of_the_plate() -> None:
    """The energy of a rolled-up strip of equilateral triangles is D / 2 times its area over the squared radius."""
    rows, columns, radius = 9, 40, 5.0
    x = np.array([[j + 0.5 * (i % 2) for j in range(columns)] for i in range(rows)]).ravel()
    y = np.repeat(np.arange(rows) * 3**0.5 / 2, columns)
    faces = []
    for i in range(rows - 1):
        for j in range(columns - 1):
            a, b, c, d = i * columns + j, i * columns + j + 1, (i + 1) * columns + j, (i + 1) * columns + j + 1
            faces += [[a, b, c], [b, d, c]] if i % 2 == 0 else [[a, b, d], [a, d, c]]
    flat = Surface(np.stack([x, y, 0 * x], axis=1), np.array(faces))
    rolled = np.stack([radius * np.sin(x / radius), y, radius * np.cos(x / radius)], axis=1)
    host = {"youngs_modulus": 12.0, "poisson_ratio": 0.0, "thickness": 1.0}
    plate = 1 / 2 * flat.area / radius**2
    assert abs(shell_energies(flat, host, rolled)["shell_bending"] / plate - 1) < 0.05


def test_a_mesh_fills_a_part_with_holes() -> None:
    part = box(0, 0, 6, 10).difference(rotate(box(1, 2, 3, 7), 20)).difference(rotate(box(3.5, 4, 3.6, 9), 7))
    coupon = Coupon(part, 0.5, 0.3)
    assert float(coupon.weight.sum()) == pytest.approx(part.area, rel=1e-12) and float(coupon.weight.min()) > 0


def test_a_sheet_between_grips_has_the_force_of_its_law() -> None:
    sheet = Coupon(box(0, 0, 2, 4), 0.0, 0.5)
    alone = sheet.stretched(Linear(np.diag([3.0, 5.0, 1.0])))
    assert (alone.force, alone.strain) == (pytest.approx(5, rel=1e-9), pytest.approx(1, rel=1e-9))
    law = Law("neo_hookean", 26.0, 0.3)
    mu, lam = 26 / 2.6, 26 * 0.3 / (1.3 * 0.4)
    tangent = np.array([[lam + 2 * mu, lam, 0], [lam, lam + 2 * mu, 0], [0, 0, mu]])
    assert sheet.stretched(law).force == pytest.approx(sheet.stretched(Linear(tangent)).force, rel=1e-9)
