"""The JSON of requests about networks on surfaces and of their answers."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple.networks import NetworkFileRequest, RelaxationRequest
from supple.wire import decode

MESH = "a" * 64
ANSWER: Dict[str, Any] = {
    "mesh": MESH,
    "points": [{"face": 0, "barycentric": [1, 0, 0]}, {"face": 2, "barycentric": [0.2, 0.3, 0.5]}],
    "positions": [[0, 0, 0], [1, 2, 3]],
    "springs": [{"between": [0, 1], "length": 4, "energy": 16, "compressed": False, "at_cut_locus": True}],
    "energy": 16, "terms": [{"name": "geodesic_springs", "energy": 16}], "gradient_norm": 0.5, "iterations": 1,
    "history": [{"energy": 20, "gradient_norm": 2, "step_length": 0, "regularization": 0},
                {"energy": 16, "gradient_norm": 0.5, "step_length": 1, "regularization": 0.1}],
    "stopped": "iteration_limit", "mollified": False, "at_vertices": [0], "loose_points": [], "warnings": ["One."],
    "accuracy": {"tolerance": 0.1, "gradient_tolerance": 0.4, "gradient_norm": 0.5, "mollifier_length": 1e-6},
    "effects": [], "cost": {"seconds": 0.1, "stages": [], "quantities": {}},
}


def test_points_and_springs_one_by_one_become_what_the_contract_says() -> None:
    springs = [(0, 1), supple.Spring(1, 2, rest_length=0.5, weight=3)]
    assert RelaxationRequest(MESH, [0, supple.Vertex(7), (3, (0.2, 0.3, 0.5))], springs, [np.int64(2)]).to_wire() == {
        "mesh": MESH, "points": [{"vertex": 0}, {"vertex": 7}, {"face": 3, "barycentric": [0.2, 0.3, 0.5]}],
        "springs": [{"between": [0, 1], "rest_length": 0.0, "weight": 1.0}, {"between": [1, 2], "rest_length": 0.5, "weight": 3.0}],
        "fixed_points": [2]}
    with pytest.raises(ValueError, match="start, end"):
        RelaxationRequest(MESH, [0, 1], [(0, 1, 2)]).to_wire()  # type: ignore[list-item]


def test_membranes_become_what_the_contract_says() -> None:
    membrane = supple.Membrane([(0, 1, np.int64(2))], youngs_modulus=3, rest_scale=0.9)
    document = RelaxationRequest(MESH, [0, 1, 2], [], membrane=membrane).to_wire()
    assert document["triangles"] == [[0, 1, 2]] and document["springs"] == []
    assert document["membrane"] == {"youngs_modulus": 3, "rest_scale": 0.9}
    every = RelaxationRequest(MESH, supple.PoissonDisk(0.5), supple.VoronoiDual(), membrane=supple.Membrane()).to_wire()
    assert every["triangles"] == {"kind": "voronoi_dual"} and "membrane" not in every


def test_an_answer_of_a_membrane_has_its_triangles() -> None:
    answer = decode(supple.RelaxedNetwork, {**ANSWER, "triangles": [[0, 1, 2]],
                                        "membrane": [{"energy": 2, "stretches": [1.5, 0.5], "at_cut_locus": True}]})
    assert answer.triangles is not None and answer.triangles.tolist() == [[0, 1, 2]]
    assert answer.stretches is not None and answer.stretches.tolist() == [[1.5, 0.5]]
    assert answer.triangle_energies is not None and answer.triangle_energies.tolist() == [2]
    assert answer.triangles_at_cut_locus is not None and answer.triangles_at_cut_locus.tolist() == [True]
    without = decode(supple.RelaxedNetwork, ANSWER)
    assert without.stretches is None and without.triangle_energies is None


def test_hosts_become_what_the_contract_says() -> None:
    shell = supple.Shell(0.01, 1e4, poisson_ratio=0.48, volume_weight=1e3, volume_scale=1.1, fixed_vertices=[np.int64(4), 7])
    document = RelaxationRequest(MESH, [0, 1], [(0, 1)], host=shell, options=supple.RelaxationOptions(bending="off")).to_wire()
    assert document["host"] == {"kind": "shell", "thickness": 0.01, "youngs_modulus": 1e4, "poisson_ratio": 0.48,
                                "volume_weight": 1e3, "volume_scale": 1.1, "fixed_vertices": [4, 7]}
    assert document["effects"] == {"bending": "off"}
    solid = supple.Solid(50, element_size=0.2, gravity=(0, 0, -1), fixed_vertices=(0,),
                         regions=[supple.SolidRegion((0, 0, 0), (1, 1, 1), youngs_modulus=5)])
    assert solid.to_wire() == {
        "kind": "solid", "youngs_modulus": 50.0, "element_size": 0.2, "gravity": [0, 0, -1], "fixed_vertices": [0],
        "regions": [{"lower": [0, 0, 0], "upper": [1, 1, 1], "youngs_modulus": 5.0}]}
    moved = supple.Solid(2, moved_vertices={np.int64(3): (0, 0, 1), 4: [[0, 0, 1], [1, 0, 1]]}).to_wire()["moved_vertices"]
    assert moved == [{"vertex": 3, "positions": [[0, 0, 1]]}, {"vertex": 4, "positions": [[0, 0, 1], [1, 0, 1]]}]
    assert supple.Shell(1, 2, moved_vertices={3: (0, 0, 1)}).to_wire()["moved_vertices"] == moved[:1]
    for wrong in ((0, 1), np.zeros((0, 3)), [[0, 1]]):
        with pytest.raises(ValueError, match="vertex 7 is moved"):
            supple.Solid(2, moved_vertices={7: wrong}).to_wire()
    assert supple.Shell(1, 2).to_wire() == {"kind": "shell", "thickness": 1.0, "youngs_modulus": 2.0}
    assert supple.Solid(2).to_wire() == {"kind": "solid", "youngs_modulus": 2.0}
    moving = supple.Moving([np.eye(3), [[0, 0, 1], [1, 0, 1], [0, 1, 1]]]).to_wire()
    assert moving == {"kind": "moving", "positions": [np.eye(3).tolist(), [[0, 0, 1], [1, 0, 1], [0, 1, 1]]]}
    with pytest.raises(ValueError, match="n, 3"):
        supple.Moving([[0, 0, 1]]).to_wire()
    assert "host" not in RelaxationRequest(MESH, [0, 1], [(0, 1)]).to_wire()
    with pytest.raises(ValueError, match="gravity"):
        supple.Solid(2, gravity=(0, -1)).to_wire()  # type: ignore[arg-type]


def test_an_answer_of_a_host_that_gives_way_has_its_vertices() -> None:
    host = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "largest_displacement": 0.5}
    shell = decode(supple.RelaxedNetwork, {**ANSWER, "host": host}).host
    assert shell is not None and shell.vertices.shape == (3, 3) and shell.vertices.dtype == np.float64
    assert shell.largest_displacement == 0.5 and shell.volume_ratio is None and shell.tetrahedra is None
    solid = decode(supple.RelaxedNetwork, {**ANSWER, "host": {**host, "volume_ratio": 0.9, "tetrahedra": 7, "nodes": 12}}).host
    assert solid is not None and (solid.volume_ratio, solid.tetrahedra, solid.nodes) == (0.9, 7, 12)
    assert solid.stops is None
    stop = {"energy": 1.5, "gradient_norm": 1e-9, "iterations": 4, "load_steps": 2, "jumps": 3, "stopped": "converged", "reached": 0.25}
    moved = decode(supple.RelaxedNetwork, {**ANSWER, "host": {**host, "stops": [stop]}}).host
    assert moved is not None and moved.stops == (supple.FollowedStop(1.5, 1e-9, 4, 2, "converged", 0.25, 3),)
    assert decode(supple.RelaxedNetwork, ANSWER).host is None


def test_builders_and_options_become_what_the_contract_says() -> None:
    options = supple.RelaxationOptions(method="lbfgs", spring_length="euclidean", tolerance=1e-6, max_iterations=5,
                                       mollifier="on", mollifier_length=0.1, kept_strips="off")
    assert RelaxationRequest(MESH, supple.PoissonDisk(0.5, seed=3), supple.VoronoiDual(0.2), options=options, paths=True,
                             deadline=9).to_wire() == {
        "mesh": MESH, "points": {"kind": "poisson_disk", "radius": 0.5, "seed": 3},
        "springs": {"kind": "voronoi_dual", "rest_length": 0.2, "weight": 1.0}, "method": "lbfgs",
        "spring_length": "euclidean", "max_iterations": 5, "accuracy": {"tolerance": 1e-6, "mollifier_length": 0.1},
        "effects": {"mollifier": "on", "kept_strips": "off"}, "paths": True, "deadline": 9}
    document = RelaxationRequest(MESH, supple.PointsInFaces(), supple.AdjacentFaces(weight=2)).to_wire()
    assert document["points"] == {"kind": "per_face", "barycentric": [0.25, 0.25, 0.5]}
    assert document["springs"] == {"kind": "adjacent_faces", "rest_length": 0.0, "weight": 2.0}
    assert supple.PoissonDisk(1).to_wire() == {"kind": "poisson_disk", "radius": 1.0}


def test_an_answer_becomes_arrays_of_its_points_and_springs() -> None:
    network = decode(supple.RelaxedNetwork, ANSWER)
    assert network.positions.shape == (2, 3) and network.springs.tolist() == [[0, 1]]
    assert (network.lengths.tolist(), network.energies.tolist()) == ([4], [16])
    assert (network.compressed.tolist(), network.at_cut_locus.tolist()) == ([False], [True])
    assert network.points[1] == supple.SurfacePoint(2, (0.2, 0.3, 0.5))
    assert network.paths is None and network.triangles is None and not network.converged
    assert network.terms == {"geodesic_springs": 16} and network.gradient_tolerance == 0.4
    assert [step.energy for step in network.history] == [20, 16] and network.at_vertices == (0,)
    path = [{"face": 0, "barycentric": [1, 0, 0], "position": [0, 0, 0], "vertex": 4},
            {"face": 2, "barycentric": [0.2, 0.3, 0.5], "position": [1, 2, 3]}]
    more = decode(supple.RelaxedNetwork, {**ANSWER, "springs": [{**ANSWER["springs"][0], "path": path}], "triangles": []})
    assert more.paths is not None and more.paths[0].length() == pytest.approx(14**0.5)
    assert more.triangles is not None and more.triangles.shape == (0, 3)


def test_a_network_without_springs_has_empty_arrays() -> None:
    network = decode(supple.RelaxedNetwork, {**ANSWER, "springs": []})
    assert network.springs.shape == (0, 2) and network.lengths.shape == (0,) and network.paths is None


def test_files_ask_for_their_media_type() -> None:
    assert RelaxationRequest(MESH, [0], []).accept == "application/json"
    file = NetworkFileRequest(MESH, [0], [], kind="vtu")
    assert file.accept == "application/x-vtu+xml" and file.to_wire() == RelaxationRequest(MESH, [0], []).to_wire()
    with pytest.raises(ValueError, match="'obj', 'vtu', 'svg'"):
        NetworkFileRequest(MESH, [0], [], kind="stl")


def test_a_job_tells_of_the_network_on_its_way() -> None:
    job = {"id": "0" * 32, "kind": "embedded-systems", "state": "running", "progress": 0.5, "stage": "search", "created": "",
           "partial": {"iteration": 3, "energy": 2.5, "gradient_norm": 0.1, "positions": [[0, 0, 1]]}}
    partial = decode(supple.JobStatus, job).partial
    assert isinstance(partial, supple.PartialRelaxation) and partial.iteration == 3 and partial.energy == 2.5
    assert partial.positions is not None and partial.positions.shape == (1, 3)
    assert partial.vertices is None
    job["partial"]["vertices"] = [[0, 0, 1], [0, 0, 2], [0, 0, 3]]  # type: ignore[index]
    on_a_host = decode(supple.JobStatus, job).partial
    assert isinstance(on_a_host, supple.PartialRelaxation) and on_a_host.vertices is not None
    assert on_a_host.vertices.shape == (3, 3)
    del job["partial"]["positions"]  # type: ignore[attr-defined]
    without = decode(supple.JobStatus, job).partial
    assert isinstance(without, supple.PartialRelaxation) and without.positions is None
