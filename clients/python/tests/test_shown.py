"""The display of results in a line, in notebooks and with matplotlib."""

from __future__ import annotations

import builtins
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List

import matplotlib
import numpy as np
import pytest

import supple
from supple.drawing import Drawing, Line, curve, to_svg
from supple.shown import MAX_LINE_LENGTH, short_text
from supple.wire import decode

from test_designs import BILL, MATERIAL, design_document, profile_document

matplotlib.use("Agg")

PATH = [{"face": 0, "barycentric": [1, 0, 0], "position": [0, 0, 0]}, {"face": 0, "barycentric": [0, 1, 0], "position": [3, 4, 0]}]


def parsed(svg: Any) -> ElementTree.Element:
    assert isinstance(svg, str)
    return ElementTree.fromstring(svg)


def drawn_paths(svg: Any) -> List[str]:
    return [path.attrib["d"] for path in parsed(svg).iter("{http://www.w3.org/2000/svg}path") if path.attrib["d"]]


def test_values_are_shown_in_a_few_characters() -> None:
    assert [short_text(value) for value in (None, True, 3, np.int64(4), 1 / 3, np.float32(0.5), "a")] == [
        "None", "True", "3", "4", "0.333333", "0.5", "'a'"]
    assert short_text(np.array([0.15, 0.65])) == "[0.15, 0.65]" and short_text(np.zeros((200, 2))) == "array(200, 2)"
    assert short_text((1.0, 2.0, 3.0)) == "(1, 2, 3)" and short_text(()) == "()"
    assert short_text(({}, {})) == "2 × dict" and len(short_text("x" * 1000)) < 50


@pytest.mark.parametrize("value, shown", [
    (1e308, "1e+308"), (0.1 + 0.2, "0.3"), (-2.07e-17, "-2.07e-17"), ([3.0, -2.07e-17], "(3, 0)"), (np.array([0.1 + 0.2, 1e-20]), "[0.3, 0]"),
    (np.array([1e-12, 2e-12]), "[1e-12, 2e-12]"), pytest.param(10**308, "1e+308", id="huge"), (2**40, "1099511627776"),
    (np.array([1.0, np.inf, np.nan]), "[1, inf, nan]"),
    ([1, 2.5], "(1, 2.5)"),
])
def test_numbers_are_shown_as_people_write_them(value: Any, shown: str) -> None:
    assert short_text(value) == shown and len(shown) < 30


def test_a_result_is_one_short_line() -> None:
    result = decode(supple.DesignResult, {**design_document(), **BILL})
    line = repr(result)
    assert line.startswith("DesignResult(deviation=2 % by the model, parameters=[0.15, 0.65], family='IH21', verdict='reached', ")
    assert line.endswith("…)") and line.count("family") == 1
    simulated = {"grade": "missed", "source": "simulation", "deviation": 0.45, "sentence": "Simulated: 45 % off."}
    assert repr(decode(supple.DesignResult, {**design_document(verdict=simulated), **BILL})).startswith("DesignResult(deviation=45 % simulated, ")
    lost = decode(supple.DesignResult, {**design_document(verdict={**simulated, "deviation": None}), **BILL})
    assert repr(lost).startswith("DesignResult(deviation=unknown, ")
    assert "\n" not in line and len(line) <= MAX_LINE_LENGTH + 4
    assert repr(result.error) == "DesignError(relative_rms=0.02, max=0.3)"


def test_a_ranking_says_what_the_model_says_and_what_the_simulation_says() -> None:
    (ranked,) = design_document()["ranking"]
    ranking = [{**ranked, "simulated_error": 0.45}, {**ranked, "family": "IH29"}]
    result = decode(supple.DesignResult, {**design_document(ranking=ranking), **BILL})
    first, second = map(repr, result.ranking)
    assert first.startswith("DesignCandidate(family='IH21', deviation=45 % simulated, ")
    assert second.startswith("DesignCandidate(family='IH29', deviation=2 % by the model, ")
    assert "IH21: 45 % simulated; IH29: 2 % by the model" in result._repr_html_()


def test_a_polished_design_shows_each_round() -> None:
    one = {"proposal": "search", "parameters": [0.15], "target_error": 0.045, "accepted": True, "reason": "", "seconds": 2.0, "orientation": 0}
    failed = {**one, "proposal": "step", "target_error": None, "accepted": False, "reason": "no equilibrium", "seconds": 1.5}
    polish = decode(supple.Polish, {"target_error": 0.045, "stopped": "round_limit", "rounds": [one, failed]})
    assert repr(polish).startswith("Polish(deviation=4.5 % by the simulation, stopped='round_limit', round 0=4.5 % after 2 s, search, kept")
    assert "not simulated after 1.5 s, step, not kept: no equilibrium" in polish._repr_html_()


