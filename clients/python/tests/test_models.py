"""The JSON of requests to neural models and of their answers."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
import pytest

from supple.models import Evaluation, EvaluationRequest, ModelInfo, UniaxialCurve, UniaxialRequest
from supple.wire import decode

COST = {"seconds": 0.1, "stages": [], "quantities": {}}


@pytest.mark.parametrize("parameters, strains", [
    ([0.15, 0.65], [0.1, 0, 0.05]), ([[0.15, 0.65]], [[0.1, 0, 0.05]]), (np.array([0.15, 0.65]), np.array([[0.1, 0, 0.05]])),
])
def test_one_design_and_one_strain_may_come_without_their_first_axis(parameters: Any, strains: Any) -> None:
    request = EvaluationRequest("ih21", parameters, strains, 2)
    assert request.url() == "/v1/models/ih21/evaluations"
    assert request.to_wire() == {"parameters": [[0.15, 0.65]], "green_strain": [[0.1, 0.0, 0.05]], "derivatives": 2}


@pytest.mark.parametrize("parameters, strains", [
    ([0.15, 0.65], [0.1, 0]), ([0.15, 0.65], [[[0.1, 0, 0]]]), ([0.15, 0.65], []), ([], [[0.1, 0, 0]]),
    ([[[0.15]]], [[0.1, 0, 0]]),
])
def test_arrays_of_another_shape_are_refused(parameters: Any, strains: Any) -> None:
    with pytest.raises(ValueError, match="shape"):
        EvaluationRequest("ih21", parameters, strains).to_wire()


def test_a_uniaxial_load_is_given_in_one_of_two_ways() -> None:
    request = UniaxialRequest("ih/21", (0.15, 0.65), 1, [1.1], tolerance=1e-6, deadline=3.0)
    assert request.url() == "/v1/models/ih%2F21/uniaxial"
    assert request.to_wire() == {"parameters": [0.15, 0.65], "direction": 1.0, "stretches": [1.1],
                                 "accuracy": {"tolerance": 1e-6}, "deadline": 3.0}
    assert UniaxialRequest("ih21", [0.1], 0, green_strains=np.array([0.1])).to_wire()["green_strains"] == [0.1]
    for stretches, strains in (([1.1], [0.1]), (None, None)):
        with pytest.raises(ValueError):
            UniaxialRequest("ih21", [0.1], 0, stretches, strains)


def test_what_was_not_asked_for_is_none() -> None:
    document: Dict[str, Any] = {"model": "ih21", "sha256": "0", "energy_density": [1, 2], "in_range": [True, False],
                                "effects": [], "cost": COST}
    energies = decode(Evaluation, document)
    assert energies.stress is None and energies.tangent is None
    np.testing.assert_array_equal(energies.energy_density, [1.0, 2.0])
    assert energies.in_range.dtype == np.bool_ and energies.in_range.tolist() == [True, False]
    tangent = np.arange(18.0).reshape(2, 3, 3)
    everything = decode(Evaluation, {**document, "stress": [[1, 2, 3], [4, 5, 6]], "tangent": tangent.tolist(),
                                       "stress_error_bar": [0.5, None]})
    assert energies.stress_error_bar is None and everything.stress_error_bar is not None
    assert everything.stress_error_bar[0] == 0.5 and np.isnan(everything.stress_error_bar[1])
    assert everything.stress is not None and everything.stress.shape == (2, 3)
    np.testing.assert_array_equal(everything.tangent, tangent)


def test_states_become_columns_and_a_missing_residual_is_nan() -> None:
    state = {"green_strain": [0.1, 0, 0], "stress": [1, 0, 0], "directional_stress": 1, "error_bar": 0.02,
             "energy_density": 0.05, "in_range": True, "converged": True, "residual": 1e-12, "iterations": 3}
    lost = {**state, "converged": False, "in_range": False, "residual": None, "error_bar": None}
    curve = decode(UniaxialCurve, {"direction": 0.5, "states": [state, lost], "accuracy": {"tolerance": 1e-10}, "sha256": "0",
                                "cost": COST})
    assert curve.green_strain.shape == curve.stress.shape == (2, 3) and curve.iterations.tolist() == [3, 3]
    assert not curve.converged and curve.state_converged.tolist() == [True, False]
    assert curve.residual[0] == 1e-12 and np.isnan(curve.residual[1])
    assert curve.error_bar[0] == 0.02 and np.isnan(curve.error_bar[1])


def test_errors_that_are_not_known_are_none() -> None:
    statistics = {"mean": 0.01, "root_mean_square": 0.02, "median": 0.005, "percentile_99": 0.1}
    info = decode(ModelInfo, {
        "id": "ih21", "family": "IH21", "parameters": {"lower": [0.1, 0.5], "upper": [0.2, 0.8]}, "sha256": "0",
        "strain_range": {"smallest_principal": -0.2, "largest_principal": 0.3, "largest_relative_energy": 0.05},
        "errors": {"design_split": {"gradient": statistics, "energy": {**statistics, "mean": 0.02}, "designs": 3,
                                    "samples": 300}, "row_split": None}, "error_bars": None,
        "network": {"width": 16}, "provenance": {"seed": 1}, "material": {"youngs_modulus": 26, "poisson_ratio": 0.48}})
    assert info.row_split is None and info.error_bars is None and info.design_split is not None
    assert (info.design_split.gradient.mean, info.design_split.energy.mean) == (0.01, 0.02)
    assert info.lower.shape == (2,) and info.smallest_principal == -0.2
