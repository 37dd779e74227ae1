"""The JSON of requests about Voronoi diagrams and of their answers."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple.voronoi import VoronoiFileRequest, VoronoiOptimizationRequest, VoronoiRequest
from supple.wire import decode

MESH = "a" * 64
SPREAD = {"mean": 1, "least": 0.5, "greatest": 2, "deviation": 0.1}
STATISTICS = {name: SPREAD for name in ("edge_length", "planarity", "area", "vertex_distance")}
CORNER = {"face": 0, "barycentric": [1, 0, 0]}
DIAGRAM: Dict[str, Any] = {
    "mesh": MESH, "sites": [CORNER, {"face": 2, "barycentric": [0.2, 0.3, 0.5]}], "site_positions": [[0, 0, 0], [1, 2, 3]],
    "cells": [{"site": 0, "area": 2.5, "boundary": [[0, 1, 2], [3, 4, 5]], "neighbours": [1]},
              {"site": 1, "area": 0, "boundary": [], "neighbours": []}],
    "vertices": [{"point": CORNER, "position": [0, 1, 0], "sites": [0, 1, 1], "distance": 0.5, "index": 3}],
    "edges": [{"sites": [0, 1], "vertices": [0, None], "length": 4, "points": [3, 1]}],
    "dual": [[0, 1, 1]], "positions": [[k, 0, 0] for k in range(6)], "unreached_area": 0.25, "warnings": ["One."],
    "effects": [], "cost": {"seconds": 0.1, "stages": [], "quantities": {}},
}
ANSWER = {**DIAGRAM, "statistics": STATISTICS,
          "accuracy": {"method": "bounded", "relative_error": 0.01, "relative_error_bound": 0.01, "border_deviation": 1e-4}}
OPTIMIZED = {**DIAGRAM, "statistics": {"before": {**STATISTICS, "area": {**SPREAD, "mean": 7}}, "after": STATISTICS},
             "energy": 3, "terms": [{"name": "centroidal", "energy": 3}], "gradient_norm": 0.5, "iterations": 1,
             "history": [{"energy": 4, "gradient_norm": 2, "step_length": 0}, {"energy": 3, "gradient_norm": 0.5, "step_length": 1}],
             "stopped": "iteration_limit", "accuracy": {"tolerance": 1e-6, "gradient_tolerance": 0.4, "gradient_norm": 0.5,
                                                      "border_deviation": 1e-3}}


def test_a_diagram_is_asked_for_as_the_contract_says() -> None:
    plain = VoronoiRequest(MESH, [0, (3, (0.2, 0.3, 0.5))])
    assert plain.to_wire() == {"mesh": MESH, "sites": [{"vertex": 0}, {"face": 3, "barycentric": [0.2, 0.3, 0.5]}]}
    full = VoronoiRequest(MESH, supple.RandomSites(5, seed=2), None, 0.05, 1e-3, 9.0, points=True, pieces=True, statistics=False)
    assert full.to_wire() == {"mesh": MESH, "sites": {"count": 5, "seed": 2}, "accuracy": {"method": "bounded", "relative_error": 0.05, "border_deviation": 1e-3},
                    "points": True, "pieces": True, "statistics": False, "deadline": 9.0}
    assert plain.url() == "/v1/voronoi-diagrams"


def test_an_optimization_is_asked_for_as_the_contract_says() -> None:
    options = supple.VoronoiOptions(target_length=0.5, method="lbfgs", tolerance=1e-4, max_iterations=7, border_deviation=1e-2)
    request = VoronoiOptimizationRequest(MESH, supple.RandomSites(5), {"planarity": 2}, [np.int64(1)], options)
    assert request.to_wire() == {"mesh": MESH, "sites": {"count": 5}, "objectives": {"planarity": 2.0}, "fixed_sites": [1],
                        "target_length": 0.5, "method": "lbfgs", "max_iterations": 7, "accuracy": {"tolerance": 1e-4, "border_deviation": 1e-2}}
    assert request.url() == "/v1/voronoi-optimizations"


def test_moves_of_single_sites_are_read_where_there_were_any() -> None:
    assert decode(supple.OptimizedVoronoi, OPTIMIZED).site_moves is None
    moves = {"held_searches": 4, "passes": 2, "tried": 1600, "taken": 3, "energy_before": 5.0, "last_gain": 0.0004}
    assert decode(supple.OptimizedVoronoi, {**OPTIMIZED, "site_moves": moves}).site_moves == supple.SiteMoves(4, 2, 1600, 3, 5.0, 0.0004)


def test_files_are_asked_for_by_their_media_types() -> None:
    panels = VoronoiFileRequest(MESH, [0], kind="svg", panel_scale=250)
    assert panels.accept == "image/svg+xml" and panels.to_wire()["panel_scale"] == 250
    assert VoronoiFileRequest(MESH, [0], kind="csv").accept == "text/csv"
    with pytest.raises(ValueError, match="'obj', 'vtu', 'svg', 'csv'"):
        VoronoiFileRequest(MESH, [0], kind="pdf")


def test_a_diagram_is_read_with_its_borders_as_polylines() -> None:
    found = decode(supple.VoronoiDiagram, ANSWER)
    assert found.site_positions.shape == (2, 3) and found.positions.shape == (6, 3) and found.dual.tolist() == [[0, 1, 1]]
    assert [border.tolist() for border in found.cells[0].boundary] == [[0, 1, 2], [3, 4, 5]]
    outer, inner = found.borders(0)
    assert outer[:, 0].tolist() == [0, 1, 2, 0] and inner[:, 0].tolist() == [3, 4, 5, 3]
    assert found.borders(1) == () and found.cells[1].neighbours == ()
    assert found.edges[0].vertices == (0, None) and found.vertices[0].sites == (0, 1, 1)
    assert found.points is None and found.pieces is None and found.unreached_area == 0.25
    assert found.statistics is not None and found.statistics.area.greatest == 2 and found.relative_error_bound == 0.01
    bare = {name: value for name, value in ANSWER.items() if name != "statistics"}
    assert decode(supple.VoronoiDiagram, bare).statistics is None


def test_points_and_pieces_are_read_where_there_are_any() -> None:
    pieces = {"vertex_sites": [0, None], "face_sites": [None, 1],
              "cut_faces": [{"site": 1, "face": 0, "area": 0.5, "corners": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}]}
    found = decode(supple.VoronoiDiagram, {**ANSWER, "points": [CORNER], "pieces": pieces})
    assert found.points == (supple.SurfacePoint(0, (1.0, 0.0, 0.0)),) and found.pieces is not None
    assert found.pieces.vertex_sites.tolist() == [0, -1] and found.pieces.face_sites.tolist() == [-1, 1]
    assert found.pieces.cut_faces[0].site == 1 and found.pieces.cut_faces[0].corners.shape == (3, 3)
    assert found.pieces.cut_faces[0].area == 0.5 and found.border_deviation == 1e-4


def test_an_optimized_diagram_is_read_with_both_statistics() -> None:
    found = decode(supple.OptimizedVoronoi, OPTIMIZED)
    assert found.before.area.mean == 7 and found.diagram.statistics is not None and found.diagram.statistics.area.mean == 1
    assert found.terms == {"centroidal": 3.0} and not found.converged and len(found.history) == 2
    assert found.gradient_tolerance == 0.4 and found.history[1].step_length == 1


def test_a_diagram_on_its_way_is_read() -> None:
    status = {"id": "1", "state": "running", "kind": "voronoi-optimizations", "progress": 0.5, "stage": "cells", "created": "",
              "partial": {"iteration": 3, "energy": 2, "gradient_norm": 1, "step_length": 0.1,
                          "sites": [CORNER], "site_positions": [[0, 0, 0]], "positions": [[0, 0, 0], [1, 0, 0]], "vertices": [1],
                          "borders": [[0, 1]]}}
    partial = decode(supple.JobStatus, status).partial
    assert isinstance(partial, supple.PartialOptimization) and partial.borders is not None
    assert partial.iteration == 3 and partial.step_length == 0.1 and partial.borders[0].tolist() == [0, 1]
    assert partial.sites is not None and len(partial.sites) == 1
    large = decode(supple.JobStatus, {**status, "partial": {"iteration": 3, "energy": 2, "gradient_norm": 1, "step_length": 0.1}}).partial
    assert isinstance(large, supple.PartialOptimization) and large.positions is None and large.borders is None