def test_text_of_the_server_is_no_markup() -> None:
    result = decode(supple.DesignResult, {**design_document(family="<script>alert(1)</script>"), **BILL})
    assert "<script>" not in result._repr_html_() and "&lt;script&gt;" in result._repr_html_()
    parsed(result._repr_svg_())


def test_a_notebook_shows_a_table_and_a_picture_of_a_design() -> None:
    result = decode(supple.DesignResult, {**design_document(), **BILL})
    html = result._repr_html_()
    assert html.startswith("<svg") and "<th style" in html and "IH21" in html and "<table>" in html
    assert len(drawn_paths(result._repr_svg_())) == 2  # the target and the achieved profile


def filled(svg: Any) -> List[str]:
    paths = parsed(svg).iter("{http://www.w3.org/2000/svg}path")
    return [path.attrib["d"] for path in paths if "fill-opacity" in path.attrib]


def test_error_bars_are_a_band_around_a_curve() -> None:
    document = profile_document(x=[0, 0.1, 0.2, 0.3, 0.4], target=[0, 1, 2, 3, 4], achieved=[0, 1, 2, 3, 4], initial=[0] * 5,
                                error_bar=[0.1, 0.2, None, 0.4, 0.5], in_range=[True] * 5, reached=[True] * 5)
    design = decode(supple.DesignResult, {**design_document(profile=document), **BILL})
    assert len(filled(design._repr_svg_())) == 2  # the sample without an error bar interrupts it
    bands = design.plot().collections
    assert len(bands) == 2
    np.testing.assert_allclose(bands[1].get_paths()[0].get_extents().intervaly, [2.6, 4.5])
    assert filled(decode(supple.DesignResult, {**design_document(), **BILL})._repr_svg_()) == []


def test_error_bars_over_directions_are_rings_or_bands_in_degrees() -> None:
    document = {"family": "IH21", "model": "ih21", "sha256": "0", "parameters": [0.1], "strain": 0.05, "strain_measure": "green",
                "x": [0, np.pi / 2], "y": [1.0, 2.0], "error_bar": [0.1, 0.2], "in_range": [True, True], "orientation": 0,
                "material": MATERIAL, **BILL}
    polar = decode(supple.ProfileCurve, {**document, "task": "stiffness"})
    assert len(filled(polar._repr_svg_())) == 2 and len(polar.plot().collections) == 2  # both halves of the turn
    band = decode(supple.ProfileCurve, {**document, "task": "poisson"}).plot().collections[0]
    np.testing.assert_allclose(band.get_paths()[0].get_extents().get_points(), [[0, 0.9], [90, 2.2]])


def test_what_is_missing_interrupts_a_curve() -> None:
    svg = to_svg(Drawing("curves", (curve([0, 1, 2, 3, 4], [0, 1, np.nan, 1, 0]),)))
    assert drawn_paths(svg)[0].count("M") == 2 and "nan" not in svg


def test_a_curve_without_values_and_a_single_point_are_drawn_without_fail() -> None:
    for points in (np.empty((0, 2)), np.zeros((1, 2)), np.full((3, 2), np.nan), np.array([[0.0, 5.0], [1.0, 5.0]])):
        for kind in ("curves", "polar", "map"):
            assert "nan" not in to_svg(Drawing(kind, (Line(points), Line(points, marks=True))))


def test_a_path_is_seen_from_a_corner_and_plotted_in_space() -> None:
    climbing = [PATH[0], {**PATH[1], "position": [3, 4, 12]}]
    geodesic = decode(supple.Geodesic, {"unreachable": False, "distance": 13.0, "path": climbing})
    assert len(drawn_paths(geodesic._repr_svg_())) == 1
    axes = geodesic.plot()
    assert axes.name == "3d"
    x, y, z = axes.lines[0].get_data_3d()
    assert (x[-1], y[-1], z[-1]) == (3, 4, 12)
    without = decode(supple.Geodesic, {"unreachable": False, "distance": 5.0})
    assert without._repr_svg_() is None and without._repr_html_().startswith("<table>")
    with pytest.raises(ValueError, match="was not asked for"):
        without.plot()


