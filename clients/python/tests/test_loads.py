"""The JSON of loads and of answers about structures."""

from __future__ import annotations

import json
from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple.simulations import SimulationRequest
from supple.transport import Answer


def test_loads_become_what_the_contract_says() -> None:
    assert supple.GreenStrain(np.array([[0.1, 0, 0.05]])).to_wire() == {"green_strain": [[0.1, 0.0, 0.05]]}
    assert supple.Uniaxial(1, (1.1, 1.2)).to_wire() == {"uniaxial": {"direction": 1.0, "stretches": [1.1, 1.2]}}
    assert supple.Uniaxial(0, [1.1], "material").to_wire()["uniaxial"]["frame"] == "material"
    assert supple.Biaxial(0.5, [(1.1, 0.9)]).to_wire() == {"biaxial": {"direction": 0.5, "stretches": [[1.1, 0.9]]}}


@pytest.mark.parametrize("strains", [[0.1, 0, 0], [[0.1, 0]], []])
def test_strains_of_another_shape_are_refused(strains: Any) -> None:
    with pytest.raises(ValueError):
        supple.GreenStrain(strains).to_wire()


def test_options_that_are_not_given_are_left_to_the_server() -> None:
    request = SimulationRequest("IH01", None, supple.Uniaxial(0, [1.1]), tolerance=1e-6, patch="off")
    assert request.to_wire() == {"family": "IH01", "load": {"uniaxial": {"direction": 0.0, "stretches": [1.1]}},
                                 "accuracy": {"tolerance": 1e-6}, "effects": {"patch": "off"},
                                 "deformed": "none"}
    assert SimulationRequest("IH01", [0.1], supple.Uniaxial(0, [1.1]), tangents=False).to_wire()["tangents"] is False


def state(**more: Any) -> Dict[str, Any]:
    return {"green_strain": [0.1, 0, 0], "stress": [1, 2, 3], "energy_density": 0.5, "tangent": None,
            "deformation_gradient": [[1, 0], [0, 1]], "stopped": "converged", "residual": 1e-9, "iterations": 3,
            "load_steps": 1, "contacts": 0, "smallest_gap": None, "smallest_jacobian": 0.9, "stable": True, "branch": 0,
            "cells": 1, "stress_error": 0.01, "energy_density_error": 0.002, **more}


def answer(**more: Any) -> Dict[str, Any]:
    return {"family": "IH01", "parameters": [0.1], "states": [state(), state(tangent=np.eye(3).tolist())], "message": "",
            "accuracy": {"tolerance": 1e-8, "residual": 1e-9, "nodes": 7, "triangles": 3, "unknowns": 18, "mesh_size": 1.0,
                         "discretization_error": {"stress": 0.003, "energy": 0.002}, "accepted_error": 0.004,
                         "error_accepted": True, "extrapolated": True}, "effects": [],
            "cost": {"seconds": 1, "stages": [], "quantities": {}}, **more}


def read(document: Dict[str, Any]) -> supple.Simulation:
    request = SimulationRequest("IH01", None, supple.Uniaxial(0, [1.1]))
    return request.decode(Answer(200, {}, json.dumps(document).encode()))


def test_the_states_are_arrays_with_nan_where_there_is_no_tangent() -> None:
    result = read(answer())
    assert result.stress.shape == (2, 3) and result.energy_density.shape == (2,)
    assert np.isnan(result.tangent[0]).all() and (result.tangent[1] == np.eye(3)).all()
    assert result.converged and result.states[0].smallest_gap is None


def test_what_is_known_of_the_meshs_error_is_told() -> None:
    result = read(answer())
    assert result.discretization_error == supple.DiscretizationError(0.003, 0.002)
    assert result.error_accepted and result.extrapolated and result.mesh_size == 1.0
    assert (result.states[0].stress_error, result.states[0].energy_density_error) == (0.01, 0.002)
    unknown = {**answer()["accuracy"], "discretization_error": None, "error_accepted": None}
    assert read(answer(accuracy=unknown)).discretization_error is None


def test_a_path_that_ended_early_has_not_converged() -> None:
    assert not read(answer(message="stuck")).converged
    assert not read(answer(states=[state(stopped="iteration_limit")])).converged
    assert read(answer(states=[])).stress.shape == (0, 3)


def test_deformed_points_refer_to_their_mesh() -> None:
    mesh = {"cells": 1, "lattice": [[1, 0], [0, 1]], "points": [[0, 0]] * 6, "triangles": [[0, 1, 2, 3, 4, 5]]}
    deformed = {"mesh": 0, "lattice": [[2, 0], [0, 1]], "points": [[1, 1]] * 6}
    patch = read(answer(meshes=[mesh], states=[state(deformed=deformed)])).states[0].deformed
    assert patch is not None and patch.mesh.triangles.shape == (1, 6) and patch.points.shape == (6, 2)


def test_a_file_of_an_unknown_kind_is_refused_before_it_is_asked_for() -> None:
    with supple.Client("http://127.0.0.1:9") as client, pytest.raises(ValueError, match="svg"):
        client.structure_file("IH01", kind="png")