def test_what_is_flat_is_seen_from_above() -> None:
    geodesic = decode(supple.Geodesic, {"unreachable": False, "distance": 5.0, "path": PATH})
    axes = geodesic.plot()
    assert axes.name == "rectilinear"
    np.testing.assert_array_equal(axes.lines[0].get_xydata(), [[0, 0], [3, 4]])
    start, end = (np.array([float(x) for x in pair.split()]) for pair in drawn_paths(geodesic._repr_svg_())[0][1:].split("L"))
    assert (start - end)[1] / (end - start)[0] == pytest.approx(4 / 3, rel=0.01)  # y increases upwards in the picture


def test_a_profile_is_plotted_over_strains_or_directions() -> None:
    axes = decode(supple.DesignResult, {**design_document(), **BILL}).plot()
    assert axes.get_xlabel() == "strain along the load" and [line.get_label() for line in axes.lines] == ["target", "achieved"]
    np.testing.assert_allclose(axes.lines[1].get_xydata(), [[0, 0], [0.1, 1.02]])
    document = {"family": "IH21", "model": "ih21", "sha256": "0", "parameters": [0.1], "strain": 0.05, "strain_measure": "green",
                "x": [0, np.pi / 2], "y": [1.0, 2.0], "error_bar": None, "in_range": [True, True], "orientation": 0, "material": MATERIAL, **BILL}
    assert decode(supple.ProfileCurve, {**document, "task": "stiffness"}).plot().name == "polar"
    over_degrees = decode(supple.ProfileCurve, {**document, "task": "poisson", "y": [-0.2, 0.3]}).plot()
    np.testing.assert_allclose(over_degrees.lines[0].get_xydata(), [[0, -0.2], [90, 0.3]])


def test_a_plot_goes_into_axes_that_are_given() -> None:
    from matplotlib import pyplot

    axes = pyplot.figure().add_subplot()
    assert decode(supple.DesignResult, {**design_document(), **BILL}).profile.plot(axes) is axes and len(axes.lines) == 2


def test_without_matplotlib_plot_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *arguments: Any, **more: Any) -> Any:
        if name.split(".")[0] == "matplotlib":
            raise ImportError("no matplotlib")
        return real(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    result = decode(supple.DesignResult, {**design_document(), **BILL})
    with pytest.raises(ImportError, match="plot.. needs matplotlib, which is not installed"):
        result.plot()
    assert result._repr_html_()


def test_sliding_and_fused_crossings_have_colours_of_their_own() -> None:
    def member(slides: bool) -> Dict[str, Any]:
        return {"strand": 0, "coordinate": 0.0, "shift": [0, 0], "slides": slides}

    layout = decode(supple.WeaveLayout, {
        "strands": [{"ends": "open", "translation": [0, 0], "length": 1.0, "radius": 0.1, "polyline": [[0, 0], [1, 1]]}],
        "crossings": [{"position": [0, 0], "members": [member(False)]}, {"position": [1, 1], "members": [member(True)]}],
        "lattice": None, "warnings": [], "cost": BILL["cost"]})
    colours = [circle.attrib["fill"] for circle in parsed(layout._repr_svg_()).iter("{http://www.w3.org/2000/svg}circle")]
    assert len(colours) == 2 and colours[0] != colours[1]


def test_stress_along_the_load_is_drawn_over_the_strain_along_it() -> None:
    state = {"green_strain": [0.1, 0.3, 0.05], "stress": [1, 2, 0], "directional_stress": 2, "error_bar": None,
             "energy_density": 0.05, "in_range": True, "converged": True, "residual": 1e-12, "iterations": 3}
    line = decode(supple.UniaxialCurve, {"direction": np.pi / 4, "states": [state], "accuracy": {"tolerance": 1e-10}, "sha256": "0",
                               "cost": BILL["cost"]}).plot().lines[0]
    np.testing.assert_allclose(line.get_xydata(), [[0.25, 2]])


def test_every_result_of_the_package_is_shown_in_its_own_way() -> None:
    from supple.shown import Shown
    from supple.wire import Sent

    results = [getattr(supple, name) for name in supple.__all__]
    answers = [one for one in results if isinstance(one, type) and one.__module__.endswith(("answers", "simulations", "tilings"))]
    assert len(answers) > 50
    assert [one.__name__ for one in answers if not issubclass(one, (Shown, Sent, supple.Request))] == []
